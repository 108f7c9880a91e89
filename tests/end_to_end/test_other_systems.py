"""The main commands in a Python that lacks what Windows and macOS lack."""

import os
import subprocess
import sys

import pytest
from paths import HELPERS, ROOT
from text_files import rows_of

from jaximpact.cli import main

SCENE = """
[impact]
speed_mps = 15
angle_deg = 40
"""
SCENES = "mass_kg,speed_mps,angle_deg\n100,6,0\n500,15,20\n50,25,40\n2000,10,60\n"
SLOPE = """
title = "Steiler Hügel: µ"
count = 20

[profile]
points_m = [[0, 50], [50, 20], [55, 20], [80, 0], [200, 0]]

[ground]
rolling_friction_angle_deg = 25

[block]
mass_kg = 100

[release]
x_m = { from = 2, to = 6 }
clearance_m = 0.5
speed_mps = 5

[[contacts]]
law = "frictional ellipsoid"
e_contact = 0.4
friction_coefficient = 0.6

[[contacts]]
name = "Feld: Ø 1 m?"
law = "constant coefficients"
e_n = 0.4
e_t = 0.8
"""
STUDY = """
title = "Wenige Versuche: ±"
data = "tests.csv"
targets = ["e_n"]
starts = 1

[parameters]
c_v = { start = 1.0, lower = 0.1, upper = 10.0 }
"""
TESTS = "mass_kg,speed_mps,angle_deg,e_n\n100,6,0,0.1\n500,15,20,0.05\n50,25,40,-0.2\n"
COMMANDS = (
    "simulate scene.toml --json",
    "batch scenes.csv --out results.csv",
    "runout slope.toml --out runout",
    "calibrate study.toml --out fit",
)
PROGRAM = f"""
from jaximpact.cli import main
for command in {COMMANDS}:
    code = main(command.split())
    assert code == 0, (command, code)
"""
COMPARED = "results.csv", "runout/comparison.csv", "fit/fitted.csv"


def write_inputs(folder):
    """The files that the commands read, in a new directory."""
    folder.mkdir()
    files = {"scene.toml": SCENE, "scenes.csv": SCENES, "slope.toml": SLOPE}
    for name, text in (files | {"study.toml": STUDY, "tests.csv": TESTS}).items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder


def in_python_without(names, folder, *words):
    command = [sys.executable, "-X", "warn_default_encoding", HELPERS / "taken_away.py"]
    return subprocess.run(
        [*command, names, *words],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        encoding="utf-8",
    )


def test_a_scene_where_all_is_taken_away(folder, capsys):
    (folder / "scene.toml").write_text(SCENE)
    command = "simulate", "scene.toml", "--json"
    assert main([*command]) == 0
    done = in_python_without("all", folder, "jaximpact", *command)
    assert done.returncode == 0, done.stderr
    assert done.stdout == capsys.readouterr().out


PORTS = {f"{name}{k}" for name in ("COM", "LPT") for k in range(1, 10)}
RESERVED = PORTS | {"CON", "PRN", "AUX", "NUL"}


@pytest.mark.slow
def test_the_same_numbers_whatever_is_taken_away(tmp_path, monkeypatch):
    """The tables are those of the same commands in this process, byte for byte."""
    whole, lacking = (write_inputs(tmp_path / name) for name in ("whole", "lacking"))
    monkeypatch.chdir(whole)
    for command in COMMANDS:
        assert main(command.split()) == 0
    done = in_python_without("all", lacking, "-c", PROGRAM)
    assert done.returncode == 0, done.stderr
    for name in COMPARED:
        assert (lacking / name).read_bytes() == (whole / name).read_bytes()
    for path in lacking.rglob("*"):
        # As Windows has it, and nothing is left unfinished or locked.
        assert not set(path.name) & set('<>:"/\\|?*'), path
        assert path.name == path.name.strip(" .")
        assert path.stem.upper() not in RESERVED


def test_a_text_without_its_encoding_is_noticed(tmp_path):
    """Else the tests above would see nothing of it."""
    program = """
import pathlib
names = {"path": pathlib.Path("f"), "__name__": "jaximpact.x"}
for call in ("read_text()", "write_text('x')", "open('w')"):
    try:
        exec(f"path.{call}", names)
    except EncodingWarning:
        print(call)
"""
    (tmp_path / "f").touch()
    done = in_python_without("nothing", tmp_path, "-c", program)
    assert done.stdout.splitlines() == ["read_text()", "write_text('x')", "open('w')"]


WINDOWS_ON_ARM = """
import llvmlite.binding as llvm
llvm.get_default_triple = lambda: "aarch64-pc-windows-msvc"
import sys
from jaximpact.cli import main
sys.exit(main(["batch", "scenes.csv", "--out", "results.csv"]))
"""


def batch_on_windows_on_arm(folder, **variables):
    """Of vertical drops, whose model XLA compiles fastest."""
    (folder / "scenes.csv").write_text("mass_kg,speed_mps\n100,6\n500,15\n50,25\n")
    return subprocess.run(
        [sys.executable, "-c", WINDOWS_ON_ARM],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)} | variables,
        capture_output=True,
        encoding="utf-8",
    )


def test_a_computer_without_machine_code_is_refused_where_that_is_asked_for(tmp_path):
    done = batch_on_windows_on_arm(tmp_path, JAXIMPACT_REQUIRE_MACHINE_CODE="1")
    assert done.returncode == 1
    assert "none is made for aarch64 under Windows" in done.stderr.splitlines()[-1]


@pytest.mark.slow
@pytest.mark.xla
def test_a_computer_without_machine_code_computes_by_xla_and_says_so_once(tmp_path):
    done = batch_on_windows_on_arm(tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("none is made for aarch64 under Windows") == 1
    assert [row["outcome"] for row in rows_of(tmp_path / "results.csv")] == (
        ["detached"] * 3
    )


def test_without_pipes_an_interrupt_ends_a_command_all_the_same(tmp_path):
    """As on Windows, by KeyboardInterrupt."""
    program = """
import os, signal
import jaximpact.__main__ as program
from jaximpact import cli
from jaximpact.io.files import replacing
from pathlib import Path

# A shell that runs the tests in the background has them ignore it.
signal.signal(signal.SIGINT, signal.default_int_handler)

def run(*_):
    with replacing(Path("results.csv")) as temporary:
        temporary.touch()
        os.kill(os.getpid(), signal.SIGINT)
        raise AssertionError("goes on")

cli._run = run
raise SystemExit(program.main())
"""
    done = in_python_without("pipes", tmp_path, "-c", program)
    assert done.returncode == 130
    assert done.stderr == "jaximpact: interrupted\n"
    assert not [*tmp_path.iterdir()]

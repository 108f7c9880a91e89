"""The main commands in a Python that lacks what Windows and macOS lack: each thing for
itself, and all of them."""

import os
import subprocess
import sys
from pathlib import PureWindowsPath

import pytest
from paths import HELPERS, ROOT
from taken_away import LACKING

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
PROGRAM = """
from jaximpact.cli import main
for command in (
    "simulate scene.toml --json",
    "batch scenes.csv --out results.csv",
    "runout slope.toml --out runout",
    "calibrate study.toml --out fit",
):
    code = main(command.split())
    assert code == 0, (command, code)
"""
COMPARED = "results.csv", "runout/comparison.csv", "fit/fitted.csv"


def everything(folder, names):
    """Runs the commands where that is taken away, and gives the tables written."""
    files = {"scene.toml": SCENE, "scenes.csv": SCENES, "slope.toml": SLOPE}
    for name, text in (files | {"study.toml": STUDY, "tests.csv": TESTS}).items():
        (folder / name).write_text(text, encoding="utf-8")
    done = in_python_without(names, folder, "-c", PROGRAM)
    assert done.returncode == 0, done.stderr
    return {name: (folder / name).read_bytes() for name in COMPARED}


def in_python_without(names, folder, *words):
    command = [sys.executable, "-X", "warn_default_encoding", HELPERS / "taken_away.py"]
    return subprocess.run(
        [*command, names, *words],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        encoding="utf-8",
    )


def test_a_scene_where_all_is_taken_away(tmp_path):
    (tmp_path / "scene.toml").write_text(SCENE)
    words = "jaximpact", "simulate", "scene.toml", "--json"
    with_all, without = (
        in_python_without(names, tmp_path, *words) for names in ("nothing", "all")
    )
    assert without.returncode == 0, without.stderr
    assert without.stdout == with_all.stdout
    assert "e_n" in without.stdout


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    return everything(tmp_path_factory.mktemp("with all"), "nothing")


@pytest.mark.slow
@pytest.mark.parametrize("names", ["all", *LACKING])
def test_the_same_numbers_whatever_is_taken_away(tmp_path, expected, names):
    assert everything(tmp_path, names) == expected
    for path in tmp_path.rglob("*"):
        # As Windows has it, and nothing is left unfinished or locked.
        assert not set(path.name) & set('<>:"/\\|?*'), path
        assert path.name == path.name.strip(" .")
        assert not PureWindowsPath(path.name).is_reserved()


@pytest.mark.parametrize("call", ["read_text()", "write_text('x')", "open('w')"])
def test_a_text_without_its_encoding_is_noticed(tmp_path, call):
    """Else the tests above would see nothing of it."""
    program = f"""
import pathlib
names = {{"path": pathlib.Path("f"), "__name__": "jaximpact.x"}}
exec("path.{call}", names)
"""
    (tmp_path / "f").touch()
    done = in_python_without("nothing", tmp_path, "-c", program)
    assert "EncodingWarning" in done.stderr

"""What is the user's stays: outputs replace no input, directories know their files, and
one process writes at a time."""

import errno
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from error_messages import assert_one_line_error
from paths import HELPERS, ROOT

from jaximpact import file_locks
from jaximpact.cli import main
from jaximpact.errors import InputError
from jaximpact.io import files
from jaximpact.io.output_files import MARK, output_directory

SCENES = "mass_kg\n100\n"
SLOPE = """\
count = 2
collectors_m = [50]
[profile]
csv = "profile.csv"
[block]
mass_kg = 100
[release]
x_m = 2
clearance_m = 1
speed_mps = 5
direction_deg = 0
[contacts]
law = "Bozzolo and Pamini"
"""
PROFILE = "x_m,y_m\n0,50\n80,0\n200,0\n"
TESTS = "mass_kg,speed_mps,angle_deg,e_n\n500,10,20,0.3\n"
INPUTS = {
    "s.csv": SCENES,
    "x.nc": "[axes]\nangle_deg = [10]\n",
    "scene.toml": "",
    "table.toml": "",
    "slope.toml": SLOPE,
    "profile.csv": PROFILE,
    "tests.csv": TESTS,
}


@pytest.fixture
def folder(folder):
    """A working directory with what the commands read."""
    for name, text in INPUTS.items():
        (folder / name).write_text(text)
    (folder / "sub").mkdir()
    return folder


def everything(folder):
    return {p: p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def soft(name):
    return lambda new: new.symlink_to(Path(name).absolute())


def hard(name):
    return lambda new: os.link(name, new)


def moved(name):
    return lambda new: shutil.move(name, new)


# Command, what is made beforehand, and how.
OVERWRITING = [
    ("batch s.csv --out s.csv", None, None),
    ("batch s.csv --out sub/../s.csv", None, None),
    ("batch s.csv --out l.csv", "l.csv", soft("s.csv")),
    ("batch s.csv --out h.csv", "h.csv", hard("s.csv")),
    ("batch r.csv.journal --out r.csv", "r.csv.journal", moved("s.csv")),
    ("batch r.csv.manifest.json --out r.csv", "r.csv.manifest.json", moved("s.csv")),
    ("batch s.csv --out r.csv", "r.csv.manifest.json", hard("s.csv")),
    ("sweep x.nc", None, None),
    ("sweep x.nc --out l.nc", "l.nc", soft("x.nc")),
    ("simulate scene.toml --plot p.png", "p.png", soft("scene.toml")),
    ("tabulate table.toml --out t.nc", "t.nc", soft("table.toml")),
    ("tabulate table.toml --csv c.csv", "c.csv.manifest.json", hard("table.toml")),
    ("predict none tests.csv --out tests.csv", None, None),
    ("predict sub tests.csv --out sub/fitted.csv", "sub/fitted.csv", hard("s.csv")),
    ("predict sub tests.csv --out l.csv", "l.csv", soft("tests.csv")),
    ("runout slope.toml --out sub", "sub/manifest.json", hard("slope.toml")),
    ("runout slope.toml --out sub", "sub/collectors.csv", soft("profile.csv")),
    ("calibrate sub/fitted.csv --out sub", "sub/fitted.csv", hard("tests.csv")),
    ("calibrate tests.csv --out sub", "sub/report.html", soft("tests.csv")),
]


@pytest.mark.parametrize(("command", "new", "make"), OVERWRITING)
def test_no_input_is_replaced(folder, capsys, command, new, make):
    if make is not None:
        make(Path(new))
    before = everything(folder)
    assert main(command.split()) == 2
    assert_one_line_error(capsys, "error: ", "which is read")
    assert everything(folder) == before


@pytest.mark.parametrize(
    ("command", "own", "message"),
    [
        ("batch s.csv --out r.csv.manifest.json", None, "must not end in .manifest"),
        ("batch s.csv --out r.csv.journal", None, "must not end in .journal"),
        (f"batch s.csv --out sub/{MARK}", None, f"must not end in {MARK}"),
        ("batch s.csv --out r.csv", "r.csv.manifest.json", "no manifest says"),
        ("batch s.csv --out r.csv", "r.csv.journal", "no journal of this run"),
        ("runout slope.toml --out sub", "sub/stops.png", "sub has stops.png"),
        ("calibrate tests.csv --out sub", "sub/report.html", "sub has report.html"),
        ("runout slope.toml --out sub", f"sub/{MARK}", "is in the place of what"),
    ],
)
def test_what_is_not_known_is_left_alone(folder, capsys, command, own, message):
    if own is not None:
        (folder / own).write_text("mine")
    before = everything(folder)
    assert main(command.split()) == 2
    assert_one_line_error(capsys, "error: ", message)
    assert everything(folder) == before


def pipe(new):
    os.mkfifo(new)


def loop(new):
    new.symlink_to(new.name)


def directory(new):
    new.mkdir()


NO_FILES = [pipe, loop, directory, soft("/dev/null")]
LOCK = ".jaximpact-lock"


@pytest.mark.parametrize("make", NO_FILES)
@pytest.mark.parametrize(
    ("command", "output"),
    [
        ("batch s.csv --out r.csv", "r.csv"),
        ("batch s.csv --out r.csv", "r.csv.journal"),
        ("batch s.csv --out r.csv", "r.csv.manifest.json"),
        ("sweep x.nc --out y.nc", "y.nc"),
        ("sweep x.nc --out y.zarr", "y.zarr"),
        ("simulate scene.toml --plot p.png", "p.png"),
        ("runout slope.toml --out sub", "sub/stops.png"),
        ("runout slope.toml --out sub", f"sub/{MARK}"),
    ],
)
def test_an_output_in_place_of_what_is_no_file(folder, capsys, command, output, make):
    make(folder / output)
    before = {path: path.lstat() for path in folder.rglob("*")}
    assert main(command.split()) == 2
    assert_one_line_error(capsys, "error: ")
    # Times of access may change.
    after = {path: path.lstat() for path in folder.rglob("*")}
    assert {p: s.st_ino for p, s in after.items()} == {
        p: s.st_ino for p, s in before.items()
    }


@pytest.mark.parametrize("make", [*NO_FILES, soft("s.csv"), hard("s.csv")])
@pytest.mark.parametrize(
    ("command", "file"),
    [
        ("batch s.csv --out r.csv", ".r.csv" + LOCK),
        ("sweep x.nc --out y.zarr", ".y.zarr" + LOCK),
        ("runout slope.toml --out sub", "sub/" + LOCK),
    ],
)
def test_a_lock_in_place_of_what_is_none(folder, capsys, command, file, make):
    make(folder / file)
    before = everything(folder)
    assert main(command.split()) == 2
    assert_one_line_error(capsys, f"{file}: is in the place of a lock")
    assert os.path.lexists(folder / file)
    assert everything(folder) == before


def test_what_is_no_file_is_not_replaced_from_python_either(folder):
    os.mkfifo("pipe")
    with pytest.raises(InputError, match="must be a file"):
        files.write_text(folder / "pipe", "text")
    assert (folder / "pipe").is_fifo()


def test_a_link_to_what_is_not_there_is_followed(folder):
    """The format is that of the name that was given."""
    (folder / "p.png").symlink_to("drawing")
    with files.replacing(folder / "p.png") as temporary:
        assert temporary.suffix == ".png"
        temporary.write_text("drawn")
    assert (folder / "p.png").is_symlink()
    assert (folder / "drawing").read_text() == "drawn"


# --- directories


def write(out, *names, text="it", command="test", study=None, inputs=()):
    with output_directory(out, command, names, study=study, inputs=inputs) as new:
        for name in names:
            new(name).write_text(text)


def names_in(out):
    return {p.relative_to(out).as_posix() for p in out.rglob("*")} - {MARK}


def test_the_same_study_goes_on_in_its_directory(tmp_path):
    study = {"ground": (1, 2)}
    write(tmp_path, "a.csv", "pictures/a.png", study=study)
    (tmp_path / "mine.txt").write_text("mine")
    write(tmp_path, "a.csv", "b.csv", study=study, text="new")
    assert names_in(tmp_path) == {
        *("a.csv", "b.csv", "pictures", "pictures/a.png", "mine.txt"),
    }
    assert (tmp_path / "a.csv").read_text() == "new"


def test_a_study_is_its_command_and_what_it_reads(tmp_path):
    study, out = tmp_path / "study.toml", tmp_path / "out"
    study.write_text("one")
    write(out, "a.csv", inputs=[study])
    write(out, "a.csv", inputs=[study])
    with pytest.raises(InputError, match="jaximpact test for another study; choose an"):
        write(out, "a.csv", inputs=[study], command="other")
    study.write_text("two")
    with pytest.raises(InputError, match="another study"):
        write(out, "a.csv", inputs=[study])
    assert names_in(out) == {"a.csv"}


def test_inputs_of_one_name_are_all_of_the_study(tmp_path):
    inputs = [tmp_path / folder / "tests.csv" for folder in "ab"]
    for file in inputs:
        file.parent.mkdir()
        file.write_text(file.parent.name)
    for edited in inputs:
        out = tmp_path / f"of {edited.parent.name}"
        write(out, "a.csv", inputs=inputs)
        write(out, "a.csv", inputs=inputs)
        edited.write_text("edited")
        with pytest.raises(InputError, match="for another study"):
            write(out, "a.csv", inputs=inputs)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no such pipes")
def test_results_of_what_came_by_a_pipe_are_not_replaced(tmp_path):
    pipe, out = tmp_path / "pipe", tmp_path / "out"
    os.mkfifo(pipe)
    write(out, inputs=[pipe])  # without a file yet
    write(out, "a.csv", inputs=[pipe])
    with pytest.raises(InputError, match=r"has results, but what comes by .*pipe, w"):
        write(out, "a.csv", inputs=[pipe], text="other")
    assert (out / "a.csv").read_text() == "it"


def test_a_run_that_failed_before_its_first_file_leaves_a_new_directory(tmp_path):
    def fail():
        with output_directory(tmp_path, "test", ["a.csv"], study={"seed": 1}):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fail()
    write(tmp_path, "a.csv", study={"seed": 2})
    assert names_in(tmp_path) == {"a.csv"}


@pytest.mark.parametrize("mark", ["[]", '{"command": "test"}', "mine"])
def test_what_is_no_mark_is_let_be(tmp_path, mark):
    (tmp_path / MARK).write_text(mark)
    with pytest.raises(InputError, match="is in the place of what jaximpact writes"):
        write(tmp_path, "a.csv")
    assert (tmp_path / MARK).read_text() == mark


def test_a_file_is_written_over_no_results_of_a_directory(folder, capsys):
    write(folder / "sub", "fitted.csv", "report/a.png", command="calibrate")
    (folder / "l.csv").symlink_to(folder / "sub" / "fitted.csv")
    for out in ("sub/fitted.csv", "sub/report/a.png", "l.csv"):
        assert main(["batch", "s.csv", "--out", out]) == 2
        assert_one_line_error(capsys, "among the results of jaximpact calibrate")


# --- one process at a time


@pytest.mark.parametrize(
    ("command", "output"),
    [
        ("batch s.csv --out r.csv", "r.csv"),
        ("batch s.csv --out sub/../r.csv", "r.csv"),
        ("sweep x.nc --out y.nc", "y.nc"),
        ("simulate scene.toml --plot p.png", "p.png"),
        ("runout slope.toml --out sub", "sub"),
        ("calibrate tests.csv --out sub", "sub"),
    ],
)
def test_a_second_process_is_refused(folder, capsys, command, output):
    before = everything(folder)
    with files.locked(Path(output)):
        assert main(command.split()) == 1
    assert_one_line_error(
        capsys, "is being written by another jaximpact", f"(process {os.getpid()})"
    )
    assert everything(folder) == before


HOLD = """
import sys, time
{before}
from pathlib import Path
from jaximpact.io.files import locked
with locked(Path(sys.argv[1])):
    print(flush=True)
    time.sleep(float(sys.argv[2]))
"""


@pytest.fixture(params=["POSIX", "Windows"])
def hold(request, monkeypatch):
    """Function that has another process hold the lock of a path, for some seconds. Both
    processes lock as POSIX or as Windows does."""
    script, running = HOLD.format(before=""), []
    if request.param == "Windows":
        import windows_locks

        monkeypatch.setattr(file_locks, "fcntl", None)
        monkeypatch.setattr(file_locks, "msvcrt", windows_locks)
        script = HOLD.format(before="import windows_locks")

    def start(path, seconds):
        environment = os.environ | {"PYTHONPATH": f"{ROOT}{os.pathsep}{HELPERS}"}
        command = [sys.executable, "-c", script, str(path), str(seconds)]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, env=environment)
        running.append(process)
        process.stdout.readline()
        return process

    yield start
    for process in running:
        process.kill()
        process.communicate()


def test_the_lock_of_a_killed_process_is_none(hold, tmp_path):
    path = tmp_path / "results.csv"
    holder = hold(path, 60)
    with (
        pytest.raises(BlockingIOError, match=rf"process {holder.pid}\); wait for it"),
        files.locked(path),
    ):
        pytest.fail("locked twice")
    holder.kill()
    holder.wait()
    with files.locked(path):
        pass
    assert not [*tmp_path.iterdir()]


def test_who_waits_has_the_lock_when_the_other_ends(hold, tmp_path):
    path = tmp_path / "results.csv"
    holder = hold(path, 0.3)
    descriptor = os.open(tmp_path / f".results.csv.{files.LOCK_SUFFIX}", os.O_RDWR)
    file_locks.lock(descriptor, wait=True)
    assert holder.wait(60) == 0
    os.close(descriptor)


def no_locks(*arguments):
    raise OSError(errno.ENOTSUP, "Operation not supported")


@pytest.mark.parametrize("without", ["module", "file system"])
def test_where_there_are_no_locks_nothing_is_locked(tmp_path, monkeypatch, without):
    if without == "module":
        monkeypatch.setattr(file_locks, "fcntl", None)
    else:
        monkeypatch.setattr(file_locks.fcntl, "flock", no_locks)
    with files.locked(tmp_path):
        write(tmp_path, "report.txt")
    assert names_in(tmp_path) == {"report.txt"}


def test_a_file_that_another_program_has_open_is_told_beforehand(
    folder, capsys, monkeypatch
):
    """Windows replaces no file that Excel shows."""
    replace = os.replace

    def refusing(before, after):
        if Path(after).name == "r.csv":
            raise PermissionError(13, "Access is denied")
        replace(before, after)

    monkeypatch.setattr(os, "replace", refusing)
    Path("r.csv").write_text("shown")
    before = everything(folder)
    assert main(["batch", "s.csv", "--out", "r.csv"]) == 2
    assert_one_line_error(capsys, "--out r.csv cannot be written: Access is denied")
    assert everything(folder) == before


def test_a_system_without_locks_says_so(monkeypatch, tmp_path):
    monkeypatch.setattr(file_locks, "fcntl", None)
    with open(tmp_path / "file", "w") as file, pytest.raises(OSError, match="no locks"):
        file_locks.lock(file.fileno(), wait=True)

"""What is the user's stays: outputs replace no input, directories know their files, and
one process writes at a time."""

import errno
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from error_messages import assert_one_line_error

from jaximpact import file_locks
from jaximpact.cli import main
from jaximpact.errors import InputError
from jaximpact.io import files as lock
from jaximpact.io.output_files import LIST, output_directory

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
        (f"batch s.csv --out sub/{LIST}", None, f"must not end in {LIST}"),
        ("batch s.csv --out r.csv", "r.csv.manifest.json", "no manifest says"),
        ("batch s.csv --out r.csv", "r.csv.journal", "no journal of this run"),
        ("runout slope.toml --out sub", "sub/stops.png", "sub holds stops.png"),
        ("calibrate tests.csv --out sub", "sub/report.html", "sub holds report.html"),
        ("runout slope.toml --out sub", f"sub/{LIST}", "is no list of files"),
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
        ("batch s.csv --out r.csv", LIST),
        ("sweep x.nc --out y.nc", "y.nc"),
        ("sweep x.nc --out y.zarr", "y.zarr"),
        ("simulate scene.toml --plot p.png", "p.png"),
        ("runout slope.toml --out sub", "sub/stops.png"),
        ("runout slope.toml --out sub", f"sub/{LIST}"),
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
        lock.write_text(folder / "pipe", "text")
    assert (folder / "pipe").is_fifo()


def test_a_link_to_what_is_not_there_is_followed(folder):
    """The format is that of the name that was given."""
    (folder / "p.png").symlink_to("drawing")
    with lock.replacing(folder / "p.png") as temporary:
        assert temporary.suffix == ".png"
        temporary.write_text("drawn")
    assert (folder / "p.png").is_symlink()
    assert (folder / "drawing").read_text() == "drawn"


# --- directories


def write(out, *names, text="it", study=None, command="test", inputs=()):
    with output_directory(out, command, names, study=study, inputs=inputs) as new:
        for name in names:
            new(name).write_text(text)


def names_in(out):
    return {p.relative_to(out).as_posix() for p in out.rglob("*")} - {LIST}


def test_another_study_takes_the_place_of_the_earlier_one(tmp_path):
    write(tmp_path, "report.txt", "old.csv", "pictures/a.png", "pictures/b.png")
    (tmp_path / "mine.txt").write_text("mine")
    write(tmp_path, "report.txt", "pictures/b.png", text="new")
    assert names_in(tmp_path) == {
        *("report.txt", "pictures", "pictures/b.png", "mine.txt"),
    }
    write(tmp_path, "report.txt")
    assert names_in(tmp_path) == {"report.txt", "mine.txt"}
    listed = json.loads((tmp_path / LIST).read_text())
    assert listed["command"] == "test"
    assert [len(digest) for digest in listed["files"].values()] == [64]


@pytest.mark.slow
def test_a_command_renews_its_directory(folder):
    assert main(["runout", "slope.toml", "--out", "out"]) == 0
    (folder / "out" / "mine.txt").write_text("mine")
    single = names_in(folder / "out")
    two = SLOPE.replace("collectors_m = [50]\n", "").replace(
        "[contacts]", "[[contacts]]"
    )
    two += '[[contacts]]\nlaw = "constant coefficients"\ne_n = 0.3\ne_t = 0.8\n'
    (folder / "two.toml").write_text(two)
    assert main(["runout", "two.toml", "--out", "out"]) == 0
    found = names_in(folder / "out")
    assert {"mine.txt", "constant-coefficients/blocks.nc", "comparison.csv"} <= found
    assert not {"blocks.nc", "collectors.csv", "stops.png"} & found
    assert main(["runout", "slope.toml", "--out", "out"]) == 0
    assert names_in(folder / "out") == single


def test_what_was_changed_is_not_removed(tmp_path):
    write(tmp_path, "report.txt", "old.csv", "gone.csv")
    (tmp_path / "old.csv").write_text("changed")
    (tmp_path / "gone.csv").unlink()
    write(tmp_path, "report.txt")
    assert (tmp_path / "old.csv").read_text() == "changed"
    # From now on it is the user's.
    with pytest.raises(InputError, match=r"holds old\.csv"):
        write(tmp_path, "old.csv")


def test_a_picture_of_the_users_is_not_replaced(tmp_path):
    (tmp_path / "pictures").mkdir()
    (tmp_path / "pictures" / "b.png").write_text("mine")
    with output_directory(tmp_path, "test", ["report.txt"]) as new:
        new("report.txt").write_text("it")
        with pytest.raises(InputError, match=r"holds pictures/b\.png"):
            new("pictures/b.png")
    assert (tmp_path / "pictures" / "b.png").read_text() == "mine"


def test_the_same_study_adds_to_its_files(tmp_path):
    write(tmp_path, "a", study={"ground": (1, 2)})
    write(tmp_path, "b", study={"ground": (1, 2)})
    assert names_in(tmp_path) == {"a", "b"}
    write(tmp_path, "b", study={"ground": (1, 3)})
    assert names_in(tmp_path) == {"b"}


def test_a_run_that_was_cut_short_knows_its_files_again(tmp_path):
    write(tmp_path, "report.txt", "old.csv")

    def cut_short():
        with output_directory(tmp_path, "test", ["report.txt", "new.csv"]) as new:
            assert names_in(tmp_path) == {"report.txt", "old.csv", ".jaximpact-lock"}
            new("new.csv").write_text("new")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        cut_short()
    assert names_in(tmp_path) == {"report.txt", "new.csv"}
    write(tmp_path, "report.txt", "new.csv")
    write(tmp_path, "report.txt")
    assert names_in(tmp_path) == {"report.txt"}


WHOLE = {"command": "test", "study": None, "files": {}}


@pytest.mark.parametrize(
    ("listed", "message"),
    [
        (WHOLE | {"command": "other"}, "results of jaximpact other"),
        (WHOLE | {"files": {"../x": None}}, "is no list"),
        (WHOLE | {"files": {"/x": None}}, "is no list"),
        (WHOLE | {"files": {"C:x": None}}, "is no list"),
        (WHOLE | {"files": {"sub\\..\\..\\x": None}}, "is no list"),
        (WHOLE | {"files": ["x"]}, "is no list"),
        ({"command": "test"}, "is no list"),
        ([], "is no list"),
    ],
)
def test_lists_that_are_none_of_the_command_are_refused(tmp_path, listed, message):
    (tmp_path / LIST).write_text(json.dumps(listed))
    with pytest.raises(InputError, match=message):
        write(tmp_path, "report.txt")
    assert names_in(tmp_path) == set()


def test_an_input_is_not_removed(tmp_path):
    write(tmp_path, "report.txt", "old.csv")
    with pytest.raises(InputError, match=r"replace or remove .*old\.csv"):
        write(tmp_path, "report.txt", inputs=[tmp_path / "old.csv"])


def test_a_file_is_written_to_no_directory_of_results(folder, capsys):
    write(folder / "sub", "fitted.csv", "report/a.png", command="calibrate")
    (folder / "l.csv").symlink_to(folder / "sub" / "fitted.csv")
    for out in ("sub/fitted.csv", "sub/report/a.png", "l.csv"):
        assert main(["batch", "s.csv", "--out", out]) == 2
        assert_one_line_error(capsys, "would overwrite a file of jaximpact calibrate")


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
    with lock.locked(Path(output)):
        assert main(command.split()) == 1
    assert_one_line_error(
        capsys, "is being written by another jaximpact", f"(process {os.getpid()})"
    )
    assert everything(folder) == before


HOLD = """\
import fcntl, os, sys, time
file = os.open(sys.argv[1], os.O_RDWR | os.O_CREAT)
fcntl.flock(file, fcntl.LOCK_EX)
os.write(file, b"77")
print(flush=True)
time.sleep(600)
"""


def test_the_lock_of_a_killed_process_is_none(tmp_path):
    file = tmp_path / ".jaximpact-lock"
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(file)], stdout=subprocess.PIPE
    )
    holder.stdout.readline()
    with pytest.raises(BlockingIOError, match=r"process 77"):
        write(tmp_path, "report.txt")
    holder.kill()
    holder.communicate()
    assert file.exists()
    write(tmp_path, "report.txt")
    assert names_in(tmp_path) == {"report.txt"}


def no_locks(*arguments):
    raise OSError(errno.ENOTSUP, "Operation not supported")


@pytest.mark.parametrize("without", ["module", "file system"])
def test_where_there_are_no_locks_nothing_is_locked(tmp_path, monkeypatch, without):
    if without == "module":
        monkeypatch.setattr(file_locks, "fcntl", None)
    else:
        monkeypatch.setattr(file_locks.fcntl, "flock", no_locks)
    with lock.locked(tmp_path):
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

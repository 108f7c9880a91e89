"""What is compiled is kept, and run again only if nobody else can have written it."""

import os
import shutil
import stat
import subprocess
import sys
import threading

import pytest
from paths import ROOT

from jaximpact import store as module
from jaximpact.cli import main
from jaximpact.store import PrivateStore, Refused, Store, open_cache

CONTENT = bytes(range(256)) * 9
ANOTHER_USER = 12345
as_root = pytest.mark.skipif(os.geteuid() != 0, reason="gives files away: for root")


@pytest.fixture
def cache(tmp_path):
    return PrivateStore(tmp_path / "cache")


def mode_of(path):
    return stat.S_IMODE(path.stat().st_mode)


def give_away(path):
    os.chown(path, ANOTHER_USER, ANOTHER_USER)


def put_link(path):
    shutil.move(path, path.parent.parent / "elsewhere")
    path.symlink_to(path.parent.parent / "elsewhere")


def put_pipe(path):
    path.unlink()
    os.mkfifo(path)


def change(data):
    return lambda path: path.write_bytes(data(path.read_bytes()))


DAMAGES = {
    "cut short": change(lambda data: data[:-1]),
    "cut short in its code": change(lambda data: data[:20]),
    "empty": change(lambda data: b""),
    "longer": change(lambda data: data + b"0"),
    "another content": change(lambda data: data[:-1] + b"?"),
    "another code": change(lambda data: b"?" + data[1:]),
    "link": put_link,
    "pipe": put_pipe,
    "device": lambda path: (path.unlink(), path.symlink_to("/dev/zero")),
    "the group may write": lambda path: path.chmod(0o620),
    "all may write": lambda path: path.chmod(0o777),
    "not there": lambda path: path.unlink(),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_file_that_cannot_be_trusted_is_made_again(cache, damage):
    cache.put("machine", "one", CONTENT)
    (path,) = cache.path.glob("machine-*")
    DAMAGES[damage](path)
    assert cache.get("machine", "one") is None
    cache.put("machine", "one", CONTENT)
    assert cache.get("machine", "one") == CONTENT
    assert mode_of(path) == 0o600


@as_root
def test_a_file_of_another_user_is_not_read(cache):
    cache.put("machine", "one", CONTENT)
    (path,) = cache.path.glob("machine-*")
    give_away(path)
    assert cache.get("machine", "one") is None


def test_a_directory_in_place_of_a_file_is_let_be(cache):
    cache.put("machine", "one", CONTENT)
    (path,) = cache.path.glob("machine-*")
    path.unlink()
    path.mkdir()
    cache.put("machine", "one", CONTENT)
    assert cache.get("machine", "one") is None
    assert path.is_dir()


def test_no_file_stands_for_another(cache):
    cache.put("machine", "one", CONTENT)
    (one,) = cache.path.glob("machine-*")
    cache.put("machine", "two", b"two")
    (two,) = set(cache.path.glob("machine-*")) - {one}
    shutil.copy(one, two)
    assert cache.get("machine", "two") is None
    assert cache.get("xla", "one") is None


def test_directories_and_files_are_for_the_user_alone(tmp_path):
    before = os.umask(0)
    try:
        PrivateStore(tmp_path / "a" / "b").put("machine", "one", CONTENT)
    finally:
        os.umask(before)
    for path in (tmp_path / "a").rglob("*"):
        assert mode_of(path) == (0o700 if path.is_dir() else 0o600)
    assert mode_of(tmp_path / "a") == 0o700


def test_a_mode_that_was_left_open_is_mended(cache):
    cache.put("machine", "one", CONTENT)
    cache.path.chmod(0o777)
    assert PrivateStore(cache.path).get("machine", "one") == CONTENT
    assert mode_of(cache.path) == 0o700


def with_other_files(path):
    (path / "of the user").touch()
    path.chmod(0o1777)


@pytest.mark.parametrize(
    ("spoil", "reason"),
    [
        pytest.param(give_away, "belongs to another user", marks=as_root),
        (with_other_files, "others may write to"),
        (put_link, "is a link"),
    ],
)
def test_a_directory_of_others_is_refused_and_stays_as_it_is(cache, spoil, reason):
    spoil(cache.path)
    before = {path: path.lstat().st_mode for path in cache.path.parent.rglob("*")}
    with pytest.raises(Refused, match=reason):
        PrivateStore(cache.path)
    assert before == {p: p.lstat().st_mode for p in cache.path.parent.rglob("*")}


def test_what_was_not_used_for_longest_goes_first_and_nothing_else(cache, monkeypatch):
    others = [cache.path / name for name in ("machine-notes.txt", "a" * 64)]
    for path in others:
        path.write_bytes(bytes(9000))
    for i, name in enumerate(("old", "used", "new")):
        cache.put("machine", name, CONTENT)
        for path in cache.path.glob("machine-" + "?" * 64):
            os.utime(path, (path.stat().st_mtime - 100 + i,) * 2)
    cache.get("machine", "used")
    monkeypatch.setattr(module, "LIMIT", 3 * (len(CONTENT) + 32))
    cache.put("machine", "newest", CONTENT)
    there = {n for n in ("old", "used", "new", "newest") if cache.get("machine", n)}
    assert there == {"used", "new", "newest"}
    assert all(path.stat().st_size == 9000 for path in others)


def test_several_at_once(cache):
    def work():
        mine = PrivateStore(cache.path)
        for i in range(200):
            mine.put("machine", str(i % 5), CONTENT + bytes([i % 5]))
            for k in range(5):
                assert mine.get("machine", str(k)) in (None, CONTENT + bytes([k]))
        done.append(True)

    done, threads = [], [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(done) == 4
    assert len(list(cache.path.iterdir())) == 5


@pytest.fixture
def place(tmp_path, monkeypatch):
    """Sets the variables that say where the cache is; gives it."""

    def open_with(**variables):
        for name in ("JAXIMPACT_CACHE_DIR", "XDG_CACHE_HOME", "HOME"):
            monkeypatch.delenv(name, raising=False)
        for name, value in variables.items():
            monkeypatch.setenv(name, value.format(tmp_path))
        open_cache.cache_clear()
        cache = open_cache()
        return None if cache is None else str(cache.path.relative_to(tmp_path))

    yield open_with
    open_cache.cache_clear()


@pytest.mark.parametrize(
    ("variables", "expected"),
    [
        ({"HOME": "{}"}, ".cache/jaximpact"),
        ({"HOME": "{}", "XDG_CACHE_HOME": "{}/xdg"}, "xdg/jaximpact"),
        ({"HOME": "{}", "XDG_CACHE_HOME": "relative"}, ".cache/jaximpact"),
        ({"HOME": "relative"}, None),
        ({"HOME": "{}/file"}, None),
        ({"HOME": "/proc/none"}, None),
        ({"HOME": "{}/missing"}, None),
        ({"HOME": "{}", "JAXIMPACT_CACHE_DIR": "{}/own"}, "own"),
        ({"HOME": "{}", "JAXIMPACT_CACHE_DIR": ""}, None),
        ({"JAXIMPACT_CACHE_DIR": "{}/file"}, None),
    ],
)
def test_where_it_is(place, folder, variables, expected):
    (folder / "file").touch()
    assert place(**variables) == expected
    if expected is None:
        assert os.listdir(folder) == ["file"]


@pytest.fixture
def without_owners(monkeypatch):
    """As on Windows: nothing says whose a file is."""
    monkeypatch.setattr(module, "HAS_OWNERS", False)
    monkeypatch.setattr(module, "NO_LINKS", 0)
    monkeypatch.setattr(module, "CACHES", "LOCALAPPDATA")
    for name in ("geteuid", "O_NOFOLLOW", "O_NONBLOCK"):
        monkeypatch.delattr(os, name)


@pytest.mark.parametrize(
    ("variables", "expected"),
    [
        ({"LOCALAPPDATA": "{}/AppData/Local"}, "AppData/Local/jaximpact"),
        ({"XDG_CACHE_HOME": "{}/xdg"}, ".cache/jaximpact"),
        ({"JAXIMPACT_CACHE_DIR": "{}/sub/own"}, "sub/own"),
        ({"JAXIMPACT_CACHE_DIR": ""}, None),
    ],
)
def test_where_it_is_on_windows(place, without_owners, variables, expected):
    assert place(HOME="{}", **variables) == expected


def test_a_place_outside_of_the_profile_is_refused_on_windows(
    place, without_owners, folder
):
    (folder / "home").mkdir()
    (folder / "home" / "link").symlink_to(folder)
    for name in ("elsewhere", "home/link/elsewhere", "home/../elsewhere", "homes"):
        with pytest.warns(UserWarning, match="is not in .*home, and only there"):
            assert place(HOME="{}/home", JAXIMPACT_CACHE_DIR=f"{{}}/{name}") is None
    assert [path.name for path in folder.iterdir()] == ["home"]


def test_a_cache_on_windows(without_owners, tmp_path, monkeypatch):
    test_what_was_not_used_for_longest_goes_first_and_nothing_else(
        PrivateStore(tmp_path / "cache"), monkeypatch
    )
    (path, *_) = (tmp_path / "cache").glob("machine-" + "?" * 64)
    DAMAGES["cut short"](path)
    cache = PrivateStore(tmp_path / "cache")
    assert [cache.get("machine", name) for name in ("used", "new", "newest")].count(
        None
    ) == 1
    with cache.making("machine", "one"):
        cache.put("machine", "one", CONTENT)
    assert cache.get("machine", "one") == CONTENT


def test_where_it_is_for_a_user_whom_the_system_does_not_know(place, monkeypatch):
    def unknown(uid):
        raise KeyError(uid)

    monkeypatch.setattr("pwd.getpwuid", unknown)
    assert place() is None


def test_python_is_warned_of_a_place_that_is_refused(place):
    with pytest.warns(UserWarning, match="compiled code is not kept: JAXIMPACT_CACHE_"):
        assert place(JAXIMPACT_CACHE_DIR="relative") is None


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
def test_a_command_warns_in_one_line_and_goes_on(place, folder, capsys):
    (folder / "scene.toml").write_text("")
    (folder / "link").symlink_to(folder)
    with pytest.warns(UserWarning, match="is a link"):
        place(JAXIMPACT_CACHE_DIR="{}/link")
    open_cache.cache_clear()
    assert main(["simulate", "scene.toml", "--json"]) == 0
    # What was not kept is compiled, unless this process has it.
    lines = capsys.readouterr().err.splitlines()
    said = [line for line in lines if not line.startswith("compiling machine code")]
    assert said == [
        f"jaximpact: warning: compiled code is not kept: {folder}/link is a link"
    ]


def test_a_full_disk_costs_time_only(cache, monkeypatch):
    def full(*arguments, **options):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    cache.put("machine", "one", CONTENT)
    assert not list(cache.path.iterdir())


@pytest.mark.parametrize("damage", ["cut short", "another content", "not there"])
def test_what_is_kept_beside_a_study_is_whole_or_not_there(tmp_path, damage):
    store = Store(tmp_path / "unfinished")
    assert store.get("fit", "one") is None
    store.path.mkdir()
    store.put("fit", "one", CONTENT)
    assert Store(store.path).get("fit", "one") == CONTENT
    (path,) = store.path.iterdir()
    shutil.copy(path, store.path / path.name.replace("fit", "draw"))
    assert store.get("draw", "one") is None
    DAMAGES[damage](path)
    assert store.get("fit", "one") is None


def test_processes_that_need_the_same_code_make_it_once(tmp_path):
    """The first waits, as it makes the code, until the second asks for it too."""
    made, places = tmp_path / "made", [tmp_path / str(number) for number in range(2)]
    program = f"""
import pathlib, sys, time
from jaximpact.store import kept
def make():
    with open({str(made)!r}, "a") as file:
        file.write("x")
    time.sleep(0.5)
    return b"code"
own, other = map(pathlib.Path, sys.argv[1:])
own.touch()
while not other.exists():
    time.sleep(0.01)
assert kept("key", make) == b"code"
"""
    environment = os.environ | {"JAXIMPACT_CACHE_DIR": str(tmp_path / "cache")}
    environment["PYTHONPATH"] = str(ROOT)
    running = [
        subprocess.Popen([sys.executable, "-c", program, *pair], env=environment)
        for pair in (places, places[::-1])
    ]
    assert [process.wait(60) for process in running] == [0, 0]
    assert made.read_text() == "x"
    assert not [*(tmp_path / "cache").glob("*.lock")]

"""Runs that are cut short, and go on."""

import contextlib
import dataclasses
import os
import signal
import subprocess
import sys
import time
import zlib

import equinox as eqx
import jax
import numpy as np
import pytest
from impact_scenes import mixed_scenes

from jaximpact import Soil, simulate_batch
from jaximpact.cli import main
from jaximpact.errors import InputError
from jaximpact.io.journal import HEAD, Journal
from jaximpact.laws import NovaMontrasio, Perzyna

COLUMNS = ["a", "b", "c"]
SUBJECT = {"of": "a test"}


def fill(path, blocks=3):
    """A journal of two rows a block, and where each block ends."""
    ends = []
    with Journal(path, SUBJECT, COLUMNS, 100) as journal:
        ends.append(path.stat().st_size)
        for k in range(blocks):
            places = np.array([2 * k, 2 * k + 1])
            journal.append(places, places[:, None] + np.array([0.25, 0.5, np.nan]))
            ends.append(path.stat().st_size)
    return ends


def read(path):
    with Journal(path, SUBJECT, COLUMNS, 100) as journal:
        return journal.rows()


def test_rows_come_back(tmp_path):
    fill(tmp_path / "j")
    places, numbers = read(tmp_path / "j")
    np.testing.assert_array_equal(places, range(6))
    np.testing.assert_array_equal(numbers[3], [3.25, 3.5, np.nan])


def test_one_without_rows_does_not_stay(tmp_path):
    fill(tmp_path / "j", blocks=0)
    assert not [*tmp_path.iterdir()]


def test_one_that_stays_is_of_its_subject_without_rows_too(tmp_path):
    with Journal(tmp_path / "j", SUBJECT, COLUMNS, 100, stays=True):
        pass
    with pytest.raises(InputError, match="no journal of this run"):
        Journal(tmp_path / "j", {"of": "another"}, COLUMNS, 100)


def test_cut_anywhere_it_keeps_the_whole_blocks(tmp_path):
    path = tmp_path / "j"
    ends = fill(path)
    data = path.read_bytes()
    for length in range(len(data) + 1):
        path.write_bytes(data[:length])
        places, _ = read(path)
        assert len(places) == 2 * sum(end <= length for end in ends[1:])
        # and what is appended then is found again
        with Journal(path, SUBJECT, COLUMNS, 100) as journal:
            journal.append(np.array([77]), np.zeros((1, 3)))
        assert read(path)[0][-1] == 77


def test_noise_at_the_end_is_left_out(tmp_path):
    path = tmp_path / "j"
    ends = fill(path)
    data = bytearray(path.read_bytes())
    data[ends[2] + 30] ^= 1
    path.write_bytes(data)
    assert len(read(path)[0]) == 4
    # a head of noise must not ask for the memory that it names
    path.write_bytes(bytes(data[: ends[2]]) + b"\xff" * 20)
    assert len(read(path)[0]) == 4


@pytest.mark.parametrize(
    "content", [b"other\n", b'{"of": "another"}\n', b"x" * 5000, b"\0\xff" * 99]
)
def test_another_file_is_refused_and_left_as_it_is(tmp_path, content):
    path = tmp_path / "j"
    path.write_bytes(content)
    with pytest.raises(InputError, match="no journal of this run"):
        Journal(path, SUBJECT, COLUMNS, 100)
    assert path.read_bytes() == content


@pytest.mark.parametrize(
    "places",
    [[-1], [100], [2**62], [-(2**63)], [50, 50], [50, 3], [50, -100], [0]],
)
def test_places_that_are_none_are_cut_off(tmp_path, places):
    path = tmp_path / "j"
    ends = fill(path)
    with Journal(path, SUBJECT, COLUMNS, 100) as journal:
        journal.append(np.array(places), np.zeros((len(places), 3)))
        journal.append(np.array([60]), np.zeros((1, 3)))
    np.testing.assert_array_equal(read(path)[0], range(6))
    assert path.stat().st_size == ends[-1]


def test_a_block_of_no_whole_rows_is_cut_off(tmp_path):
    path = tmp_path / "j"
    ends = fill(path)
    rows = b"\0" * 40
    for count in (0, 1, 2):  # rows are of 32 bytes
        with open(path, "ab") as file:
            file.write(HEAD.pack(count, zlib.crc32(rows)) + rows)
        np.testing.assert_array_equal(read(path)[0], range(6))
        assert path.stat().st_size == ends[-1]


def test_a_file_that_cannot_be_opened_is_refused(tmp_path, monkeypatch):
    def denied(*arguments):
        raise PermissionError(13, "Permission denied")

    # For root every file can be written.
    monkeypatch.setattr("jaximpact.io.journal.open", denied, raising=False)
    with pytest.raises(InputError, match="j: cannot be written: Permission denied"):
        read(tmp_path / "j")
    assert not list(tmp_path.iterdir())


@contextlib.contextmanager
def room_for(size):
    """A limit of the size of files stands for a disk that is full."""
    resource = pytest.importorskip("resource")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_on_a_full_disk_no_lock_stays(tmp_path):
    with room_for(1000), pytest.raises(OSError, match=r"large: '.*a\.journal'"):
        fill(tmp_path / "a.journal", 100)
    assert [path.name for path in tmp_path.iterdir()] == ["a.journal"]
    assert len(read(tmp_path / "a.journal")[0]) > 0


@pytest.mark.parametrize("found", [b"", b'{"col'])
def test_without_room_for_its_first_line_no_journal_stays(tmp_path, found):
    """Neither a new one, nor one that had the half of it from the time before."""
    (tmp_path / "a.journal").write_bytes(found)
    with room_for(20), pytest.raises(OSError, match=r"large: '.*a\.journal'"):
        fill(tmp_path / "a.journal")
    assert not [*tmp_path.iterdir()]


def test_a_journal_is_of_one_process(tmp_path):
    with (
        Journal(tmp_path / "j", SUBJECT, COLUMNS, 100),
        pytest.raises(BlockingIOError, match="is being written by another"),
    ):
        read(tmp_path / "j")
    assert len(read(tmp_path / "j")[0]) == 0


class Stop(Exception):
    pass


@pytest.mark.slow
def test_a_batch_goes_on_with_the_same_numbers(tmp_path):
    scenes = mixed_scenes(2500, seed=5)
    whole = simulate_batch(scenes, accuracy="fast")
    journal = tmp_path / "j"

    def stop_half_way(done, count):
        if done > count // 2:
            raise Stop

    with pytest.raises(Stop):
        simulate_batch(scenes, accuracy="fast", journal=journal, progress=stop_half_way)
    seen, timing = [], {}
    resumed = simulate_batch(
        scenes,
        accuracy="fast",
        journal=journal,
        progress=lambda done, count: seen.append(done),
        timing=timing,
    )
    # nothing lost, nothing repeated
    assert timing["impacts"] == 2500 - seen[0] < 1300
    for before, after in zip(
        jax.tree.leaves(whole), jax.tree.leaves(resumed), strict=True
    ):
        np.testing.assert_array_equal(before, after)
    again = {}
    simulate_batch(scenes, accuracy="fast", journal=journal, timing=again)
    assert again["impacts"] == 0
    for changed in (dict(accuracy="balanced"), dict(accuracy="fast", ledger=True)):
        with pytest.raises(InputError, match="no journal of this run"):
            simulate_batch(scenes, journal=journal, **changed)


def test_laws_of_a_session_are_known_by_their_code(tmp_path):
    def run(factor):
        names = {}
        code = "class Mine(Vesic):\n    def factors(self, friction):\n"
        code += f"        return super().factors(friction * {factor})"
        exec(f"from jaximpact.laws import Vesic\n{code}", names)
        soil = Soil(bearing=names["Mine"]())
        scenes, timing = dataclasses.replace(mixed_scenes(3), soil=soil), {}
        simulate_batch(scenes, journal=tmp_path / "j", timing=timing)
        return timing["impacts"]

    assert [run(1.0), run(1.0)] == [3, 0]
    with pytest.raises(InputError, match="no journal of this run"):
        run(0.9)


def test_fields_that_are_no_parameters_are_part_of_a_law(tmp_path):
    """Of a law of the package, and of one's own; also in the manifest and on screen."""

    class Mine(Perzyna):
        order: int = eqx.field(default=1, static=True)

    def run(changed):
        soil, timing = Soil(**changed), {}
        scenes = dataclasses.replace(mixed_scenes(3), soil=soil)
        found = simulate_batch(scenes, journal=tmp_path / "j", timing=timing)
        laws = found.manifest()["laws"]
        return timing["impacts"], *(laws[slot].rpartition(", ")[2] for slot in changed)

    wide = {"loading_surface": NovaMontrasio(rounding=0.3), "flow": Mine(order=3)}
    assert run(wide) == (3, "rounding=0.3", "order=3")
    assert run(wide)[0] == 0
    assert repr(wide["loading_surface"]).endswith(", rounding=0.3)")
    for slot, usual in (("loading_surface", NovaMontrasio()), ("flow", Mine())):
        with pytest.raises(InputError, match="no journal of this run"):
            run(wide | {slot: usual})


@pytest.mark.slow
def test_a_killed_command_goes_on(tmp_path):
    rows = np.random.default_rng(3).uniform([1, 5], [100, 30], (4000, 2)).tolist()
    table = "mass_kg,speed_mps\n" + "".join(f"{m!r},{v!r}\n" for m, v in rows)
    (tmp_path / "scenes.csv").write_text(table)
    command = ["batch", "scenes.csv", "--accuracy", "fast", "--out"]
    run = subprocess.Popen(
        [sys.executable, "-m", "jaximpact", *command, "killed.csv"],
        cwd=tmp_path,
        stderr=subprocess.PIPE,
    )
    journal = tmp_path / "killed.csv.journal"
    started = time.monotonic()
    while not journal.exists() or journal.stat().st_size < 150_000:
        assert run.poll() is None, run.stderr.read()
        assert time.monotonic() - started < 300, "the journal does not grow"
        time.sleep(0.01)
    os.kill(run.pid, signal.SIGKILL)
    run.communicate()
    assert not (tmp_path / "killed.csv").exists()
    kept = journal.stat().st_size
    here = os.getcwd()
    os.chdir(tmp_path)
    try:
        assert main([*command, "killed.csv"]) == 0
        assert main([*command, "whole.csv"]) == 0
    finally:
        os.chdir(here)
    assert kept > 150_000
    assert not journal.exists()
    assert (tmp_path / "killed.csv").read_bytes() == (
        tmp_path / "whole.csv"
    ).read_bytes()

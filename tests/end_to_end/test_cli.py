"""The command line: exit codes, what goes to which stream, and what is left behind."""

import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from error_messages import assert_one_line_error
from text_files import rows_of

from jaximpact import PRESETS, Block, Impact, Outcome, Soil, simulate
from jaximpact.cli import main
from jaximpact.quantities import INPUT_COLUMNS, RESULT_COLUMNS

MASSES = (3.0, 1.0, 2.0)
SCENES = "name,mass_kg\nc,3\na,1\nb,2\n"


class FakeResult:
    """Results that tell which scene they belong to: each is the scene's mass."""

    def __init__(self, scene, accuracy):
        self.accuracy = PRESETS[accuracy]
        mass = np.asarray(scene.block.mass)
        for column in RESULT_COLUMNS.values():
            setattr(self, column.field, mass.copy())
        self.outcome_code = np.zeros(len(mass))


@pytest.fixture
def fake_batch(monkeypatch):
    """Puts a function of the result in place of the model; lists the settings used."""
    used = []

    def install(change=lambda result: None):
        def simulate_batch(scene, *, accuracy, journal, progress, timing, executor):
            assert executor is None
            used.append(accuracy)
            result = FakeResult(scene, accuracy)
            change(result)
            count = len(result.outcome_code)
            for done in range(1, count + 1):
                progress("impacts", done, count)
            timing.update(engine="XLA", impacts=count, compile_s=1.5, run_s=0.5)
            Path(journal).touch()
            return result

        monkeypatch.setattr("jaximpact.batch.simulate_batch", simulate_batch)
        return used

    return install


@pytest.fixture
def folder(folder):
    """A working directory with one table of scenes."""
    (folder / "scenes.csv").write_text(SCENES)
    return folder


# --- arguments and help


def test_help_explains_every_command_option_and_column(capsys):
    for command, words in (
        ([], ["simulate", "batch", "calibrate", "--version"]),
        (["batch"], ["--out", "--timing", "--accuracy", *INPUT_COLUMNS]),
        (["batch"], [*RESULT_COLUMNS, "outcome"]),
        (["simulate"], ["--json", "--plot", "--accuracy", *INPUT_COLUMNS]),
        (["calibrate"], ["--out", "STUDY"]),
    ):
        with pytest.raises(SystemExit) as exit_:
            main([*command, "--help"])
        assert exit_.value.code == 0
        text = capsys.readouterr().out.split()
        assert set(words) <= {word.strip("[],:") for word in text}


def test_the_module_runs_as_a_program():
    done = subprocess.run(
        [sys.executable, "-m", "jaximpact", "batch"], capture_output=True, text=True
    )
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith("jaximpact: error: the following arguments are req")
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        ([], "COMMAND"),
        (["bach"], "'bach'"),
        (["validate"], "in a checkout of the repository run python -m paper claims"),
        (["batch", "scenes.csv"], "--out"),
        (["batch", "--out", "o.csv"], "scenes.csv"),
        (["batch", "scenes.csv", "--out", "o.csv", "--accuracy", "fats"], "'fats'"),
        (["batch", "scenes.csv", "--out", "o.csv", "--time"], "--time"),
        (["batch", "none.csv", "--out", "o.csv"], "none.csv: cannot be read"),
        (["batch", "scenes.csv", "--out", "none/o.csv"], "existing directory"),
        (["batch", "scenes.csv", "--out", "."], "must be a file"),
        (["batch", "scenes.csv", "--out", os.devnull], "must be a file"),
        (["batch", "scenes.csv", "--out", "./scenes.csv"], "which is read"),
        (["simulate", "none.toml"], "none.toml: cannot be read"),
        (["simulate", "scene.toml", "--plot", "plot.csv"], ".png"),
        (["simulate", "scene.toml", "--plot", "none/plot.png"], "existing directory"),
    ],
)
def test_wrong_arguments_are_one_line_and_leave_nothing(
    folder, fake_batch, capsys, arguments, part
):
    used = fake_batch()
    assert main(arguments) == 2
    assert assert_one_line_error(capsys, "error: ", part).count("\n") == 1
    assert os.listdir(folder) == ["scenes.csv"]
    assert used == []


# --- batch


def test_results_stand_in_the_order_of_the_scenes(folder, fake_batch, capsys):
    used = fake_batch()
    assert main(["batch", "scenes.csv", "--out", "results.csv"]) == 0
    rows = rows_of("results.csv")
    assert [row["name"] for row in rows] == ["c", "a", "b"]
    assert [float(row["e_n"]) for row in rows] == list(MASSES)
    assert [row["outcome"] for row in rows] == ["detached"] * 3
    assert used == ["balanced"]
    assert sorted(os.listdir(folder)) == [
        "results.csv",
        "results.csv.manifest.json",
        "scenes.csv",
    ]
    out, err = capsys.readouterr()
    assert out == ""
    assert err.splitlines()[-1] == "jaximpact: 3 impacts: 3 detached"
    assert "compiling" not in err


def test_a_scene_that_cannot_be_solved_does_not_stop_the_rest(
    folder, fake_batch, capsys
):
    def fail_the_second(result):
        for column in RESULT_COLUMNS.values():
            getattr(result, column.field)[1] = math.nan
        result.outcome_code[1] = float(Outcome.failed)

    fake_batch(fail_the_second)
    assert main(["batch", "scenes.csv", "--out", "results.csv"]) == 0
    rows = rows_of("results.csv")
    assert [row["outcome"] for row in rows] == ["detached", "failed", "detached"]
    assert {rows[1][name] for name in RESULT_COLUMNS} == {"nan"}
    assert float(rows[2]["e_bar"]) == MASSES[2]
    err = capsys.readouterr().err
    assert err.splitlines()[-1] == "jaximpact: 3 impacts: 2 detached, 1 failed"


def test_accuracy_and_timing(folder, fake_batch, capsys):
    used = fake_batch()
    arguments = ["--accuracy", "fast", "--timing"]
    assert main(["batch", "scenes.csv", "--out", "results.csv", *arguments]) == 0
    assert used == ["fast"]
    err = capsys.readouterr().err
    assert "jaximpact: 1.50 s compiling, 0.50 s running, 6 impacts/s in XLA\n" in err


def test_a_bad_cell_ends_a_batch_before_it_starts(folder, fake_batch, capsys):
    used = fake_batch()
    (folder / "scenes.csv").write_text("mass_kg,angle_deg\n1,10\n1,95\n")
    (folder / "results.csv").write_text("of an earlier run")
    assert main(["batch", "scenes.csv", "--out", "results.csv"]) == 2
    err = assert_one_line_error(
        capsys, "error: scenes.csv, row 3, column angle_deg: must be in (-90, 90) deg"
    )
    assert err.count("\n") == 1
    assert used == []
    assert (folder / "results.csv").read_text() == "of an earlier run"
    assert sorted(os.listdir(folder)) == ["results.csv", "scenes.csv"]


@pytest.mark.parametrize(
    ("error", "code", "part"),
    [
        (KeyboardInterrupt(), 130, "interrupted"),
        (OSError(28, "No space left on device"), 1, "No space left on device"),
    ],
)
def test_a_batch_that_is_cut_short_leaves_its_journal_alone(
    folder, fake_batch, monkeypatch, capsys, error, code, part
):
    fake_batch()

    def cut_short(table, result):
        yield ["half of it"]
        raise error

    monkeypatch.setattr("jaximpact.io.result_table._lines", cut_short)
    assert main(["batch", "scenes.csv", "--out", "results.csv"]) == code
    assert_one_line_error(capsys, part)
    assert sorted(os.listdir(folder)) == ["results.csv.journal", "scenes.csv"]


@pytest.mark.slow
def test_a_batch_gives_what_single_impacts_give(folder):
    (folder / "scenes.csv").write_text("angle_deg,c_v\n0,1\n40,2\n")
    assert (
        main(["batch", "scenes.csv", "--out", "results.csv", "--accuracy", "reference"])
        == 0
    )
    rows = rows_of("results.csv")
    for row, angle, c_v in zip(rows, (0.0, 40.0), (1.0, 2.0), strict=True):
        impact = Impact(angle=math.radians(angle))
        single = simulate(Block(), Soil(c_v=c_v), impact, accuracy="reference")
        assert row["outcome"] == str(single.outcome)
        for column in RESULT_COLUMNS.values():
            expected = float(getattr(single, column.field))
            assert float(row[column.name]) == pytest.approx(
                expected, rel=1e-5, abs=1e-9, nan_ok=True
            ), column.name

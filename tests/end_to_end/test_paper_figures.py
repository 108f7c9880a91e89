"""The paper's figures: their numbers against the independent implementation, what is
drawn from them, and the command."""

import json

import model_oracle as oracle
import numpy as np
import pandas as pd
import pytest
from error_messages import assert_one_line_error

from jaximpact import Accuracy, Block, Impact, Soil, simulate
from jaximpact.cli import main
from jaximpact.quantities import (
    FURTHER_COLUMNS,
    INPUT_COLUMNS,
    OUTCOME_COLUMN,
    RESULT_COLUMNS,
)
from jaximpact.units import DEGREE
from paper.__main__ import make_parser
from paper.figures import PAPER_FIGURES, write_figures, write_table
from paper.figures.drawing import colours_of
from paper.figures.slope_figures import ENDING_COLUMN, LINE
from paper.figures.tables import BRANCH, DURATION, JUMP, SERIES, peak
from paper.study import Study

pytestmark = pytest.mark.slow


def run(*argv):
    return main(["figures", *argv], make_parser)


# What is promised of every figure.
COEFFICIENT = 1e-3
RELATIVE = 2e-3

OF_RUNS = ("x_m", "y_m", "height_m", "velocity_mps", "spin_degps")
OF_RUNS += ("start_x_m", "rise_m", "hop")
COARSE = ("7", "11", "12", "14")


@pytest.fixture(scope="module")
def tables():
    """Every figure's table, as the command computes it; Fig. 7, which takes a history
    for each of its points, and the runs at a coarser setting."""
    coarse, fine = Study(accuracy="balanced"), Study(accuracy="reference")
    return {
        number: figure.compute(coarse if number in COARSE else fine)
        for number, figure in PAPER_FIGURES.items()
    }


def row(table, **where):
    """The row at a point."""
    for name, value in where.items():
        table = table[np.isclose(table[name], value, rtol=0.0, atol=1e-9)]
    (found,) = table.to_dict("records")
    return found


def oracle_ratio(solution, model):
    """R_r over the steps of the independent implementation."""
    normal, tangential, spin = solution.y[3:6]
    turning = model.inertia * spin**2
    return turning / (model.mass * (normal**2 + tangential**2) + turning)


# --- numbers


@pytest.mark.parametrize(
    ("number", "point"),
    [
        ("5", dict(orientation_deg=90.0, aspect_ratio=2.5)),
        ("7", dict(angle_deg=65.0, aspect_ratio=2.0)),
        # On the far side of a jump, and behind it
        ("8", dict(orientation_deg=54.0, aspect_ratio=3.0)),
        ("8", dict(orientation_deg=142.0, aspect_ratio=4.0)),
        ("9", dict(orientation_deg=90.0, angle_deg=35.0, aspect_ratio=2.5)),
        ("13", dict(angular_velocity_degps=2000.0, orientation_deg=40.0)),
    ],
)
def test_agrees_with_the_independent_implementation(tables, number, point):
    found = row(tables[number], **point)
    scene = point | ({"aspect_ratio": 2.0} if number == "13" else {})
    expected = oracle.simulate(scene, history=True)
    expected["e_n_vijayakumar"] = expected["e_vijayakumar"]
    ratios = oracle_ratio(expected["solution"], expected["model"])
    expected["max_R_r"] = np.max(ratios)
    assert found[OUTCOME_COLUMN] == expected[OUTCOME_COLUMN]
    results = [name for name in found if name not in (*scene, OUTCOME_COLUMN, BRANCH)]
    assert len(results) >= 2
    for name in results:
        if name.startswith("e_"):
            assert found[name] == pytest.approx(expected[name], abs=COEFFICIENT)
        else:
            assert found[name] == pytest.approx(expected[name], rel=RELATIVE)


def test_time_series_are_the_histories_of_simulate(tables):
    table = tables["6"]
    table = table[table["aspect_ratio"] == 3.0]
    impact = Impact(angle=20.0 * DEGREE)
    result = simulate(
        Block(aspect_ratio=3.0), Soil(), impact, accuracy="reference", history=True
    )
    for column, field in SERIES.items():
        np.testing.assert_array_equal(table[column], getattr(result.history, field))
    assert set(table[OUTCOME_COLUMN]) == {str(result.outcome)}


def test_largest_energy_ratio_is_right_to_a_thousandth(tables):
    # The sphere at 10 degrees has its peak inside, and steps of a percent about it.
    for angle, aspect_ratio in ((10.0, 1.0), (10.0, 1.5), (45.0, 4.0)):
        result = simulate(
            Block(aspect_ratio=aspect_ratio),
            Soil(),
            Impact(angle=angle * DEGREE),
            accuracy=Accuracy("exact", 1e-10, 0.01),
            history=True,
        )
        exact = np.max(result.history.rotational_ratio)
        found = row(tables["7"], angle_deg=angle, aspect_ratio=aspect_ratio)["max_R_r"]
        assert found == pytest.approx(exact, rel=1e-3)
        assert found >= float(result.R_r) * (1.0 - 1e-3)


def test_peak_lies_between_rows():
    time = np.array([0.0, 0.1, 0.4, 0.6, 1.0])
    assert peak(time, 3.0 - (time - 0.45) ** 2) == pytest.approx(3.0, abs=1e-12)
    assert peak(time, time) == 1.0
    assert peak(time, -time) == 0.0
    assert peak(time, np.ones(5)) == 1.0
    assert np.isnan(peak(time, np.array([0.0, 1.0, np.nan, 0.0, 0.0])))


# --- runs down the slope


def test_the_first_flight_is_the_parabola_of_figure_10(tables):
    parabola = tables["10"][tables["10"][LINE] == "parabola of the release"]
    for _, way in tables["11"].groupby("aspect_ratio"):
        flight = way[way["x_m"] < 55.0]
        # Chords of 1/240 of the flight lie some 0.3 mm below the parabola.
        expected = np.interp(flight["x_m"], parabola["x_m"], parabola["y_m"])
        np.testing.assert_allclose(flight["y_m"], expected, atol=1e-3)
        assert set(flight["spin_degps"]) == {0.0}
    # It ends where the centre comes to the ground.
    end = parabola.iloc[-1]
    assert end["y_m"] == pytest.approx(230.0 - 0.575 * end["x_m"], abs=1e-9)


def test_jumps_and_impacts_are_of_one_set_of_runs(tables):
    jumps, impacts = tables["12"], tables["14"]
    by = ["aspect_ratio", "angular_velocity_degps"]
    assert len(impacts.groupby(by)) == 45
    first = impacts.groupby(by).first()
    assert first["x_m"].between(59.0, 61.5).all()
    # A block that hops after an impact does not fly from it.
    flies = impacts["hop"] == 0
    assert len(jumps) <= flies.sum()
    assert set(impacts[~flies]["aspect_ratio"]) == {1.5, 2.0, 3.0, 4.0}


# --- jumps


def test_jumps_remain_however_close_their_sides(tables):
    """And so are found where they are, mirrored, and nowhere else."""
    places = {}
    for aspect_ratio, curve in tables["8"].groupby("aspect_ratio"):
        last = curve.groupby(BRANCH)["orientation_deg"].last().to_numpy()[:-1]
        first = curve.groupby(BRANCH)["orientation_deg"].first().to_numpy()[1:]
        np.testing.assert_allclose(first - last, 1.0 / 1024.0)
        places[aspect_ratio] = 0.5 * (first + last)
    assert [len(found) for found in places.values()] == [0, 0, 0, 0, 2, 2, 2]
    for found in places.values():
        np.testing.assert_allclose(found + found[::-1], 180.0, atol=1.0 / 1024.0)
    # A thousandth of the distance still: the same two impacts.
    place = places[4.0][0]
    durations = [
        float(
            simulate(
                Block(aspect_ratio=4.0),
                Soil(),
                Impact(orientation=(place + side) * DEGREE),
                accuracy="reference",
            ).duration
        )
        for side in (-0.5 / 1024.0, 0.5 / 1024.0)
    ]
    sides = tables["8"][tables["8"]["aspect_ratio"] == 4.0]
    sides = sides[np.abs(sides["orientation_deg"] - place) < 1.0 / 1024.0]
    np.testing.assert_allclose(sides[DURATION], durations, rtol=1e-6)
    assert durations[1] > (1.0 + JUMP) * durations[0]


def test_lines_are_broken_at_jumps(tables):
    figure = PAPER_FIGURES["8"].draw(tables["8"])
    colour = colours_of(tables["8"]["aspect_ratio"])[4.0]
    lines = [x for x in figure.axes[1].get_lines() if x.get_color() == colour]
    assert [line.get_linestyle() for line in lines] == ["-", "-", "-", ":", ":"]
    assert sum(len(line.get_xdata()) for line in lines[:3]) == 181 + 4
    # Nothing of that kind in panel a, which runs along aspect ratios
    assert {line.get_linestyle() for line in figure.axes[0].get_lines()} == {"-"}


# --- drawings


PANELS = {"4": 2, "5": 2, "6": 4, "7": 4, "8": 6, "9": 4}
PANELS |= {"10": 1, "11": 4, "12": 6, "13": 4, "14": 2}


@pytest.mark.parametrize("number", PAPER_FIGURES)
def test_panels_have_letters_and_labels_with_units(tables, number):
    figure = PAPER_FIGURES[number].draw(tables[number])
    letters = [axes.get_title(loc="left") for axes in figure.axes]
    assert letters == list("abcdef")[: PANELS[number]]
    for axes in figure.axes:
        for label in (axes.get_xlabel(), axes.get_ylabel()):
            assert label.endswith("]")
    assert figure.legends


def test_failed_points_are_left_out_and_said(tables, tmp_path, monkeypatch):
    table = tables["5"].copy()
    table.loc[3, ["max_penetration_m", "max_normal_force_N"]] = np.nan
    table.loc[3, OUTCOME_COLUMN] = "failed"
    figure = PAPER_FIGURES["5"]._replace(compute=lambda study: table)
    monkeypatch.setitem(PAPER_FIGURES, "5", figure)
    said = []
    write_figures(tmp_path, Study(), only=["5"], say=said.append)
    assert said[0].startswith(f"{tmp_path / 'figure-5.png'}: ")
    assert "1 of 14 rows failed" in said[0]
    manifest = json.loads((tmp_path / "figure-5.csv.manifest.json").read_text())
    assert manifest["rows"] == {"detached": 13, "failed": 1}


# --- files


@pytest.mark.parametrize("number", PAPER_FIGURES)
def test_tables_come_back_from_their_files(tables, tmp_path, number):
    known = {*INPUT_COLUMNS, *RESULT_COLUMNS, *FURTHER_COLUMNS, *SERIES}
    known |= {"max_R_r", BRANCH, OUTCOME_COLUMN}
    known |= {ENDING_COLUMN, LINE, *OF_RUNS}
    table = tables[number]
    assert set(table) <= known
    write_table(tmp_path / "table.csv", table)
    again = pd.read_csv(tmp_path / "table.csv")
    # A row a point: no index to be known, no column twice
    assert isinstance(table.index, pd.RangeIndex)
    pd.testing.assert_frame_equal(again, table, rtol=1e-15, check_dtype=False)


# --- the command


def test_command_writes_drawing_table_and_manifest(tmp_path, capsys):
    out = tmp_path / "new" / "figures"
    ground = "c_v 0.5, gamma_v 0.85"
    arguments = ["--out", str(out), "--only", "5", "--ground", ground]
    assert run(*arguments, "--accuracy", "fast") == 0
    assert "figure-5.png" in capsys.readouterr().err
    names = ["figure-5.csv", "figure-5.csv.manifest.json", "figure-5.png"]
    assert sorted(path.name for path in out.iterdir()) == names
    table = pd.read_csv(out / "figure-5.csv")
    assert len(table) == 14
    expected = simulate(
        Block(aspect_ratio=1.5), Soil(c_v=0.5, gamma_v=0.85), Impact(), accuracy="fast"
    )
    found = row(table, orientation_deg=0.0, aspect_ratio=1.5)
    assert found["max_penetration_m"] == pytest.approx(
        float(expected.max_penetration), rel=1e-9
    )
    manifest = json.loads((out / "figure-5.csv.manifest.json").read_text())
    assert manifest["ground"] == ground
    assert manifest["accuracy"]["name"] == "fast"
    assert manifest["sets"]["II"]["orientation_deg"] == pytest.approx(90.0)
    assert manifest["sets"]["I"]["gamma_v"] == 0.85
    assert manifest["rows"] == {"detached": 14}
    assert "jaximpact" in manifest["versions"]
    assert (out / "figure-5.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (["--only", "15"], ["one of 4, 5, 6, 7, 8,", "'15'"]),
        (["--only", "4", "figure-8"], ["one of 4, 5, 6, 7, 8,", "'figure-8'"]),
        (["--ground", "table 1"], ["'table 1'", "did you mean 'Table 1'"]),
    ],
)
def test_what_is_unknown_is_refused(tmp_path, capsys, arguments, parts):
    out = tmp_path / "out"
    assert run("--out", str(out), *arguments) == 2
    assert_one_line_error(capsys, *parts)
    assert not out.exists()

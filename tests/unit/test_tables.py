"""Tables of scenes: what is read, and how results go out. What is refused is in
test_malformed_inputs.py."""

import contextlib
import csv
import gc
import json
import math
import os
import sys

import numpy as np
import pandas as pd
import pytest
from error_messages import assert_one_line_error

from jaximpact import PRESETS, Block, Impact, Outcome, Soil, simulate_batch
from jaximpact.cli import main
from jaximpact.errors import InputError
from jaximpact.io.files import replacing
from jaximpact.io.output_files import manifest_path
from jaximpact.io.result_table import count_outcomes, write_results
from jaximpact.io.scene_table import SIGMA_COLUMNS, SLICE_ROWS, read_table
from jaximpact.quantities import (
    INPUT_COLUMNS,
    LABEL_COLUMNS,
    OUTCOME_MEANING,
    RESULT_COLUMNS,
)


@pytest.fixture
def table_of(tmp_path):
    """Writes bytes or text to scenes.csv and reads it."""

    def read(content, **options):
        path = tmp_path / "scenes.csv"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return read_table(path, **options)

    return read


FAST = PRESETS["fast"]


class FakeResult:
    """A result of known numbers, in place of one that is computed."""

    def __init__(self, count):
        generator = np.random.default_rng(7)
        for column in RESULT_COLUMNS.values():
            values = generator.normal(size=count) * 10.0 ** generator.integers(
                -300, 300, count
            )
            setattr(self, column.field, values)
        self.outcome_code = np.arange(count) % len(Outcome) * 1.0


def test_values_are_converted_to_si_and_missing_columns_take_their_default(table_of):
    scene = table_of(
        "slope_deg,mass_kg,unit_weight_kNm3\n45,2.5,20\n-30,1e3,16.5\n"
    ).scene()
    np.testing.assert_array_equal(scene.block.mass, [2.5, 1000.0])
    np.testing.assert_allclose(scene.impact.slope, [math.pi / 4, -math.pi / 6], 1e-15)
    np.testing.assert_array_equal(scene.soil.unit_weight, [20e3, 16.5e3])
    assert float(scene.impact.speed) == 14.0
    assert float(scene.soil.friction_angle) == pytest.approx(math.pi / 6, rel=1e-15)


def test_a_table_without_numbers_has_a_default_scene_for_each_row(table_of):
    scene = table_of("name\nfirst\nsecond\nthird\n").scene()
    np.testing.assert_array_equal(scene.block.mass, [100.0] * 3)


def test_defaults_of_the_columns_are_those_of_the_modules():
    parts = {"block": Block(), "soil": Soil(), "impact": Impact()}
    for column in INPUT_COLUMNS.values():
        value = float(getattr(parts[column.part], column.field))
        assert value == pytest.approx(column.factor * column.default, rel=1e-15), column


def test_the_help_of_the_outcome_names_every_outcome():
    assert all(str(outcome) in OUTCOME_MEANING for outcome in Outcome)


@pytest.mark.parametrize(
    "content",
    [
        b"\xef\xbb\xbfmass_kg,speed_mps\n1,2\n3,4\n",
        b"mass_kg,speed_mps\r\n1,2\r\n3,4\r\n",
        b"mass_kg,speed_mps\r1,2\r3,4",
        b"\nmass_kg,speed_mps\n\n1,2\n  \n3,4\n\n",
        b'"mass_kg", speed_mps\n"1",2\n 3 , 4\n',
        b'mass_kg,note,speed_mps\n1,"two\nlines, quoted",2\n3,\xc3\xa4,4\n',
    ],
    ids=["byte-order-mark", "windows", "old-mac", "blank-lines", "spaces", "quotes"],
)
def test_harmless_variants_of_csv_are_read(table_of, content):
    numbers = table_of(content).numbers
    np.testing.assert_array_equal(numbers["mass_kg"], [1.0, 3.0])
    np.testing.assert_array_equal(numbers["speed_mps"], [2.0, 4.0])


@pytest.mark.parametrize("column", INPUT_COLUMNS.values(), ids=INPUT_COLUMNS)
def test_each_bound_is_allowed_or_refused_as_its_column_says(table_of, column):
    for bound, allowed in (
        (column.lower, column.lower_allowed),
        (column.upper, column.upper_allowed),
    ):
        content = f"{column.name}\n{bound!r}\n"
        if allowed:
            assert table_of(content).numbers[column.name] == [bound]
        else:
            with pytest.raises(InputError, match=f"row 2, column {column.name}"):
                table_of(content)


def test_a_bad_cell_deep_in_the_table_is_found(table_of):
    rows = ["1"] * (3 * SLICE_ROWS)
    rows[2 * SLICE_ROWS + 17] = "0"
    with pytest.raises(InputError, match=f"row {2 * SLICE_ROWS + 19}, column mass_kg"):
        table_of("mass_kg\n" + "\n".join(rows))


@pytest.mark.parametrize("mass", [1.0, -1.0])
def test_the_collector_runs_again_after_a_table_is_read_or_refused(table_of, mass):
    with contextlib.suppress(InputError):
        table_of(f"mass_kg\n{mass}\n")
    assert gc.isenabled()


def test_measured_values_are_read_with_their_uncertainty(table_of):
    table = table_of(
        "test,e_n,sigma_e_n,outcome\nA,-0.25,0.05,detached\n", measured=True
    )
    assert table.numbers["e_n"] == [-0.25]
    assert table.numbers["sigma_e_n"] == [0.05]


@pytest.mark.parametrize(
    ("content", "needed"),
    [
        ("e_n\n0.5\ninf\n", "row 3, column e_n: must be finite, but is inf"),
        ("e_n\n0.5\n>nan\n", "row 3, column e_n: has a sign without a number"),
        ("e_n\n0.5\n>\n", "row 3, column e_n: has a sign without a number"),
        ("e_n\n0.5\n>=0.3\n", "row 3, column e_n: must be a number, but is '=0.3'"),
        ("sigma_e_n\n>0.1\n", "row 2, column sigma_e_n: must be a number"),
        ('mass_kg,e_n\n1,0.5\n"",0.5\n', "row 3, column mass_kg: is empty"),
        ("sigma_e_n\n0\n", "row 2, column sigma_e_n: must be above 0"),
        ("e_nn\n0.5\n", "row 1, column e_nn: is unknown; did you mean e_n?"),
    ],
)
def test_bad_measured_values_are_refused(table_of, content, needed):
    with pytest.raises(InputError) as caught:
        table_of(content, measured=True)
    assert needed in str(caught.value)


def test_no_name_of_a_column_has_two_meanings():
    names = [*INPUT_COLUMNS, *RESULT_COLUMNS, *SIGMA_COLUMNS, *LABEL_COLUMNS, "outcome"]
    assert len(set(names)) == len(names)


def test_results_are_appended_to_rows_left_as_they_were(table_of, tmp_path):
    count = SLICE_ROWS + 5
    rows = [f'{k + 1}.50,"block, {k}",1e1' for k in range(count)]
    table = table_of("\r\n".join(["mass_kg, name ,speed_mps", *rows]))
    result = FakeResult(count)
    write_results(tmp_path / "results.csv", table, result, FAST)

    text = (tmp_path / "results.csv").read_text()
    assert text.endswith("\n")
    lines = text.splitlines()
    assert len(lines) == count + 1
    assert all(a.startswith(b + ",") for a, b in zip(lines[1:], rows, strict=True))
    read = list(csv.reader(lines))
    assert read[0] == ["mass_kg", " name ", "speed_mps", *RESULT_COLUMNS, "outcome"]
    for place, column in enumerate(RESULT_COLUMNS.values(), start=3):
        back = [float(row[place]) for row in read[1:]]
        np.testing.assert_array_equal(back, getattr(result, column.field))
    assert [row[-1] for row in read[1:7]] == [str(outcome) for outcome in Outcome]


def test_what_is_undefined_is_written_as_nan(table_of, tmp_path):
    result = FakeResult(1)
    result.e_t = np.array([np.nan])
    table = table_of("mass_kg\n1\n")
    write_results(tmp_path / "results.csv", table, result, FAST)
    header, row = csv.reader((tmp_path / "results.csv").read_text().splitlines())
    assert row[header.index("e_t")] == "nan"


def test_the_manifest_says_from_what_the_results_came(table_of, tmp_path):
    table = table_of("mass_kg\n1\n2\n")
    write_results(tmp_path / "results.csv", table, FakeResult(2), FAST)
    manifest = json.loads(manifest_path(tmp_path / "results.csv").read_text())
    assert manifest["scenes"]["file"] == "scenes.csv"
    assert manifest["scenes"]["sha256"] == table.sha256
    assert manifest["accuracy"]["name"] == "fast"
    assert manifest["outcomes"] == {"detached": 1, "toppled": 1}
    assert "jax" in manifest["versions"]


def test_outcomes_are_counted():
    result = FakeResult(0)
    result.outcome_code = np.array([5.0, 0.0, 0.0, 3.0])
    assert count_outcomes(result) == {"detached": 2, "in contact": 1, "failed": 1}


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="Linux has a full disk")
def test_a_full_disk_is_told_with_the_file(tmp_path):
    def write_to_full_disk():
        with replacing(tmp_path / "results.csv"), open("/dev/full", "w") as full:
            full.write("half of")

    with pytest.raises(OSError, match=r"No space left on device: '.*results\.csv'"):
        write_to_full_disk()
    assert os.listdir(tmp_path) == []


def test_an_error_names_the_file_that_was_asked_for(tmp_path):
    """Not the hidden one that is written in its place; other files keep their names."""

    def write(place):
        with replacing(tmp_path / "a.png") as temporary:
            raise OSError(28, "No space left on device", str(place or temporary))

    with pytest.raises(OSError, match=r"on device: '[^']*[/\\]a\.png'$"):
        write(None)
    with pytest.raises(OSError, match="on device: 'other'"):
        write("other")


# --- Parquet


@pytest.fixture
def frame():
    draw = np.random.default_rng(3)
    return pd.DataFrame(
        {
            "name": [f"a, {i}" for i in range(9)],
            "mass_kg": draw.uniform(20.0, 90.0, 9),
            "angle_deg": draw.uniform(0.0, 80.0, 9),
        }
    )


def test_a_table_in_parquet_is_the_csv(frame, tmp_path):
    frame.to_parquet(tmp_path / "scenes.parquet")
    frame.to_csv(tmp_path / "scenes.csv", index=False)
    tables = [read_table(tmp_path / f"scenes.{kind}") for kind in ("parquet", "csv")]
    assert tables[0].rows == tables[1].rows
    result = simulate_batch(tables[0].scene())
    out = tmp_path / "results.parquet"
    write_results(out, tables[0], result, result.accuracy)
    received = pd.read_parquet(out)
    for name in frame:
        assert received[name].tolist() == frame[name].tolist()
    assert received.e_n.to_numpy().tobytes() == np.asarray(result.e_n).tobytes()
    assert set(received.outcome) == {"detached"}
    assert (tmp_path / "results.parquet.manifest.json").exists()


def test_columns_of_parquet_are_carried_along_with_their_types(tmp_path):
    frame = pd.DataFrame(
        {
            "id": pd.array([7, None, 9], dtype="Int64"),
            "mass_kg": [100, 200, 300],
            "test": [True, False, True],
            "date": pd.to_datetime(["2020-01-01", "2020-01-02", "2020-01-03"]),
            "note": [None, "a", ""],
            "comment": [1.0, np.nan, 3.0],
            "angle_deg": np.array([0.1, 0.2, 0.3], np.float32),
        },
        index=[5, 3, 8],
    )
    frame.to_parquet(tmp_path / "scenes.parquet")
    table = read_table(tmp_path / "scenes.parquet")
    result = simulate_batch(table.scene())
    out = tmp_path / "results.parquet"
    write_results(out, table, result, result.accuracy)
    received = pd.read_parquet(out)[[*frame]]
    came = pd.read_parquet(tmp_path / "scenes.parquet").reset_index(drop=True)
    pd.testing.assert_frame_equal(received, came)


@pytest.mark.parametrize("kind", ["float16", "float32", "Float32"])
def test_short_numbers_of_parquet_keep_every_bit(tmp_path, kind):
    angles = pd.Series([0.1, 0.7]).astype(kind)
    pd.DataFrame({"angle_deg": angles}).to_parquet(tmp_path / "a.parquet")
    numbers = read_table(tmp_path / "a.parquet").numbers["angle_deg"]
    assert numbers.tolist() == angles.astype(float).tolist() != [0.1, 0.7]


def test_labels_of_parquet_may_hold_any_end_of_a_line(tmp_path):
    names = ["a\rb", "a\nb", "a\r\nb", '"a, b"', "\r"]
    frame = pd.DataFrame({"name": names, "mass_kg": 100.0})
    frame.to_parquet(tmp_path / "a.parquet")
    table = read_table(tmp_path / "a.parquet", measured=True)
    assert table.labels["name"] == [name.strip() for name in names]
    pd.DataFrame({"name": [" ", None, "a"]}).to_parquet(tmp_path / "alone.parquet")
    assert len(read_table(tmp_path / "alone.parquet").rows) == 3


def test_a_column_of_parquet_that_stands_twice_is_named(tmp_path):
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    masses = pyarrow.array([1.0, 2.0])
    table = pyarrow.table([masses, masses], names=["mass_kg", "mass_kg"])
    parquet.write_table(table, tmp_path / "a.parquet")
    with pytest.raises(InputError, match="column mass_kg: stands twice"):
        read_table(tmp_path / "a.parquet")


def test_bad_values_are_told_as_of_a_csv(frame, tmp_path):
    frame.loc[4, "angle_deg"] = 95.0
    frame.to_parquet(tmp_path / "scenes.parquet")
    with pytest.raises(InputError, match="row 6, column angle_deg: must be in"):
        read_table(tmp_path / "scenes.parquet")


def test_what_is_no_parquet_is_refused(tmp_path):
    (tmp_path / "scenes.parquet").write_text("mass_kg\n1\n")
    with pytest.raises(InputError, match="is no table in Parquet"):
        read_table(tmp_path / "scenes.parquet")


def test_without_pyarrow_nothing_is_computed_first(frame, folder, monkeypatch, capsys):
    frame.to_csv("scenes.csv", index=False)
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    assert main(["batch", "scenes.csv", "--out", "results.parquet"]) == 2
    assert_one_line_error(capsys, "--out results.parquet needs the package pyarrow")
    assert [path.name for path in folder.iterdir()] == ["scenes.csv"]


def test_an_index_of_parquet_is_a_column(tmp_path):
    """As it is in a CSV of the same frame: a mass is no default."""
    frame = pd.DataFrame({"mass_kg": [500.0, 2000.0], "angle_deg": [10.0, 20.0]})
    by_name = frame.assign(name=["a", "b"]).set_index(["name", "mass_kg"])
    by_name.to_parquet(tmp_path / "tests.parquet")
    table = read_table(tmp_path / "tests.parquet", measured=True)
    np.testing.assert_array_equal(table.numbers["mass_kg"], [500.0, 2000.0])
    assert table.labels["name"] == ["a", "b"]

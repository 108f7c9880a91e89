"""Tables in Parquet: the same scenes and results as in CSV, to the last bit."""

import sys

import numpy as np
import pandas as pd
import pytest
from error_messages import assert_one_line_error

from jaximpact import simulate_batch
from jaximpact.cli import main
from jaximpact.errors import InputError
from jaximpact.io.result_table import write_results
from jaximpact.io.scene_table import read_table


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

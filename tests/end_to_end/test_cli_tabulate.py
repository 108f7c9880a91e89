"""Tables through the command: made, used, refused."""

import json

import numpy as np
import pytest
import xarray as xr
from error_messages import assert_one_line_error
from slope_study import assert_refused, slope_text
from text_files import rows_of, write_changed

from jaximpact import Block, Soil, read_netcdf
from jaximpact.cli import main
from jaximpact.io.journal import Journal
from jaximpact.lookup import Nodes, Tabulated, read_table, tabulate
from jaximpact.runout import read_slope_study, run_slope_study

pytestmark = pytest.mark.slow

TABLE = """
[block]
mass_kg = 200

[ground]
gamma_v = 4

[table]
slopes_deg = [-10, 0, 40]
total_speeds_mps = [0.5, 40]
nodes = { speed = 4, elevation = 6, azimuth = 9 }
"""
SLOPE = slope_text(
    top="count = 20",
    profile="points_m = [[0, 20], [30, 0], [80, 0]]",
    ground="[ground]\ngamma_v = 4",
    block="mass_kg = 200",
    contacts='law = "table"\nfiles = ["table.nc"]',
)
SECOND = "[ground.segment.2]\n"


@pytest.fixture
def here(folder):
    (folder / "table.toml").write_text(TABLE)
    (folder / "slope.toml").write_text(SLOPE)
    return folder


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """What the command writes."""
    path = tmp_path_factory.mktemp("made")
    (path / "table.toml").write_text(TABLE)
    files = ("--out", "table.nc", "--csv", "table.csv")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(path)
        assert main(["tabulate", "table.toml", *files]) == 0
    return path


def test_the_command_makes_the_table(made):
    table = read_table(made / "table.nc")
    assert table.outcomes.shape == (4, 6, 9, 1, 3)
    assert float(table.block.mass) == 200.0
    assert float(table.soil.gamma_v) == 4.0
    np.testing.assert_allclose(np.degrees(table.slopes), [-10.0, 0.0, 40.0])
    assert 0.0 < table.error.median < table.error.of_90_percent
    assert table.error.impacts > 9000
    rows = rows_of(made / "table.csv")
    assert len(rows) == table.outcomes.size
    assert {"speed_mps", "angle_deg", "e_n", "duration_s"} <= set(rows[0])
    manifest = json.loads((made / "table.csv.manifest.json").read_text())
    assert manifest["error"]["median"] == table.error.median
    assert not list(made.glob("*.journal"))


def test_the_slope_uses_the_table(here, made):
    (here / "table.nc").write_bytes((made / "table.nc").read_bytes())
    study = read_slope_study(here / "slope.toml")
    assert isinstance(study.law.contacts, Tabulated)
    assert study.law.description["law"] == "table"
    assert len(study.inputs.checksums_by_name["table.nc"]) == 64
    assert main(["runout", "slope.toml", "--out", "out"]) == 0
    dataset = read_netcdf(here / "out" / "blocks.nc")
    assert set(dataset.ending.values) == {"stopped"}
    contacts = Tabulated(read_table(made / "table.nc"))
    by_hand = study._replace(law=study.law._replace(contacts=contacts))
    xr.testing.assert_equal(dataset, run_slope_study(by_hand))


@pytest.mark.parametrize(
    ("message", "old", "new"),
    [
        ("block 0 ... mass_kg is 190 and ... 200", "mass_kg = 200", "mass_kg = 190"),
        ("0 on segment 1 ... mass_kg is", "= 200", "= { mean = 200, sd = 1 }"),
        ("block 1 ... gamma_v is 5 and ... 4", "gamma_v = 4", "gamma_v = [4, 5]"),
        ("2 ... c_v is 0.3 and in a table 1", "[block]", f"{SECOND}c_v = 0.3\n[block]"),
        ("slopes of 45 deg for block 0 on segment 1", "[30, 0]", "[20, 0]"),
        ("18.69 to 48.69 deg for block 0", "gamma_v", "roughness_deg = 5\ngamma_v"),
        ("tabel.nc", '["table.nc"]', '["tabel.nc"]'),
        ("key contacts.files ... must be a list", '["table.nc"]', '"table.nc"'),
        ("contacts.files ... list of files", '["table.nc"]', "[]"),
    ],
)
def test_other_blocks_and_grounds_are_refused(here, made, capsys, message, old, new):
    (here / "table.nc").write_bytes((made / "table.nc").read_bytes())
    write_changed(here / "slope.toml", SLOPE, (old, new))
    assert_refused(capsys, message)


def test_a_table_goes_on(here, made, capsys, monkeypatch):
    kept, append = [], Journal.append

    def interrupted(journal, places, rows):
        append(journal, places, rows)
        kept.extend(places)
        if len(kept) == len(places):
            raise KeyboardInterrupt

    monkeypatch.setattr("jaximpact.backend.rows.LANES_AT_ONCE", 100)
    monkeypatch.setattr(Journal, "append", interrupted)
    assert main(["tabulate", "table.toml", "--out", "table.nc"]) == 130
    assert_one_line_error(capsys, "the same command goes on from here")
    assert 0 < len(kept) < 648
    assert main(["tabulate", "table.toml", "--out", "table.nc"]) == 0
    assert sorted(kept) == list(range(648))
    whole = read_table(made / "table.nc")
    again = read_table(here / "table.nc")
    np.testing.assert_array_equal(again.entries, whole.entries)
    np.testing.assert_array_equal(again.outcomes, whole.outcomes)


def test_the_file_is_that_of_python(made):
    table = tabulate(
        Block(mass=200.0),
        Soil(gamma_v=4.0),
        slopes=np.radians([-10.0, 0.0, 40.0]),
        speeds=(0.5, 40.0),
        nodes=Nodes(4, 6, 9),
    )
    np.testing.assert_array_equal(table.entries, read_table(made / "table.nc").entries)


@pytest.mark.parametrize(
    ("options", "part"),
    [
        ((), "--out or --csv is needed"),
        (("--out", "table.csv"), "--out must end in .nc"),
        (("--csv", "a.nc"), "--csv must end in .csv"),
    ],
)
def test_wrong_options_are_refused(here, capsys, options, part):
    assert main(["tabulate", "table.toml", *options]) == 2
    assert_one_line_error(capsys, part)

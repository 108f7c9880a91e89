"""Laws of contact beside each other: the same blocks, and each as it goes alone."""

import json

import numpy as np
import pytest
import xarray as xr
from error_messages import assert_one_line_error
from slope_study import assert_refused
from text_files import rows_of

from jaximpact import FrictionalEllipsoid, read_netcdf
from jaximpact.cli import main
from jaximpact.errors import InputError
from jaximpact.reports.tables import Table
from jaximpact.runout import (
    ClosedForm,
    Ending,
    FullModel,
    read_slope_studies,
    read_slope_study,
    run_slope_study,
)
from jaximpact.runout.study import run_study as study_module

# Before a test replaces `simulate`, which it imports.
from jaximpact.runout.study.output import comparison_report

pytestmark = pytest.mark.slow

SLOPE = """
count = 60
collectors_m = [40, 60]
bins = 12

[profile]
points_m = [[0, 50], [50, 20], [80, 0], [200, 0]]

[ground]
roughness_deg = 3

[block]
aspect_ratio = [1, 1.5]

[release]
x_m = { from = 2, to = 6 }
clearance_m = 0.5
speed_mps = 5

[[barriers]]
x_m = 60
height_m = 1
capacity_kJ = 20
"""
CONSTANT = """
[[contacts]]
law = "constant coefficients"
e_n = 0.35
e_t = 0.85
"""
FRICTIONAL = """
[[contacts]]
name = "mu 0.6"
law = "frictional ellipsoid"
e_contact = 0.3
friction_coefficient = 0.6
"""
SMOOTHER = FRICTIONAL.replace("0.6", "0.2")


@pytest.fixture
def slope(folder):
    path = folder / "slope.toml"
    path.write_text(SLOPE + CONSTANT + FRICTIONAL + SMOOTHER)
    return path


LEAVING = """
count = 40

[profile]
points_m = [[0, 100], [100, 0], [200, 0]]
origin = [2600000, 1200000]
azimuth_deg = 135
crs = "EPSG:2056"

[release]
x_m = [0, 5]
clearance_m = 1
v_x_mps = [-1, 2]
"""


def test_blocks_that_leave_the_profile_at_their_release(folder):
    """They have no path: a point stands for it on the map, and largest values are those
    of the others."""
    path = folder / "leaving.toml"
    path.write_text(LEAVING + CONSTANT + FRICTIONAL)
    assert main(["runout", str(path), "--out", "out"]) == 0
    for row in rows_of(folder / "out" / "comparison.csv"):
        assert all(float(row[name]) > 0.0 for name in row if name.startswith("max_"))
    assert [*(folder / "out").rglob("maps.gpkg")]


def test_laws_get_the_same_blocks(slope):
    studies = read_slope_studies(slope)
    assert [s.law.name for s in studies] == [
        *("constant coefficients", "mu 0.6", "mu 0.2")
    ]
    assert studies[1].law.contacts.law.friction_coefficient == 0.6
    assert isinstance(studies[1].law.contacts.law, FrictionalEllipsoid)
    for study in studies[1:]:
        assert study.release is studies[0].release
        assert study.ground is studies[0].ground
    with pytest.raises(InputError, match="names 3 laws"):
        read_slope_study(slope)


def test_a_file_without_contacts_has_the_full_model(slope):
    slope.write_text(SLOPE)
    (study,) = read_slope_studies(slope, "fast")
    assert study.law.contacts == FullModel("fast")
    slope.write_text('accuracy = "fast"\n' + SLOPE + CONSTANT + "[[contacts]]\n")
    closed, full = read_slope_studies(slope)
    assert isinstance(closed.law.contacts, ClosedForm)
    assert full.law.contacts == FullModel("fast")
    assert full.law.name == "full model"


def test_the_command_compares(slope, tmp_path, capsys):
    assert main(["runout", "slope.toml", "--out", "out"]) == 0
    printed, said = capsys.readouterr()
    assert "contacts by mu 0.6" in said
    assert "Barriers by constant coefficients" in printed
    out = tmp_path / "out"
    assert {path.name for path in out.iterdir()} == {
        *("constant-coefficients", "mu-0-6", "mu-0-2", "jaximpact-study.json"),
        *("comparison.csv", "comparison_collectors.csv", "comparison_barriers.csv"),
        *("comparison.png", "comparison_collectors.png", "manifest.json"),
        "report.html",
    }
    assert not list(out.glob("*/*.journal"))
    rows = {row["law"]: row for row in rows_of(out / "comparison.csv")}
    passages = {
        (row["law"], row["collector_m"], row["quantity"]): row
        for row in rows_of(out / "comparison_collectors.csv")
    }
    barriers = rows_of(out / "comparison_barriers.csv")
    laws = json.loads((out / "manifest.json").read_text())["laws"]
    for study in read_slope_studies(slope):
        # Each as it would be by itself.
        name, alone = study.law.name, out / study.law.directory
        dataset = read_netcdf(alone / "blocks.nc")
        xr.testing.assert_equal(dataset, run_slope_study(study))
        stopped = dataset.ending.values == str(Ending.stopped)
        row = rows[name]
        assert (int(row["stopped"]), int(row["blocks"])) == (stopped.sum(), 60)
        x, speed = dataset.x_m.values[stopped], dataset.max_speed_mps
        assert float(row["stop_x_p95_m"]) == np.percentile(x, 95)
        assert float(row["max_speed_p95_mps"]) == np.percentile(speed, 95)
        energies = dataset.passage_energy_J_percentiles.sel(collector=60.0)
        at = passages[name, "60.0", "energy_J"]
        assert float(at["p99"]) == energies.sel(percentile=99)
        of_law = [row for row in barriers if row["law"] == name]
        assert [{**r, "law": name} for r in rows_of(alone / "barriers.csv")] == of_law
        assert laws[name]["contacts"] == study.law.description
        assert f"\n  {name} " in printed


def test_a_comparison_goes_on(slope, capsys, monkeypatch):
    """Laws that were done are not computed again, but for the drawing."""
    computed, simulate = [], study_module.simulate

    def interrupted(study, chosen, progress=None):
        computed.append((study.law.name, len(chosen)))
        if study.law.name == "mu 0.2":
            raise KeyboardInterrupt
        return simulate(study, chosen, progress)

    monkeypatch.setattr(study_module, "simulate", interrupted)
    assert main(["runout", "slope.toml", "--out", "out"]) == 130
    assert_one_line_error(capsys, "the same command goes on from here")
    assert computed == [("constant coefficients", 60), ("mu 0.6", 60), ("mu 0.2", 60)]
    computed.clear()
    assert main(["runout", "slope.toml", "--out", "out"]) == 130
    assert computed == [("mu 0.2", 60)]


LEFT = """
count = 30

[profile]
points_m = [[-400, 0], [-100, 0], [0, 60]]

[release]
x_m = -2
clearance_m = 1
speed_mps = { from = 2, to = 6 }
direction_deg = 180
"""


def test_the_farthest_of_blocks_that_run_left(folder):
    (folder / "left.toml").write_text(LEFT + CONSTANT + FRICTIONAL)
    studies = read_slope_studies(folder / "left.toml")
    datasets = {study.law.name: run_slope_study(study) for study in studies}
    report = comparison_report(datasets)
    (table,) = (part for part in report.answer if isinstance(part, Table))
    assert table.columns[-1] == "farthest"
    assert len(table.rows) == 2
    for law, *_, farthest in table.rows:
        x = datasets[law].x_m.values[datasets[law].ending.values == "stopped"]
        assert farthest == f"{x.min():.5g}" != f"{x.max():.5g}"
    assert "Blocks run to the left." in report.text()


def test_letters_of_any_language_name_directories(slope):
    names = ("Ä", "雪 2", "Fels_A")
    laws = (FRICTIONAL.replace("mu 0.6", name) for name in names)
    slope.write_text(SLOPE + "".join(laws), encoding="utf-8")
    directories = [study.law.directory for study in read_slope_studies(slope)]
    assert directories == ["ä", "雪-2", "fels-a"]


@pytest.mark.parametrize(
    ("message", "text"),
    [
        ("contacts.name ... stands twice", SLOPE + CONSTANT * 2),
        ("contacts.name ... 'mu 0.6' stands twice", SLOPE + FRICTIONAL * 2),
        (
            "'mu 0.6' and 'Mu_0.6' ... directory mu-0-6",
            SLOPE + FRICTIONAL + FRICTIONAL.replace("mu 0.6", "Mu_0.6"),
        ),
        ("must be one line", SLOPE + FRICTIONAL.replace("mu 0.6", "mu\\n0.6")),
        ("needs a letter", SLOPE + CONSTANT + FRICTIONAL.replace("mu 0.6", "?")),
        ("mean name?", SLOPE + CONSTANT + FRICTIONAL.replace("name", "nmae")),
        ("contacts.e_n ... is needed", SLOPE + CONSTANT.replace("e_n = 0.35", "")),
        ("mean constant", SLOPE + CONSTANT.replace('"constant', '"konstant')),
        ("files ... is needed", SLOPE + CONSTANT + '[[contacts]]\nlaw = "table"\n'),
        ("key contacts ... must be a table", "contacts = [3]\n" + SLOPE),
        ("key contacts ... empty list", "contacts = []\n" + SLOPE),
    ],
)
def test_bad_laws_are_refused_in_one_line(slope, capsys, message, text):
    slope.write_text(text)
    assert_refused(capsys, f"slope.toml ... {message}")

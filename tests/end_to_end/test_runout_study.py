"""Many blocks from a file: draws, portions, journal, endings, files, and bad input."""

import json

import jax
import numpy as np
import pytest
import xarray as xr
from error_messages import assert_one_line_error
from slope_study import SLOPE
from text_files import rows_of

from jaximpact import ConstantCoefficients, read_netcdf
from jaximpact.cli import main
from jaximpact.errors import InputError
from jaximpact.rebound import Rebound
from jaximpact.runout import (
    ClosedForm,
    Ending,
    FullModel,
    Ground,
    Profile,
    Release,
    read_slope_study,
    run_slope_study,
)
from jaximpact.runout.study import run_study as study_module

# Before a test replaces `simulate`, which it imports.
from jaximpact.runout.study.drawing import draw_stops
from jaximpact.runout.study.output import names_of_files

pytestmark = pytest.mark.slow


def test_the_file_says_what_is_computed(changed):
    study = read_slope_study(
        changed(("speed_mps = 5", "speed_mps = 5\ndirection_deg = 10"))
    )
    assert study.release.count == 90
    assert list(study.settings.collectors) == [40.0, 60.0]
    assert list(study.profile.soil.c_v) == [1.0, 0.5, 1.0, 1.0]
    mass = np.asarray(study.release.block.mass)
    assert mass.min() >= 20.0
    assert len(np.unique(mass)) == 90
    assert list(study.release.block.aspect_ratio[:4]) == [1.0, 1.5, 2.0, 1.0]
    np.testing.assert_allclose(study.release.v_y, 5.0 * np.sin(np.radians(10.0)))
    assert study.law.description == {
        "law": "frictional ellipsoid",
        "e_contact": 0.3,
        "friction_coefficient": 0.6,
    }


def test_neither_portions_nor_the_count_matter(
    slope, changed, slope_results, monkeypatch
):
    whole = slope_results.dataset
    monkeypatch.setattr(study_module, "FIRST_PORTION", 7)
    monkeypatch.setattr(study_module, "QUICK", 0.0)
    xr.testing.assert_identical(run_slope_study(read_slope_study(slope)), whole)
    fewer = run_slope_study(read_slope_study(changed(("count = 90", "count = 25"))))
    for name, values in fewer.items():
        if "block" in values.dims:
            xr.testing.assert_identical(values, whole[name].isel(block=slice(25)))


def test_a_journal_goes_on(changed, slope_results, tmp_path, monkeypatch):
    study, whole = slope_results.study, slope_results.dataset
    monkeypatch.setattr(study_module, "FIRST_PORTION", 20)
    monkeypatch.setattr(study_module, "QUICK", 0.0)

    def interrupt(done, total):
        if done >= 30:
            raise KeyboardInterrupt

    journal = tmp_path / "blocks.journal"
    with pytest.raises(KeyboardInterrupt):
        run_slope_study(study, journal=journal, progress=interrupt)
    computed, simulate = [], study_module.simulate

    def counted(study, chosen, progress=None):
        computed.extend(chosen)
        return simulate(study, chosen, progress)

    monkeypatch.setattr(study_module, "simulate", counted)
    again = run_slope_study(study, journal=journal)
    assert computed == list(range(20, 90))
    xr.testing.assert_identical(again, whole)
    other = read_slope_study(changed(("seed = 7", "seed = 8")))
    with pytest.raises(InputError, match="is no journal of this run"):
        run_slope_study(other, journal=journal)


def test_a_journal_is_not_of_a_study_that_was_changed_in_python(
    slope_results, tmp_path
):
    study, journal = slope_results.study, tmp_path / "blocks.journal"
    run_slope_study(study, journal=journal)
    limits = study.settings.limits._replace(time=1.0)
    p, ground, turned = study.profile, study.ground, study.release.body._asdict()
    turned["orientation"] = turned["orientation"] + 0.1
    others = [
        study._replace(settings=study.settings._replace(limits=limits)),
        study._replace(profile=Profile(p.x, p.y + 1.0, p.soil)),
        study._replace(release=Release(study.release.block, **turned)),
        study._replace(ground=Ground(ground.soil, 0.5)),
        study._replace(
            law=study.law._replace(contacts=ClosedForm(ConstantCoefficients(0.4, 0.9)))
        ),
    ]
    for other in others:
        with pytest.raises(InputError, match="is no journal of this run"):
            run_slope_study(other, journal=journal)
    again = run_slope_study(read_slope_study(study.inputs.path), journal=journal)
    xr.testing.assert_identical(again, slope_results.dataset)


CALLS = []


class CountsItsCalls(ConstantCoefficients):
    """A law with a memory of its own."""

    def __call__(self, block, impact):
        CALLS.append(block)
        return super().__call__(block, impact)


def test_a_journal_of_a_law_that_remembers_goes_on(slope_results, tmp_path):
    study, journal = slope_results.study, tmp_path / "blocks.journal"
    law = study.law._replace(contacts=ClosedForm(CountsItsCalls(0.4, 0.9)))
    whole = run_slope_study(study._replace(law=law), journal=journal)
    assert CALLS
    again = run_slope_study(study._replace(law=law), journal=journal)
    xr.testing.assert_identical(again, whole)
    plain = study.law._replace(contacts=ClosedForm(ConstantCoefficients(0.4, 0.9)))
    with pytest.raises(InputError, match="is no journal of this run"):
        run_slope_study(study._replace(law=plain), journal=journal)


class FailsOnTheFlat(ConstantCoefficients):
    """A law that fails for heavy blocks, after they passed the collectors."""

    def __call__(self, block, impact):
        after = super().__call__(block, impact)
        known = jax.numpy.where(impact.slope > 0.1, 1.0, 100.0 - block.mass)
        return Rebound(*(x + 0.0 * jax.numpy.sqrt(known) for x in after))


def test_nothing_is_averaged_over_failures(slope_results):
    study = slope_results.study
    law = study.law._replace(contacts=ClosedForm(FailsOnTheFlat(0.4, 0.9)))
    study = study._replace(law=law)
    dataset = run_slope_study(study)
    failed = dataset.ending.values == "failed"
    assert np.all(study.release.block.mass[failed] > 100.0)
    assert 0 < failed.sum() < 90
    endings = json.loads(dataset.attrs["endings"])
    assert endings["failed"] == failed.sum()
    assert sum(endings.values()) == 90
    assert dataset.blocks_in_bin.values.max() <= np.sum(~failed)
    energy = dataset.passage_energy_J.sel(collector=40.0).values
    assert np.sum(np.isfinite(energy[failed])) > 0
    energy = energy[~failed]
    passing = np.isfinite(energy)
    assert dataset.blocks_passing.sel(collector=40.0) == passing.sum() > 0
    np.testing.assert_array_equal(
        dataset.passage_energy_J_percentiles.sel(collector=40.0),
        np.percentile(energy[passing], [50, 90, 95, 99]),
    )


def test_the_command_writes_all(slope_results):
    folder = slope_results.folder
    files = {path.name for path in folder.iterdir()}
    assert files == {"jaximpact-study.json", *names_of_files(slope_results.study)}
    assert files == {
        *("manifest.json", "blocks.nc", "stops.csv", "collectors.csv", "barriers.csv"),
        *("profile.png", "envelopes.png", "stops.png", "collectors.png"),
        *("report.html", "trajectories.csv", "trajectories.geojson", "maps.gpkg"),
        *("stops.geojson", "collectors.geojson", "jaximpact-study.json"),
    }
    dataset = read_netcdf(folder / "blocks.nc")
    assert dict(dataset.sizes) == {
        **{"block": 90, "collector": 2, "barrier": 2, "percentile": 4, "bin": 20},
    }
    stops = rows_of(folder / "stops.csv")
    assert [row["ending"] for row in stops] == list(dataset.ending.values)
    np.testing.assert_array_equal(
        [float(row["x_m"]) for row in stops], dataset.x_m.values
    )
    rows = rows_of(folder / "collectors.csv")
    speed = next(r for r in rows if r["quantity"] == "speed_mps")
    assert float(speed["p95"]) == dataset.passage_speed_mps_percentiles.sel(
        percentile=95, collector=40.0
    )
    manifest = json.loads((folder / "manifest.json").read_text())
    assert manifest["seed"] == 7
    assert len(manifest["files"]["slope.toml"]) == 64
    assert "numpy" in manifest["versions"]
    assert sum(manifest["endings"].values()) == 90
    for ending, count in manifest["endings"].items():
        assert f"{count} {ending}" in slope_results.printed
    assert "90 of 90 blocks (100 %)" in slope_results.said


def test_limits_are_told(changed, capsys):
    changed(("bins = 20", "time_limit_s = 1.0"), ("[40, 60]", "[195]"))
    assert main(["runout", "slope.toml", "--out", "out"]) == 0
    out, _ = capsys.readouterr()
    assert "90 time limit" in out
    assert "  195    0 (0.0%)" in out
    assert "90 blocks were cut off by a limit and might have gone farther" in out


def test_interruption_says_how_to_go_on(slope, capsys, monkeypatch):
    def interrupted(*arguments, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(study_module, "simulate", interrupted)
    assert main(["runout", "slope.toml", "--out", "out"]) == 130
    assert_one_line_error(capsys, "the same command goes on from here")


def test_the_full_model_takes_an_accuracy(changed):
    law = SLOPE[SLOPE.index("[contacts]") : SLOPE.index("[[barriers]]")]
    study = read_slope_study(changed((law, "")), accuracy="fast")
    assert study.law.contacts == FullModel("fast")
    few = run_slope_study(study._replace(settings=study.settings._replace(bins=3)))
    assert set(few.ending.values) <= {str(Ending.stopped), str(Ending.left_profile)}
    assert json.loads(few.attrs["contacts"])["accuracy"] == "fast"


@pytest.mark.parametrize(
    ("places", "stays"), [("[0, 0.5]", [0, 2, 4]), ("0", range(6))]
)
def test_blocks_that_leave_at_once_keep_their_energy(tmp_path, places, stays):
    """They have no piece of a trajectory, and the energy of none."""
    path = tmp_path / "slope.toml"
    path.write_text(
        "count = 6\n[profile]\npoints_m = [[0, 50], [80, 0], [200, 0]]\n"
        "[block]\nmass_kg = 100\n"
        f"[release]\nx_m = {places}\nclearance_m = 1\nspeed_mps = 10\n"
        "direction_deg = 180\n"
    )
    blocks = run_slope_study(read_slope_study(path))
    release, end = blocks.energy_at_release_J.values, blocks.energy_at_end_J.values
    np.testing.assert_allclose(release, 0.5 * 100.0 * 10.0**2)
    np.testing.assert_array_equal(end[[*stays]], release[[*stays]])
    others = np.setdiff1d(range(6), stays)
    assert np.all(end[others] > release[others])


TO_THE_LEFT = """
count = 60
seed = 1

[profile]
points_m = [[0, 0], [300, 0], [360, 40], [420, 120]]

[ground]
rolling_friction_angle_deg = { from = 25, to = 35, correlation_length_m = 20 }

[block]
mass_kg = 100

[release]
x_m = 418
clearance_m = 1
v_x_mps = { from = -6, to = -1 }

[contacts]
law = "constant coefficients"
e_n = 0.35
e_t = 0.85
"""


def test_slopes_that_descend_to_the_left(tmp_path, capsys):
    (tmp_path / "left.toml").write_text(TO_THE_LEFT)
    out = tmp_path / "out"
    assert main(["runout", str(tmp_path / "left.toml"), "--out", str(out)]) == 0
    dataset = read_netcdf(out / "blocks.nc")
    stops = dataset.x_m.values[dataset.ending.values == "stopped"]
    text = " ".join((out / "report.html").read_text().split())
    percentile = f"{np.percentile(stops, 5):.4g}"
    assert f"95 % of those that stopped did so beyond x = {percentile} m" in text
    assert f"the farthest at {np.min(stops):.4g} m" in text
    assert "Blocks run to the left." in text
    # It varies along the slope.
    assert "rolling friction is its default" not in text


def test_stops_that_differ_by_rounding_are_drawn(slope_results):
    """As in a ditch in which all blocks come to rest."""
    dataset = slope_results.dataset
    x = 60.0 + 1e-13 * np.arange(dataset.sizes["block"])
    ditch = dataset.assign(
        x_m=("block", x), ending=("block", np.full(len(x), "stopped", object))
    )
    (axes,) = draw_stops(ditch).axes
    assert sum(patch.get_height() for patch in axes.patches) == len(x)

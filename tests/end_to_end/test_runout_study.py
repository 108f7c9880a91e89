"""Many blocks from a file: draws, portions, journal, endings, files, and bad input."""

import json

import jax
import numpy as np
import pytest
import xarray as xr
from error_messages import assert_one_line_error
from slope_study import SLOPE, refusals
from text_files import rows_of

import jaximpact.runout.study.output  # noqa: F401, takes `simulate` before a test replaces it
from jaximpact import ConstantCoefficients, read_netcdf
from jaximpact.cli import main
from jaximpact.errors import InputError
from jaximpact.rebound import Rebound
from jaximpact.runout import (
    ClosedForm,
    Ending,
    FullModel,
    Normal,
    Uniform,
    draw,
    read_slope_study,
    run_slope_study,
)
from jaximpact.runout.study import run_study as study_module

pytestmark = pytest.mark.slow

FIRST_DRAWS = [1.098990039096864, 2.7912608936625847, 1.141582449641262]
"""Of the seed 3 for a quantity a, between 1 and 3."""


def test_draws_depend_on_seed_and_name_alone():
    quantities = {"a": Uniform(1.0, 3.0), "b": Normal(0.0, 1.0), "c": 5.0}
    many = draw(quantities, 1000, 3)
    few = draw(quantities, 10, 3)
    alone = draw({"b": Normal(0.0, 1.0)}, 1000, 3)
    for name in quantities:
        np.testing.assert_array_equal(few[name], many[name][:10])
    np.testing.assert_array_equal(alone["b"], many["b"])
    assert not np.any(draw(quantities, 1000, 4)["a"] == many["a"])
    # The first numbers of the streams, as they must stay from version to version.
    np.testing.assert_allclose(few["a"][:3], FIRST_DRAWS, rtol=1e-15)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_far_tails_keep_their_distribution(side):
    """Beyond 12 standard deviations what is left is near exponential, with a mean of
    1 / (12 + 1 / 12) or so; shares of 1e-33 must not be rounded away."""
    shares = (np.arange(1000) + 0.5) / 1000
    ends = (12.0, np.inf) if side > 0.0 else (-np.inf, -12.0)
    values = Normal(0.0, 1.0, *ends).values(shares)
    beyond = side * values - 12.0
    assert np.all(np.isfinite(values))
    assert np.all(np.diff(values) > 0.0)
    # 1 / 12 to its next order, 1 / 12**3; a thousand shares cut the tail off by 1e-3.
    assert np.mean(beyond) == pytest.approx(1 / 12 - 2 / 12**3, rel=0.01)


def test_lists_make_every_combination():
    drawn = draw({"a": (1.0, 2.0), "b": (5.0, 6.0, 7.0)}, 8, 0)
    assert list(drawn["a"]) == [1, 1, 1, 2, 2, 2, 1, 1]
    assert list(drawn["b"]) == [5, 6, 7, 5, 6, 7, 5, 6]


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


def test_energy_of_a_block_is_what_the_slope_gives(slope_results):
    """Nothing exceeds what it had at release and by its fall."""
    dataset = slope_results.dataset
    fall = dataset.mass_kg * 9.81 * (dataset.release_y_m - 0.0)
    given = dataset.energy_at_release_J + fall
    assert np.all(dataset.max_energy_J <= given * (1.0 + 1e-9))
    assert np.all(dataset.max_energy_J >= dataset.energy_at_release_J)
    stopped = dataset.ending == "stopped"
    assert np.all(dataset.energy_at_end_J.values[stopped] == 0.0)
    # At a collector it is in the bin's maximum too.
    at = dataset.passage_energy_J.sel(collector=60.0)
    assert at.max() <= dataset.envelope_energy_J_max.sel(bin=60.0, method="nearest")


def test_the_command_writes_all(slope_results):
    folder = slope_results.folder
    assert {path.name for path in folder.iterdir()} == {
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


def test_without_collectors_there_are_none(changed, tmp_path, capsys):
    changed(("collectors_m = [40, 60]\n", ""))
    assert main(["runout", "slope.toml", "--out", "out"]) == 0
    dataset = read_netcdf(tmp_path / "out" / "blocks.nc")
    assert "collector" not in dataset.dims
    assert dataset.sizes["block"] == 90
    assert not (tmp_path / "out" / "collectors.csv").exists()
    assert "Collectors" not in capsys.readouterr()[0]


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


test_bad_files_are_refused_in_one_line = refusals(
    ("count = 90", "cuont = 60", ("key cuont", "did you mean count?")),
    ("count = 90", "count = 0", ("key count", "at least 1")),
    ("seed = 7", "seed = -1", ("key seed", "at least 0")),
    ("[40, 60]", "[60, 240]", ("key collectors_m", "between the ends")),
    ("[40, 60]", "[60, 60]", ("key collectors_m", "twice")),
    ("[50, 20], ", "[90, 20], ", ("profile.points_m", "x that increases")),
    ("[50, 20], ", "[50], ", ("profile.points_m", "list of [x, y]")),
    ("[50, 20], ", "[50, nan], ", ("profile.points_m", "finite")),
    ("[50, 20], ", '["50", 20], ', ("profile.points_m", "list of [x, y]")),
    ("segment.2", "segment.02", ("ground.segment.02", "number of a segment")),
    ("least = 20", "least = 20000", ("block.mass_kg", "holds nothing between")),
    ("points_m", "ponits_m", ("profile.ponits_m", "did you mean points_m?")),
    ("c_v = 0.5", "c_w = 0.5", ("ground.segment.2.c_w", "did you mean c_v?")),
    ("c_v = 0.5", "c_v = -1", ("ground.segment.2.c_v", "at least 0")),
    ("segment.2", "segment.9", ("ground.segment.9", "from 1 to 4")),
    ("least = 20", "lest = 20", ("block.mass_kg.lest", "did you mean least?")),
    (", least = 20", "", ("block.mass_kg", "above 0 kg", "for block")),
    ("from = 2, to = 6", "from = 2", ("release.x_m", "{ from, to }")),
    ("from = 2, to = 6", "from = 6, to = 2", ("release.x_m", "go up")),
    ("from = 2, to = 6", "from = -2, to = 6", ("key release", "is released at x")),
    ("clearance_m = 0.5", "y_m = 40", ("key release", "in the ground")),
    ("clearance_m = 0.5", "", ("key release", "y_m or clearance_m")),
    ("clearance_m = 0.5", "clearance_m = -1", ("release.clearance_m", "least 0")),
    (
        "speed_mps = 5",
        "speed_mps = 5\nv_x_mps = 5",
        ("key release", "speed_mps and v_x"),
    ),
    ("[1, 1.5, 2]", "[]", ("block.aspect_ratio", "empty list")),
    ("[1, 1.5, 2]", '"round"', ("block.aspect_ratio", "must be a number")),
    ("frictional", "frictionless", ("contacts.law", "did you mean frictional ell")),
    ("e_contact = 0.3", "", ("contacts.e_contact", "is needed")),
    ("e_contact = 0.3", "e_contact = 1.3", ("contacts.e_contact", "in [0, 1]")),
    ("seed = 7", 'accuracy = "fast"', ("contacts.law", "takes none")),
    ("export_trajectories = 70", "export_trajectories = 0", ("at least 1",)),
    ("export_trajectories", "export_trajectory", ("mean export_trajectories?",)),
    ("azimuth_deg = 90", "azimut_deg = 90", ("did you mean azimuth_deg?",)),
    ("azimuth_deg = 90\n", "", ("profile.azimuth_deg", "needed beside origin")),
    ("x_m = 85", "x_m = 285", ("barriers.2.x_m", "between the ends")),
    ("height_m = 1\n", "", ("barriers.1.height_m", "is needed")),
)

"""Back-analyses of a slope whose ground is known, on the command line and in Python."""

import concurrent.futures
import dataclasses
import json
import multiprocessing
import re

import numpy as np
import pytest
from error_messages import assert_one_line_error
from slope_study import slope_text
from text_files import rows_of, write_changed

from benchmarks.back_analysis import BENCHES, observe
from jaximpact import calibrate
from jaximpact.cli import main
from jaximpact.errors import InputError
from jaximpact.lookup import Tabulated
from jaximpact.runout import calibrate_slope, read_slope_study, run_slope_study
from jaximpact.runout.back_analysis import posterior as posterior_module
from jaximpact.runout.back_analysis import predictive
from jaximpact.runout.back_analysis.data_sets import _seed, simulate_data_sets
from jaximpact.runout.back_analysis.observed import ObservedCount
from jaximpact.runout.back_analysis.predictive import (
    PASSAGE_COLUMNS,
    PER_PLACE,
    ModelCheck,
    _curve,
    column_of,
    predict,
)
from jaximpact.runout.back_analysis.problem import read_slope_fit
from jaximpact.runout.back_analysis.report import report, warnings_of
from jaximpact.runout.study.barriers import estimates_of

pytestmark = pytest.mark.slow

SLOPE = slope_text(
    top="seed = 3",
    profile="points_m = [[0, 40], [50, 10], [150, 5]]",
    ground="[ground]\nroughness_deg = 3",
    block="mass_kg = { median = 300, geometric_sd = 1.6 }",
    release="x_m = { from = 2, to = 20 }",
    contacts='law = "constant coefficients"\ne_n = 0.35\ne_t = 0.85',
)
SLOPE = SLOPE.replace("speed_mps = 5", "speed_mps = 3").replace("_m = 0.5", "_m = 1")
SLOPE += """
[[barriers]]
name = "fence"
x_m = 57
height_m = 2
capacity_kJ = 100
"""
FIT = """
[fit]
data_sets = 200
rolling_friction_angle_deg = { from = 10, to = 45 }

[observed]
stops = "stops.csv"
passages = "passages.csv"
counts = [{ x_m = 57, passed = %d, of = 15 }]
held_out_m = [53]
"""
TRUE = 27.0


def true_study(path, head, seed, friction=TRUE, restitution=0.35):
    """Results of a study on known ground, and what is said before its tables."""
    known = f"roughness_deg = 3\nrolling_friction_angle_deg = {friction}"
    pairs = (
        ("roughness_deg = 3", known),
        ("seed = 3", f"seed = {seed}\n{head}"),
        ("e_n = 0.35", f"e_n = {restitution}"),
    )
    return run_slope_study(read_slope_study(write_changed(path, SLOPE, *pairs)))


@pytest.fixture(scope="module")
def observed(tmp_path_factory):
    """A folder with a study and what was observed of 15 blocks."""
    folder = tmp_path_factory.mktemp("slope")
    head = "count = 15\ncollectors_m = [50, 53, 57]"
    found = true_study(folder / "truth.toml", head, seed=9)
    speed, rows = found.passage_speed_mps.values, ["collector_m,speed_mps"]
    for place, x in enumerate((50, 53)):
        passing = speed[np.isfinite(speed[:, place]), place]
        rows += [f"{x},{value}" for value in passing]
    (folder / "passages.csv").write_text("\n".join(rows) + "\n")
    (folder / "stops.csv").write_text("x_m\n" + "\n".join(map(str, found.x_m.values)))
    passed = int(np.sum(np.isfinite(speed[:, 2])))
    (folder / "slope.toml").write_text(SLOPE + FIT % passed)
    return folder


@pytest.fixture(scope="module")
def fitted(observed):
    """Computed by other processes; the command computes the same by itself."""
    context = multiprocessing.get_context("forkserver")
    with concurrent.futures.ProcessPoolExecutor(2, mp_context=context) as pool:
        return calibrate_slope(observed / "slope.toml", executor=pool)


def test_the_truth_is_found_again(fitted):
    (parameter,) = fitted.posterior.fitted
    assert parameter.low < TRUE < parameter.high
    assert parameter.determined
    assert not parameter.at_bound
    assert fitted.predicted.check.explained
    assert warnings_of(fitted) == []
    assert "rolling_friction_angle_deg" in repr(fitted)


def test_collectors_are_predicted(fitted):
    """Those held out too; curves fall and lie in their bands."""
    channels = fitted.predicted.channels
    (held_out,) = (c for c in channels if getattr(c.channel, "held_out", False))
    assert held_out.channel.place == 53.0
    for _, ours, low, middle, high in held_out.percentiles():
        assert low <= middle <= high
        assert low <= ours <= high
    curves = fitted.predicted.curves
    assert {curve.place for curve in curves} == {50.0, 53.0, 57.0}
    for curve in curves:
        assert np.all(np.diff(curve.share) <= 0.0)
        assert np.all(curve.low <= curve.high)
        assert np.all((curve.share >= 0.0) & (curve.share <= 1.0))
    assert curve.names == ("fence",)


def test_barriers_stop_what_they_stop_on_the_true_ground(fitted, tmp_path):
    """The true share and design values, of 20 000 blocks, lie in their intervals, which
    hold what 15 blocks leave open of the ground."""
    (found,) = fitted.predicted.barriers
    study = true_study(tmp_path / "plain.toml", "count = 20000", seed=11)
    (truth,) = estimates_of(study)
    assert found.barrier == truth.barrier
    assert truth.estimates["share_stopped_of_all"].value > 0.2
    for name in (
        *("share_arriving", "share_stopped_of_all", "share_over_of_arriving"),
        *("share_broken_of_arriving", "energy_kJ_p95", "centre_height_m_p95"),
    ):
        ours, true = found.estimates[name], truth.estimates[name]
        assert ours.low <= true.value <= ours.high
        # Not by being of no use: the shares of all grounds of the prior differ by 0.9.
        if name.startswith("share"):
            assert ours.high - ours.low < 0.6
    assert ours.blocks > 1000


def test_a_posterior_of_one_ground_gives_a_plain_study(fitted, tmp_path):
    """The same blocks, shares and intervals."""
    u = fitted.posterior.u[:1]
    (friction,) = fitted.fit.values(u)[0]
    one = dataclasses.replace(fitted.posterior, u=u)
    found = predict(fitted.fit, one, None)
    blocks, seed = found.blocks, _seed(fitted.fit, predictive.STREAM, 0)
    study = true_study(tmp_path / "plain.toml", f"count = {blocks}", seed, friction)
    (truth,) = estimates_of(study)
    for name, estimate in found.barriers[0].estimates.items():
        ours, theirs = (
            np.array(e[1:], float) for e in (estimate, truth.estimates[name])
        )
        # Energies went through kJ.
        np.testing.assert_allclose(ours, theirs, rtol=1e-14)
    energy = next(c for c in found.curves if c.names and c.quantity == "energy_kJ")
    of_study = truth.estimates["energy_kJ_p95"]
    expected = of_study.value, of_study.low, of_study.high
    np.testing.assert_allclose(energy.design[95], expected, rtol=1e-14)


def test_a_coefficient_of_restitution_is_found_again(tmp_path, monkeypatch):
    """A parameter of the contact law, from speeds and heights at a collector."""
    monkeypatch.setattr(predictive, "LEAST_BLOCKS", 20)
    study = true_study(
        tmp_path / "truth.toml",
        "count = 60\ncollectors_m = [57]",
        seed=5,
        friction=20.0,
        restitution=0.45,
    )
    columns = (
        study.passage_speed_mps.values[:, 0],
        study.passage_centre_height_m.values[:, 0],
    )
    rows = [f"57,{v},{h}" for v, h in zip(*columns, strict=True) if np.isfinite(v)]
    head = "collector_m,speed_mps,height_m"
    (tmp_path / "passages.csv").write_text("\n".join((head, *rows)) + "\n")
    fit = """
[fit]
data_sets = 200

[fit.contacts]
e_n = { from = 0.1, to = 0.8 }

[observed]
passages = "passages.csv"
blocks = 60
"""
    (tmp_path / "slope.toml").write_text(SLOPE.replace("e_n = 0.35\n", "") + fit)
    found = calibrate_slope(tmp_path / "slope.toml")
    (parameter,) = found.posterior.fitted
    assert parameter.parameter.name == "contacts.e_n"
    assert parameter.low < 0.45 < parameter.high
    assert parameter.determined
    assert found.predicted.check.explained


def test_narrow_intervals_and_parameters_that_act_together_are_named(fitted):
    """Of 50 data sets left out 40 lie inside, which is no chance."""
    (parameter,) = fitted.posterior.fitted
    narrow = {
        "fitted": (dataclasses.replace(parameter, coverage_95=0.8),),
        "left_out": 50,
    }
    twice = {
        "fitted": (parameter, parameter),
        "correlation": np.array([[1.0, -0.95], [-0.95, 1.0]]),
    }
    for changes, said in (
        (narrow, "Only 80% of left-out data sets"),
        (twice, "act together (correlation -0.95)"),
    ):
        posterior = dataclasses.replace(fitted.posterior, **changes)
        (line,) = warnings_of(dataclasses.replace(fitted, posterior=posterior))
        assert said in line


def text_of(result):
    """The report, without its line breaks."""
    return " ".join(report(result).text().split())


def test_what_is_never_predicted_and_what_is_always_are_told_in_words(fitted):
    check = ModelCheck(probability=0.002, worst="the mean", deviation=np.inf)
    predicted = fitted.predicted._replace(check=check)
    page = text_of(dataclasses.replace(fitted, predicted=predicted))
    assert "the mean as observed never occurs in what the fitted ground" in page
    assert "inf " not in page
    check = ModelCheck(probability=1.0, worst="the mean", deviation=0.1)
    predicted = fitted.predicted._replace(check=check)
    page = text_of(dataclasses.replace(fitted, predicted=predicted))
    assert "100 % of predicted data sets" in page


def test_a_table_stands_in_for_no_law_but_may_be_the_law(fitted):
    said = "no table or emulator stands in for it"
    assert said in text_of(fitted)
    slope = fitted.fit.slope
    law = slope.laws[0]._replace(contacts=Tabulated.__new__(Tabulated))
    fit = dataclasses.replace(fitted.fit, slope=slope._replace(laws=[law]))
    assert said not in text_of(dataclasses.replace(fitted, fit=fit))


def test_blocks_that_fail_are_told_and_no_shares(fitted):
    """Of those that did not fail half exceed a value, whatever failed beside them."""
    fit = fitted.fit
    x = fit.places[0]
    first = column_of(fit.places, x, PASSAGE_COLUMNS[0])
    outcomes = np.full((3, 40, 1 + PER_PLACE * len(fit.places) + 1), np.nan)
    outcomes[..., -1] = np.arange(40) >= 20
    outcomes[:, :10, first], outcomes[:, 10:20, first] = 5.0, 15.0
    curve = _curve(fit, outcomes, x, PASSAGE_COLUMNS[0])
    assert curve.share[0] == 1.0
    assert curve.share[np.searchsorted(curve.values, 10.0)] == 0.5
    for failed, said in ((0.064, "6.4 % of the"), (1.0, "100 % of the.*do not use")):
        predicted = fitted.predicted._replace(failed=failed)
        (line,) = warnings_of(dataclasses.replace(fitted, predicted=predicted))
        assert re.match(said, line)
        assert ("do not use" in line) == (failed > 0.5)


BRITTLE = """
import jax.numpy as jnp

from jaximpact._types import Scalar
from jaximpact.parameters import parameter
from jaximpact.rebound import AbstractRebound, Rebound


class Brittle(AbstractRebound):
    e_n: Scalar = parameter(0.3, "-", "[0, 1]", "restitution; none is known from 0.5")

    def __call__(self, block, impact):
        e_n = jnp.where(self.e_n < 0.5, self.e_n, jnp.nan)
        spin = impact.angular_velocity
        return Rebound(
            -e_n * impact.normal_velocity, 0.85 * impact.tangential_velocity, spin
        )
"""


def test_ground_on_which_blocks_fail_explains_nothing(tmp_path, monkeypatch):
    """That no block is seen below explains no ground on which all fail above."""
    monkeypatch.setattr(predictive, "LEAST_BLOCKS", 20)
    (tmp_path / "laws.py").write_text(BRITTLE)
    text = SLOPE.replace('"constant coefficients"', '"laws.py:Brittle"')
    text = text.replace("e_n = 0.35\ne_t = 0.85", "")
    text += """
[fit]
data_sets = 200
[fit.contacts]
e_n = { from = 0.2, to = 0.7 }
[observed]
counts = [{ x_m = 57, passed = 0, of = 15 }]
"""
    (tmp_path / "slope.toml").write_text(text)
    fit = read_slope_fit(tmp_path / "slope.toml")
    lasting, failing = simulate_data_sets(fit, np.array([[0.3], [0.9]]), 15, stream=0)
    assert np.all(np.isfinite(lasting[:, 0]))
    assert np.all(lasting[:, -1] == 0.0)
    assert np.all(np.isnan(failing[:, :-1]))
    assert np.all(failing[:, -1] == 1.0)
    found = calibrate_slope(tmp_path / "slope.toml")
    # Three fifths of the prior.
    assert found.searched.failed == pytest.approx(80, abs=30)
    assert found.searched.without == 0
    (parameter,) = found.posterior.fitted
    assert parameter.high < 0.5
    assert any("data sets most blocks failed" in line for line in warnings_of(found))


def test_the_command_writes_a_report_and_goes_on_where_it_was(
    observed, fitted, tmp_path, monkeypatch, capsys
):
    out = tmp_path / "out"
    command = ["calibrate", str(observed / "slope.toml"), "--out", str(out)]
    simulate, calls = posterior_module.simulate_data_sets, []

    def interrupted(*arguments, **named):
        if calls:
            raise KeyboardInterrupt
        calls.append(1)
        return simulate(*arguments, **named)

    with monkeypatch.context() as patch:
        patch.setattr(posterior_module, "simulate_data_sets", interrupted)
        with pytest.raises(KeyboardInterrupt):
            calibrate_slope(observed / "slope.toml", out)
    assert any((out / "unfinished").iterdir())
    assert main(command) == 0
    printed = capsys.readouterr().out
    assert "1 of 1 parameters are identifiable" in printed
    assert not (out / "unfinished").exists()
    page = (out / "report.html").read_text()
    assert "fence" in page
    assert "http" not in page
    # What was interrupted ends like what was not.
    tree = json.loads((out / "fit.json").read_text())
    (parameter,) = fitted.posterior.fitted
    friction = tree["parameters"]["rolling_friction_angle_deg"]
    assert friction["interval_95"] == [parameter.low, parameter.high]
    assert set(tree["manifest"]["files"]) == {"slope.toml", "stops.csv", "passages.csv"}
    assert len(rows_of(out / "samples.csv")) == len(fitted.posterior.values)
    assert rows_of(out / "exceedance.csv")
    rows = {row["quantity"]: row for row in rows_of(out / "barriers.csv")}
    (barrier,) = tree["barriers"]
    assert set(barrier["estimates"]) == set(rows)
    stopped = barrier["estimates"]["share_stopped_of_all"]
    assert float(rows["share_stopped_of_all"]["value"]) == stopped["value"]
    of_arriving = barrier["estimates"]["share_stopped_of_arriving"]
    words = f"{of_arriving['low']:.1%} to {of_arriving['high']:.1%}"
    assert words in printed
    assert words in page


def test_data_of_another_mechanism_are_not_explained(observed, tmp_path, monkeypatch):
    """Blocks at the toe and far out, none between, which no single friction gives."""
    monkeypatch.setattr(predictive, "LEAST_BLOCKS", 20)
    for name in ("slope.toml", "passages.csv"):
        text = (observed / name).read_text()
        text = text.replace('passages = "passages.csv"\n', "")
        (tmp_path / name).write_text(text.replace("held_out_m = [53]\n", ""))
    (tmp_path / "stops.csv").write_text("x_m\n" + "48\n" * 8 + "140\n" * 7)
    found = calibrate_slope(tmp_path / "slope.toml")
    assert not found.predicted.check.explained
    assert "does not explain" in warnings_of(found)[0]


def test_one_block_and_what_it_does_not_determine(observed, tmp_path, monkeypatch):
    """One block's place says nothing of the elasticity, which the law has not."""
    monkeypatch.setattr(predictive, "LEAST_BLOCKS", 20)
    text = (observed / "slope.toml").read_text().partition("[observed]")[0]
    text += 'k_E = { from = 100, to = 1000 }\n[observed]\nstops = "stops.csv"\n'
    (tmp_path / "slope.toml").write_text(text)
    (tmp_path / "stops.csv").write_text("x_m\n60\n")
    with pytest.warns(UserWarning, match="k_E: is a parameter of the soil"):
        found = calibrate_slope(tmp_path / "slope.toml")
    friction, elasticity = found.posterior.fitted
    assert friction.determined
    assert not elasticity.determined
    assert any("k_E is not identifiable" in line for line in warnings_of(found))


def test_stops_that_no_candidate_gives_are_refused(observed, tmp_path):
    """Collectors where no block comes."""
    text = (observed / "slope.toml").read_text().replace("held_out_m = [53]\n", "")
    (tmp_path / "slope.toml").write_text(text)
    (tmp_path / "stops.csv").write_text("x_m\n60\n")
    (tmp_path / "passages.csv").write_text("collector_m,speed_mps\n149.5,5\n")
    with pytest.raises(InputError, match="simulated data sets have what was observed"):
        calibrate_slope(tmp_path / "slope.toml")


def test_calibrations_of_impacts_point_to_that_of_slopes(observed):
    with pytest.raises(InputError, match=r"is a slope.*calibrate_slope"):
        calibrate(observed / "slope.toml")


def test_a_fit_of_a_slope_predicts_no_impacts(tmp_path, capsys):
    (tmp_path / "fit.json").write_text('{"title": "slope", "parameters": {}}')
    (tmp_path / "tests.csv").write_text("speed_mps\n10\n")
    assert main(["predict", str(tmp_path), str(tmp_path / "tests.csv")]) == 2
    assert_one_line_error(capsys, "fit.json")


def test_twins_count_the_blocks_past_each_line(tmp_path):
    """Blocks that stop beyond a line have passed it, and none comes back."""
    (tmp_path / "benches.toml").write_text(BENCHES)
    fit = read_slope_fit(tmp_path / "benches.toml")
    blocks = simulate_data_sets(fit, np.array([[0.45, 0.5]]), 30, stream=0)[0]
    twin = observe(fit, blocks, ("energy_kJ",), 15)
    counts = [c for c in twin.observed.channels if isinstance(c, ObservedCount)]
    passed = [int(np.sum(~(blocks[:, 0] <= line.place))) for line in counts]
    assert [count.passed for count in counts] == passed
    assert 0 < passed[1] < passed[0]

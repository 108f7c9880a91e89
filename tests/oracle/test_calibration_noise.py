"""Scatter in proportion to the value: estimated, predicted with, and told from constant
scatter. Models linear in one unknown have exact answers."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from calibration_studies import Linear, study_of_columns
from calibration_studies import fitted as fitted_from

from jaximpact import Block, Impact, Scene, Soil, simulate_batch
from jaximpact.calibration import Calibration, examine, fit_study, predict
from jaximpact.calibration.diagnostics.cross_validation import leave_out_each
from jaximpact.calibration.diagnostics.further_tests import default_measure
from jaximpact.calibration.diagnostics.residuals import residuals_of
from jaximpact.calibration.diagnostics.scatter import chosen_in_words, doubtful_scatter
from jaximpact.calibration.diagnostics.uncertainty import estimate
from jaximpact.calibration.estimation.sigma import SETTLED, relative_sigma
from jaximpact.calibration.problem.noise import LEAST_SIZE, LOSSES
from jaximpact.calibration.problem.targets import NOMINAL_SIGMA
from jaximpact.calibration.report.contents import target_table
from jaximpact.calibration.report.files import as_json
from jaximpact.calibration.study import best_fit

PART = 0.03
BOUNDS = {"start": 1.0, "lower": 1e-3, "upper": 1e3}
PROPORTIONAL, CONSTANT = "proportional", "constant"


def study(columns, scatter=PROPORTIONAL, **content):
    content = {"parameters": {"c_v": BOUNDS}, "scatter": scatter} | content
    return study_of_columns(columns, **content)


def objective_of(slopes, measured, scatter=PROPORTIONAL, **content):
    """Of one target, predicted as x times its slopes."""
    found = study({"v_t_mps": measured}, scatter, **content)
    return Linear(found, matrix=np.asarray(slopes)[:, None])


def fitted(objective):
    objective, best = fitted_from(objective, [1.0])
    return objective, best.points


def noisy(slopes, seed, part=PART, constant=0.0):
    random = np.random.default_rng(seed)
    noise = part * slopes * random.normal(size=len(slopes))
    return slopes + noise + constant * random.normal(size=len(slopes))


def part_of(objective, points):
    study = objective.study
    return relative_sigma(study, objective.sigma, points.predicted[0])[0]


def test_the_estimate_is_the_restricted_one():
    """Weighted by 1 / slope^2 the best x is the mean of measured / slope, and r the
    deviation of these about it, with n - 1, over it."""
    slopes = np.geomspace(1.0, 30.0, 12)
    measured = noisy(slopes, 1)
    objective, points = fitted(objective_of(slopes, measured))
    ratio = measured / slopes
    # The fit to sigmas of what was measured moves by some r^2, and settles within.
    np.testing.assert_allclose(points.x[0, 0], np.mean(ratio), rtol=1e-5)
    expected = np.std(ratio, ddof=1) / np.mean(ratio)
    assert part_of(objective, points) == pytest.approx(expected, rel=SETTLED)
    predicted = points.predicted[0]
    np.testing.assert_allclose(objective.sigma, expected * predicted, rtol=SETTLED)
    assert estimate(objective, points).reduced_chi_square == pytest.approx(
        1.0, rel=0.01
    )


@pytest.mark.parametrize("loss", LOSSES)
def test_the_part_is_found_whatever_the_loss(loss):
    """Of 400 measurements: known to 3.5 %, by robust losses to 4.5; 4 of them."""
    slopes = np.geomspace(1.0, 30.0, 400)
    for seed in range(3):
        objective, points = fitted(objective_of(slopes, noisy(slopes, seed), loss=loss))
        assert part_of(objective, points) == pytest.approx(PART, rel=0.18)


def test_constant_is_as_it_always_was():
    """Said or not; nominal is a part of the root mean square, and the estimate the
    textbook's."""
    slopes = np.geomspace(1.0, 30.0, 12)
    measured = noisy(slopes, 2)
    said, not_said = (
        fitted(objective_of(slopes, measured, scatter)) for scatter in (CONSTANT, {})
    )
    np.testing.assert_array_equal(said[0].sigma, not_said[0].sigma)
    np.testing.assert_array_equal(said[1].x, not_said[1].x)
    nominal = study({"v_t_mps": measured}, {}).sigma
    assert np.all(nominal == NOMINAL_SIGMA * np.sqrt(np.mean(measured**2)))
    x = slopes @ measured / (slopes @ slopes)
    squares = np.sum((measured - x * slopes) ** 2)
    np.testing.assert_allclose(said[0].sigma, np.sqrt(squares / 11.0), rtol=1e-6)
    assert np.isnan(part_of(*said))


def test_a_value_near_zero_does_not_rule():
    """Its sigma is that of the floor. Were it as small as the value, x would follow the
    first test alone, which is off by half a per cent of the others."""
    slopes = np.concatenate([[1e-6], np.linspace(5.0, 10.0, 9)])
    measured = noisy(slopes, 3)
    measured[0] = 0.05
    objective, points = fitted(objective_of(slopes, measured))
    least = LEAST_SIZE * np.sqrt(np.mean(measured**2))
    part = part_of(objective, points)
    assert objective.sigma[0, 0] == pytest.approx(part * least)
    assert np.all(objective.sigma[1:, 0] > 20.0 * objective.sigma[0, 0])
    assert points.x[0, 0] == pytest.approx(1.0, abs=4.0 * PART / 3.0)


def test_gaps_and_limits():
    """A cell without measurement changes nothing, nor does a limit that is kept by far;
    at the limit sigma is a part of what is predicted there, not of the limit."""
    slopes = np.geomspace(1.0, 30.0, 12)
    measured = list(noisy(slopes, 4))
    objective, points = fitted(objective_of(slopes, measured))
    for cell in ("", "<60"):
        more = objective_of([*slopes, 15.0], [*measured, cell])
        found, at = fitted(more)
        # y_0, a part of the root mean square with the limit, is nowhere reached.
        np.testing.assert_allclose(at.x, points.x, rtol=1e-8)
        np.testing.assert_allclose(found.sigma[:12], objective.sigma, rtol=1e-8)
        assert found.sigma[12, 0] == pytest.approx(part_of(found, at) * at.x[0, 0] * 15)


class OneEach(Linear):
    """Each test measures its own target: `x` times a slope."""

    def _predict(self, x, derivatives):
        predicted = x[:, :, None] * self.matrix
        jacobian = np.broadcast_to(
            self.matrix[..., None], (len(x), *self.matrix.shape, 1)
        )
        return predicted, np.zeros((len(x), len(self.matrix))), jacobian


def test_targets_with_one_measurement_share_a_factor():
    """Three of them, one unknown: two degrees of freedom, on the nominal parts. One
    alone keeps its nominal sigma."""
    cells = {"v_t_mps": 10.3, "e_n": 0.29, "v_n_mps": 2.1}
    slopes = np.diag([10.0, 0.3, 2.0])
    columns = {
        name: [value if row == place else None for row in range(3)]
        for place, (name, value) in enumerate(cells.items())
    }
    found = study(columns)
    order = [list(cells).index(name) for name in found.targets]
    objective, points = fitted(OneEach(found, matrix=slopes[:, order]))
    u = (points.predicted[0] - found.measured) / objective.sigma
    assert np.nansum(u**2) == pytest.approx(2.0, rel=2.0 * SETTLED)
    size = np.nanmax(np.where(found.known, np.abs(found.measured), np.nan), axis=0)
    sigma = np.array([objective.sigma[order[k], k] for k in range(3)])
    np.testing.assert_allclose(sigma / size, sigma[0] / size[0], rtol=1e-6)
    alone = objective_of([2.0], [2.1])
    settled, points = fitted(alone)
    np.testing.assert_allclose(settled.sigma, NOMINAL_SIGMA * 2.1)


def test_left_out_has_the_sigma_of_what_the_rest_predicts():
    slopes = np.geomspace(1.0, 30.0, 9)
    measured = noisy(slopes, 5, part=0.1)
    objective, points = fitted(objective_of(slopes, measured))
    found = leave_out_each(objective, points, estimate(objective, points))
    part, x = part_of(objective, points), points.x[0, 0]
    for k in range(9):
        rest = np.mean(np.delete(measured / slopes, k))
        # Of 8 measurements of x, each with the sigma r x of the whole fit.
        expected = slopes[k] * part * np.hypot(rest, x / np.sqrt(8.0))
        # The fits end a hundredth of a standard error from their minima.
        assert found.deviation[k, 0] == pytest.approx(expected, rel=2e-3)


@pytest.mark.slow
def test_left_out_tests_lie_in_their_intervals_at_every_size():
    """3 % of values from 1 to 30. Constant scatter covers too much of the small ones
    and too little of the large."""
    slopes = np.geomspace(1.0, 30.0, 15)
    inside = {PROPORTIONAL: [], CONSTANT: []}
    for seed in range(40):
        measured = noisy(slopes, seed)
        for scatter, rows in inside.items():
            objective, points = fitted(objective_of(slopes, measured, scatter))
            found = leave_out_each(objective, points, estimate(objective, points))
            rows.append(found.inside(measured[:, None])[:, 0])
    small, large = (
        {kind: np.mean(np.array(rows)[:, part]) for kind, rows in inside.items()}
        for part in (slice(None, 5), slice(10, None))
    )
    # 200 each, of a campaign sharing its sigma: 95 +- 2 %.
    assert 0.89 <= small[PROPORTIONAL] <= 1.0
    assert 0.89 <= large[PROPORTIONAL] <= 1.0
    assert small[CONSTANT] == 1.0
    assert large[CONSTANT] < large[PROPORTIONAL] - 0.03


# --- Which of the two. ---

SLOPES = np.geomspace(1.0, 30.0, 20)


def doubts(measured, scatter, slopes=SLOPES, **content):
    return doubtful_scatter(*fitted(objective_of(slopes, measured, scatter, **content)))


def test_the_other_scatter_is_named():
    (words,) = doubts(noisy(SLOPES, 0), CONSTANT)
    assert "residuals of v_t_mps grow with its value" in words
    assert words.endswith('Set scatter.v_t_mps = "proportional".')
    (words,) = doubts(noisy(SLOPES, 0, part=0.0, constant=0.3), PROPORTIONAL)
    assert "do not grow" in words
    assert words.endswith('Set scatter.v_t_mps = "constant".')


def test_nothing_is_said_of_the_right_one():
    """20 to 1 against it is found less than once in 20."""
    said = 0
    for seed in range(40):
        said += bool(doubts(noisy(SLOPES, seed), PROPORTIONAL))
        said += bool(doubts(noisy(SLOPES, seed, 0.0, 0.3), CONSTANT))
    assert said <= 4


def test_where_residuals_cannot_tell():
    measured = noisy(SLOPES, 0)
    assert doubts(measured, CONSTANT)
    fit_of_it = fitted(objective_of(SLOPES, measured, CONSTANT))
    assert not doubtful_scatter(*fit_of_it, biased=["v_t_mps"])
    assert doubtful_scatter(*fit_of_it, biased=["e_n"])
    few = np.geomspace(1.0, 30.0, 7)
    assert not doubts(noisy(few, 0), CONSTANT, few)
    assert not doubts(measured, CONSTANT, loss="student")
    assert not doubts(measured, {}, default_sigma={"v_t_mps": 0.3})
    # Of both signs.
    signs = np.where(np.arange(20) % 2, -1.0, 1.0)
    assert not doubts(signs * measured, CONSTANT, signs * SLOPES)
    # Below what an integration leaves.
    assert not doubts(noisy(SLOPES, 0, part=1e-5), CONSTANT)
    # Limits tell no scatter.
    limits = [*measured[:7], *(f"<{2 * value}" for value in measured[7:])]
    assert not doubts(limits, CONSTANT)


def test_the_better_one_is_taken_where_nobody_stated_it():
    """For values that span a decade; the fit is that of proportional scatter stated."""
    measured = noisy(SLOPES, 0)
    for values, scatter, expected in (
        (measured, {}, PROPORTIONAL),
        (measured, CONSTANT, CONSTANT),
        (measured, {"v_t_mps": CONSTANT}, CONSTANT),
        (noisy(SLOPES, 0, part=0.0, constant=0.3), {}, CONSTANT),
    ):
        objective, best, *_ = best_fit(objective_of(SLOPES, values, scatter, starts=1))
        stated, _ = fitted(objective_of(SLOPES, values, expected))
        assert objective.study.proportional[0] == (expected == PROPORTIONAL)
        np.testing.assert_allclose(objective.sigma, stated.sigma, rtol=2 * SETTLED)
        taken = scatter == {} and expected == PROPORTIONAL
        words = chosen_in_words(objective, best.points)
        assert [line[:25] for line in words] == ["The values of v_t_mps spa"] * taken
    narrow = np.geomspace(1.0, 9.0, 20)
    assert not objective_of(narrow, noisy(narrow, 0), {}).study.scatter_open
    # An empty cell is no small value.
    cells = [*noisy(narrow, 0)[:-1], None]
    assert not objective_of(narrow, cells, {}).study.scatter_open
    assert objective_of(SLOPES, measured, {}).study.scatter_open == ("v_t_mps",)
    signs = np.where(np.arange(20) % 2, -1.0, 1.0)
    assert not objective_of(signs * SLOPES, signs * measured, {}).study.scatter_open
    given = objective_of(SLOPES, measured, {}, default_sigma={"v_t_mps": 0.3})
    assert not given.study.scatter_open


# --- What a study may say. ---

TWO = {"e_n": [0.2, 0.3], "v_t_mps": [1.0, 2.0]}
WITH_SIGMA = TWO | {"sigma_e_n": [0.01, 0.02]}


def test_one_word_for_all_that_is_estimated():
    np.testing.assert_array_equal(study(TWO).proportional, [True, True])
    np.testing.assert_array_equal(study(WITH_SIGMA).proportional, [False, True])
    np.testing.assert_array_equal(study(WITH_SIGMA).sigma[:, 0], [0.01, 0.02])
    found = study(TWO, {"v_t_mps": PROPORTIONAL})
    np.testing.assert_array_equal(found.proportional, [False, True])
    np.testing.assert_allclose(found.sigma[:, 1], [0.05, 0.1])


# --- Impacts. ---

RANDOM = np.random.default_rng(7)
IMPACTS = {
    "mass_kg": np.full(24, 500.0),
    "speed_mps": np.geomspace(2.0, 30.0, 24),
    "angle_deg": RANDOM.uniform(20.0, 65.0, 24),
}
CONTENT = {"parameters": {"c_v": {}, "k_E": {}}, "starts": 3, "accuracy": "balanced"}


@pytest.fixture(scope="module")
def result():
    """The fit of impacts on Table 1, v_t with noise of 3 % of each value."""
    impact = Impact.from_degrees(IMPACTS["speed_mps"], IMPACTS["angle_deg"])
    found = simulate_batch(Scene(Block(mass=IMPACTS["mass_kg"]), Soil(), impact))
    noise = 1.0 + PART * np.random.default_rng(8).normal(size=24)
    columns = IMPACTS | {"v_t_mps": np.asarray(found.tangential_velocity) * noise}
    return fit_study(study_of_columns(columns, scatter=PROPORTIONAL, **CONTENT))


@pytest.mark.slow
def test_a_twin_shows_its_noise(result):
    """r from some 22 degrees of freedom: to 15 %; 3 of them. It is printed."""
    variant = result.variants[0]
    part = part_of(variant.objective, variant.points)
    assert part == pytest.approx(PART, rel=0.45)
    residuals = residuals_of(variant.objective, variant.points, 1.0)
    diagnostics = SimpleNamespace(each=None, residuals=residuals)
    assert target_table(result, variant, diagnostics).rows[0][-1] == (
        f"{100 * part:.3g} % of the value (estimated)"
    )
    # A further test is taken to be measured as well.
    sigma = default_measure(variant)["v_t_mps"]
    assert sigma.relative == pytest.approx(part)
    assert 0.0 < sigma.absolute < part * np.max(variant.predicted)


@pytest.mark.slow
def test_predictions_have_the_part_of_their_values(result, tmp_path):
    """Through fit.json."""
    found, examined = result, examine(result)
    summary = " ".join(Calibration(found, examined).summary().split())
    assert "the same fraction of the value" in summary
    tree = as_json(found, examined)
    assert tree["manifest"]["scatter"] == {"v_t_mps": PROPORTIONAL}
    path = tmp_path / "fit.json"
    path.write_text(json.dumps(tree))
    new = {
        "mass_kg": [500.0] * 3,
        "speed_mps": [2.5, 8.0, 25.0],
        "angle_deg": [40.0] * 3,
    }
    prediction = predict(path, new)
    variant = prediction.variants[0]
    part = part_of(found.variants[0].objective, found.variants[0].points)
    sigma, best = variant.sigma[:, 0], variant.best[:, 0]
    # The draws' median beside the best fit: a part of r, with one unknown to 1 %.
    np.testing.assert_allclose(sigma / best, part, rtol=0.02)
    assert f"The scatter of v_t_mps is {100 * part:.3g} % of the value" in str(
        prediction
    )

r"""Prediction of tests that a fit has not seen, and its scores.

A measurement of such a test is the model's value for each draw of the unknowns, plus
scatter: the sigma of the fit, times the root of its inflation. Where sigmas were given
to the fit, a sigma in the table of the new tests replaces it; where the scatter was
estimated it follows Student's distribution with the degrees of freedom left. Scatter
estimated as a fraction of the value is that fraction of the draws' median. Results
that are never negative (`NEVER_NEGATIVE`) scatter on the scale of their logarithm. Away
from the fitted tests the discrepancy of the model (`diagnostics.discrepancy`) is added.

A nuisance parameter of a group that the fit knows has the fit's values; that of another
group is sampled from its prior, once for each group and draw.
"""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..accuracy import PRESETS
from ..errors import InputError
from ..identity import name_of
from ..impact.events import Outcome
from ..parameters import Part
from ..progress import tell, within
from ..quantities import NEVER_NEGATIVE, USUAL
from ..scene_quantities import SHAPE
from .comparison.fitted_law import LawPrediction, predict_simple
from .diagnostics.discrepancy import freedom_of_sum
from .diagnostics.predictive import Predictive, predictive
from .diagnostics.residuals import rms
from .diagnostics.uncertainty import TAIL
from .fitted_ground import FittedGround, FittedVariant, ground_of_tests
from .problem.config import Study, Variant
from .problem.dataset import Measurements
from .problem.forward_model import ForwardModel, models_of
from .problem.nuisance import open_nuisances
from .problem.objective import Objective

OF_MODEL = {"model_low": TAIL, "model_high": 1.0 - TAIL}
OF_MEASUREMENT = {
    "middle": 0.5,
    "low_50": 0.25,
    "high_50": 0.75,
    "low_95": TAIL,
    "high_95": 1.0 - TAIL,
}
"""Quantiles of the predictive distribution, by fields of `VariantPrediction`."""


class Outside(NamedTuple):
    """Column in which tests leave the range of the fitted ones."""

    column: str
    low: float
    high: float
    """Range of the fitted tests [unit of the column]."""
    tests: np.ndarray
    """Indices of the tests that leave it."""
    values: np.ndarray
    """What these tests have there."""


class VariantPrediction(NamedTuple):
    """Predictions of one variant, shape (tests, targets); NaN where there is none.

    Intervals of `model_low` and `model_high` hold 95 % of the model's values, those of
    `low_50` and so on measurements about it.
    """

    fitted: FittedVariant
    outcomes: list[str]
    """Outcome of every test at the best fit."""
    outcome_share: np.ndarray
    """Weight of the draws with that outcome, shape (tests,)."""
    best: np.ndarray
    """Value of the model at the best fit."""
    model_low: np.ndarray
    model_high: np.ndarray
    middle: np.ndarray
    """Median of the predicted measurement."""
    low_50: np.ndarray
    high_50: np.ndarray
    low_95: np.ndarray
    high_95: np.ndarray
    sigma: np.ndarray
    """Standard deviation of the scatter; 0 where it is unknown."""
    discrepancy: np.ndarray
    """Standard deviation of the discrepancy of the model; 0 where it is unknown."""
    missing_part: np.ndarray
    """Weight of the draws without a result."""
    crps: np.ndarray
    """CRPS of exact measurements (`predictive`)."""
    mean_crps: np.ndarray
    """CRPS of the forecast by mean and scatter of the fitted tests."""
    limit_chance: np.ndarray
    """Predicted probability that a limit is satisfied."""


class PredictedTests(NamedTuple):
    """Tests, and the predictions of each variant of a calibration."""

    ground: FittedGround
    tests: Measurements
    targets: tuple[str, ...]
    """Fitted targets, then other measured results."""
    measured: np.ndarray
    """Measurements, shape (tests, targets); NaN where there is none."""
    censored: np.ndarray
    """1 where the true value is above, -1 where it is below, else 0; the same shape."""
    outside: list[Outside]
    """Columns in which tests leave the range of the fitted ones."""
    variants: list[VariantPrediction]
    inputs: list[Path]
    """Files from which the predictions were made."""
    simple: tuple[LawPrediction, ...] = ()
    """Predictions of simple laws fitted to the same tests."""

    @property
    def new_shapes(self) -> list[str]:
        """Shapes of blocks that no fitted test has."""
        fitted = self.ground.shapes
        return sorted({*self.tests.shapes} - {*fitted}) if fitted else []


def predict_tests(
    ground: FittedGround, measurements: Measurements, inputs: list[Path]
) -> PredictedTests:
    """Predict tests with every variant of a ground that was read from files."""
    study, variants = held_out_study(ground, measurements), []
    tell("compiling once")
    for fitted, model in zip(ground.variants, models_of(study), strict=True):
        with within(f"variant {len(variants) + 1} of {len(ground.variants)}: "):
            variants.append(predict_variant(study, ground, fitted, model))
    return PredictedTests(
        ground=ground,
        tests=study.tests,
        targets=study.targets,
        measured=study.measured,
        censored=study.censored,
        outside=_outside(ground, study),
        variants=variants,
        inputs=[*inputs, *(table.path for table in measurements.sources)],
        simple=predict_simple(ground.simple, study),
    )


def held_out_study(ground: FittedGround, tests: Measurements) -> Study:
    """Make a study of new tests with the parameters of a fit; it is not fitted."""
    variants = tuple(fitted.variant for fitted in ground.variants)
    for variant in variants:
        check_laws({**ground.parts, **variant.laws}, tests)
    tests = with_ground_of_fit(
        tests, ground, variants, ground.ranges, nuisances=ground.nuisances
    )
    path = tests.files[0].path
    targets = (*ground.targets, *(n for n in tests.measured if n not in ground.targets))
    nothing = np.full(len(tests), np.nan)
    measured = [tests.measured.get(name, nothing) for name in targets]
    censored = [tests.censored.get(name, np.zeros(len(tests))) for name in targets]
    return Study(
        path=path,
        title=path.stem,
        tests=tests,
        parameters=ground.parameters,
        tied=ground.tied,
        nuisances=open_nuisances(
            ground.nuisances,
            tests.with_laws(variants[0].laws),
            ground.soil,
        ),
        soil=ground.soil,
        targets=targets,
        measured=np.stack(measured, axis=1),
        censored=np.stack(censored, axis=1),
        sigma=np.ones((len(tests), len(targets))),
        sigma_given=np.ones(len(targets), bool),
        proportional=np.zeros(len(targets), bool),
        weights=np.ones(len(targets)),
        seed=ground.seed,
        accuracy=ground.accuracy,
        variants=variants,
        parts=tests.parts,
        block=ground.block,
    )


def with_ground_of_fit(
    tests: Measurements,
    fit: Study | FittedGround,
    variants: Iterable[Variant],
    ranges: Mapping[str, tuple[float, float]],
    *,
    nuisances: Iterable[str],
    more: Iterable[str] = (),
) -> Measurements:
    """Give tests the quantities of block and ground that they do not state, as the
    fitted tests have them.

    Args:
        ranges: smallest and largest value of columns in the fitted tests.
        nuisances: names of the nuisance parameters of the fit.
        more: names of what was fitted beside its parameters.

    Raises InputError for what was fitted, and cannot be stated, and for a quantity that
    differs between the fitted tests, and must be.
    """
    path = tests.files[0].path
    fitted = [*(one.name for one in (*fit.parameters, *fit.tied)), *more]
    for name in fitted:
        if name in tests.inputs:
            raise InputError(
                "was fitted, and cannot be given with the tests; remove it",
                file=path,
                column=name,
            )
    tests = tests.with_inputs(fit.block)
    said = *fit.soil, *(name for variant in variants for name in variant.soil)
    known = {*fitted, *nuisances, *said, *tests.inputs}
    columns = {n: c for n, c in tests.known_columns.items() if c.part == "soil"}
    shared, differing = ground_of_tests(ranges, columns, known)
    for name, (low, high) in differing.items():
        raise InputError(
            f"has no column {name}, which is {low:g} to {high:g} in the fitted tests",
            file=path,
        )
    return tests.with_inputs(shared)


def check_laws(parts: Mapping[str, Part], tests: Measurements) -> None:
    """Raise InputError where the tests name another law than those of the fit, which
    are the usual ones where `parts` has none."""
    for slot in sorted(tests.slots - {SHAPE}):
        named = type(tests.parts[slot])
        law = type(parts[slot]) if slot in parts else USUAL[slot]
        if name_of(named) != name_of(law):
            raise InputError(
                f"is {named.__name__}, but the fit was made with {law.__name__}",
                file=tests.files[0].path,
                column=slot,
            )


def unknowns(
    study: Study, fitted: FittedVariant, seed: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Sample the unknowns of the new tests, in the units of the columns: best values
    (unknowns,), the prior's mean for a new group, draws (draws, unknowns) and their
    weights."""
    random = np.random.default_rng(seed)
    soil, of_fit, weights = len(study.parameters), fitted.draws, fitted.weights
    if study.nuisances:
        # Resampled: a draw of much weight would have one value of a new group.
        count = len(weights)
        middles = (np.arange(count) + 0.5) / count
        chosen = np.searchsorted(np.cumsum(weights), middles)
        of_fit, weights = of_fit[chosen], np.full(count, 1.0 / count)
    best, draws = [*fitted.best[:soil]], [*of_fit[:, :soil].T]
    for nuisance in study.nuisances:
        prior = nuisance.prior
        places = nuisance.places_in(fitted.unknowns, study.tests)
        for group, known in enumerate(places):
            if known is not None:
                best.append(fitted.best[known])
                draws.append(of_fit[:, known])
                continue
            drawn = random.normal(prior.mean, prior.sd, len(weights))
            best.append(prior.mean)
            draws.append(np.clip(drawn, nuisance.lower[group], nuisance.upper[group]))
    return np.array(best), np.stack(draws, axis=1), weights


def predict_variant(
    study: Study, ground: FittedGround, fitted: FittedVariant, model: ForwardModel
) -> VariantPrediction:
    """Predict the tests of a study with one variant of a fitted ground."""
    objective = Objective(study, fitted.variant, model, PRESETS[ground.accuracy])
    best, draws, weights = unknowns(study, fitted, ground.seed)
    bounds = objective.bounds
    best, draws = (
        bounds.coordinate(np.clip(p, bounds.lower, bounds.upper)) for p in (best, draws)
    )
    at_best = objective.values(best[None])
    at_draws = objective.at(fitted.accuracy).values(draws)
    predicted, ends = at_draws.predicted, at_draws.outcomes
    outcomes = at_best.outcomes[0]
    sigma, of_sigma = scatter(study, fitted, predicted, weights)
    apart, of_apart = np.zeros(sigma.shape), 1.0
    if (discrepancy := fitted.discrepancy) is not None:
        count, of_apart = len(ground.targets), discrepancy.freedom
        best_values = at_best.predicted[0, :, :count]
        apart[:, :count] = discrepancy.deviation(study.tests, study.stated, best_values)
    freedom = freedom_of_sum(sigma, of_sigma, apart, of_apart)
    return VariantPrediction(
        fitted=fitted,
        outcomes=[str(Outcome(int(code))) for code in outcomes],
        outcome_share=np.minimum(weights @ (ends == outcomes), 1.0),
        best=at_best.predicted[0],
        sigma=sigma,
        discrepancy=apart,
        missing_part=np.einsum("d,drt->rt", weights, ~np.isfinite(predicted)),
        **_of_cells(study, ground, weights, predicted, sigma, apart, freedom),
    )


def scatter(
    study: Study, fitted: FittedVariant, predicted: np.ndarray, weights: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Compute sigma of a measurement about the model (tests, targets), 0 where unknown,
    and the degrees of freedom from which it was estimated (targets,), with predictions
    of the draws, shape (draws, tests, targets)."""
    sigma = np.zeros(study.measured.shape)
    freedom = np.full(len(study.targets), np.inf)
    for place, name in enumerate(study.targets):
        stated = study.tests.stated_sigma(name) * fitted.factors.get(name, 1.0)
        if fitted.estimated.get(name, False):
            sigma[:, place] = fitted.sigma[name]
            if name in fitted.proportional:
                # Median of the draws for each test; 0 without any.
                all_draws = predicted[:, :, place].T
                medians = [predictive(values, weights, 0.0) for values in all_draws]
                middle = [0.0 if one is None else one.quantile(0.5) for one in medians]
                sigma[:, place] = fitted.proportional[name].sigma(np.array(middle))
            freedom[place] = max(fitted.freedom[name], 1.0)
            continue
        otherwise = fitted.sigma.get(name, 0.0)
        of_tests = np.where(np.isfinite(stated), stated, otherwise)
        if name in fitted.sigma:
            of_tests = of_tests * np.sqrt(fitted.inflation)
        sigma[:, place] = of_tests
    return sigma, freedom


def _of_cells(study, ground, weights, predicted, sigma, apart, freedom) -> dict:
    shape = study.measured.shape
    names = *OF_MODEL, *OF_MEASUREMENT, "crps", "mean_crps", "limit_chance"
    cells = {name: np.full(shape, np.nan) for name in names}
    plain = [plain_forecast(ground.results, name) for name in study.targets]
    for cell in np.ndindex(*shape):
        test, target = cell
        if not target:
            tell(f"intervals of {test} of {shape[0]} tests")
        values = predicted[:, test, target]
        model = predictive(values, weights, 0.0)
        if model is None:
            continue
        positive = study.targets[target] in NEVER_NEGATIVE
        of_one = predictive(
            values,
            weights,
            sigma[cell],
            freedom[cell],
            discrepancy=apart[cell],
            positive=positive,
        )
        assert of_one is not None  # the model has a value
        for distribution, parts in ((model, OF_MODEL), (of_one, OF_MEASUREMENT)):
            for name, part in parts.items():
                cells[name][cell] = distribution.quantile(part)
        measured, side = study.measured[cell], study.censored[cell]
        if np.isfinite(measured) and side:
            above = of_one.above(measured)
            cells["limit_chance"][cell] = above if side > 0 else 1.0 - above
        elif np.isfinite(measured):
            cells["crps"][cell] = of_one.crps(measured)
            if plain[target] is not None:
                cells["mean_crps"][cell] = plain[target].crps(measured)
    return cells


def plain_forecast(all_results: dict[str, dict], name: str) -> Predictive | None:
    """Forecast a target without a model: Student's distribution about the mean of the
    fitted tests. None of fewer than two."""
    results = all_results.get(name)
    if results is None or results["count"] < 2:
        return None
    count = results["count"]
    spread = results["standard_deviation"] * np.sqrt(1.0 + 1.0 / count)
    mean = np.array([results["mean"]])
    positive = name in NEVER_NEGATIVE
    return predictive(mean, np.ones(1), spread, count - 1.0, positive=positive)


def _outside(ground: FittedGround, study: Study) -> list[Outside]:
    """Find the columns in which tests leave the range of the fitted ones."""
    columns, leaving = study.tests.columns(study.stated), []
    known = ground.ranges.keys() - {parameter.name for parameter in ground.parameters}
    for name in filter(known.__contains__, columns):
        low, high = ground.ranges[name]
        # Rounding leaves no range.
        room = 1e-6 * max(high - low, abs(low), abs(high))
        beyond = (columns[name] < low - room) | (columns[name] > high + room)
        if np.any(beyond):
            of_tests = np.flatnonzero(beyond), columns[name][beyond]
            leaving.append(Outside(name, low, high, *of_tests))
    return leaving


class Scores(NamedTuple):
    """Scores of the predictions of one target; None where undefined."""

    count: int
    """Number of exact measurements with a prediction."""
    unpredicted: int
    """Number of measurements and limits without one."""
    rms: float | None
    """Root mean square of predicted median less measured, and the mean of it."""
    bias: float | None
    with_scatter: int
    """Number of those whose scatter is known: others have intervals of the model
    alone."""
    inside_50: int
    """Number of these within their 50 % intervals, and within those of 95 %."""
    inside_95: int
    crps: float | None
    """Mean CRPS [unit of the target]; see `predictive`."""
    mean_rms: float | None
    """The same scores of a forecast by the mean of the fitted tests."""
    mean_crps: float | None
    skill: float | None
    """Skill score 1 - crps / mean_crps: 1 is perfect, below 0 worse than that mean."""
    limits: int
    """Number of limits with a prediction."""
    limits_expected: float
    """Expected number of satisfied limits, as a sum of probabilities."""


def score(prediction: PredictedTests, variant: VariantPrediction) -> dict[str, Scores]:
    """Score every target of which anything was measured."""
    known = np.isfinite(prediction.measured)
    return {
        name: _score(prediction, variant, name, place, known[:, place])
        for place, name in enumerate(prediction.targets)
        if np.any(known[:, place])
    }


def _score(prediction, variant, name: str, place: int, known) -> Scores:
    limit = known & (prediction.censored[:, place] != 0)
    there = np.isfinite(variant.middle[:, place])
    exact = known & ~limit & there
    measured = prediction.measured[exact, place]
    apart = variant.middle[exact, place] - measured
    scatters = variant.sigma[exact, place] > 0.0

    def inside(low: np.ndarray, high: np.ndarray) -> int:
        within = (measured >= low[exact, place]) & (measured <= high[exact, place])
        return int(np.sum(within & scatters))

    results = prediction.ground.results.get(name, {"count": 0})
    crps = _mean(variant.crps[exact, place])
    mean_crps = _mean(variant.mean_crps[exact, place])
    return Scores(
        count=int(np.sum(exact)),
        unpredicted=int(np.sum(known & ~there)),
        rms=rms(apart),
        bias=_mean(apart),
        with_scatter=int(np.sum(scatters)),
        inside_50=inside(variant.low_50, variant.high_50),
        inside_95=inside(variant.low_95, variant.high_95),
        crps=crps,
        mean_rms=rms(results["mean"] - measured) if results["count"] else None,
        mean_crps=mean_crps,
        skill=1.0 - crps / mean_crps if crps is not None and mean_crps else None,
        limits=int(np.sum(limit & there)),
        limits_expected=float(np.sum(variant.limit_chance[limit & there, place])),
    )


def _mean(values) -> float | None:
    known = len(values) and np.all(np.isfinite(values))
    return float(np.mean(values)) if known else None

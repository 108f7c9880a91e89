r"""Tests that a fit has not seen, predicted with the fitted ground, and scored.

A measurement of such a test is what the model gives for each of the fit's draws of the
unknowns, and scatter about it: the fit's sigma, times the root of its inflation. Where
sigmas were given to the fit, a sigma in the table of the new tests takes its place;
where the scatter was estimated it is Student's, of the degrees of freedom left. Scatter
that was estimated as a part of the value is that part of the draws' median.

A nuisance of a group that the fit knows has the fit's values; that of another is drawn
from its prior, once a group and draw.
"""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..accuracy import PRESETS
from ..errors import InputError
from ..fields import expect
from ..formats.scenes import SHAPE
from ..identity import name_of
from ..mechanics.outcomes import Outcome
from ..precision import require_float64
from . import prediction_text
from .campaigns import Measurements, joined_tables
from .candidates import Candidates
from .engine import Engine
from .fitted_ground import (
    FittedGround,
    FittedVariant,
    files_of_fit,
    fitted_of,
    read_fitted,
)
from .given import table_given
from .laws import scene_of
from .least_squares import Progress
from .losses import LOSSES
from .nuisance import EACH_TEST, Nuisance, read_nuisances
from .objective import Objective, engines_of, names_of
from .one_call import Calibration
from .predictive import CONFIDENCES, Predictive, predictive
from .study_file import METHODS, Study

BESIDE = 1e-6
"""Part of a range, or of its larger end, by which a test may lie outside."""


class Outside(NamedTuple):
    """A column in which tests leave the range of those that were fitted."""

    column: str
    low: float
    high: float
    """The range of the fitted tests."""
    tests: np.ndarray
    """Which leave it."""


class VariantPrediction(NamedTuple):
    """Of one variant; arrays are `(tests, targets)`, NaN where there is nothing."""

    fitted: FittedVariant
    outcomes: list[str]
    """Of every test, at the best fit."""
    outcome_share: np.ndarray
    """Weight of the draws that end like it, `(tests,)`."""
    best: np.ndarray
    """What the model gives for the best fit."""
    model_low: np.ndarray
    """To `model_high` 95 % of what it gives for the draws."""
    model_high: np.ndarray
    middle: np.ndarray
    """Median of the measurement predicted."""
    low_50: np.ndarray
    """To `high_50` half of such measurements, and to `high_95` 95 %."""
    high_50: np.ndarray
    low_95: np.ndarray
    high_95: np.ndarray
    sigma: np.ndarray
    """Of the scatter; 0 where nobody stated it."""
    missing_part: np.ndarray
    """Weight of the draws without a result."""
    crps: np.ndarray
    """Of what was measured exactly (`predictive`)."""
    mean_crps: np.ndarray
    """The same of the plain forecast: mean and scatter of the fitted tests."""
    limit_chance: np.ndarray
    """Of a limit: the chance, as predicted, that it is kept."""


class Prediction(NamedTuple):
    """Tests, and what each variant of a calibration predicts of them."""

    ground: FittedGround
    tests: Measurements
    targets: tuple[str, ...]
    """Those that were fitted, then what else was measured."""
    measured: np.ndarray
    """`(tests, targets)`; NaN where nothing was measured."""
    censored: np.ndarray
    """1 where the true value is above, -1 where it is below, else 0."""
    outside: list[Outside]
    variants: list[VariantPrediction]
    inputs: list[Path]
    """Files that it was made from."""

    @property
    def new_shapes(self) -> list[str]:
        """Shapes of blocks that no fitted test has."""
        fitted = self.ground.shapes
        return sorted({*self.tests.shapes} - {*fitted}) if fitted else []

    def __str__(self) -> str:
        return prediction_text.as_text(self)

    def write(self, path: str | os.PathLike) -> None:
        """Write a table of all predictions, and scores and origin beside it.

        Raises InputError for a path that would replace what they were made from.
        """
        prediction_text.write(self, Path(path))


def predict(
    result: Calibration | str | os.PathLike,
    tests: str | os.PathLike | Mapping,
    *,
    progress: Progress | None = None,
) -> Prediction:
    """Predict tests with a fitted ground; score what was measured of them.

    Args:
        result: of `calibrate`, or the fit.json or directory that it wrote.
        tests: as for `calibrate`. Result columns are not needed; those that are there
            are compared with the predictions, and empty cells and limits are as there.
        progress: called with lines of text.

    Where the fit did not determine a parameter its draws go as far as the fit's bounds,
    and the intervals are as wide as that makes them.

    Raises InputError, naming file, row and column, for what cannot be used;
    RuntimeError if JAX is set to float32.
    """
    require_float64()
    expect("result", result, Calibration, str, os.PathLike)
    if isinstance(result, Calibration):
        ground, inputs = ground_of(result), result.result.study.inputs
    else:
        ground, inputs = read_fitted(Path(result)), files_of_fit(Path(result))
    measurements = joined_tables((table_given(tests, scene_of(ground.parts)),))
    study = held_out_study(ground, measurements)
    progress = progress or (lambda text: None)
    progress("compiling once")
    engines = engines_of(study)
    variants = []
    for number, (fitted, engine) in enumerate(
        zip(ground.variants, engines, strict=True), 1
    ):
        start = f"variant {number} of {len(ground.variants)}: "
        variants.append(
            predict_variant(
                study,
                ground,
                fitted,
                engine,
                lambda text, start=start: progress(start + text),
            )
        )
    return Prediction(
        ground=ground,
        tests=study.tests,
        targets=study.targets,
        measured=study.measured,
        censored=study.censored,
        outside=_outside(ground, study.tests),
        variants=variants,
        inputs=[*inputs, *(table.path for table in measurements.files)],
    )


def ground_of(found: Calibration) -> FittedGround:
    """What a calibration found, as `read_fitted` gives it."""
    study = found.result.study
    laws = [variant.laws for variant in study.variants]
    return fitted_of(found.as_json(), study.parts, laws)


def held_out_study(ground: FittedGround, tests: Measurements) -> Study:
    """New tests as a study with the parameters of a fit. It is not fitted."""
    path = tests.files[0].path
    _check_laws(ground, tests, path)
    tests = tests.with_inputs(
        {n: value for n, value in ground.block.items() if n not in tests.inputs}
    )
    for parameter in ground.parameters:
        if parameter.name in tests.inputs:
            raise InputError(
                "was fitted, and cannot be given with the tests; remove it",
                file=path,
                column=parameter.name,
            )
    targets = (*ground.targets, *(n for n in tests.measured if n not in ground.targets))
    nothing = np.full(len(tests), np.nan)
    measured = [tests.measured.get(name, nothing) for name in targets]
    censored = [tests.censored.get(name, np.zeros(len(tests))) for name in targets]
    return Study(
        path=path,
        title=path.stem,
        source="",
        notes="",
        tests=tests,
        parameters=ground.parameters,
        nuisances=_nuisances(ground, tests, path),
        soil=ground.soil,
        targets=targets,
        measured=np.stack(measured, axis=1),
        censored=np.stack(censored, axis=1),
        sigma=np.ones((len(tests), len(targets))),
        sigma_given=np.ones(len(targets), bool),
        proportional=np.zeros(len(targets), bool),
        weights=np.ones(len(targets)),
        loss=LOSSES[0],
        starts=1,
        seed=ground.seed,
        accuracy=ground.accuracy,
        method=METHODS[0],
        variants=tuple(fitted.variant for fitted in ground.variants),
        candidates=Candidates(),
        parts=tests.parts,
        block=ground.block,
    )


def _check_laws(ground: FittedGround, tests: Measurements, path: Path) -> None:
    """Raise InputError where the tests name another law than the fit's."""
    for slot, law in ground.parts.items():
        named = tests.parts.get(slot, law)
        if slot != SHAPE and name_of(type(named)) != name_of(type(law)):
            raise InputError(
                f"is {type(named).__name__}, but the fit was made with "
                f"{type(law).__name__}",
                file=path,
                column=slot,
            )


def _nuisances(
    ground: FittedGround, tests: Measurements, path: Path
) -> tuple[Nuisance, ...]:
    """Those of the fit that the new tests leave open."""
    entries = {}
    for name, entry in ground.nuisances.items():
        in_table = name in tests.inputs
        if entry["added"] and not in_table:
            raise InputError(
                f"has no column {name}, to which the fit added what it found",
                file=path,
            )
        if in_table and not entry["added"]:
            continue  # nobody had measured it then; here it is known
        entries[name] = {key: entry[key] for key in entry if key != "added"}
    of_first = tests.with_laws(ground.variants[0].variant.laws)
    return read_nuisances(path, {"nuisance": entries}, of_first, ground.soil)


def unknowns(
    study: Study, fitted: FittedVariant, seed: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The unknowns of the new tests, in the units of the columns.

    Returns:
        Best values `(unknowns,)`, where a group is new the prior's mean, draws
        `(draws, unknowns)` and their weights.
    """
    random = np.random.default_rng(seed)
    soil, of_fit, weights = len(study.parameters), fitted.draws, fitted.weights
    if study.nuisances:
        # A draw that carries much weight would carry one value of a new group.
        count = len(weights)
        middles = (np.arange(count) + 0.5) / count
        of_fit = of_fit[np.searchsorted(np.cumsum(weights), middles)]
        weights = np.full(count, 1.0 / count)
    best, draws = [*fitted.best[:soil]], [*of_fit[:, :soil].T]
    labels = names_of(study)[soil:]
    stated = study.tests.files[0].labels
    for nuisance in study.nuisances:
        # A file's name stands in for a campaign's: no sign that it is the same.
        named = nuisance.by != EACH_TEST and nuisance.by in stated
        for place in range(len(nuisance.groups)):
            label = labels.pop(0)
            if named and label in fitted.unknowns:
                known = fitted.unknowns.index(label)
                best.append(fitted.best[known])
                draws.append(of_fit[:, known])
                continue
            prior = nuisance.prior
            drawn = random.normal(prior.mean, prior.sd, len(weights))
            best.append(prior.mean)
            draws.append(np.clip(drawn, nuisance.lower[place], nuisance.upper[place]))
    return np.array(best), np.stack(draws, axis=1), weights


def predict_variant(
    study: Study,
    ground: FittedGround,
    fitted: FittedVariant,
    engine: Engine,
    progress: Progress = lambda text: None,
) -> VariantPrediction:
    objective = Objective(study, fitted.variant, engine, PRESETS[ground.accuracy])
    best, draws, weights = unknowns(study, fitted, ground.seed)
    at_best = objective.values(_coordinates(objective, best[None]))
    _, predicted, ends = objective.at(fitted.accuracy).values_by_parts(
        _coordinates(objective, draws), lambda text: progress(f"{text} draws")
    )
    outcomes = at_best.outcomes[0]
    alike = ends == outcomes
    sigma, freedom = scatter(study, fitted, predicted, weights)
    cells = _of_cells(study, ground, weights, predicted, sigma, freedom, progress)
    there = np.isfinite(predicted)
    return VariantPrediction(
        fitted=fitted,
        outcomes=[str(Outcome(int(code))) for code in outcomes],
        outcome_share=weights @ alike,
        best=at_best.predicted[0],
        sigma=sigma,
        missing_part=np.einsum("d,drt->rt", weights, ~there),
        **cells,
    )


def _coordinates(objective: Objective, parameters: np.ndarray) -> np.ndarray:
    """x of unknowns in the units of the columns."""
    bounds = objective.bounds
    return bounds.coordinate(np.clip(parameters, bounds.lower, bounds.upper))


def scatter(
    study: Study, fitted: FittedVariant, predicted: np.ndarray, weights: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Sigma of a measurement about the model `(tests, targets)`, 0 where nobody stated
    it, and the degrees of freedom from which it was estimated `(targets,)`.

    Args:
        predicted: by the draws, `(draws, tests, targets)`.
        weights: of the draws.
    """
    sigma = np.zeros(study.measured.shape)
    freedom = np.full(len(study.targets), np.inf)
    for place, name in enumerate(study.targets):
        own = study.tests.sigmas.get(name, np.full(len(study.tests), np.nan))
        if fitted.estimated.get(name, False):
            sigma[:, place] = fitted.sigma[name]
            if name in fitted.proportional:
                middle = _medians(predicted[:, :, place], weights)
                sigma[:, place] = fitted.proportional[name].sigma(middle)
            freedom[place] = max(fitted.freedom[name], 1.0)
            continue
        otherwise = fitted.sigma.get(name, 0.0)
        of_tests = np.where(np.isfinite(own), own, otherwise)
        if name in fitted.sigma:
            of_tests = of_tests * np.sqrt(fitted.inflation)
        sigma[:, place] = of_tests
    return sigma, freedom


def _medians(predicted: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Of what the draws give for each test, `(tests,)`; 0 where no draw gives any."""
    found = [predictive(values, weights, 0.0) for values in predicted.T]
    return np.array([0.0 if one is None else one.quantile(0.5) for one in found])


def _of_cells(
    study, ground, weights, predicted, sigma, freedom, progress: Progress
) -> dict:
    """Quantiles and scores of every test and target."""
    shape = study.measured.shape
    names = ("model_low", "model_high", "middle", "low_50", "high_50", "low_95")
    names += ("high_95", "crps", "mean_crps", "limit_chance")
    found = {name: np.full(shape, np.nan) for name in names}
    tails = [(1.0 - confidence) / 2.0 for confidence in CONFIDENCES]
    plain = [plain_forecast(ground.results.get(name)) for name in study.targets]
    for cell in np.ndindex(*shape):
        if not cell[1]:
            progress(f"intervals of {cell[0]} of {shape[0]} tests")
        values = predicted[:, *cell]
        model = predictive(values, weights, 0.0)
        if model is None:
            continue
        of_one = predictive(values, weights, sigma[cell], freedom[cell[1]])
        found["model_low"][cell] = model.quantile(tails[1])
        found["model_high"][cell] = model.quantile(1.0 - tails[1])
        found["middle"][cell] = of_one.quantile(0.5)
        for percent, tail in zip(("50", "95"), tails, strict=True):
            found[f"low_{percent}"][cell] = of_one.quantile(tail)
            found[f"high_{percent}"][cell] = of_one.quantile(1.0 - tail)
        measured, side = study.measured[cell], study.censored[cell]
        if not np.isfinite(measured):
            continue
        if side:
            above = of_one.above(measured)
            found["limit_chance"][cell] = above if side > 0 else 1.0 - above
            continue
        found["crps"][cell] = of_one.crps(measured)
        if plain[cell[1]] is not None:
            found["mean_crps"][cell] = plain[cell[1]].crps(measured)
    return found


def plain_forecast(results: dict | None) -> Predictive | None:
    """What is expected of a target without a model: as in the fitted tests, Student's
    distribution about their mean. None of fewer than two."""
    if results is None or results["count"] < 2:
        return None
    count = results["count"]
    spread = results["standard_deviation"] * np.sqrt(1.0 + 1.0 / count)
    mean = np.array([results["mean"]])
    return predictive(mean, np.ones(1), spread, count - 1.0)


def _outside(ground: FittedGround, tests: Measurements) -> list[Outside]:
    """Columns in which tests leave the range of the fitted ones."""
    fitted = {parameter.name for parameter in ground.parameters}
    columns = tests.columns(ground.soil)
    found = []
    for name in columns:
        if name in fitted or name not in ground.ranges:
            continue
        low, high = ground.ranges[name]
        room = BESIDE * max(high - low, abs(low), abs(high))
        beyond = (columns[name] < low - room) | (columns[name] > high + room)
        if np.any(beyond):
            found.append(Outside(name, low, high, np.flatnonzero(beyond)))
    return found

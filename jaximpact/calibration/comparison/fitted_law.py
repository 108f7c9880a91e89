"""One law fitted to the tests of a study, and its predictions of others; simple laws
stand beside every calibration."""

import dataclasses
from typing import NamedTuple

import numpy as np

from ...errors import InputError
from ...progress import tell
from ...quantities import NEVER_NEGATIVE
from ..diagnostics.discrepancy import (
    Discrepancy,
    discrepancy_of_json,
    estimate_discrepancy,
    finite_numbers,
    freedom_of_sum,
    scale_of,
)
from ..diagnostics.posterior import variances
from ..diagnostics.predictive import Predictive, predictive
from ..diagnostics.uncertainty import (
    TAIL,
    Uncertainty,
    estimate,
    regular_covariance,
)
from ..estimation.sigma import (
    freedom_of_sigmas,
    median_sigma,
    relative_sigma,
    sigma_factors,
)
from ..problem.config import Study
from ..problem.fitted_parameters import DEFAULTS, Parameter
from ..problem.forward_model import models_of
from ..problem.objective import Objective, Points, names_of
from ..study import best_fit
from .contenders import SIMPLE, Contender
from .rebound_objective import PREDICTED, rebound_objective

SIMPLE_LAWS = {law.words: Contender(law.words, law) for law in SIMPLE}
"""Simple laws by name."""
JSON_NAMES = {"name": "law", "freedom": "degrees_of_freedom"}
"""Names in fit.json of the fields of `FittedLaw` that have others there."""


class FittedLaw(NamedTuple):
    """Fit of one law; parameters in the units of their columns."""

    name: str
    unknowns: tuple[str, ...]
    """Names of the law's parameters, then of the nuisance parameters."""
    parameters: int
    """Number of the law's parameters."""
    values: np.ndarray
    """Best fit, shape (unknowns,)."""
    covariance: np.ndarray
    """Covariance of the unknowns, shape (unknowns, unknowns)."""
    targets: tuple[str, ...]
    sigma: np.ndarray
    """Standard deviation of measurements of each target, shape (targets,), the
    inflation included; a fraction of the value where scatter is proportional."""
    least_size: np.ndarray
    """Value below which sigma is constant, shape (targets,), where scatter is
    proportional; infinite where sigma is constant."""
    freedom: np.ndarray
    """Degrees of freedom of each sigma, shape (targets,); infinite where it is
    given."""
    discrepancy: Discrepancy | None
    """Error of the law outside the fitted tests; None where it is unknown."""
    given: np.ndarray
    """Whether each sigma was given, shape (targets,)."""
    inflation: np.ndarray
    """Factor on the squares of given sigmas, shape (targets,)."""

    def of_targets(self, targets: tuple[str, ...]) -> "FittedLaw":
        """Return the fit as one that predicts some of its targets alone."""
        places = [self.targets.index(name) for name in targets]
        apart = self.discrepancy
        return self._replace(
            targets=targets,
            sigma=self.sigma[places],
            least_size=self.least_size[places],
            freedom=self.freedom[places],
            discrepancy=None if apart is None else apart.of_targets(places),
            given=self.given[places],
            inflation=self.inflation[places],
        )

    def as_json(self) -> dict:
        """Collect the numbers for fit.json."""
        return {JSON_NAMES.get(n, n): value for n, value in self._asdict().items()}


def law_of_json(entry: dict) -> FittedLaw:
    """Make a fit of the numbers of fit.json. Raises InputError or ValueError where one
    is missing."""
    # Older files have none of these, or one inflation of all targets.
    given = [freedom is None for freedom in entry[JSON_NAMES["freedom"]]]
    entry = {"discrepancy": None, "inflation": 1.0, "given": given} | entry
    fields = {name: entry[JSON_NAMES.get(name, name)] for name in FittedLaw._fields}
    for name in ("unknowns", "targets"):
        fields[name] = tuple(fields[name])
    for name in ("values", "covariance", "sigma", "inflation"):
        fields[name] = finite_numbers(fields, name)
    for name in ("least_size", "freedom"):
        # What is infinite is None in the file.
        numbers = np.array(fields[name], float)
        fields[name] = np.nan_to_num(numbers, nan=np.inf, posinf=np.inf)
    fields["given"] = np.array(fields["given"], bool)
    count = len(fields["targets"])
    fields["inflation"] = np.broadcast_to(fields["inflation"], count)
    fields["discrepancy"] = discrepancy_of_json(fields["discrepancy"])
    return FittedLaw(**fields)


class LawFit(NamedTuple):
    """Fit of a law with all that cross-validation needs."""

    objective: Objective
    """Objective with the sigmas of the fit."""
    points: Points
    """Best fit, one lane."""
    uncertainty: Uncertainty
    fitted: FittedLaw


def of_targets(study: Study, targets: tuple[str, ...]) -> Study:
    """Return a study of some of its targets."""
    places = [study.targets.index(name) for name in targets]
    return dataclasses.replace(
        study,
        targets=targets,
        measured=study.measured[:, places],
        censored=study.censored[:, places],
        sigma=study.sigma[:, places],
        sigma_given=study.sigma_given[places],
        proportional=study.proportional[places],
        weights=study.weights[places],
    )


def predicted_by_rebound(study: Study) -> tuple[str, ...]:
    """List the targets that every law of rebound predicts."""
    return tuple(name for name in study.targets if name in PREDICTED)


def objective_of(study: Study, contender: Contender) -> Objective:
    """Make the objective function of a law for the tests of a study."""
    law = contender.law
    more = tuple(Parameter(name, **DEFAULTS[name]) for name in contender.more)
    study = dataclasses.replace(study, parameters=(*study.parameters, *more))
    if more or not any(law is variant for variant in study.variants):
        study = dataclasses.replace(study, starts=min(study.starts, 16))
    if isinstance(law, type):
        return rebound_objective(study, law)
    alone = dataclasses.replace(study, variants=(law,))
    return Objective(alone, law, models_of(alone)[0])


def fit_law(study: Study, contender: Contender) -> LawFit:
    """Fit a law to the tests of a study, with impacts as accurate as the sigmas need.

    Raises InputError where no start gives a prediction.
    """
    objective = objective_of(study, contender)
    if not contender.is_rebound and np.all(study.sigma_given):
        objective = objective.no_finer_than_sigmas()
    objective, best, *_ = best_fit(objective)
    return law_fit(contender.name, objective, best.points)


def law_fit(name: str, objective: Objective, points: Points) -> LawFit:
    """Make of a best fit (one lane) what cross-validation needs."""
    objective = objective.no_finer_than_sigmas()
    points = objective(points.x)
    uncertainty = estimate(objective, points)
    covariance = regular_covariance(objective, points, uncertainty.inflation)
    slope = objective.bounds.slope(points.x[0])
    study = objective.study
    relative = relative_sigma(study, objective.sigma, points.predicted[0])
    constant = median_sigma(study, objective.sigma)
    sigma = np.where(study.proportional, relative, constant)
    factors, s2 = sigma_factors(objective), uncertainty.inflation
    fitted = FittedLaw(
        name=name,
        unknowns=tuple(names_of(study)),
        parameters=len(study.parameters),
        values=objective.bounds.parameter(points.x[0]),
        covariance=covariance * np.outer(slope, slope),
        targets=study.targets,
        sigma=sigma * np.sqrt(uncertainty.inflation),
        least_size=np.where(study.proportional, study.least_size, np.inf),
        freedom=freedom_of_sigmas(objective, points),
        discrepancy=estimate_discrepancy(objective, points, uncertainty),
        given=study.sigma_given | np.isin(study.targets, study.understated),
        inflation=np.array(
            [factors[n] ** 2 if n in factors else s2 for n in study.targets]
        ),
    )
    return LawFit(objective, points, uncertainty, fitted)


class LawPrediction(NamedTuple):
    """Predictions of one law, shape (tests, targets); NaN where there is none."""

    name: str
    targets: tuple[str, ...]
    best: np.ndarray
    """Value of the law at its best fit."""
    deviation: np.ndarray
    """Standard deviation of a measurement about it, without the discrepancy."""
    discrepancy: np.ndarray
    """Standard deviation of the discrepancy of the law; 0 where it is unknown."""
    freedom: np.ndarray
    """Degrees of freedom of both."""

    def distribution(self, test: int, target: int) -> Predictive | None:
        """Make the distribution of one measurement; None where there is none."""
        return predictive(
            values=self.best[test, target][None],
            weights=np.ones(1),
            sigma=float(self.deviation[test, target]),
            freedom=float(self.freedom[test, target]),
            discrepancy=float(self.discrepancy[test, target]),
            positive=self.targets[target] in NEVER_NEGATIVE,
        )

    def interval(self, test: int, target: int) -> tuple[float, float]:
        """Compute the 95 % interval of one measurement; NaN where there is none."""
        distribution = self.distribution(test, target)
        if distribution is None:
            return np.nan, np.nan
        return distribution.quantile(TAIL), distribution.quantile(1.0 - TAIL)


def predict_law(fitted: FittedLaw, contender: Contender, study: Study) -> LawPrediction:
    """Predict the tests of a study, which is not fitted, as far as the law does.

    A nuisance parameter of a group that the fit knows has the fit's value; that of
    another group the mean and the standard deviation of its prior. Sigmas that the
    tests state stand for those of the fit where these were given too.
    """
    study = of_targets(study, fitted.targets)
    objective = objective_of(study, contender)
    values, covariance = _unknowns(fitted, objective.study)
    bounds = objective.bounds
    x = np.clip(bounds.coordinate(values), bounds.low, bounds.high)
    points = objective(x[None])
    slope = bounds.slope(x)
    predicted = points.predicted[0]
    variance = variances(points.jacobian[0] / slope, covariance)
    sigma = scale_of(fitted.sigma, fitted.least_size, predicted)
    for place in np.flatnonzero(fitted.given):
        stated = study.tests.stated_sigma(fitted.targets[place])
        inflated = stated * np.sqrt(fitted.inflation[place])
        sigma[:, place] = np.where(np.isfinite(stated), inflated, sigma[:, place])
    deviation, apart = np.sqrt(sigma**2 + variance), np.zeros(predicted.shape)
    of_apart = 1.0
    if fitted.discrepancy is not None:
        apart = fitted.discrepancy.deviation(study.tests, study.stated, predicted)
        of_apart = fitted.discrepancy.freedom
    freedom = freedom_of_sum(deviation, fitted.freedom, apart, of_apart)
    return LawPrediction(
        fitted.name, fitted.targets, predicted, deviation, apart, freedom
    )


def _unknowns(fitted: FittedLaw, study: Study) -> tuple[np.ndarray, np.ndarray]:
    """Find values and covariance of the unknowns of new tests."""
    places, values = [*range(fitted.parameters)], [*fitted.values[: fitted.parameters]]
    known, variances = [*places], [0.0] * len(places)
    for nuisance in study.nuisances:
        for place in nuisance.places_in(fitted.unknowns, study.tests):
            if place is None:
                values.append(nuisance.prior.mean)
                variances.append(nuisance.prior.sd**2)
                continue
            places.append(place)
            known.append(len(values))
            values.append(fitted.values[place])
            variances.append(0.0)
    covariance = np.diag(variances)
    covariance[np.ix_(known, known)] = fitted.covariance[np.ix_(places, places)]
    return np.array(values), covariance


def fit_simple(study: Study) -> tuple[FittedLaw, ...]:
    """Fit constant coefficients, and Pfeiffer and Bowen, to the targets that they
    predict."""
    targets, fits = predicted_by_rebound(study), []
    if not targets:
        return ()
    study = of_targets(study, targets)
    for name, contender in SIMPLE_LAWS.items():
        tell(name)
        try:
            fits.append(fit_law(study, contender).fitted)
        except InputError:
            continue  # the predictions say that it is not there
    return tuple(fits)


def predict_simple(
    simple: tuple[FittedLaw, ...], study: Study
) -> tuple[LawPrediction, ...]:
    """Predict the tests of a study, which is not fitted, with simple laws."""
    return tuple(predict_law(law, SIMPLE_LAWS[law.name], study) for law in simple)

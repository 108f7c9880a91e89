r"""Discrepancy: how far the model itself is off where it was not fitted.

With z the logarithms of speed and size of a test, and its angle over 45 degrees, the
model is off by sigma times a Gaussian random field that is 0 at the fitted tests, and
whose differences have the variance

$$ E[(\delta(z) - \delta(z'))^2] = s^2 |z - z'|^{3/2} . $$

Given the fitted tests the variance is that of ordinary kriging (Matheron 1963). Each
target has a field of its own, all of them one s. It is estimated from tests left out:
those of the largest and of the smallest third of speed, size and angle are predicted by
fits to the others. Their errors e are normal with the covariance

$$ \sigma^2 I + J C J^T + s^2 \sigma^2 K , $$

with C the covariance of the unknowns of that fit, J the derivatives of its predictions,
and K the kriging covariance of the tests left out. s is the root of the posterior mean
of s^2, with a uniform prior on s (Gelman 2006); a test left out several times counts
once. The degrees of freedom are those of the Fisher information of s^2, at least 3.

Results that are never negative are off in proportion to their value.
"""

from typing import Any, NamedTuple

import numpy as np

from ..._checks import real_number, whole_number
from ...progress import within
from ...quantities import NEVER_NEGATIVE
from ..estimation.sigma import median_sigma, relative_sigma
from ..problem.dataset import Measurements
from ..problem.objective import Objective, Points
from .cross_validation import fits_without
from .uncertainty import Uncertainty, regular_covariance

POWER = 1.5
"""Exponent of the variance of differences over the distance."""
ANGLE = 45.0
"""Angle [deg] that counts as a factor e in speed or in size."""
AXES = ("speed", "size", "angle")
NUGGET = 1e-6
"""Variance added at the fitted tests: tests alike would have a singular matrix."""
FACTORS = np.linspace(0.0, 32.0, 257)
"""Values of s over which the likelihood is averaged."""
LEAST_FREEDOM = 3.0
"""Least degrees of freedom: the mean of s^2, which has no bound with fewer, already
holds most of what is uncertain about s."""
MOST = 300
"""Largest number of measurements left out at once from which s is estimated."""


class Discrepancy(NamedTuple):
    """Error of the model outside the fitted tests, of one fit."""

    factor: float
    """s: standard deviation, over the scatter, a factor e in speed away from a test."""
    freedom: float
    """Degrees of freedom from which it was estimated."""
    left_out: int
    """Number of measurements that were left out."""
    groups: tuple[str, ...]
    """Groups of tests that were left out."""
    places: np.ndarray
    """z of the fitted tests, those alike once, shape (places, 3)."""
    scatter: np.ndarray
    """Standard deviation of the scatter of each target, shape (targets,); a fraction of
    the value where it is proportional, or where the target is never negative."""
    least_size: np.ndarray
    """Value below which that is constant, shape (targets,); infinite where it is
    constant in any case."""

    def of_targets(self, places: list[int]) -> "Discrepancy":
        """Return the discrepancy of some targets, by their indices."""
        return self._replace(
            scatter=self.scatter[places], least_size=self.least_size[places]
        )

    def deviation(self, tests: Measurements, fixed, predicted) -> np.ndarray:
        """Compute the standard deviation of the discrepancy of tests, shape (tests,
        targets).

        Args:
            fixed: values that are in no table, as for `Measurements.columns`.
            predicted: predictions of the targets, shape (tests, targets).
        """
        variance = kriging_variance(places_of(tests, fixed), self.places)
        apart = self.factor * np.sqrt(variance)
        return apart[:, None] * scale_of(self.scatter, self.least_size, predicted)


def scale_of(
    scatter: np.ndarray, least_size: np.ndarray, values: np.ndarray
) -> np.ndarray:
    """Compute standard deviations about values, shape (..., targets); `scatter` and
    `least_size` are those of `Discrepancy`."""
    sizes = np.maximum(np.abs(np.nan_to_num(values)), least_size)
    return scatter * np.where(np.isinf(least_size), 1.0, sizes)


def estimate_discrepancy(
    objective: Objective, points: Points, uncertainty: Uncertainty
) -> Discrepancy | None:
    """Estimate the discrepancy of a fit (points of one lane) with the objective that
    has its sigmas; None where speed, size and angle all have fewer than three values
    in tests with exact measurements."""
    study = objective.study
    places = places_of(study.tests, study.stated)
    groups = thirds(places, np.any(study.exact, axis=1))
    if not groups:
        return None
    sigma = objective.sigma * np.sqrt(uncertainty.inflation)
    scatter, least = _scatter(objective, points, uncertainty.inflation)
    scale = scale_of(scatter, least, points.predicted[0])
    left = np.stack([*groups.values()])
    steps = np.full((len(left), points.x.shape[1]), np.nan)
    parts, times = [], np.zeros(study.exact.shape)
    with within("thirds left out: "):
        for rest in fits_without(objective, points, left, steps, points.x):
            exact = study.exact & rest.tests[:, None]
            row, target = _some(exact & np.isfinite(rest.points.predicted[0]))
            if not len(row):
                continue
            cells = row, target
            times[cells] += 1
            fitted = places[np.any(rest.objective.study.known, axis=1)]
            same = target[:, None] == target
            field = kriging(places[row], fitted) * same
            field *= np.outer(scale[cells], scale[cells])
            slopes = rest.points.jacobian[0][cells]
            covariance = regular_covariance(
                rest.objective, rest.points, uncertainty.inflation
            )
            noise = np.diag(sigma[cells] ** 2) + slopes @ covariance @ slopes.T
            error = study.measured[cells] - rest.points.predicted[0][cells]
            parts.append((error, noise, field))
    if not parts:
        return None
    # A test left out several times is no more than one.
    factor, freedom = _factor(parts, 1.0 / float(np.mean(times[times > 0])))
    measured = np.any(study.known, axis=1)
    return Discrepancy(
        factor=factor,
        freedom=freedom,
        left_out=int(np.sum(times > 0)),
        groups=(*groups,),
        places=np.unique(places[measured], axis=0),
        scatter=scatter,
        least_size=least,
    )


def freedom_of_sum(sigma, of_sigma, apart, of_apart: float) -> np.ndarray:
    """Compute the degrees of freedom of sigma and discrepancy together, shape (tests,
    targets), from those of each (Welch 1947, Satterthwaite 1946)."""
    whole = sigma**2 + apart**2
    parts = sigma**4 / of_sigma + apart**4 / of_apart
    return np.where(parts > 0.0, whole**2 / np.where(parts > 0.0, parts, 1.0), np.inf)


def discrepancy_of_json(entry: dict | None) -> Discrepancy | None:
    """Make a discrepancy of the numbers of fit.json. Raises InputError or ValueError
    where one is missing."""
    if entry is None:
        return None
    fields: dict[str, Any] = entry | {"groups": tuple(entry["groups"])}
    for name in ("factor", "freedom"):
        fields[name] = real_number(f"{name} of the discrepancy", entry[name])
    left_out = "left_out of the discrepancy"
    fields["left_out"] = whole_number(left_out, entry["left_out"], 1)
    for name in ("places", "scatter"):
        fields[name] = finite_numbers(entry, name)
    # What is infinite is None in the file.
    least = np.array(entry["least_size"], float)
    fields["least_size"] = np.nan_to_num(least, nan=np.inf, posinf=np.inf)
    return Discrepancy(**fields)


def finite_numbers(entry: dict, name: str) -> np.ndarray:
    """Return the numbers that stand under a name in fit.json, as an array. Raises
    ValueError for null, which NumPy would take for NaN, and for others not finite."""
    numbers = np.array(entry[name], float)
    if not np.all(np.isfinite(numbers)):
        raise ValueError(f"{name} is not finite")
    return numbers


def in_words(discrepancy: Discrepancy | None) -> str:
    """Say how large a discrepancy is, what it was estimated from, and what it cannot
    know."""
    if discrepancy is None:
        return (
            "Discrepancy is unknown: an estimate needs three values of speed, size or "
            "angle in fitted tests with measurements that are not limits. Outside the "
            "fitted tests the intervals are too narrow."
        )
    return (
        f"Discrepancy is estimated from {discrepancy.left_out} measurements left out "
        f"({', '.join(discrepancy.groups)}): {discrepancy.factor:.2g} times the "
        "scatter where speed or size differs by a factor of 2.7, or the angle by "
        f"{ANGLE:g} degrees, from every fitted test. It knows nothing of another "
        "ground, shape or spin, nor of what changes beyond the tests."
    )


def _some(cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Find the indices of cells, of many only some."""
    row, target = np.nonzero(cells)
    chosen = slice(None, None, -(-len(row) // MOST) or 1)
    return row[chosen], target[chosen]


def _scatter(
    objective: Objective, points: Points, inflation: float
) -> tuple[np.ndarray, np.ndarray]:
    """Find `scatter` and `least_size` of a fit."""
    study, predicted = objective.study, points.predicted[0]
    relative = relative_sigma(study, objective.sigma, predicted)
    constant = median_sigma(study, objective.sigma)
    positive = np.isin(study.targets, NEVER_NEGATIVE)
    size = study.scale
    constant = np.where(positive, constant / size, constant)
    scatter = np.where(study.proportional, relative, constant) * np.sqrt(inflation)
    in_proportion = positive | study.proportional
    return scatter, np.where(in_proportion, study.least_size, np.inf)


def _factor(parts: list, weight: float) -> tuple[float, float]:
    """Estimate s, and its degrees of freedom, from the errors, their covariance without
    discrepancy, and K sigma^2, of each group."""
    spectra = []
    for error, noise, field in parts:
        # In the coordinates in which the noise is 1 and the field diagonal.
        root = np.linalg.inv(np.linalg.cholesky(noise))
        values, vectors = np.linalg.eigh(root @ field @ root.T)
        spectra.append((vectors.T @ root @ error, np.maximum(values, 0.0)))
    errors, values = (np.concatenate(part) for part in zip(*spectra, strict=True))
    variance = 1.0 + FACTORS[:, None] ** 2 * values
    log_likelihood = -0.5 * np.sum(errors**2 / variance + np.log(variance), axis=1)
    chance = np.exp(weight * (log_likelihood - np.max(log_likelihood)))
    square = chance @ FACTORS**2 / np.sum(chance)
    share = square * values / (1.0 + square * values)
    return float(np.sqrt(square)), max(float(weight * np.sum(share**2)), LEAST_FREEDOM)


def places_of(tests: Measurements, fixed) -> np.ndarray:
    """Compute z of tests, shape (tests, 3), with `fixed` as for
    `Measurements.columns`."""
    columns = tests.columns(fixed)
    # Factors of e: 1e-6 m/s stands for no speed at all.
    speed = np.log(np.maximum(columns["speed_mps"], 1e-6))
    size = np.log(columns["mass_kg"] / columns["density_kgm3"]) / 3.0
    return np.stack([speed, size, columns["angle_deg"] / ANGLE], axis=1)


def thirds(places: np.ndarray, measured: np.ndarray) -> dict[str, np.ndarray]:
    """Find the measured tests of the largest and the smallest third of the values of
    speed, size and angle, as masks by name."""
    groups = {}
    for name, along in zip(AXES, np.round(places, 9).T, strict=True):
        values = np.unique(along[measured])
        if len(values) >= 3:
            count = len(values) // 3
            groups[f"largest {name}s"] = measured & (along >= values[-count])
            groups[f"smallest {name}s"] = measured & (along <= values[count - 1])
    return groups


def kriging(places: np.ndarray, fitted: np.ndarray) -> np.ndarray:
    """Compute the covariance over s^2 of the discrepancy at places, shape (places,
    places), that is 0 at the fitted ones."""
    beside, weights = _kriging_system(places, fitted)
    return -_half_variance(places, places) - beside.T @ weights


def kriging_variance(places: np.ndarray, fitted: np.ndarray) -> np.ndarray:
    """Compute the diagonal of `kriging` alone, shape (places,)."""
    beside, weights = _kriging_system(places, fitted)
    return np.maximum(-np.sum(beside * weights, axis=0), 0.0)


def _kriging_system(
    places: np.ndarray, fitted: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Set up and solve the equations of ordinary kriging: right-hand sides and weights,
    shape (fitted + 1, places)."""
    fitted = np.unique(fitted, axis=0)
    count = len(fitted)
    matrix = np.ones((count + 1, count + 1))
    matrix[:count, :count] = -_half_variance(fitted, fitted) + NUGGET * np.eye(count)
    matrix[count, count] = 0.0
    beside = np.vstack([-_half_variance(fitted, places), np.ones(len(places))])
    return beside, np.linalg.solve(matrix, beside)


def _half_variance(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return 0.5 * np.linalg.norm(a[:, None] - b, axis=-1) ** POWER

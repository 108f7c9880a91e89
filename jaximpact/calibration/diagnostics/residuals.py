r"""Studentised residuals, and tests for bias and trends in them.

A residual is (measured - predicted) / (s sigma), divided by sqrt(1 - h) with h its
leverage. If the model is right residuals are normal, of variance 1, of mean 0 and
independent of every input.

Whether a target is biased is tested twice: by the signs of its residuals, and by their
mean. With u = (predicted - measured) / sigma of n measurements and f the degrees of
freedom of the target,

$$ t = \frac{\bar u \sqrt n}{s}, \qquad s^2 = \frac{\sum (u - \bar u)^2}{f - 1} , $$

where t has Student's distribution with f - 1 degrees of freedom. A fit takes up a part
of a mean, so that both tests find less than they would without one.
"""

from typing import Any, NamedTuple

import numpy as np

# Not scipy.stats here, which takes 0.6 s to import.
from scipy.special import bdtr, ndtr, ndtri, stdtr

from ...quantities import CURVE_COLUMNS, TARGET_COLUMNS
from ..estimation.sigma import LEAST_LEFT, LEAST_PART, freedom_of_targets
from ..problem.config import Study
from ..problem.objective import Objective, Points
from .uncertainty import leverages

FEWEST = 8
"""Least number of different values of an input for a test of trend."""
LEAST_BIAS = 0.25
"""Least ratio of the mean of the residuals and their root mean square that is called a
bias: below it is a sixteenth of their mean square, and their scatter matters more."""


class Trend(NamedTuple):
    """Trend of the residuals of a target with an input."""

    target: str
    against: str
    correlation: float
    """Spearman's rank correlation."""
    autocorrelation: float
    """Lag-1 autocorrelation: 1 - half of von Neumann's ratio of the ranks."""
    chance: float
    """p-value of the more significant of the two."""


class Bias(NamedTuple):
    """Mean residual of a target, with the tests of its bias."""

    target: str
    mean: float
    """Mean of predicted less measured [unit of the target]."""
    rms: float
    """Root mean square of predicted less measured [unit of the target]."""
    percent: float
    """Mean over the mean size of the measurements [%]; NaN where all are 0."""
    above: int
    """Number of exact measurements that the fit overestimates."""
    count: int
    """Number of exact measurements."""
    chance_of_mean: float
    """p-value of the t-test; NaN where there are too few degrees of freedom."""
    chance_of_signs: float
    """p-value of the sign test, two-sided."""
    significant: bool
    """Whether the target is biased: by one of the tests, with a probability of 5 % in
    all to find a bias where there is none."""

    @property
    def chance(self) -> float:
        """Smaller of the two p-values."""
        return float(np.fmin(self.chance_of_mean, self.chance_of_signs))

    @property
    def words(self) -> str:
        """The bias in words, without a full stop."""
        over = self.mean > 0.0
        number = self.above if over else self.count - self.above
        size, unit = f"{abs(self.percent):.2g} %", TARGET_COLUMNS[self.target].unit
        if np.isnan(self.percent):
            size = f"{abs(self.mean):.2g} {unit}".removesuffix(" -")
        return (
            f"the fit {'overestimates' if over else 'underestimates'} {self.target} in "
            f"{number} of {self.count} tests, by {size} in the mean"
        )


class Residuals(NamedTuple):
    """Residuals of all exact measurements, shape (tests, targets); NaN elsewhere."""

    values: np.ndarray
    """Studentised residuals [standard deviations]."""
    trends: list[Trend]
    """Significant trends, the smallest p-value first."""
    looked_for: int
    """Number of tests of trend: two for each target and input."""
    biases: list[Bias]
    """Mean residual of every target with exact measurements."""

    @property
    def biased(self) -> list[Bias]:
        """Significant biases."""
        return [bias for bias in self.biases if bias.significant]

    def ordered(self) -> tuple[np.ndarray, np.ndarray]:
        """Return normal quantiles and the ascending residuals of a Q-Q plot."""
        values = np.sort(self.values[np.isfinite(self.values)])
        part = (np.arange(len(values)) + 0.5) / max(len(values), 1)
        return ndtri(part), values


def residuals_of(objective: Objective, points: Points, inflation: float) -> Residuals:
    """Compute the residuals at a fit (points of one lane)."""
    study = objective.study
    predicted = points.predicted[0]
    exact = study.exact & np.isfinite(predicted)
    left = 1.0 - leverages(objective, points)
    scale = objective.sigma * np.sqrt(inflation * np.maximum(left, LEAST_LEFT))
    there = exact & (left > LEAST_LEFT)
    values = np.where(there, (study.measured - predicted) / scale, np.nan)
    biases = _biases(objective, points)
    return Residuals(values, *_trends(objective, values, predicted), biases)


def rms(values: np.ndarray) -> float | None:
    """Compute a root mean square; None of nothing."""
    return float(np.sqrt(np.mean(values**2))) if len(values) else None


def varying_inputs(objective: Objective) -> dict[str, np.ndarray]:
    """Find the columns of the scene that differ among the tests by more than
    rounding."""
    inputs = objective.study.tests.inputs.items()
    there = ((name, v) for name, v in inputs if np.any(np.isfinite(v)))
    ranges = {name: (np.nanmin(v), np.nanmax(v), v) for name, v in there}
    return {
        name: v
        for name, (low, high, v) in ranges.items()
        if high - low > 1e-9 * max(abs(low), abs(high))
    }


def _biases(objective: Objective, points: Points) -> list[Bias]:
    study, predicted = objective.study, points.predicted[0]
    exact = study.exact & np.isfinite(predicted)
    freedom = freedom_of_targets(objective, points) - 1.0
    # Forces along a curve follow one another.
    tested = ~np.isin(study.targets, [*CURVE_COLUMNS])
    level = 0.05 / max(2 * np.sum(tested), 1)
    biases = []
    for place in np.flatnonzero(np.any(exact, axis=0)):
        cells = exact[:, place]
        measured, sigma = study.measured[cells, place], objective.sigma[cells, place]
        apart = predicted[cells, place] - measured
        u, count, above = apart / sigma, len(apart), int(np.sum(apart > 0.0))
        size = float(np.mean(np.abs(measured)))
        signs = min(above, int(np.sum(apart < 0.0)))
        of_signs = min(1.0, 2.0 * float(bdtr(signs, np.sum(apart != 0.0), 0.5)))
        of_mean = np.nan
        if freedom[place] >= 1.0 and np.ptp(u) > 0.0:
            scatter = np.sqrt(np.sum((u - np.mean(u)) ** 2) / freedom[place])
            ratio = abs(np.mean(u)) * np.sqrt(count) / scatter
            of_mean = 2.0 * float(stdtr(freedom[place], -ratio))
        material = abs(np.mean(u)) > LEAST_BIAS * np.sqrt(np.mean(u**2))
        # Less of the smallest sigmas is errors of the integration.
        material &= bool(abs(np.mean(u)) > 0.1) and not _is_exact(study, place, apart)
        biases.append(
            Bias(
                target=study.targets[place],
                mean=float(np.mean(apart)),
                rms=float(np.sqrt(np.mean(apart**2))),
                percent=float(100.0 * np.mean(apart) / size) if size else np.nan,
                above=above,
                count=count,
                chance_of_mean=of_mean,
                chance_of_signs=of_signs,
                significant=bool(
                    tested[place] and material and np.fmin(of_mean, of_signs) < level
                ),
            )
        )
    return biases


def _is_exact(study: Study, place: int | np.integer, apart: np.ndarray) -> bool:
    """Tell whether a fit misses a target by less than anything is measured to, where
    nobody stated how well it was: numbers of the model itself, of another accuracy."""
    size = float(study.scale[place])
    least = LEAST_PART * size
    return bool(not study.sigma_given[place] and np.sqrt(np.mean(apart**2)) < least)


def _trends(objective: Objective, values, predicted) -> tuple[list[Trend], int]:
    from scipy.stats import rankdata, spearmanr

    study, all_trends, count = objective.study, [], 0
    for place, target in enumerate(study.targets):
        there = np.isfinite(values[:, place])
        apart = predicted[there, place] - study.measured[there, place]
        small = not np.any(np.abs(values[there, place]) > 0.01)
        if small or _is_exact(study, place, apart):
            continue  # errors of the integration
        against = varying_inputs(objective) | {"prediction": predicted[:, place]}
        for name, along in against.items():
            x, back = np.unique(along[there], return_inverse=True)
            if len(x) < FEWEST:
                continue
            # Residuals at one value of the input have no order: their mean is taken.
            mean = np.bincount(back, values[there, place]) / np.bincount(back)
            ranked: Any = spearmanr(np.arange(len(mean)), mean)
            autocorrelation, other = _autocorrelation(rankdata(mean))
            count += 2
            chance = float(min(ranked.pvalue, other))
            correlation = float(ranked.statistic)
            all_trends.append(Trend(target, name, correlation, autocorrelation, chance))
    # One of twenty studies shows a trend by chance.
    trends = [trend for trend in all_trends if trend.chance * count < 0.05]
    return sorted(trends, key=lambda trend: trend.chance), count


def _autocorrelation(ranks: np.ndarray) -> tuple[float, float]:
    """Compute the lag-1 autocorrelation of ranks and its p-value (Bartels 1982)."""
    ratio = np.sum(np.diff(ranks) ** 2) / np.sum((ranks - np.mean(ranks)) ** 2)
    # Bartels's approximation of the ratio's distribution: normal, mean 2.
    variance = 20.0 / (5.0 * len(ranks) + 7.0)
    return float(1.0 - 0.5 * ratio), float(ndtr((ratio - 2.0) / np.sqrt(variance)))


def in_words(residuals: Residuals, objective: Objective) -> list[str]:
    """Describe trends and large residuals."""
    study = objective.study
    lines = [
        f"The residuals of {trend.target} depend on {trend.against}: rank "
        f"correlation {trend.correlation:+.2f}, lag-1 autocorrelation "
        f"{trend.autocorrelation:+.2f}, p-value {trend.chance:.1g}."
        for trend in residuals.trends
    ]
    if not residuals.trends and residuals.looked_for:
        lines.append(
            "No significant trend with the prediction or with any input that varies."
        )
    large = np.abs(np.nan_to_num(residuals.values)) > 3.0
    names = study.tests.names_apart() if np.any(large) else ()
    for test, place in zip(*np.nonzero(large), strict=True):
        value = residuals.values[test, place]
        lines.append(
            f"{study.targets[place]} of {names[test]} lies {abs(value):.2g} "
            f"standard deviations {'above' if value > 0.0 else 'below'} the fit."
        )
    return lines

"""What the fitted ground predicts: data sets like the observed one, values at
collectors, and curves of exceedance at barriers, each with its interval."""

import concurrent.futures
from typing import NamedTuple

import numpy as np

from ...progress import Progress
from ...store import Store
from .data_sets import simulate_data_sets
from .observed import PASSAGE_COLUMNS, PER_PLACE, STOP_COLUMN, Count, Passages, Stops
from .posterior import TAILS, Posterior
from .problem import SlopeFit
from .summaries import observed_summary, simulated_summaries, summary_names

DRAWS = 200
"""Number of samples of the posterior behind a prediction."""
LEAST_BLOCKS = 200
"""Least number of blocks released for each."""
STREAM = 100
"""Stream of random numbers of predictions, which no round has."""
GRID = 101
PERCENTS = (50, 95)
DESIGN_PERCENTS = (50, 95, 99)
RARE = 0.01
"""Probability of a worse deviation below which the model does not explain the
observations."""


class ModelCheck(NamedTuple):
    """Comparison of the observed summaries with predicted ones."""

    probability: float
    """Fraction of predicted data sets whose worst summary deviates as much."""
    worst: str
    """Name of the observed summary that deviates most."""
    deviation: float
    """Its deviation from the predicted mean, in predicted standard deviations."""

    @property
    def explained(self) -> bool:
        """Tell whether the fitted model explains the observations."""
        return self.probability > RARE


class Curve(NamedTuple):
    """Share of all released blocks that exceed a value at a place."""

    place: float
    """x [m]."""
    names: tuple[str, ...]
    """Barriers there."""
    quantity: str
    """Name with unit, one of `PASSAGE_COLUMNS`."""
    values: np.ndarray
    """`(values,)`, in that unit."""
    share: np.ndarray
    """Mean over the posterior, `(values,)`."""
    low: np.ndarray
    """Lower end of the 95 % interval."""
    high: np.ndarray
    design: dict[int, tuple[float, float, float]]
    """Lower end, median and upper end of each percentile of the blocks that arrive."""


class ChannelPrediction(NamedTuple):
    """Observed values of a channel beside predicted data sets of the same size."""

    channel: Stops | Passages
    predicted: np.ndarray
    """Sorted values of each data set, NaN last, `(data sets, values)`."""

    def percentiles(self) -> list[tuple[int, float, float, float, float]]:
        """List percentage, observed percentile, and lower end, median and upper end of
        the predicted one."""
        full = self.predicted[np.all(np.isfinite(self.predicted), axis=1)]
        if not len(full):
            return []
        return [
            (
                percent,
                float(np.percentile(self.channel.values, percent)),
                *np.quantile(np.percentile(full, percent, axis=1), TAILS).tolist(),
            )
            for percent in PERCENTS
        ]


class Predicted(NamedTuple):
    """All that the fitted ground predicts."""

    check: ModelCheck
    channels: tuple[ChannelPrediction, ...]
    curves: tuple[Curve, ...]
    draws: int
    blocks: int
    """Number of blocks released for each draw."""


def predict(
    fit: SlopeFit,
    posterior: Posterior,
    store: Store | None,
    progress: Progress,
    executor: concurrent.futures.Executor | None = None,
) -> Predicted:
    """Simulate data sets for samples of the posterior, and compare and count."""
    released = fit.observed.released
    blocks = max(released, LEAST_BLOCKS)
    outcomes = simulate_data_sets(
        *(fit, posterior.u[:DRAWS], blocks, STREAM, store, progress),
        what="predicted data sets",
        executor=executor,
    )
    names = {x: tuple(b.name for b in fit.barriers if b.x == x) for x in fit.places}
    return Predicted(
        check=_check(fit, outcomes[:, :released]),
        channels=tuple(
            ChannelPrediction(channel, _values(fit, channel, outcomes))
            for channel in fit.observed.channels
            if not isinstance(channel, Count)
        ),
        curves=tuple(
            curve
            for x in fit.places
            for quantity in PASSAGE_COLUMNS
            if (curve := _curve(fit, outcomes, x, names[x], quantity)) is not None
        ),
        draws=len(outcomes),
        blocks=blocks,
    )


def _check(fit: SlopeFit, outcomes: np.ndarray) -> ModelCheck:
    found = simulated_summaries(fit.observed, outcomes, fit.places, STREAM)
    found = found[np.all(np.isfinite(found), axis=1)]
    observed, names = observed_summary(fit.observed), summary_names(fit.observed)
    if len(found) < 2:
        return ModelCheck(0.0, names[0], np.inf)
    mean, spread = np.mean(found, axis=0), np.std(found, axis=0)

    def deviations(summary: np.ndarray) -> np.ndarray:
        apart = np.abs(summary - mean)
        # What never varies either agrees or cannot be.
        same = apart <= 1e-9 * (1.0 + np.abs(mean))
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(same, 0.0, apart / spread)

    ours, theirs = deviations(observed), np.max(deviations(found), axis=1)
    worst = int(np.argmax(ours))
    probability = (np.sum(theirs >= ours[worst]) + 1.0) / (len(found) + 1.0)
    return ModelCheck(float(probability), names[worst], float(ours[worst]))


def _column(fit: SlopeFit, place: float, quantity: str) -> int:
    return 1 + PER_PLACE * fit.places.index(place) + PASSAGE_COLUMNS.index(quantity)


def _values(
    fit: SlopeFit, channel: Stops | Passages, outcomes: np.ndarray
) -> np.ndarray:
    """Give the first values of each data set with errors of measurement, sorted, as
    many as were observed."""
    name, column = STOP_COLUMN, 0
    if isinstance(channel, Passages):
        name, column = channel.quantity, _column(fit, channel.place, channel.quantity)
    values = outcomes[..., column]
    noise = np.random.default_rng(STREAM).standard_normal(values.shape)
    values = values + fit.observed.sigma.get(name, 0.0) * noise
    first = np.cumsum(np.isfinite(values), axis=1) <= channel.blocks
    values = np.sort(np.where(first, values, np.nan), axis=1)
    return values[:, : channel.blocks]


def _curve(
    fit: SlopeFit, outcomes: np.ndarray, x: float, names: tuple, quantity: str
) -> Curve | None:
    """Count exceedances at a place; None where no block comes."""
    values = outcomes[..., _column(fit, x, quantity)]
    there = np.isfinite(values)
    if not np.any(there):
        return None
    grid = np.linspace(0.0, np.max(values[there]), GRID)
    ordered = np.sort(np.where(there, values, -np.inf), axis=1)
    blocks = values.shape[1]
    shares = np.stack(
        [1.0 - np.searchsorted(row, grid, "right") / blocks for row in ordered]
    )
    low, _, high = np.quantile(shares, TAILS, axis=0)
    rows = [row[np.isfinite(row)] for row in values if np.any(np.isfinite(row))]
    design = {
        percent: tuple(
            np.quantile([np.percentile(row, percent) for row in rows], TAILS).tolist()
        )
        for percent in DESIGN_PERCENTS
    }
    return Curve(x, names, quantity, grid, np.mean(shares, axis=0), low, high, design)

"""Predictions with the fitted ground: data sets like the observed one, values at
collectors, curves of exceedance, and what barriers do, each with its interval."""

import dataclasses
from typing import NamedTuple

import numpy as np

from ...io.display import Rows, ShownAsTable
from ...store import Store
from ..study.barriers import Barrier, BarrierEstimates, estimates_at
from ..study.intervals import (
    percentile_interval_over_grounds,
    share_intervals_over_grounds,
)
from .data_sets import (
    column_of,
    measured,
    observed_summary,
    simulate_data_sets,
    simulated_summaries,
    summary_names,
)
from .observed import PASSAGE_COLUMNS, PER_PLACE, ObservedValues
from .posterior import TAILS, Posterior, Searched
from .problem import SlopeFit

LEAST_BLOCKS = 200
"""Least number of blocks released for each data set: enough for percentiles of 95."""
STREAM = 100
"""Stream of random numbers of predictions, which no round has."""
RARE = 0.01
"""Probability of a worse deviation below which the model does not explain the
observations."""


class ModelCheck(NamedTuple):
    """Comparison of the observed summaries with predicted ones."""

    probability: float
    """Fraction of predicted data sets whose worst summary deviates as much."""
    worst: str  # name of the observed summary that deviates most
    deviation: float
    """Deviation of that summary from the predicted mean, in predicted standard
    deviations; infinite where what is predicted never varies, and is another."""

    @property
    def explained(self) -> bool:
        """Tell whether the fitted model explains the observations."""
        return self.probability > RARE


class Curve(NamedTuple):
    """Share of all released blocks that exceed a value at a place."""

    place: float  # x [m]
    names: tuple[str, ...]  # barriers there
    quantity: str  # name with unit, one of `PASSAGE_COLUMNS`
    values: np.ndarray  # `(values,)`, in that unit
    share: np.ndarray  # fraction of the blocks on all grounds, `(values,)`
    low: np.ndarray  # lower end of the 95 % interval
    high: np.ndarray
    design: dict[int, tuple[float, float, float]]
    """Each percentile of the blocks that arrive, and the ends of its interval."""


class ChannelPrediction(NamedTuple):
    """Observed values of a channel beside predicted data sets of the same size."""

    channel: ObservedValues
    predicted: np.ndarray
    """Sorted values of each data set, NaN last, `(data sets, values)`."""

    def percentiles(self) -> list[tuple[int, float, float, float, float]]:
        """List percentage, observed percentile, and lower end, median and upper end of
        the predicted one."""
        full = self.predicted[np.all(np.isfinite(self.predicted), axis=1)]
        return [
            (
                percent,
                float(np.percentile(self.channel.values, percent)),
                *np.quantile(np.percentile(full, percent, axis=1), TAILS).tolist(),
            )
            for percent in ((50, 95) if len(full) else ())
        ]


class Predicted(NamedTuple):
    """All that the fitted ground predicts."""

    check: ModelCheck
    channels: tuple[ChannelPrediction, ...]
    curves: tuple[Curve, ...]
    barriers: tuple[BarrierEstimates, ...]
    draws: int  # number of grounds, samples of the posterior
    blocks: int  # number of blocks released on each
    failed: float  # fraction of all these blocks that failed


def predict(fit: SlopeFit, posterior: Posterior, store: Store | None) -> Predicted:
    """Simulate data sets for samples of the posterior, and compare and count."""
    released = fit.observed.released
    # Five data sets on each of 100 grounds.
    size = max(released, LEAST_BLOCKS)
    blocks = 5 * size
    outcomes = simulate_data_sets(
        fit=fit,
        u=posterior.u[:100],
        blocks=blocks,
        stream=STREAM,
        store=store,
        what="predicted data sets",
    )
    data_sets = outcomes.reshape(-1, size, outcomes.shape[-1])
    channels = [c for c in fit.observed.channels if isinstance(c, ObservedValues)]
    curves = [_curve(fit, outcomes, x, q) for x in fit.places for q in PASSAGE_COLUMNS]
    return Predicted(
        check=_check(fit, data_sets[:, :released]),
        channels=tuple(
            ChannelPrediction(channel, _values(fit, channel, data_sets))
            for channel in channels
        ),
        curves=tuple(curve for curve in curves if curve is not None),
        barriers=tuple(at_barrier(fit, outcomes, b) for b in fit.barriers),
        draws=len(outcomes),
        blocks=blocks,
        failed=float(np.mean(outcomes[..., -1])),
    )


def _check(fit: SlopeFit, outcomes: np.ndarray) -> ModelCheck:
    summaries = simulated_summaries(fit.observed, outcomes, fit.places, STREAM)
    summaries = summaries[np.all(np.isfinite(summaries), axis=1)]
    observed, names = observed_summary(fit.observed), summary_names(fit.observed)
    if len(summaries) < 2:
        return ModelCheck(0.0, names[0], np.inf)
    mean, spread = np.mean(summaries, axis=0), np.std(summaries, axis=0)
    rounding = 1e-9 * (1.0 + np.abs(mean))
    spread = np.where(spread > rounding, spread, 0.0)

    def deviations(summary: np.ndarray) -> np.ndarray:
        apart = np.abs(summary - mean)
        # What never varies either agrees or cannot be.
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(apart <= rounding, 0.0, apart / spread)

    ours, theirs = deviations(observed), np.max(deviations(summaries), axis=1)
    worst = int(np.argmax(ours))
    probability = (np.sum(theirs >= ours[worst]) + 1.0) / (len(summaries) + 1.0)
    return ModelCheck(float(probability), names[worst], float(ours[worst]))


def _values(fit: SlopeFit, channel: ObservedValues, outcomes: np.ndarray) -> np.ndarray:
    """Give the first values of each data set with errors of measurement, sorted, as
    many as were observed."""
    rng = np.random.default_rng(STREAM)
    values = measured(fit.observed, channel, outcomes, fit.places, rng)
    first = np.cumsum(np.isfinite(values), axis=1) <= channel.blocks
    values = np.sort(np.where(first, values, np.nan), axis=1)
    return values[:, : channel.blocks]


def _curve(
    fit: SlopeFit, outcomes: np.ndarray, x: float, quantity: str
) -> Curve | None:
    """Count exceedances at a place; None where no block comes."""
    values = outcomes[..., column_of(fit.places, x, quantity)]
    there = np.isfinite(values)
    if not np.any(there):
        return None
    names = tuple(barrier.name for barrier in fit.barriers if barrier.x == x)
    grid = np.linspace(0.0, np.max(values[there]), 101)
    grounds = [np.sort(row[np.isfinite(row)]) for row in values]
    counts = np.stack([len(g) - np.searchsorted(g, grid, "right") for g in grounds])
    blocks = np.sum(outcomes[..., -1] == 0.0, axis=1)  # the others failed
    low, high = share_intervals_over_grounds(counts, blocks)
    design = {
        percent: (
            float(np.percentile(values[there], percent)),
            *percentile_interval_over_grounds(grounds, percent),
        )
        for percent in (50, 95, 99)
    }
    share = np.sum(counts, axis=0) / np.sum(blocks)
    return Curve(x, names, quantity, grid, share, low, high, design)


def at_barrier(
    fit: SlopeFit, outcomes: np.ndarray, barrier: Barrier
) -> BarrierEstimates:
    """Estimate what a barrier does, from data sets on one or several grounds."""
    first = column_of(fit.places, barrier.x, PASSAGE_COLUMNS[0])
    speed, centre, energy, lowest = np.moveaxis(
        outcomes[..., first : first + PER_PLACE], -1, 0
    )
    passages = {"speed_mps": speed, "energy_J": 1e3 * energy}
    passages |= {"centre_height_m": centre, "lowest_height_m": lowest}
    return estimates_at(barrier, outcomes[..., -1] == 0.0, passages)


@dataclasses.dataclass(frozen=True, repr=False)
class SlopeCalibration(ShownAsTable):
    """Ground of a slope, fitted to where blocks stopped and how they passed."""

    fit: SlopeFit
    searched: Searched
    posterior: Posterior
    predicted: Predicted

    def display_rows(self) -> tuple[str, Rows]:
        """Give median and 95 % interval of each parameter."""
        rows = [
            (p.parameter.name, f"{p.median:.4g}", f"{p.low:.4g} to {p.high:.4g}")
            for p in self.posterior.fitted
        ]
        return f"SlopeCalibration: {self.fit.title}", rows

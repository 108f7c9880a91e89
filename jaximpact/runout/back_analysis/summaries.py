"""Summary statistics of data sets, alike for what was observed and what is simulated.

Of stopping points: quantiles, mean and standard deviation [m], and the share of the
blocks observed that there are. Of values at a collector: the same of their logarithms.
Of a count past a line: the logit of the share.
"""

import numpy as np

from .observed import PASSAGE_COLUMNS, PER_PLACE, STOP_COLUMN, Count, Observed, Stops

PROBABILITIES = np.array([0.05, 0.25, 0.5, 0.75, 0.95])
STATISTICS = (*(f"{p:.0%} quantile" for p in PROBABILITIES), "mean", "spread", "number")


def summary_names(observed: Observed) -> list[str]:
    """List the names of the summary statistics."""
    names = []
    for channel in observed.fitted:
        if isinstance(channel, Count):
            names.append(channel.words)
        else:
            names += [f"{statistic} of {channel.words}" for statistic in STATISTICS]
    return names


def observed_summary(observed: Observed) -> np.ndarray:
    """Compute the summary statistics of what was observed, `(statistics,)`."""
    parts = []
    for channel in observed.fitted:
        if isinstance(channel, Count):
            counts = np.array([channel.passed])
            parts.append(_logit_of_share(counts, channel.blocks)[:, None])
        else:
            values = channel.values[None]
            if not isinstance(channel, Stops):
                values = np.log(values)
            parts.append(_statistics(values, channel.blocks))
    return np.concatenate(parts, axis=1)[0]


def simulated_summaries(
    observed: Observed, outcomes: np.ndarray, places: list[float], seed: int
) -> np.ndarray:
    """Compute the summary statistics of simulated data sets, `(data sets, statistics)`.

    Each channel is of the first blocks that have a value, as many as were observed,
    with errors of measurement; NaN where a data set has none.

    Args:
        outcomes: result of `simulate_data_sets`.
        places: places of its passages [m].
        seed: of the errors of measurement.
    """
    rng, parts = np.random.default_rng(seed), []
    for channel in observed.fitted:
        if isinstance(channel, Count):
            of = outcomes[:, : channel.blocks]
            speed = of[..., 1 + PER_PLACE * places.index(channel.place)]
            passed = np.sum(np.isfinite(speed), axis=1)
            parts.append(_logit_of_share(passed, channel.blocks)[:, None])
            continue
        name, column = STOP_COLUMN, 0
        if not isinstance(channel, Stops):
            name = channel.quantity
            column = 1 + PER_PLACE * places.index(channel.place)
            column += PASSAGE_COLUMNS.index(name)
        values = outcomes[..., column]
        values = values + observed.sigma.get(name, 0.0) * rng.standard_normal(
            values.shape
        )
        if not isinstance(channel, Stops):
            # Errors can be larger than a small value: what is measured is above 0.
            values = np.log(np.maximum(values, 1e-3))
        parts.append(_statistics(values, channel.blocks))
    return np.concatenate(parts, axis=1)


def _statistics(values: np.ndarray, blocks: int) -> np.ndarray:
    """Compute `STATISTICS` of the first finite values of each row."""
    there = np.isfinite(values)
    there &= np.cumsum(there, axis=1) <= blocks
    values = np.sort(np.where(there, values, np.nan), axis=1)
    count = np.sum(there, axis=1)
    some = np.maximum(count, 1)
    place = PROBABILITIES * (some[:, None] - 1)
    below = np.floor(place).astype(int)
    above = np.minimum(below + 1, some[:, None] - 1)
    low, high = (np.take_along_axis(values, i, 1) for i in (below, above))
    quantiles = low + (place - below) * (high - low)
    filled = np.where(np.isfinite(values), values, 0.0)
    mean = np.sum(filled, axis=1) / some
    apart = np.where(np.isfinite(values), values - mean[:, None], 0.0)
    spread = np.sqrt(np.sum(apart**2, axis=1) / some)
    found = np.column_stack([quantiles, mean, spread, count / blocks])
    found[count == 0] = np.nan
    return found


def _logit_of_share(passed: np.ndarray, blocks: int) -> np.ndarray:
    # With half a block added on both sides, finite for none and for all.
    return np.log((passed + 0.5) / (blocks - passed + 0.5))

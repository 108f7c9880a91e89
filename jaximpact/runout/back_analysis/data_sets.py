"""Data sets simulated for candidates of the ground, kept in a store, and their summary
statistics.

A data set is as many released blocks as were observed, each with a release, a block and
facets of its own. Random numbers come from the study's seed and the number of the data
set, so that the same candidates meet the same blocks in every fit of the same slope.

Summary statistics are alike for what was observed and what is simulated. Of stopping
points: quantiles, mean and standard deviation [m], and the share of the blocks observed
that there are. Of values at a collector: the same of their logarithms. Of a count past
a line: the logit of the share.

Where a block failed nothing is known of where it would have gone: as in a run-out it is
in no number. A data set is what the other blocks give, if they are most of them.
"""

import dataclasses
import hashlib
import io
import json
from typing import Any

import numpy as np

from ..._packages import versions
from ...progress import tell
from ...store import Store
from ...tasks import call_each
from ..analysis import first_passages, passages
from ..contacts.contact_models import ClosedForm
from ..scheduler import follow
from ..trajectory import Ending, stretches_of
from .observed import (
    PASSAGE_COLUMNS,
    PER_PLACE,
    Observations,
    ObservedCount,
    ObservedValues,
)
from .problem import CONTACTS, SlopeFit


def simulate_data_sets(
    fit: SlopeFit,
    u: np.ndarray,
    blocks: int,
    stream: int,
    store: Store | None = None,
    what: str = "data sets",
) -> np.ndarray:
    """Simulate a data set for each candidate, by the executor that is set.

    Args:
        u: candidates, as probabilities under the priors, `(data sets, parameters)`.
        blocks: blocks released in each.
        stream: number that tells apart the random numbers of several calls.
        store: keeps portions that are done.
        what: name of the data sets in progress.

    Returns:
        `(data sets, blocks, 1 + 4 * places + 1)`: x where a block stopped [m]; at each
        place speed [m/s], height of the centre [m], kinetic energy [kJ] and height of
        the lowest point [m] at the first passage; 1 for a block that failed, else 0.
        NaN for a block that does not stop, or does not come there, and for all but the
        last of a block that failed.
    """
    size = max(1, 4096 // blocks)  # as many blocks as keep the cores busy
    parts = [u[start : start + size] for start in range(0, len(u), size)]
    keys = [_key(fit, part, blocks, stream, i) for i, part in enumerate(parts)]
    outcomes: dict[int, np.ndarray] = {}
    for i, key in enumerate(keys):
        stored = None if store is None else store.get("dataset", key)
        if stored is not None:
            outcomes[i] = np.load(io.BytesIO(stored))
    missing = [i for i in range(len(parts)) if i not in outcomes]
    work = ((fit, parts[i], blocks, _seed(fit, stream, i)) for i in missing)

    def tell_progress() -> None:
        tell(what, sum(map(len, outcomes.values())), len(u))

    def take(place: int, part: np.ndarray) -> None:
        i = missing[place]
        outcomes[i] = part
        if store is not None:
            buffer = io.BytesIO()
            np.save(buffer, part)
            store.put("dataset", keys[i], buffer.getvalue())
        tell_progress()

    tell_progress()
    call_each(_simulate, work, take)
    return np.concatenate([outcomes[i] for i in range(len(parts))])


def _simulate(fit: SlopeFit, u: np.ndarray, blocks: int, seed: int) -> np.ndarray:
    values = np.repeat(fit.values(u), blocks, axis=0)
    fixed, of_law = {}, {}
    for parameter, samples in zip(fit.parameters, values.T, strict=True):
        if parameter.key.startswith(CONTACTS):
            column = parameter.column
            of_law[column.field] = column.factor * samples
        else:
            fixed[parameter.key] = samples
    _, release, ground = fit.slope.sample(len(values), seed, fixed)
    profile = fit.slope.layout.profile
    contacts: Any = fit.slope.laws[0].contacts
    if of_law:
        contacts = ClosedForm(dataclasses.replace(contacts.law, **of_law))
    runs = follow(profile, release, ground, fit.slope.limits, contacts=contacts)
    columns = [np.where(runs.ending == Ending.stopped, runs.x, np.nan)]
    stretches = stretches_of(runs)
    for x in fit.places:
        _, first = first_passages(passages(runs, x, stretches), len(values))
        columns += [first.speed, first.centre_height, 1e-3 * first.energy]
        columns.append(first.lowest_height)
    failed = runs.ending == Ending.failed
    columns = [*(np.where(failed, np.nan, column) for column in columns), failed]
    return np.stack(columns, axis=1).reshape(len(u), blocks, -1)


def _seed(fit: SlopeFit, stream: int, number: int) -> int:
    sequence = np.random.SeedSequence((fit.slope.seed, stream, number))
    return int(sequence.generate_state(1, np.uint32)[0])


def _key(fit: SlopeFit, u: np.ndarray, blocks: int, stream: int, number: int) -> str:
    digest = hashlib.sha256(fit.identity.encode())
    digest.update(repr((versions(), np.__version__)).encode())
    about = [fit.slope.seed, stream, number, blocks, fit.places, PER_PLACE]
    digest.update(json.dumps(about).encode())
    for parameter in fit.parameters:
        digest.update(parameter.key.encode())
    digest.update(np.ascontiguousarray(fit.values(u)).tobytes())
    return digest.hexdigest()


MOST_FAILED = 0.5
"""Fraction of failed blocks above which the others do not stand for all."""


def mostly_failed(outcomes: np.ndarray) -> np.ndarray:
    """Tell in which data sets most blocks failed, `(data sets,)`."""
    return np.mean(outcomes[..., -1], axis=1) > MOST_FAILED


PROBABILITIES = np.array([0.05, 0.25, 0.5, 0.75, 0.95])
STATISTICS = (*(f"{p:.0%} quantile" for p in PROBABILITIES), "mean", "spread", "number")


def summary_names(observed: Observations) -> list[str]:
    """List the names of the summary statistics."""
    names = []
    for channel in observed.fitted:
        if isinstance(channel, ObservedCount):
            names.append(channel.words)
        else:
            names += [f"{statistic} of {channel.words}" for statistic in STATISTICS]
    return names


def observed_summary(observed: Observations) -> np.ndarray:
    """Compute the summary statistics of what was observed, `(statistics,)`."""
    parts = []
    for channel in observed.fitted:
        if isinstance(channel, ObservedCount):
            passed, blocks = np.array([channel.passed]), np.array([channel.blocks])
            parts.append(_logit_of_share(passed, blocks))
        else:
            parts.append(_statistics(channel, channel.values[None]))
    return np.concatenate(parts, axis=1)[0]


def simulated_summaries(
    observed: Observations, outcomes: np.ndarray, places: list[float], seed: int
) -> np.ndarray:
    """Compute the summary statistics of simulated data sets, `(data sets, statistics)`.

    Each channel is of the first blocks that have a value, as many as were observed,
    with errors of measurement, of a seed; NaN where a data set has none, or where most
    of its blocks failed.

    Args:
        outcomes: result of `simulate_data_sets`, with passages at some places [m].
    """
    rng, parts = np.random.default_rng(seed), []
    ended = outcomes[..., -1] == 0.0  # the others failed
    # Each stands for more than one block of those released, where some failed.
    stands_for = outcomes.shape[1] / np.maximum(np.sum(ended, axis=1), 1)
    for channel in observed.fitted:
        if isinstance(channel, ObservedCount):
            first = ended & (np.cumsum(ended, axis=1) <= channel.blocks)
            column = column_of(places, channel.place, PASSAGE_COLUMNS[0])
            passed = np.sum(first & np.isfinite(outcomes[..., column]), axis=1)
            parts.append(_logit_of_share(passed, np.sum(first, axis=1)))
        else:
            values = measured(observed, channel, outcomes, places, rng)
            parts.append(_statistics(channel, values, stands_for))
    summaries = np.concatenate(parts, axis=1)
    summaries[mostly_failed(outcomes)] = np.nan
    return summaries


def measured(
    observed: Observations,
    channel: ObservedValues,
    outcomes: np.ndarray,
    places: list[float],
    rng: np.random.Generator,
) -> np.ndarray:
    """Give the values of a channel in simulated data sets with errors of measurement,
    `(data sets, blocks)`; see `simulated_summaries`."""
    name, place = channel.quantity, channel.place
    column = 0 if place is None else column_of(places, place, name)
    values = outcomes[..., column]
    return values + observed.sigma.get(name, 0.0) * rng.standard_normal(values.shape)


def column_of(places: list[float], place: float, quantity: str) -> int:
    """Give the column of a quantity of `PASSAGE_COLUMNS` in simulated data sets."""
    return 1 + PER_PLACE * places.index(place) + PASSAGE_COLUMNS.index(quantity)


def _statistics(
    channel: ObservedValues, values: np.ndarray, stands_for: np.ndarray | float = 1.0
) -> np.ndarray:
    """Compute `STATISTICS` of the first finite values of each row, as many as were
    observed; each finite value stands for so many blocks."""
    if channel.place is not None:
        # Errors can be larger than a small value: what is measured is above 0.
        values = np.log(np.maximum(values, 1e-3))
    there = np.isfinite(values)
    share = np.minimum(np.sum(there, axis=1) * stands_for / channel.blocks, 1.0)
    there &= np.cumsum(there, axis=1) <= channel.blocks
    values = np.sort(np.where(there, values, np.nan), axis=1)
    count = np.sum(there, axis=1)
    divisor = np.maximum(count, 1)
    place = PROBABILITIES * (divisor[:, None] - 1)
    below = np.floor(place).astype(int)
    above = np.minimum(below + 1, divisor[:, None] - 1)
    low, high = (np.take_along_axis(values, i, 1) for i in (below, above))
    quantiles = low + (place - below) * (high - low)
    filled = np.where(np.isfinite(values), values, 0.0)
    mean = np.sum(filled, axis=1) / divisor
    apart = np.where(np.isfinite(values), values - mean[:, None], 0.0)
    spread = np.sqrt(np.sum(apart**2, axis=1) / divisor)
    statistics = np.column_stack([quantiles, mean, spread, share])
    statistics[count == 0] = np.nan
    return statistics


def _logit_of_share(passed: np.ndarray, blocks: np.ndarray) -> np.ndarray:
    # With half a block added on both sides, finite for none and for all.
    return np.log((passed + 0.5) / (blocks - passed + 0.5))[:, None]

"""Data sets simulated for candidates of the ground, kept in a store.

A data set is as many released blocks as were observed, each with a release, a block and
facets of its own. Random numbers come from the study's seed and the number of the data
set, so that the same candidates meet the same blocks in every fit of the same slope.
"""

import concurrent.futures
import dataclasses
import hashlib
import io
import json
from typing import Any

import numpy as np

from ..._packages import versions
from ...progress import Progress
from ...store import Store
from ...tasks import call_each
from ..analysis import first_passages, passages
from ..contacts.contact_models import ClosedForm
from ..scheduler import WIDTH, follow
from ..state import State
from ..trajectory import Ending, stretches_of
from .observed import PER_PLACE
from .problem import CONTACTS, SlopeFit

CHUNK = 4096
"""Number of blocks that are simulated, and kept, at once."""


def simulate_data_sets(
    fit: SlopeFit,
    u: np.ndarray,
    blocks: int,
    stream: int,
    store: Store | None = None,
    progress: Progress | None = None,
    what: str = "data sets",
    executor: concurrent.futures.Executor | None = None,
) -> np.ndarray:
    """Simulate a data set for each candidate.

    Args:
        u: candidates, as probabilities under the priors, `(data sets, parameters)`.
        blocks: blocks released in each.
        stream: number that tells apart the random numbers of several calls.
        store: keeps chunks that are done.
        progress: told how many are done.
        what: name of the data sets in progress.
        executor: computes chunks in other processes; the results are the same.

    Returns:
        `(data sets, blocks, 1 + 4 * places + 1)`: x where a block stopped [m]; at each
        place speed [m/s], height of the centre [m], kinetic energy [kJ] and height of
        the lowest point [m] at the first passage; 1 for a block that failed, else 0.
        NaN for a block that does not stop, or does not come there.
    """
    size, progress = max(1, CHUNK // blocks), progress or Progress()
    parts = [u[start : start + size] for start in range(0, len(u), size)]
    keys = [_key(fit, part, blocks, stream, i) for i, part in enumerate(parts)]
    found = [_stored(store, key) for key in keys]
    missing = [i for i, outcomes in enumerate(found) if outcomes is None]
    work = ((fit, parts[i], blocks, _seed(fit, stream, i)) for i in missing)

    def take(place: int, outcomes: np.ndarray) -> None:
        i = missing[place]
        found[i] = outcomes
        if store is not None:
            buffer = io.BytesIO()
            np.save(buffer, outcomes)
            store.put("dataset", keys[i], buffer.getvalue())
        progress(what, _count(found), len(u))

    progress(what, _count(found), len(u))
    call_each(_simulate, work, take, executor)
    return np.concatenate([outcomes for outcomes in found if outcomes is not None])


def _stored(store: Store | None, key: str) -> np.ndarray | None:
    stored = None if store is None else store.get("dataset", key)
    return None if stored is None else np.load(io.BytesIO(stored))


def _count(found: list[np.ndarray | None]) -> int:
    """Count the data sets that are there."""
    return sum(len(outcomes) for outcomes in found if outcomes is not None)


def _simulate(fit: SlopeFit, u: np.ndarray, blocks: int, seed: int) -> np.ndarray:
    values = np.repeat(fit.values(u), blocks, axis=0)
    given, of_law = {}, {}
    for parameter, own in zip(fit.parameters, values.T, strict=True):
        if parameter.key.startswith(CONTACTS):
            column = parameter.column
            of_law[column.field] = column.factor * own
        else:
            given[parameter.key] = own
    _, release, ground = fit.slope.sample(len(values), seed, given)
    profile = fit.slope.layout.profile
    contacts: Any = fit.slope.laws[0].contacts
    if of_law:
        contacts = ClosedForm(dataclasses.replace(contacts.law, **of_law))
    state = State.at_release(profile, release, ground, fit.slope.limits)
    runs = follow(state, contacts, WIDTH, Progress())
    columns = [np.where(runs.ending == Ending.stopped, runs.x, np.nan)]
    stretches = stretches_of(runs)
    for x in fit.places:
        _, first = first_passages(passages(runs, x, stretches), len(values))
        columns += [first.speed, first.centre_height, 1e-3 * first.energy]
        columns.append(first.lowest_height)
    columns.append(runs.ending == Ending.failed)
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

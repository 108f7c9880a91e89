"""Scenes as numbers: what is known of them, and what is an array or traced."""

import functools
from collections.abc import Sequence
from typing import NamedTuple

import jax
import numpy as np

from .._jax_internals import Tracer
from .._precision import float64_leaf
from .._types import Structure
from ..accuracy import Accuracy
from ..identity import heed_edits
from ..impact.dynamics import LedgerItems
from ..impact.results import Solution, empty_history, empty_summary
from . import NATIVE, Engine


class Request(NamedTuple):
    """Static description of the scenes to compute."""

    structure: Structure
    """Laws and shapes of the scene: its tree structure."""
    ledger: LedgerItems
    places: tuple[int, ...]
    """Indices of the leaves that are not known yet, or are arrays."""
    rest: np.ndarray
    """All other leaves, each at its place, then tolerance and floor. They stay known
    inside of `jax.jit`, and a single array is quicker to hand over than thirty."""
    engine: Engine
    sampled: bool = False
    """Whether a history is sampled at times that are asked for."""

    @property
    def place_of_times(self) -> int:
        """Index that stands for the times among the leaves: the one behind them."""
        return self.structure.num_leaves

    def leaves(self, values: list, unknown: Sequence[int] = ()) -> list:
        """Return the leaves of the scene, with the values of those at `places`, and
        with NaN for those that are not known."""
        leaves = list(self.rest[:-2])
        for place, value in zip(self.places, values, strict=True):
            leaves[place] = value
        for place in set(unknown) - {self.place_of_times}:
            leaves[place] = np.nan
        return leaves

    def solution(self, rows) -> Solution:
        """Return the results from their rows."""
        return jax.tree.unflatten(_structure(self.ledger, self.sampled), rows)


def _is_open(leaf) -> bool:
    """Tell whether a leaf is traced, or an array with axes; quickly of a number."""
    is_number = isinstance(leaf, float)
    return not is_number and (isinstance(leaf, Tracer) or np.ndim(leaf) > 0)


@functools.cache
def _structure(ledger: LedgerItems, sampled: bool):
    samples = empty_history(bool(ledger)) if sampled else None
    return jax.tree.structure(Solution(empty_summary(ledger), samples))


def row_of(wanted: Request, name: str) -> int:
    """Return the place of a number among the rows of an impact."""
    structure = _structure(wanted.ledger, False)
    rows = jax.tree.unflatten(structure, range(structure.num_leaves))
    return getattr(rows.numbers, name)


def request(
    structure,
    leaves,
    accuracy: Accuracy,
    ledger: LedgerItems,
    engine: Engine = NATIVE,
    sampled: bool = False,
) -> tuple[Request, list]:
    """Describe scenes; and return the values of leaves that are arrays or traced.

    The leaves of a single impact, all known, may be one array.
    """
    heed_edits(structure)
    places, rest = [], np.empty(len(leaves) + 2)
    rest[-2:] = accuracy.tolerance, accuracy.floor
    if isinstance(leaves, np.ndarray):
        rest[:-2] = leaves
        return Request(structure, ledger, (), rest, engine, sampled), []
    for place, leaf in enumerate(leaves):
        if _is_open(leaf):
            places.append(place)
            rest[place] = np.nan
        else:
            rest[place] = leaf
    # Whoever puts leaves in place by himself may put numbers of another type.
    values = [
        leaf if leaf.dtype == np.float64 else float64_leaf(leaf)
        for leaf in (leaves[place] for place in places)
    ]
    return Request(structure, ledger, tuple(places), rest, engine, sampled), values

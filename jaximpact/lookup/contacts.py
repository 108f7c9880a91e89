"""Contacts of a run-out by tables."""

import dataclasses
import functools
from collections.abc import Sequence
from typing import Any, NamedTuple

import jax
import numpy as np

from ..errors import InputError
from ..identity import part_names
from ..impact.events import Outcome
from ..impact_response import ImpactResponse, ImpactResponses
from ..quantities import columns_of
from ..scene import Block, Impact, Scene, Soil
from ..scene_quantities import value_of
from ..shapes import each_shape
from ..units import DEGREE
from .table import Entry, ReboundTable, look_up_many

PART = 512
"""Impacts looked up at once. Always so many, so that nothing is compiled again and the
result of a lane does not depend, to the last bit, on how many run beside it."""


class Tabulated:
    """Every contact looked up in a table, for `simulate_runout`.

    Args:
        tables: one for each pair of block and ground that will meet.

    Impacts beyond a table fail, and end their trajectories so. Raises InputError for a
    block on a ground that no table was made for: of other numbers, another shape, or
    another law.
    """

    def __init__(self, tables: ReboundTable | Sequence[ReboundTable]):
        self.tables = [tables] if isinstance(tables, ReboundTable) else list(tables)
        if not self.tables:
            raise InputError("Tabulated needs at least one table, but got none")
        self._pairs = [_Pair.of(table) for table in self.tables]

    def __call__(self, block: Block, soil: Soil, impact: Impact) -> ImpactResponses:
        impact = jax.tree.map(np.asarray, impact)
        count = len(impact.speed)
        columns = np.full((len(Entry._fields), count), np.nan)
        open_yet = np.ones(count, bool)
        ours = _alternatives(block, soil)
        for table, pair in zip(self.tables, self._pairs, strict=True):
            chosen = open_yet & _same(ours, pair, count)
            if np.any(chosen):
                lanes = jax.tree.map(lambda leaf, where=chosen: leaf[where], impact)
                columns[:, chosen] = _in_parts(table, lanes)
                open_yet &= ~chosen
        if np.any(open_yet):
            lane = int(np.argmax(open_yet))
            mass, ratio = (
                np.broadcast_to(np.asarray(each), (count,))[lane]
                for each in (block.mass, block.aspect_ratio)
            )
            raise InputError(
                f"no table was made for a block of {mass:g} kg with aspect ratio "
                f"{ratio:g} ({type(block.shape).__name__}) on the ground that it "
                "struck; tabulate that pair too"
            )
        outcome = columns[-1].astype(int)
        columns[:-1, outcome == Outcome.failed] = np.nan
        return ImpactResponses(ImpactResponse(*columns[:-1]), outcome)

    def problem_with(
        self,
        block: Block,
        soil: Soil,
        least_slope: np.ndarray,
        most_slope: np.ndarray,
    ) -> str | None:
        """Say in one sentence what of a run-out the tables do not have; None if all.

        Args:
            block: fields `(blocks,)`.
            soil: fields that broadcast to `(blocks, segments)`.
            least_slope, most_slope: of the planes that each may strike, likewise
                [rad].
        """
        shape = least_slope.shape
        block = jax.tree.map(lambda leaf: np.asarray(leaf)[:, None], block)
        known, covered = np.zeros(shape, bool), np.zeros(shape, bool)
        ours, rounding = _alternatives(block, soil), 1e-9
        for table, pair in zip(self.tables, self._pairs, strict=True):
            same = _same(ours, pair, shape)
            low, high = (float(table.slopes[end]) for end in (0, -1))
            known |= same
            within = least_slope >= low - rounding
            covered |= same & within & (most_slope <= high + rounding)
        if np.all(covered):
            return None
        lane, segment = (int(i) for i in np.argwhere(~covered)[0])
        where = f"block {lane} on segment {segment + 1}"
        if known[lane, segment]:
            slopes = least_slope[lane, segment], most_slope[lane, segment]
            low, high = (slope / DEGREE for slope in slopes)
            needed = f"{low:.5g}" if high == low else f"{low:.5g} to {high:.5g}"
            return (
                f"must cover slopes of {needed} deg for {where}, but no table of that "
                "pair does"
            )

        def one(tree):
            return jax.tree.map(
                lambda leaf: np.broadcast_to(leaf, shape)[lane, segment], tree
            )

        ((alone, _),) = each_shape(Scene(one(block), one(soil)))
        differences = [_difference(alone, table) for table in self.tables]
        nearest = min(differences, key=lambda text: text.count(","))
        return f"holds no table of {where}: its {nearest}"


class _Pair(NamedTuple):
    """Block on a ground."""

    structure: Any  # shape and laws
    numbers: list
    chosen: Any  # places of the lanes that have this shape

    @classmethod
    def of(cls, table: ReboundTable) -> "_Pair":
        """Make the pair of a table, with floats, as every contact compares them."""
        leaves, structure = jax.tree.flatten((table.block, table.soil))
        return cls(structure, [float(leaf) for leaf in leaves], ...)


def _alternatives(block: Block, soil: Soil) -> list[_Pair]:
    """Blocks on grounds, those of one shape at a time."""
    pairs = []
    for alone, chosen in each_shape(Scene(block, soil)):
        leaves, structure = jax.tree.flatten((alone.block, alone.soil))
        pairs.append(_Pair(structure, [np.asarray(x) for x in leaves], chosen))
    return pairs


def _same(ours: list[_Pair], theirs: _Pair, shape) -> np.ndarray:
    """Tell where shape and laws are the same, and all numbers but for the rounding of a
    file's units."""
    same = np.zeros(shape, bool)
    for pair in ours:
        if pair.structure == theirs.structure:
            numbers = zip(pair.numbers, theirs.numbers, strict=True)
            same[pair.chosen] = functools.reduce(
                np.logical_and, (_alike(a, b) for a, b in numbers)
            )
    return same


def _alike(a, b: float) -> np.ndarray:
    return np.abs(a - b) <= 1e-12 * abs(b)  # but for rounding


def _difference(scene: Scene, table: ReboundTable) -> str:
    """Say in what a block on a ground, scalars, differ from those of a table."""
    differences, of_table = [], Scene(table.block, table.soil)
    names = part_names(table.soil, table.block)
    for slot, name in part_names(scene.soil, scene.block).items():
        if name != names[slot]:
            differences.append(f"{slot} is {name} and in a table {names[slot]}")
    columns = columns_of(of_table)
    for name, column in columns_of(scene).items():
        if column.part != "impact" and name in columns:
            ours, theirs = (float(value_of(of, column)) for of in (scene, of_table))
            if not _alike(ours, theirs):
                differences.append(f"{name} is {ours:g} and in a table {theirs:g}")
    return ", ".join(differences)


def _in_parts(table: ReboundTable, impact: Impact) -> np.ndarray:
    """Return the entries as columns."""
    table = dataclasses.replace(table, error=None)  # once for all parts
    count = len(impact.speed)
    padded = jax.tree.map(lambda leaf: np.pad(leaf, (0, -count % PART), "edge"), impact)
    parts = []
    for start in range(0, count, PART):
        part = jax.tree.map(lambda leaf, k=start: leaf[k : k + PART], padded)
        parts.append([np.asarray(column) for column in look_up_many(table, part)])
    return np.concatenate(parts, axis=1)[:, :count]

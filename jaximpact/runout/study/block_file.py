"""Blocks of a study, from its file: their shapes and quantities."""

import dataclasses
import math
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple, cast

import numpy as np

from ...errors import InputError, located
from ...io.toml import known_table, typed, with_named_parts
from ...quantities import InputColumn, columns_of_part
from ...scene import Block
from ...scene_quantities import SHAPE, part_named, replaced_parts
from ...shapes import AbstractShape, shape_of_each
from ..random_inputs import Quantity
from .quantity import read_quantity

MASS, VOLUME = "mass_kg", "volume_m3"
VOLUME_COLUMN = InputColumn(
    *(VOLUME, "block", "volume", 1.0, math.nan, 0.0, math.inf, False, False),
    *("m3", "volume", (1e-9, 1e5)),
)
"""Volume as a study may have it in place of the mass."""


class BlockInput(NamedTuple):
    """Blocks as the file says them, in the units of its names."""

    kinds: tuple[type[AbstractShape], ...]
    """Shapes of the blocks."""
    base: Block
    """Block with a shape of each kind, all else being the default."""
    quantities: dict[str, Quantity]
    """Quantities by name; several shapes as their indices."""

    @property
    def columns(self) -> dict[str, InputColumn]:
        """Columns of the blocks, by name."""
        return columns_of_part("block", self.base)

    def of_samples(self, samples: Mapping[str, np.ndarray], count: int) -> Block:
        """Make the blocks.

        Args:
            samples: samples of the quantities `(count,)`, by name.
        """
        base = self.base
        if len(self.kinds) > 1:
            kinds = [self.kinds[int(i)] for i in samples[SHAPE]]
            base = cast(Block, replaced_parts(base, {SHAPE: shape_of_each(kinds)}))
        fields = {
            column.field: column.factor * samples[name]
            for name, column in self.columns.items()
            if name in samples
        }
        if VOLUME in samples:
            density = fields.get("density", float(base.density))
            with np.errstate(over="ignore"):  # a mass of inf is refused
                fields["mass"] = density * samples[VOLUME]
        fields.setdefault("mass", np.full(count, float(base.mass)))
        return dataclasses.replace(base, **fields)


def read_blocks(path: Path, content: dict) -> BlockInput:
    """Read the table [block] of a study."""
    kinds, base = _shapes(path, content)
    columns = columns_of_part("block", base)
    table = known_table(path, content, "block", (*columns, VOLUME, SHAPE))
    if MASS in table and VOLUME in table:
        raise InputError(
            "takes mass_kg or volume_m3, not both: the mass is density_kgm3 times the "
            "volume",
            file=path,
            key="block",
        )
    quantities, columns = {}, columns | {VOLUME: VOLUME_COLUMN}
    for name, value in table.items():
        if name != SHAPE:
            key = f"block.{name}"
            quantities[name] = read_quantity(path, key, value, columns[name])
        elif isinstance(value, list):
            quantities[name] = tuple(map(float, range(len(value))))
    return BlockInput(kinds, base, quantities)


def _shapes(path: Path, content: dict) -> tuple[tuple[type[AbstractShape], ...], Block]:
    """Read the shapes that the file names: one, or a list; give them, and a block with
    a shape of each."""
    table = typed(path, content, "block", dict, {})
    key = f"block.{SHAPE}"
    names = table.get(SHAPE)
    if not isinstance(names, list):
        base = cast(Block, with_named_parts(path, "block", table, Block()))
        return (type(base.shape),), base
    if not names or not all(isinstance(name, str) for name in names):
        raise InputError(
            f"must be a name or a list of names, but is {names!r}", file=path, key=key
        )
    with located(path, key):
        shapes = [part_named(SHAPE, name, path.parent) for name in names]
        kinds = [type(cast(AbstractShape, shape)) for shape in shapes]
        one_of_each = {SHAPE: shape_of_each(kinds)}
        base = cast(Block, replaced_parts(Block(), one_of_each))
    if len(set(kinds)) < len(kinds):
        raise InputError("holds a shape twice", file=path, key=key)
    return tuple(kinds), base

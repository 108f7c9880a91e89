"""Numbers of many blocks together with their derivatives: gather, compute, scatter."""

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import numpy as np

from .lane_programs import ClosedProgram


class Carried(NamedTuple):
    """Numbers of many blocks, and the derivatives that they carry."""

    value: Any
    """Tree of arrays `(blocks,)`, or with more axes behind."""
    tangent: Any = None
    """Tree of the same structure, its arrays with an axis of the parameters in front;
    None where no derivatives are carried."""

    def at(self, *index: np.ndarray) -> "Carried":
        """Select blocks, or whatever the last axes of all arrays are of."""
        return self.map(lambda tree: jax.tree.map(lambda leaf: leaf[..., *index], tree))

    def put(self, lanes: np.ndarray, new: "Carried") -> None:
        """Set some blocks in all arrays."""
        own, other = jax.tree.leaves(self), jax.tree.leaves(new)
        for leaf, values in zip(own, other, strict=True):
            leaf[..., lanes] = values

    def map(self, function: Callable, of_tangent: Callable | None = None) -> "Carried":
        """Apply a linear function to the tree and to that of the derivatives, to which
        another may be applied in its place."""
        if self.tangent is None:
            return Carried(function(self.value))
        return Carried(function(self.value), (of_tangent or function)(self.tangent))

    def copy(self) -> "Carried":
        """Copy all arrays."""
        return self.map(lambda tree: jax.tree.map(np.copy, tree))

    def part(self, name: str) -> "Carried":
        """Take a field of the tree."""
        return self.map(lambda tree: getattr(tree, name))

    def split(self) -> "tuple[Carried, ...]":
        """Take a tuple of trees apart."""
        if self.tangent is None:
            return tuple(Carried(value) for value in self.value)
        return tuple(map(Carried, self.value, self.tangent))


def call(program: ClosedProgram, *inputs) -> Carried:
    """Compute a program's results, with derivatives if any input carries them.

    Values are the same with and without derivatives, to the last bit.

    Args:
        inputs: `Carried`, or trees of arrays without derivatives.
    """
    carried = [x if isinstance(x, Carried) else Carried(x) for x in inputs]
    values = tuple(x.value for x in carried)
    tangents = tuple(x.tangent for x in carried)
    found = program(*values)
    if all(tangent is None for tangent in tangents):
        return Carried(found)
    return Carried(found, program.along(values, tangents))

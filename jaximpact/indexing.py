"""Indexing of results and scenes over the axes of their impacts, as of arrays."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np

from ._jax_internals import Tracer
from .scene import Scene
from .shapes import MixedShapes


class Selection:
    """An index into impacts, to be applied to their numbers, scene and history.

    Args:
        shape: of the impacts.
        index: whatever NumPy takes as an index of an array of this shape.
        tree: what will be indexed; where JAX traces the tree or the index, JAX does it.
    """

    def __init__(self, shape: tuple[int, ...], index, tree):
        index = index if isinstance(index, tuple) else (index,)
        self.traced = any(map(is_traced, jax.tree.leaves((index, tree))))
        self._shape = shape
        self._index = tuple(map(_as_array, index))
        # JAX takes 50 microseconds for each of 60 arrays, and compiles for each new
        # shape: it is for what NumPy cannot do.
        self._numpy = jnp if self.traced else np

    def of_numbers(self, tree):
        """Entries of arrays that have one entry for each impact."""
        return jax.tree.map(lambda leaf: self._entries(leaf, self._shape, 0), tree)

    def of_scene(self, scene: Scene) -> Scene:
        """The scenes of the impacts selected.

        A field that is one number for all impacts stays one number. A single scene has
        its own shape in place of several.
        """

        def of_field(leaf):
            return self._entries(leaf, self._shape, 0) if np.ndim(leaf) else leaf

        selected = jax.tree.map(of_field, scene)
        shape = selected.block.shape
        is_single = not any(map(np.ndim, jax.tree.leaves(selected)))
        if not is_single or not isinstance(shape, MixedShapes):
            return selected
        if is_traced(shape.index):
            return selected
        own = shape.alone(int(shape.index))
        block = dataclasses.replace(selected.block, shape=own)
        return Scene(block, selected.soil, selected.impact)

    def of_history(self, history):
        """Entries of series, whose last axis is time; one for all impacts stays."""

        def of_series(leaf):
            if np.ndim(leaf) < 2:
                return leaf
            return self._entries(leaf, (*self._shape, np.shape(leaf)[-1]), 1)

        return jax.tree.map(of_series, history)

    def _entries(self, leaf, shape: tuple[int, ...], further_axes: int):
        if any(entry is Ellipsis for entry in self._index):
            index = self._index + (slice(None),) * further_axes
        else:
            index = (*self._index, ...)  # which gives arrays, never NumPy's scalars
        values = self._numpy.asarray(leaf)
        if values.shape != shape:
            values = self._numpy.broadcast_to(values, shape)
        return values[index]


def is_traced(value) -> bool:
    """Tell whether a JAX transformation traces a value, so that it is not known."""
    return isinstance(value, Tracer)


def _as_array(entry):
    """An entry of an index as NumPy and JAX both take it."""
    if isinstance(entry, list):
        return np.asarray(entry) if entry else np.zeros(0, int)
    is_array = hasattr(entry, "__array__") and not is_traced(entry)
    return np.asarray(entry) if is_array else entry

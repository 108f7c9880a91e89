"""The results of one impact, or of many: numbers, and what they were computed from.

Arrays of NumPy and of JAX do alike, and so do those that a JAX transformation is
tracing; words and tables alone need values that are known.
"""

import dataclasses
from collections.abc import Iterator
from typing import TYPE_CHECKING

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from ._jax_internals import Tracer
from .accuracy import Accuracy
from .engines.selection import MACHINE_CODE
from .formats import provenance
from .history import History
from .mechanics.outcomes import Outcome
from .numbers import Numbers
from .scene import Scene
from .shapes import MixedShapes

if TYPE_CHECKING:  # both take a while to load
    import pandas as pd
    import xarray as xr


_ALWAYS = [f.name for f in dataclasses.fields(Numbers) if f.name != "energy"]
"""The numbers that every result has."""


class ImpactResult(Numbers):
    """Everything about one impact, or about many: its numbers, and what they were
    computed from.

    Of many impacts every number is an array of the shape `result.shape`, and the result
    can be indexed as such an array: `result[3]`, `result[2:5]`,
    `result[result.e_n > 0.1]`, `result[i, j]`. What is taken out is again a result,
    with the scenes that belong to it, in arrays of NumPy or of JAX as before.
    """

    scene: Scene
    accuracy: Accuracy = eqx.field(static=True)
    history: History | None = None
    model_tolerance: float = eqx.field(default=0.0, static=True)
    """Error for which a model that leaves something out was allowed."""
    engine: str = eqx.field(default=MACHINE_CODE, static=True)
    """What it was asked to be computed by: machine code (XLA where there is none), or
    diffrax, with the name of the solver if that is not the package's own."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of every number; `()` for one impact."""
        return np.shape(self.outcome_code)

    @property
    def outcome(self) -> Outcome | np.ndarray:
        """How the impact ended; of many impacts an array of the words, of type `str`
        as in tables and datasets, which files hold and which compare with a word:
        `result.outcome == "failed"`.

        Not to be had from inside a JAX transformation; use `outcome_code` there, which
        compares with the members of `Outcome`.
        """
        if self.shape == ():
            return Outcome(int(self.outcome_code))
        from .formats.results import outcomes_in_words

        return outcomes_in_words(self.outcome_code)

    def outcome_counts(self) -> dict[str, int]:
        """How many impacts ended in which way, outcomes that did not occur left out."""
        from .formats.results import count_outcomes

        return count_outcomes(self)

    def __len__(self) -> int:
        if self.shape == ():
            raise TypeError("this is the result of one impact, which has no length")
        return self.shape[0]

    def __bool__(self) -> bool:
        """True for one impact; of many, whether there are any. Without this the truth
        of one impact would be asked of its length, which it does not have."""
        return self.shape == () or len(self) > 0

    def __iter__(self) -> "Iterator[ImpactResult]":
        if self.shape == ():
            raise TypeError(
                "this is the result of one impact, over which nothing can be iterated"
            )
        return (self[place] for place in range(len(self)))

    def __getitem__(self, index) -> "ImpactResult":
        """Some of the impacts, as an array of them is indexed.

        Fields of the scene that are one number for all impacts stay one number, but a
        shape that differs from impact to impact becomes that of the impact taken.

        Raises IndexError as NumPy does; inside a JAX transformation places beyond the
        ends are taken for the ends, as JAX does.
        """
        take = _Taking(self.shape, index, self)
        numbers = {
            field.name: jax.tree.map(take.of_each, getattr(self, field.name))
            for field in dataclasses.fields(Numbers)
        }
        scene = jax.tree.map(take.of_scene, self.scene)
        if np.shape(numbers["outcome_code"]) == ():
            scene = _with_own_shape(scene)
        history = jax.tree.map(take.of_series, self.history)
        taken = numbers | {"scene": scene, "history": history}
        if isinstance(self.outcome_code, jax.Array) and not take.traced:
            taken = jax.device_put(taken)
        return dataclasses.replace(self, **taken)

    def __repr__(self) -> str:
        return self._shown("text") or super().__repr__()

    def _repr_html_(self) -> str:
        return self._shown("html") or f"<pre>{super().__repr__()}</pre>"

    def _shown(self, how: str) -> str | None:
        """The result as "text" or "html". None where that is not to be had: while a
        transformation traces it or holds other things in its fields, and for trees of
        derivatives or means, whose outcomes are none."""
        with_values = (self.scene, [getattr(self, name) for name in _ALWAYS])
        leaves = jax.tree.leaves(with_values, is_leaf=lambda x: x is None)
        if not all(map(_is_known, leaves)):
            return None
        if not np.all(np.isin(self.outcome_code, list(Outcome))):
            return None
        from .formats import display

        return {"text": display.as_text, "html": display.as_html}[how](self)

    def to_dataframe(self, *, all_inputs: bool = False) -> "pd.DataFrame":
        """The results as a table, one row an impact, as `jaximpact batch` writes them.

        First come the quantities of the scene that vary, then the results, then the
        outcome in words; names and units are those of the tables (`angle_deg`,
        `max_normal_force_N`). A failed impact has NaN. What the shape of a row has no
        parameter for is NaN too.

        Args:
            all_inputs: also the quantities that are the same for all impacts, and the
                names of laws and shapes that are not the usual ones.
        """
        from .formats.frames import frame_of

        return frame_of(self, all_inputs)

    def to_xarray(self, dims: tuple[str, ...] | None = None) -> "xr.Dataset":
        """Every number as a dataset, with units, meanings and provenance, as `sweep`
        gives it.

        Quantities of the scene that vary are coordinates along the dimensions along
        which they do; all others stand in the attribute `base`. With the energy ledger
        there are variables `energy_*_J`. `repeat_sweep` computes such a dataset again.

        Args:
            dims: names of the dimensions, one for each axis of `result.shape`; by
                default `scene`, or `scene_0`, `scene_1` and so on. The name of a
                quantity that varies along that axis alone (`"angle_deg"`) makes it the
                index of the dimension.

        Raises InputError for names that cannot be those of the dimensions.
        """
        from .formats.datasets import dataset_of_result

        return dataset_of_result(self, dims)

    def plot(self, path=None):
        """Force, penetration, rotation and energy against time; see
        `plotting.plot_impact`. Records the history first if it was not asked for."""
        from .plotting import plot_impact

        return plot_impact(self, path)

    def manifest(self) -> dict:
        """What is needed to compute this again, ready for JSON."""
        return provenance.manifest(
            self.scene, self.accuracy, self.model_tolerance, self.engine
        )


class _Taking:
    """Indexing of arrays whose leading axes are those of the impacts."""

    def __init__(self, shape: tuple[int, ...], index, result: ImpactResult):
        index = index if isinstance(index, tuple) else (index,)
        self.traced = any(map(_is_traced, jax.tree.leaves((index, result))))
        self._shape = shape
        self._index = tuple(map(_plain, index))
        # JAX takes 50 microseconds for each of 60 arrays, and compiles for each new
        # shape: it is for what NumPy cannot do.
        self._numpy = jnp if self.traced else np

    def of_each(self, leaf):
        """Entries of an array with an entry for each impact."""
        return self._of(leaf, self._shape, 0)

    def of_scene(self, leaf):
        """Entries of a field of the scene; a number for all impacts is itself one."""
        return self.of_each(leaf) if np.ndim(leaf) else leaf

    def of_series(self, leaf):
        """Entries of series, whose last axis is time; one for all impacts stays."""
        if np.ndim(leaf) < 2:
            return leaf
        return self._of(leaf, (*self._shape, np.shape(leaf)[-1]), 1)

    def _of(self, leaf, shape: tuple[int, ...], further_axes: int):
        if any(entry is Ellipsis for entry in self._index):
            index = self._index + (slice(None),) * further_axes
        else:
            index = (*self._index, ...)  # which gives arrays, never NumPy's scalars
        values = self._numpy.asarray(leaf)
        if values.shape != shape:
            values = self._numpy.broadcast_to(values, shape)
        return values[index]


def _is_traced(value) -> bool:
    return isinstance(value, Tracer)


def _plain(entry):
    """An entry of an index as NumPy and JAX both take it."""
    if isinstance(entry, list):
        return np.asarray(entry) if entry else np.zeros(0, int)
    is_array = hasattr(entry, "__array__") and not _is_traced(entry)
    return np.asarray(entry) if is_array else entry


def _with_own_shape(scene: Scene) -> Scene:
    """One scene with its own shape in place of one of several, where it is known
    which."""
    shape = scene.block.shape
    if not isinstance(shape, MixedShapes) or _is_traced(shape.index):
        return scene
    own = shape.alone(int(shape.index))
    return Scene(dataclasses.replace(scene.block, shape=own), scene.soil, scene.impact)


def _is_known(leaf) -> bool:
    if isinstance(leaf, jax.Array):
        return not _is_traced(leaf) and not leaf.is_deleted()
    return isinstance(leaf, np.ndarray | np.generic | float)

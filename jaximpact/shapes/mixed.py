"""Mixed shapes: several in one scene, one for each lane."""

import abc
import dataclasses
import functools
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from .._jax_internals import Tracer, broadcast_shapes, namespace_of
from .._precision import float64_leaf
from .._types import Scalar
from ..errors import InputError
from ..parameters import Declared, declared_of, parameter
from .base import AbstractShape, Section, SemiAxes

ONE_BY_ONE = "blocks of several shapes are computed shape by shape: shape_by_shape"


class MixedShapes(AbstractShape):
    """One of several shapes, `index` says which.

    Tables and scenes of blocks of several shapes hold it; impacts and run-outs are
    computed shape by shape.

    `mixed(Ellipsoid, RectangularPrism)` is such a class. Its parameters are those of
    all its shapes, each once; those that the shape of a lane does not have change
    nothing there.
    """

    # No parameter, and said to be none.
    index: Scalar = eqx.field(converter=float64_leaf, metadata={"declared": None})
    """Index among `kinds` of the shape of a lane: a whole number."""

    @property
    @abc.abstractmethod
    def kinds(self) -> tuple[type[AbstractShape], ...]:
        """The shapes that there are; an attribute of the class."""

    def __reduce__(self):
        fields = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}
        return _made_again, (self.kinds, fields)

    def of_kind(self, place: int, lanes) -> AbstractShape:
        """Return the shapes of lanes that all have one kind."""
        kind = self.kinds[place]
        return kind(**{name: getattr(self, name)[lanes] for name in declared_of(kind)})

    def alone(self, place: int) -> AbstractShape:
        """Return the shape of one kind. Lanes of another have its defaults, which are
        always allowed."""
        usual = self.kinds[place]()
        chosen = self.index == place
        values = {
            name: jnp.where(chosen, getattr(self, name), getattr(usual, name))
            for name in declared_of(self.kinds[place])
        }
        return dataclasses.replace(usual, **values)

    def _of_lane(self, of_shape: Callable):
        """Select the result of the lane's shape. The others are computed too, for
        finite inputs, so that their derivatives are finite and count nothing."""
        *others, result = [of_shape(self.alone(k)) for k in range(len(self.kinds))]
        for place, other in reversed(list(enumerate(others))):
            is_it = self.index == place
            result = jax.tree.map(
                lambda one, rest, is_it=is_it: jnp.where(is_it, one, rest),
                other,
                result,
            )
        return result

    @property
    def unit_volume(self) -> Scalar:
        return self._of_lane(lambda shape: shape.unit_volume)

    @property
    def unit_inertia(self) -> Scalar:
        return self._of_lane(lambda shape: shape.unit_inertia)

    def semi_axes(self, mass, density) -> SemiAxes:
        return self._of_lane(lambda shape: shape.semi_axes(mass, density))

    def inertia(self, mass, axes) -> Scalar:
        return self._of_lane(lambda shape: shape.inertia(mass, axes))

    def support(self, axes, sin, cos, *, side=None) -> Scalar:
        raise TypeError(ONE_BY_ONE)

    def section(self, axes, sin, cos, height, sinking, *, side=None) -> Section:
        raise TypeError(ONE_BY_ONE)


@functools.cache
def mixed(*kinds: type[AbstractShape]) -> type[MixedShapes]:
    """Make the class of blocks that have one of several shapes each.

    Raises InputError for two parameters of one name that differ in unit or column.
    """
    fields = {
        name: parameter(**declared._asdict())
        for name, declared in _declared(kinds).items()
    }
    names = ", ".join(f"{kind.__module__}.{kind.__qualname__}" for kind in kinds)
    metaclass: Any = type(MixedShapes)
    return metaclass(
        MixedShapes.__name__,
        (MixedShapes,),
        fields
        | {
            "__annotations__": dict.fromkeys(fields, Scalar),
            "__doc__": f"One of several shapes: {names}.",
            "__module__": __name__,
            "__qualname__": f"{MixedShapes.__qualname__}[{names}]",
            "kinds": kinds,
        },
    )


def shape_of_each(kinds: Sequence[type[AbstractShape]]) -> AbstractShape:
    """Make the shapes of many blocks, with default parameters.

    They are `MixedShapes` unless all blocks have a shape of one class.
    """
    different = sorted(set(kinds), key=lambda kind: (kind.__module__, kind.__name__))
    if len(different) == 1:
        return different[0]()
    index = np.array([different.index(kind) for kind in kinds], float)
    defaults = {}
    for place, kind in reversed(list(enumerate(different))):
        for name, declared in declared_of(kind).items():
            value = np.asarray(declared.si_default)
            before = defaults.get(name, value)
            if np.any(before != value):
                value = np.where(index == place, value, before)
            defaults[name] = value
    return mixed(*different)(index=index, **defaults)


def each_shape(lanes: Any) -> Iterator[tuple[Any, Any]]:
    """Divide blocks by their shapes.

    Args:
        lanes: tree whose fields broadcast to one shape, with `MixedShapes` in it where
            blocks have several.

    Yields:
        The tree of the blocks of one shape, and their places: a mask, or `...` for all.

    Raises InputError for an index that is none, and where JAX traces it.
    """
    nodes = jax.tree.leaves(lanes, is_leaf=_is_mixed)
    several = next(filter(_is_mixed, nodes), None)
    if several is None:
        yield lanes, ...
        return
    if isinstance(several.index, Tracer):
        raise InputError(
            "JAX traces which block has which shape, but a program has one shape; "
            "trace each shape by itself, or leave the index out of what is traced"
        )
    shape = broadcast_shapes(*map(np.shape, jax.tree.leaves(lanes)))
    index = np.broadcast_to(np.asarray(several.index), shape)
    kinds, count = np.unique(index), len(several.kinds)
    unknown = kinds[~np.isin(kinds, np.arange(count))]
    if unknown.size:
        raise InputError(
            f"the index of mixed shapes must be one of 0 to {count - 1}, but holds "
            f"{unknown[0]:g}"
        )
    lanes = jax.tree.map(
        lambda leaf: namespace_of(leaf).broadcast_to(leaf, shape), lanes
    )
    for place in kinds.astype(int):
        chosen = ... if len(kinds) == 1 else index == place

        def of_shape(leaf, place=place, chosen=chosen):
            if isinstance(leaf, MixedShapes):
                return leaf.of_kind(place, chosen)
            return leaf[chosen]

        yield jax.tree.map(of_shape, lanes, is_leaf=_is_mixed), chosen


def shape_by_shape(function: Callable, lanes: Any, *further: Any) -> Any:
    """Call a function of blocks once for each shape that they have.

    Args:
        function: called with `lanes` and `further` of the blocks of one shape; gives a
            tree of arrays that begin with the axis of these blocks.
        lanes: as for `each_shape`.
        further: trees of arrays that begin with the shape of the blocks.

    Returns:
        The results, which begin with that shape, in the order of the blocks.

    Raises InputError as `each_shape` does.
    """
    shape = broadcast_shapes(*map(np.shape, jax.tree.leaves(lanes)))
    results: Any = None
    for alone, chosen in each_shape(lanes):
        if chosen is ...:
            return function(alone, *further)
        part = function(
            alone, *jax.tree.map(lambda leaf, chosen=chosen: leaf[chosen], further)
        )

        def put(leaf, whole=None, chosen=chosen):
            """Put results, of NumPy or of JAX, into those of all lanes."""
            xp: Any = np if isinstance(leaf, np.ndarray) else jnp
            if whole is None:
                whole = xp.zeros((*shape, *leaf.shape[1:]), leaf.dtype)
            if xp is jnp:
                return whole.at[chosen].set(leaf)
            whole[chosen] = leaf
            return whole

        results = jax.tree.map(put, part, *([] if results is None else [results]))
    return results


def _is_mixed(leaf) -> bool:
    return isinstance(leaf, MixedShapes)


def _declared(kinds: Sequence[type[AbstractShape]]) -> dict[str, Declared]:
    """Declarations of the parameters of several shapes, each name once; ranges are
    those within which any of them is allowed."""
    merged: dict[str, Declared] = {}
    owner: dict[str, type] = {}
    for kind in kinds:
        for name, said in declared_of(kind).items():
            before = merged.get(name, said)
            if (before.unit, before.column) != (said.unit, said.column):
                raise InputError(
                    f"{owner[name].__name__}.{name} is in {before.unit} (column "
                    f"{before.column}), but {kind.__name__}.{name} in {said.unit} "
                    f"(column {said.column}); rename the one that is yours"
                )
            (low, high), (lower, upper) = before.usual, said.usual
            merged[name] = before._replace(
                range=_hull(before.range, said.range),
                usual=(min(low, lower), max(high, upper)),
            )
            owner.setdefault(name, kind)
    return merged


def _hull(one: str, other: str) -> str:
    if one == other:
        return one
    ends = [[float(end) for end in text[1:-1].split(",")] for text in (one, other)]
    lower, upper = min(e[0] for e in ends), max(e[1] for e in ends)
    texts = list(zip((one, other), ends, strict=True))
    left = "[" if any(t[0] == "[" and e[0] == lower for t, e in texts) else "("
    right = "]" if any(t[-1] == "]" and e[1] == upper for t, e in texts) else ")"
    return f"{left}{lower:g}, {upper:g}{right}"


def _made_again(kinds: tuple[type[AbstractShape], ...], fields: dict) -> MixedShapes:
    return mixed(*kinds)(**fields)

"""Results of impacts as compiled functions of their unknowns, with derivatives by JAX.

A program is compiled for each of few numbers of impacts (`SIZES`). What is missing is
filled with impacts without speed, which end at once.
"""

import functools
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, Protocol

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from ..._types import Structure
from ...accuracy import Accuracy
from ...backend.xla_compilation import unfused_jit
from ...identity import clear_when_edited, heed_edits
from .expressions import Tied

SIZES = tuple(64 * 4**power for power in range(5))
"""Numbers of impacts for which programs are compiled: each takes some 0.2 s, and half a
minute where XLA integrates, which has the first alone."""


class Response(Protocol):
    """How the results of impacts follow from their tree: a scene, or more."""

    def places(self, tree: Any) -> dict[str, int]:
        """Find the leaf of each column that a tree has."""
        ...

    def in_xla(self, structure: Structure, leaves: Sequence) -> bool:
        """Tell whether XLA computes impacts, and not machine code; leaves are arrays
        where impacts differ."""
        ...

    def __call__(
        self, tree: Any, times: Array, accuracy: Accuracy
    ) -> tuple[list[Array], Array]:
        """Compute results of many impacts, arrays (impacts, results): those that are no
        forces, then forces at the times (impacts, times), target by target; and the
        codes of the outcomes."""
        ...


class OwnColumn(NamedTuple):
    """A column of the tree that unknowns set."""

    name: str
    factor: float
    """SI value of one unit of the column."""
    pooled: bool
    """Whether the unknown is the logarithm of a factor on the column."""


class ImpactRows(NamedTuple):
    """What differs between impacts, an array each, impacts first."""

    unknowns: np.ndarray
    """Values of the unknowns that set a column, shape (impacts, columns)."""
    leaves: np.ndarray
    """Leaves that are no constants, shape (impacts, leaves)."""
    times: np.ndarray
    """Times at which forces are wanted, infinite where none is, (impacts, times)."""


class ImpactProgram:
    """Results of impacts that have one structure.

    Args:
        structure: tree of an impact.
        constants: SI values of the leaves; None where impacts differ.
        columns: columns that unknowns set.
        tied: columns that follow from fitted parameters, with the SI value of one unit.
        response: computes the results of an impact.
    """

    def __init__(
        self,
        structure: Structure,
        constants: tuple[float | None, ...],
        columns: tuple[OwnColumn, ...],
        tied: tuple[tuple[Tied, float], ...],
        response: Response,
    ):
        self.structure, self.constants, self.columns = structure, constants, columns
        self.tied, self.response = tied, response
        template = jax.tree.unflatten(structure, [0.0] * len(constants))
        self.places = response.places(template)
        # The speed, too, which is zero in impacts that fill.
        differ = [value is None for value in constants]
        differ[self.places["speed_mps"]] = True
        self.varied = np.flatnonzero(differ)
        unknown = np.full(1, np.nan)
        leaves = [unknown if value is None else value for value in constants]
        self.in_xla = response.in_xla(structure, leaves)
        self._compiled: dict = {}

    def __reduce__(self):
        # Compiled functions stay in their process. A class made at run time, as for
        # several shapes, is pickled with its owner, not with a tree structure.
        template = jax.tree.unflatten(self.structure, [0.0] * len(self.constants))
        return _made_again, (
            template,
            *(self.constants, self.columns, self.tied, self.response),
        )

    def results(
        self, unknowns: Array, leaves: Array, times: Array, accuracy: Accuracy
    ) -> tuple[Array, Array]:
        """Compute results (impacts, results) and codes of the outcomes (impacts,);
        arguments are those of `ImpactRows`."""
        values: list[Any] = list(self.constants)
        for number, place in enumerate(self.varied):
            values[place] = leaves[:, number]
        fitted = {}
        for number, column in enumerate(self.columns):
            if column.pooled:
                values[self.places[column.name]] *= jnp.exp(unknowns[:, number])
                continue
            fitted[column.name] = unknowns[:, number]
            # A parameter of another shape changes nothing.
            if column.name in self.places:
                values[self.places[column.name]] = column.factor * unknowns[:, number]
        for tied, factor in self.tied:
            values[self.places[tied.name]] = factor * tied.evaluate(fitted)
        tree = jax.tree.unflatten(self.structure, values)
        results, outcome = self.response(tree, times, accuracy)
        return jnp.concatenate(results, axis=1), outcome

    def derivatives(
        self, unknowns: Array, leaves: Array, times: Array, accuracy: Accuracy
    ) -> tuple[Array, Array, Array]:
        """Compute as `results`, and the derivatives of each result with respect to the
        unknowns of its impact, shape (impacts, results, columns)."""

        def of_unknowns(unknowns):
            return self.results(unknowns, leaves, times, accuracy)

        results, along, outcome = jax.linearize(of_unknowns, unknowns, has_aux=True)
        columns = jnp.eye(unknowns.shape[1])[:, None] * jnp.ones_like(unknowns)
        return results, outcome, jax.vmap(along, out_axes=2)(columns)

    def run(
        self, rows: ImpactRows, accuracy: Accuracy, *, derivatives: bool
    ) -> list[np.ndarray]:
        """Compute many impacts: results (impacts, results), codes of the outcomes
        (impacts,) and, if wanted, derivatives (impacts, results, columns)."""
        sizes = SIZES[:1] if self.in_xla else SIZES
        compiled = self._of(accuracy, derivatives)
        parts = []
        for first in range(0, len(rows.unknowns), sizes[-1]):
            part = ImpactRows(*(values[first : first + sizes[-1]] for values in rows))
            count = len(part.unknowns)
            size = next(size for size in sizes if size >= count)
            arrays = compiled(*self._filled(part, size))
            parts.append([np.asarray(values)[:count] for values in arrays])
        return [np.concatenate(arrays) for arrays in zip(*parts, strict=True)]

    def _filled(self, rows: ImpactRows, size: int) -> ImpactRows:
        """Append impacts without speed; in XLA, where these take long, others again."""
        count = len(rows.unknowns)
        filled = ImpactRows(
            *(np.resize(values, (size, *values.shape[1:])) for values in rows)
        )
        if self.in_xla:
            return filled
        speed = [column.name == "speed_mps" for column in self.columns]
        filled.unknowns[count:, speed] = 0.0
        filled.leaves[count:, self.varied == self.places["speed_mps"]] = 0.0
        return filled

    def _of(self, accuracy: Accuracy, derivatives: bool) -> Callable:
        # XLA takes so long to compile that one program serves both.
        derivatives |= self.in_xla
        key = accuracy, derivatives
        if key not in self._compiled:
            function = self.derivatives if derivatives else self.results
            of_all = functools.partial(function, accuracy=accuracy)
            if self.in_xla:
                self._compiled[key] = unfused_jit(of_all)
            else:
                # Around the machine code there is little to optimise.
                options = {"xla_backend_optimization_level": "0"}
                self._compiled[key] = jax.jit(of_all, compiler_options=options)
        return self._compiled[key]


@functools.lru_cache(maxsize=64)
def _kept(*arguments) -> ImpactProgram:
    return ImpactProgram(*arguments)


def _made_again(template: Any, *arguments) -> ImpactProgram:
    return _kept(jax.tree.structure(template), *arguments)


clear_when_edited(_kept.cache_clear)


def program_of(
    structure: Structure,
    leaves: np.ndarray,
    columns: Sequence[OwnColumn],
    tied: Sequence[tuple[Tied, float]],
    response: Response,
) -> ImpactProgram:
    """Make a program, or return the one that this process has made of the same.

    Args:
        leaves: leaves of all impacts, shape (leaves, impacts).
    """
    heed_edits(structure)
    same = np.all(leaves == leaves[:, :1], axis=1).tolist()
    first = leaves[:, 0].tolist()
    constants = (value if one else None for value, one in zip(first, same, strict=True))
    return _kept(structure, (*constants,), (*columns,), (*tied,), response)

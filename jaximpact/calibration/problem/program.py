"""Results of impacts as compiled functions of their unknowns, with derivatives by JAX.

A program is compiled for each of few numbers of impacts (`SIZES`). What is missing is
filled with impacts without speed, which end at once.
"""

import functools
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, Protocol

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from ..._types import Structure
from ...accuracy import Accuracy
from ...backend.xla_compilation import unfused_jit
from ...quantities import InputColumn
from .expressions import Tied

SIZES = tuple(64 * 4**power for power in range(5))
"""Numbers of impacts for which programs are compiled: each takes some 0.2 s."""
XLA_SIZES = (256,)
"""The same where XLA integrates: each takes half a minute."""
QUICK = {"xla_backend_optimization_level": "0"}
"""Options of XLA: around the machine code there is little to optimise, and compiling
takes half the time."""


class Response(Protocol):
    """How the results of one impact follow from its tree: a scene, or more."""

    targets: tuple[str, ...]
    """Names of the results."""
    columns: Mapping[str, InputColumn]
    """Columns of the tree."""

    def places(self, tree: Any) -> dict[str, int]:
        """Find the leaf of each column that a tree has."""
        ...

    def by_machine_code(self, structure: Structure) -> bool:
        """Tell whether machine code computes it, and not XLA."""
        ...

    def __call__(self, tree: Any, times: Array, accuracy: Accuracy) -> tuple:
        """Compute the results that are no forces, then forces at the times, target by
        target, and the code of the outcome."""
        ...


class OwnColumn(NamedTuple):
    """A column of the tree that unknowns set."""

    name: str
    factor: float
    """SI value of one unit of the column."""
    pooled: bool
    """Whether the unknown is the logarithm of a factor on the column."""


class Rows(NamedTuple):
    """What differs between impacts, an array each, impacts first."""

    own: np.ndarray
    """Values of the unknowns that set a column, shape (impacts, columns)."""
    leaves: np.ndarray
    """Leaves that are no constants, shape (impacts, leaves)."""
    times: np.ndarray
    """Times at which forces are wanted, infinite where none is, (impacts, times)."""


class Program:
    """Results of impacts that have one structure.

    Args:
        structure: tree of an impact: a scene, or a scene and a law.
        constants: SI values of the leaves, shape (leaves,); NaN where impacts differ.
        places: index of the leaf of each column.
        columns: columns that unknowns set.
        tied: columns that follow from fitted parameters, with the SI value of one unit.
        response: computes the results of an impact.
    """

    def __init__(
        self,
        structure: Structure,
        constants: np.ndarray,
        places: Mapping[str, int],
        columns: Sequence[OwnColumn],
        tied: Sequence[tuple[Tied, float]],
        response: Response,
    ):
        self.structure, self.places, self.tied = structure, places, tied
        self.columns, self.response = columns, response
        self.machine_code = response.by_machine_code(structure)
        self.constants = constants.tolist()
        # The speed, too, which is zero in impacts that fill.
        speed = np.arange(len(constants)) == places["speed_mps"]
        self.varied = np.flatnonzero(np.isnan(constants) | speed)
        self._compiled: dict = {}

    def results(
        self, own: Array, leaves: Array, times: Array, accuracy: Accuracy
    ) -> tuple[Array, Array]:
        """Compute the results of one impact and the code of its outcome; arguments are
        those of one row of `Rows`."""
        values: list[Any] = list(self.constants)
        for number, place in enumerate(self.varied):
            values[place] = leaves[number]
        fitted = {}
        for number, column in enumerate(self.columns):
            place = self.places.get(
                column.name
            )  # of another shape's column there is none
            if column.pooled:
                values[place] = values[place] * jnp.exp(own[number])
                continue
            fitted[column.name] = own[number]
            if place is not None:
                values[place] = column.factor * own[number]
        for tied, factor in self.tied:
            values[self.places[tied.name]] = factor * tied.value_of(fitted)
        return self.response(
            jax.tree.unflatten(self.structure, values), times, accuracy
        )

    def derivatives(
        self, own: Array, leaves: Array, times: Array, accuracy: Accuracy
    ) -> tuple[Array, Array, Array]:
        """Compute as `results`, and the derivatives of the results with respect to
        `own`."""

        def of_own(own):
            found = self.results(own, leaves, times, accuracy)
            return found[0], found

        slopes, found = jax.jacfwd(of_own, has_aux=True)(own)
        return *found, slopes

    def run(
        self, rows: Rows, accuracy: Accuracy, *, derivatives: bool
    ) -> list[np.ndarray]:
        """Compute many impacts: results (impacts, results), codes of the outcomes
        (impacts,) and, if wanted, derivatives (impacts, results, columns)."""
        sizes = SIZES if self.machine_code else XLA_SIZES
        compiled = self._of(accuracy, derivatives)
        parts = []
        for first in range(0, len(rows.own), sizes[-1]):
            part = Rows(*(values[first : first + sizes[-1]] for values in rows))
            count = len(part.own)
            size = next(size for size in sizes if size >= count)
            found = compiled(*self._filled(part, size))
            parts.append([np.asarray(values)[:count] for values in found])
        return [np.concatenate(found) for found in zip(*parts, strict=True)]

    def _filled(self, rows: Rows, size: int) -> Rows:
        """Append impacts without speed."""
        count = len(rows.own)
        filled = Rows(
            *(np.resize(values, (size, *values.shape[1:])) for values in rows)
        )
        speed = [column.name == "speed_mps" for column in self.columns]
        filled.own[count:, speed] = 0.0
        filled.leaves[count:, self.varied == self.places["speed_mps"]] = 0.0
        return filled

    def _of(self, accuracy: Accuracy, derivatives: bool) -> Callable:
        """Return the compiled function of many impacts."""
        # XLA takes so long to compile that one program serves both.
        derivatives |= not self.machine_code
        key = accuracy, derivatives
        if key not in self._compiled:
            of_one = self.derivatives if derivatives else self.results
            of_all = jax.vmap(functools.partial(of_one, accuracy=accuracy))
            if self.machine_code:
                self._compiled[key] = jax.jit(of_all, compiler_options=QUICK)
            else:
                self._compiled[key] = unfused_jit(of_all)
        return self._compiled[key]

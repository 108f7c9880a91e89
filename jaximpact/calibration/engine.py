"""Predictions of all tests for many soils at once, with derivatives.

On a CPU in machine code (`machine.compile_native_along`): one derivative a run, along a
direction of the scene, and as many runs as derivatives are wanted. What has no machine
code, laws of the user's own or another device, is computed by XLA, in programs for a
fixed number of impacts.
"""

import concurrent.futures
import copy
import functools
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np

from ..accuracy import Accuracy
from ..engines.compilation import unfused_jit
from ..engines.machine import (
    compile_native,
    compile_native_along,
    computes_on_cpu,
    solve_rows,
    with_setting,
)
from ..engines.threads import thread_count
from ..engines.xla import compute_lanes
from ..formats.columns import RESULT_COLUMNS
from ..mechanics.problem import Assembly

AT_ONCE = 512
"""Impacts that a thread takes at a time in machine code."""
MANY = 20_000
"""Impacts from which code without a derivative, compiled in a second, pays."""
XLA_AT_ONCE = 256
"""Impacts in a program of XLA: fewer waste time on dispatch, more on waiting for the
slowest."""
OUTCOME = "outcome_code"


class Engine:
    """Computes impacts and their derivatives by columns of the scene.

    Args:
        assembly: of the model.
        targets: result columns that are wanted.
    """

    def __init__(self, assembly: Assembly, targets: tuple[str, ...]):
        self.assembly = assembly
        self.fields = _fields_of(targets)
        self.name = "XLA" if self.kernel is None else "machine code"

    @functools.cached_property
    def kernel(self):
        """Its machine code, None where there is none."""
        if not computes_on_cpu():
            return None
        return compile_native_along(self.assembly)

    def __getstate__(self) -> dict:
        # Machine code belongs to a process; another compiles its own, if it computes.
        state = {name: v for name, v in vars(self).items() if name != "kernel"}
        structure = self.assembly.structure
        # A class that is made as the program runs, as of several shapes, is pickled by
        # what has it, not by a structure.
        state["template"] = jax.tree.unflatten(structure, [0.0] * structure.num_leaves)
        return state | {"assembly": self.assembly._replace(structure=None)}

    def __setstate__(self, state: dict) -> None:
        structure = jax.tree.structure(state.pop("template"))
        vars(self).update(state)
        self.assembly = self.assembly._replace(structure=structure)

    def for_targets(self, targets: tuple[str, ...]) -> "Engine":
        """The same code, for other result columns."""
        other = copy.copy(self)
        other.fields = _fields_of(targets)
        return other

    def run(
        self, leaves: np.ndarray, directions: np.ndarray, accuracy: Accuracy
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Results of impacts, and how they change along a direction.

        Args:
            leaves: of the scenes, `(leaves, impacts)`.
            directions: derivative of the leaves along the direction, likewise.
            accuracy: of the integration.

        Returns:
            Targets and their derivatives `(impacts, targets)`, NaN where there is no
            result, and codes of the outcomes `(impacts,)`.
        """
        count = leaves.shape[1]
        if self.kernel is None:
            size = XLA_AT_ONCE
            parts = [np.arange(i, min(i + size, count)) for i in range(0, count, size)]
            found = [self._in_xla(leaves, directions, p, accuracy) for p in parts]
        else:
            rows = with_setting(leaves, accuracy)
            rows = np.concatenate([rows, directions])
            found = _on_all_cores(
                self._with_derivatives,
                rows,
            )
        values, derivatives = (
            np.concatenate(rows, axis=1) for rows in zip(*found, strict=True)
        )
        return values[:-1].T, derivatives[:-1].T, values[-1]

    def _with_derivatives(self, part: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        numbers, (along,) = solve_rows(self.kernel, part)
        return self._chosen(numbers), self._chosen(along)

    def run_values(
        self, leaves: np.ndarray, accuracy: Accuracy
    ) -> tuple[np.ndarray, np.ndarray]:
        """Results of impacts alone: the same numbers as `run` gives, to the last bit in
        machine code, and where there are many in half the time.

        Returns:
            Targets `(impacts, targets)` and codes of the outcomes `(impacts,)`.
        """
        if self.kernel is None or leaves.shape[1] < MANY:
            values, _, outcomes = self.run(leaves, np.zeros_like(leaves), accuracy)
            return values, outcomes
        kernel = compile_native(self.assembly)
        found = _on_all_cores(
            lambda part: self._chosen(solve_rows(kernel, part)),
            with_setting(leaves, accuracy),
        )
        values = np.concatenate(found, axis=1)
        return values[:-1].T, values[-1]

    def _in_xla(self, leaves, directions, places, accuracy):
        filled = np.resize(places, XLA_AT_ONCE)  # repeats impacts to fill the program
        numbers, derivatives = _in_xla(
            self.assembly,
            jnp.asarray(leaves[:, filled]),
            jnp.asarray(directions[:, filled]),
            jnp.asarray(accuracy.tolerance),
            jnp.asarray(accuracy.floor),
        )
        count = len(places)
        chosen = self._chosen(numbers), self._chosen(derivatives)
        return tuple(rows[:, :count] for rows in chosen)

    def _chosen(self, numbers) -> np.ndarray:
        """The wanted results, a row each."""
        return np.stack([np.asarray(getattr(numbers, name)) for name in self.fields])


def _on_all_cores(work: Callable, rows: np.ndarray) -> list:
    """What the work gives of some of the columns at a time, in their order."""
    count = rows.shape[1]
    size = max(1, min(AT_ONCE, -(-count // thread_count())))
    parts = [rows[:, first : first + size] for first in range(0, count, size)]
    if len(parts) == 1:
        return [work(parts[0])]
    with concurrent.futures.ThreadPoolExecutor(thread_count()) as pool:
        return list(pool.map(work, parts))


def _fields_of(targets: tuple[str, ...]) -> tuple[str, ...]:
    return (*(RESULT_COLUMNS[name].field for name in targets), OUTCOME)


def _along(assembly, leaves, directions, tolerance, floor):
    structure = assembly.structure

    def of_leaves(rows):
        scene = jax.tree.unflatten(structure, list(rows))
        return compute_lanes(assembly, scene, tolerance, floor)

    return jax.jvp(of_leaves, (leaves,), (directions,))


_in_xla = unfused_jit(_along, static_argnums=(0,))

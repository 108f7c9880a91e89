"""Engines: the compiled model that computes impacts with a directional derivative.

On a CPU impacts are computed in machine code (`compile_along_one`): one directional
derivative a run, and as many runs as derivatives are wanted. Laws without machine code,
and other devices, are computed by XLA in programs for a fixed number of impacts.
"""

import concurrent.futures
import copy
import functools
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np

from ...accuracy import Accuracy
from ...backend.native_backend import (
    compile_along_one,
    compile_native,
    computes_on_cpu,
    solve_rows,
    with_setting,
)
from ...backend.threads import thread_count
from ...backend.xla_compilation import unfused_jit
from ...impact.problem import Assembly
from ...quantities import CURVE_COLUMNS, TARGET_COLUMNS, leaf_places
from .derived_targets import ANGLE, WithRate, base_columns, derive
from .force_curves import forces_at

AT_ONCE = 512
"""Impacts of one call of the machine code by a thread."""
MANY = 20_000
"""Impacts from which code without derivatives pays the second of its compilation."""
XLA_AT_ONCE = 256
"""Impacts in a program of XLA: fewer waste time on dispatch, more on waiting for the
slowest impact."""
OUTCOME = "outcome_code"


class Engine:
    """Compiled model that computes result columns of impacts, and their directional
    derivatives."""

    def __init__(self, assembly: Assembly, targets: tuple[str, ...]):
        self.assembly = assembly
        self._set_targets(targets)
        self.name = "XLA" if self.kernel is None else "machine code"
        self.valued = 0
        """Impacts computed without derivatives so far, or announced."""

    @functools.cached_property
    def kernel(self):
        """Machine code of the model; None where there is none."""
        if not computes_on_cpu():
            return None
        return compile_along_one(self.assembly)

    def __getstate__(self) -> dict:
        # Machine code belongs to a process; another one compiles its own.
        state = {name: v for name, v in vars(self).items() if name != "kernel"}
        structure = self.assembly.structure
        # A class made at run time, as for several shapes, is pickled with its owner,
        # not with a tree structure.
        state["template"] = jax.tree.unflatten(structure, [0.0] * structure.num_leaves)
        return state | {"assembly": self.assembly._replace(structure=None)}

    def __setstate__(self, state: dict) -> None:
        structure = jax.tree.structure(state.pop("template"))
        vars(self).update(state)
        self.assembly = self.assembly._replace(structure=structure)

    def for_targets(self, targets: tuple[str, ...]) -> "Engine":
        """Return the same code for other result columns."""
        other = copy.copy(self)
        other._set_targets(targets)
        return other

    def _set_targets(self, targets: tuple[str, ...]) -> None:
        self.targets = targets
        self.curves = [name for name in targets if name in CURVE_COLUMNS]
        self.others = tuple(name for name in targets if name not in CURVE_COLUMNS)
        fields = (TARGET_COLUMNS[name].field for name in base_columns(self.others))
        self.fields = (*fields, OUTCOME)

    def run(
        self, leaves: np.ndarray, directions: np.ndarray, accuracy: Accuracy
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Compute targets of impacts and their derivatives along a direction.

        Args:
            leaves: leaves of the scenes, shape (leaves, impacts); with forces at times
                among the targets a row of these times last, NaN for the others.
            directions: derivatives of the leaves along the direction, the same shape.

        Returns:
            Targets and their derivatives, shape (impacts, targets), NaN where there is
            no result, and codes of the outcomes, shape (impacts,).
        """
        if not self.curves:
            return self._run_others(leaves, directions, accuracy)
        leaves, directions, times = leaves[:-1], directions[:-1], leaves[-1]
        timed, is_curve = np.isfinite(times), np.isin(self.targets, self.curves)
        values = np.full((len(times), len(self.targets)), np.nan)
        derivatives, outcomes = np.zeros_like(values), np.empty(len(times))
        for tests, targets in ((~timed, ~is_curve), (timed, is_curve)):
            if not np.any(tests):
                continue
            rows = leaves[:, tests], directions[:, tests]
            if targets is is_curve:
                given = times[tests], self.curves, accuracy
                found = forces_at(self.assembly.structure, *rows, *given)
            else:
                found = self._run_others(*rows, accuracy)
            cells = np.ix_(tests, targets)
            values[cells], derivatives[cells], outcomes[tests] = found
        return values, derivatives, outcomes

    def _run_others(
        self, leaves: np.ndarray, directions: np.ndarray, accuracy: Accuracy
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Compute what `run` does of targets that are not at times."""
        count = leaves.shape[1]
        if self.kernel is None:
            size = XLA_AT_ONCE
            parts = [np.arange(i, min(i + size, count)) for i in range(0, count, size)]
            found = np.concatenate(
                [self._in_xla(leaves, directions, p, accuracy) for p in parts], axis=-1
            )
        else:
            rows = with_setting(leaves, accuracy)
            rows = np.concatenate([rows, directions])
            order = self._longest_first(leaves)
            found = _on_all_cores(self._with_derivatives, rows, order)
        values, derivatives = found
        base = values[:-1].T, derivatives[:-1].T
        return *self._derived(*base, leaves, directions), values[-1]

    @functools.cached_property
    def places(self) -> dict[str, int]:
        """Index of the leaf of each column of the scene."""
        structure = self.assembly.structure
        template = [0.0] * structure.num_leaves
        return leaf_places(jax.tree.unflatten(structure, template))

    def _derived(self, values, derivatives, leaves, directions):
        """Compute the targets from the results that `base_columns` names."""
        inputs = {
            name: WithRate(leaves[self.places[name]], directions[self.places[name]])
            for name in ("speed_mps", ANGLE, "mass_kg")
        }
        return derive(self.others, values, derivatives, inputs)

    def _longest_first(self, leaves: np.ndarray) -> np.ndarray:
        """Order impacts by the expected length of the contact: one that begins late
        would go on alone."""
        speed, angle, mass = (
            leaves[self.places[name]] for name in ("speed_mps", ANGLE, "mass_kg")
        )
        return np.argsort(speed * np.cos(angle) / mass ** (1 / 6), kind="stable")

    def _with_derivatives(self, part: np.ndarray) -> np.ndarray:
        assert self.kernel is not None
        numbers, (along,) = solve_rows(self.kernel, part)
        return np.stack([self._chosen(numbers), self._chosen(along)])

    def run_values(
        self, leaves: np.ndarray, accuracy: Accuracy, of: int = 0
    ) -> tuple[np.ndarray, np.ndarray]:
        """Compute results of impacts without derivatives.

        In machine code the numbers are those of `run` bit for bit, and many impacts
        take half the time.

        Args:
            of: number of impacts of all calls to come, if it is known.

        Returns:
            Targets, shape (impacts, targets), and codes of the outcomes (impacts,).
        """
        self.valued = max(of, self.valued + leaves.shape[1])
        if self.kernel is None or self.curves or self.valued < MANY:
            values, _, outcomes = self.run(leaves, np.zeros_like(leaves), accuracy)
            return values, outcomes
        kernel = compile_native(self.assembly)
        found = _on_all_cores(
            lambda part: self._chosen(solve_rows(kernel, part)),
            with_setting(leaves, accuracy),
            self._longest_first(leaves),
        )
        outcomes, values = found[-1], found[:-1].T
        nothing, still = np.zeros_like(values), np.zeros_like(leaves)
        return self._derived(values, nothing, leaves, still)[0], outcomes

    def _in_xla(self, leaves, directions, places, accuracy) -> np.ndarray:
        """Compute the wanted results and their derivatives of the impacts at some
        places, shape (2, results, places)."""
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
        return np.stack(chosen)[..., :count]

    def _chosen(self, numbers) -> np.ndarray:
        """Select the wanted results, a row each."""
        return np.stack([np.asarray(getattr(numbers, name)) for name in self.fields])


def _on_all_cores(work: Callable, rows: np.ndarray, order: np.ndarray) -> np.ndarray:
    """Call a function of blocks of columns on all cores, in an order that is given;
    results, along the last axis, stand in the order of the columns."""
    rows, count = rows[:, order], rows.shape[1]
    size = max(1, min(AT_ONCE, -(-count // thread_count())))
    parts = [rows[:, first : first + size] for first in range(0, count, size)]
    if len(parts) == 1:
        found = work(parts[0])
    else:
        with concurrent.futures.ThreadPoolExecutor(thread_count()) as pool:
            found = np.concatenate(list(pool.map(work, parts)), axis=-1)
    return found[..., np.argsort(order)]


def _along(assembly, leaves, directions, tolerance, floor):
    from ...backend.xla_backend import compute_lanes  # loads diffrax

    structure = assembly.structure

    def of_leaves(rows):
        scene = jax.tree.unflatten(structure, list(rows))
        return compute_lanes(assembly, scene, tolerance, floor)

    return jax.jvp(of_leaves, (leaves,), (directions,))


_in_xla = unfused_jit(_along, static_argnums=(0,))

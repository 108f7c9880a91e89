"""The compiled step: one of optimistix' Levenberg-Marquardt, for several fits at once.

Each fit is a lane. Lanes are stepped in groups of a fixed size, so that there is one
program, and those that have come to an end are left out. One step from a fresh lane
evaluates residuals and Jacobian at its z, so nothing else need be compiled.
"""

import concurrent.futures
import os
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import optimistix as optx
from jaxtyping import Array, Float

from ..compilation import unfused_jit
from .residuals import Case, Program, Residuals, function_of_reals
from .transforms import Parameters

IMPACTS_AT_ONCE = 256
"""Impacts, tests times lanes, in a group: fewer waste time on dispatch, more on waiting
for the slowest."""
TOLERANCE = 1e-6
"""Of z and of the residuals, absolute and relative, at which a fit has converged."""
SOLVER = optx.LevenbergMarquardt(rtol=TOLERANCE, atol=TOLERANCE)
# "bwd" makes the solver keep the Jacobian as a matrix. Ours is made forward all the
# same, see `function_of_reals`; what runs backward is a product with that matrix.
OPTIONS = {"jac": "bwd"}


class Lane(NamedTuple):
    """One fit under way; with a leading axis, several."""

    z: Parameters
    free: Parameters
    """1 where a parameter is fitted, 0 where it is held at that of `anchor`."""
    anchor: Parameters
    state: Any
    """Of the solver."""

    @property
    def residuals(self) -> Float[Array, "*lanes residuals"]:
        """At z."""
        return self.state.f_info.residual

    @property
    def failed(self) -> Float[Array, "*lanes residuals"]:
        """At z, 1 where there is no prediction."""
        return self.state.aux

    @property
    def jacobian(self) -> Float[Array, "*lanes residuals parameters"]:
        """Of the residuals by z."""
        return self.state.f_info.jac.pytree

    @property
    def cost(self) -> np.ndarray:
        """Half the sum of squared residuals at z."""
        return 0.5 * np.sum(np.asarray(self.residuals) ** 2, axis=-1)


def fresh_lanes(case: Case, z, free=None, anchor=None) -> Lane:
    """Lanes at the start: `z` is `(lanes, parameters)`, as `free` and `anchor` are."""
    z = jnp.asarray(z, float)
    free = jnp.ones_like(z) if free is None else jnp.asarray(free, float)
    anchor = z if anchor is None else jnp.asarray(anchor, float)
    count = case.measured.size

    def shapes_only(z, arguments):
        nothing = jnp.zeros(count) + 0.0 * jnp.sum(z)
        return nothing, nothing

    struct = jax.ShapeDtypeStruct((count,), z.dtype)

    def of_lane(z, free, anchor):
        state = SOLVER.init(
            shapes_only, z, (free, anchor), OPTIONS, struct, struct, frozenset()
        )
        return Lane(z, free, anchor, state)

    return jax.vmap(of_lane)(z, free, anchor)


def _step(program: Program, case: Case, lanes: Lane) -> Lane:
    function = function_of_reals(program, case)

    def for_solver(z, arguments):
        out: Residuals = function(z, *arguments)
        return out.values, out.failed

    def of_lane(lane: Lane) -> Lane:
        arguments = (lane.free, lane.anchor)
        z, state, _ = SOLVER.step(
            for_solver, lane.z, arguments, OPTIONS, lane.state, frozenset()
        )
        return lane._replace(z=z, state=state)

    return jax.vmap(of_lane)(lanes)


_compiled_step = unfused_jit(_step, static_argnums=(0,))


class Stepper:
    """Steps lanes of one case, on every core."""

    def __init__(self, program: Program, case: Case, lanes: int):
        """`lanes` is how many are wanted at once; a group is no larger."""
        self.program, self.case = program, case
        self.group = max(1, min(lanes, IMPACTS_AT_ONCE // len(case.measured)))
        self.compiled = False

    def step(self, lanes: Lane) -> Lane:
        """All lanes, one step on."""
        count = len(lanes.z)
        groups = [
            np.arange(i, min(i + self.group, count))
            for i in range(0, count, self.group)
        ]
        done = []
        if not self.compiled:  # threads would compile it once each
            done.append(self._step_group(lanes, groups.pop(0)))
            self.compiled = True
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count() or 1) as pool:
            done += pool.map(lambda group: self._step_group(lanes, group), groups)
        return jax.tree.map(lambda *parts: np.concatenate(parts), *done)

    def _step_group(self, lanes: Lane, chosen: np.ndarray) -> Lane:
        filled = np.resize(chosen, self.group)  # repeats lanes to fill the group
        group = jax.tree.map(lambda leaf: jnp.asarray(np.asarray(leaf)[filled]), lanes)
        after = _compiled_step(self.program, self.case, group)
        return jax.tree.map(lambda leaf: np.asarray(leaf)[: len(chosen)], after)


def take(lanes: Lane, chosen) -> Lane:
    """Some of the lanes, or one."""
    return jax.tree.map(lambda leaf: np.asarray(leaf)[chosen], lanes)


def put(lanes: Lane, chosen, values: Lane) -> Lane:
    """The lanes with some of them replaced."""

    def replaced(old, new):
        old = np.array(old)
        old[chosen] = new
        return old

    return jax.tree.map(replaced, lanes, values)

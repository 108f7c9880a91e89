"""Lane functions: an impact as functions in JAX from which machine code is made.

They are imported only to compile: code that is kept on disk runs without them.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool

from .._settings import collector_paused
from ..impact.problem import Assembly
from ..impact.results import History, ImpactSummary
from ..impact.specialize import depends
from ..integrator.accumulators import cut
from ..integrator.batched import (
    Lanes,
    accepted_step,
    sample_lanes,
    start_lanes,
    step_lanes,
)
from ..integrator.summarise import summarise_lanes
from .simd import (
    MOST_DIRECTIONS,
    Code,
    Derivatives,
    LaneFunctions,
    Mode,
    Reverse,
    compile_code,
    compile_reverse,
)


@collector_paused()
def code_of_lanes(
    assembly: Assembly, mode: Mode, sampled: bool, thorough: bool = False
) -> Code:
    """Compile the code of `native_backend.compile_native`; `thorough` as for
    `compile_code`."""
    one = jax.ShapeDtypeStruct((1,), float)
    leaves = assembly.structure.num_leaves
    # Scene, tolerance and floor
    inputs = jax.tree.unflatten(assembly.structure, [one] * leaves), one, one
    lanes = _Lanes(assembly, sampled)
    sampling = (lanes.sample, _time_of) if sampled else ()
    functions = LaneFunctions(lanes.begin, lanes.step, lanes.finish, *sampling)
    if mode == Mode.VALUES:
        return compile_code(functions, inputs, None, thorough)
    changing = _changing(lanes, inputs, leaves)
    if mode == Mode.FORWARD:
        derivatives = Derivatives(MOST_DIRECTIONS, range(leaves), changing)
        return compile_code(functions, inputs, derivatives, thorough)
    reverse = Reverse(range(leaves), changing, accepted_step, _accepted_of)
    return compile_reverse(functions, inputs, reverse, thorough)


def _time_of(lanes: Lanes):
    return lanes.time


def _accepted_of(lanes: Lanes):
    return lanes.accepted


class _Lanes(NamedTuple):
    assembly: Assembly
    sampled: bool

    def begin(self, inputs) -> Lanes:
        scenes, tolerance, floor = inputs
        return start_lanes(self.assembly, scenes, tolerance[0], floor[0], self.sampled)

    def step(self, lanes: Lanes) -> tuple[Lanes, Bool[Array, " lanes"]]:
        lanes = step_lanes(lanes)
        return lanes, lanes.going

    def finish(self, inputs, lanes: Lanes) -> ImpactSummary:
        return summarise_lanes(inputs[0], lanes)

    def sample(self, lanes: Lanes, times) -> History:
        return sample_lanes(lanes, times)


def _changing(lanes: _Lanes, inputs, leaves: int) -> list[int]:
    """Return the leaves of lanes that change with any of the first leaves of their
    inputs, those of the scene, in their state or, as constants, from the start."""
    traced, at_start = jax.make_jaxpr(lanes.begin, return_shape=True)(inputs)
    of_inputs = [place < leaves for place in range(len(traced.in_avals))]
    from_start = depends(traced.jaxpr, of_inputs)
    # What is cut from differentiation has no rows of derivatives.
    uncut = at_start.state._replace(fold=cut(at_start.state.fold, lambda _: None))
    state = {id(leaf) for leaf in jax.tree.leaves(uncut)}
    constants = {id(leaf) for leaf in jax.tree.leaves(at_start.problem)}
    return [
        i
        for i, leaf in enumerate(jax.tree.leaves(at_start))
        if jnp.issubdtype(leaf.dtype, jnp.inexact)
        and (id(leaf) in state or (id(leaf) in constants and from_start[i]))
    ]

"""Lane functions: an impact, and its derivatives along directions, as functions in JAX
from which machine code is made.

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
from ..integrator.batched import Lanes, sample_lanes, start_lanes, step_lanes
from ..integrator.summarise import summarise_lanes
from .simd import Code, LaneFunctions, compile_code, without_copies


@collector_paused()
def code_of_lanes(assembly: Assembly, directions: int, sampled: bool) -> Code:
    """Compile the code of `native_backend.compile_native`, with derivatives along so
    many directions."""
    one = jax.ShapeDtypeStruct((1,), float)
    leaves = assembly.structure.num_leaves
    # Scene, tolerance and floor
    inputs = jax.tree.unflatten(assembly.structure, [one] * leaves), one, one
    lanes = _Lanes(assembly, sampled)
    sampling = (lanes.sample, _time_of) if sampled else ()
    if not directions:
        functions = without_copies(lanes.begin, lanes.step, lanes.finish, *sampling)
        return compile_code(functions, inputs)
    along = _Along(lanes, inputs)
    sampling = (along.sample, _time_of) if sampled else ()
    functions = LaneFunctions(along.begin, along.step, along.finish, *sampling)
    return compile_code(functions, inputs, [one] * (leaves + sampled), directions)


def _time_of(lanes: Lanes):
    return lanes.time


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


class _Along:
    """Functions of lanes that integrate impacts and their derivatives along a
    direction.

    Those leaves of the lanes are differentiated that change with any leaf of a scene.
    A direction is a list: a number for each leaf of the scene, and where lanes are
    sampled one for the times asked for. A slope is a list too, of what changes in the
    lanes, and ends with that number.
    """

    def __init__(self, lanes: _Lanes, inputs):
        self.lanes = lanes
        self.varied = list(range(lanes.assembly.structure.num_leaves))
        traced, at_start = jax.make_jaxpr(lanes.begin, return_shape=True)(inputs)
        places = (_changing(traced, at_start, place) for place in self.varied)
        self.changing = sorted(set().union(*places))

    def begin(self, inputs, direction):
        def of_leaves(*values):
            lanes = self.lanes.begin(_with_leaves(inputs, self.varied, values))
            return _leaves(lanes, self.changing), lanes

        count = len(self.varied)
        _, slope, lanes = jax.jvp(
            of_leaves, _leaves(inputs, self.varied), direction[:count], has_aux=True
        )
        return lanes, [*slope, *direction[count:]]

    def step(self, lanes, slope):
        def of_changing(*values):
            after, going = self.lanes.step(_with_leaves(lanes, self.changing, values))
            return _leaves(after, self.changing), (after, going)

        count = len(self.changing)
        _, after_slope, (after, going) = jax.jvp(
            of_changing, _leaves(lanes, self.changing), slope[:count], has_aux=True
        )
        return after, [*after_slope, *slope[count:]], going

    def sample(self, lanes, slope, times):
        def of_changing(*values_and_times):
            *values, times = values_and_times
            lanes_then = _with_leaves(lanes, self.changing, values)
            return self.lanes.sample(lanes_then, times)

        return jax.jvp(
            of_changing, (*_leaves(lanes, self.changing), times), tuple(slope)
        )

    def finish(self, inputs, direction, lanes, slope):
        count = len(self.varied)

        def of_both(*values):
            return self.lanes.finish(
                _with_leaves(inputs, self.varied, values[:count]),
                _with_leaves(lanes, self.changing, values[count:]),
            )

        values = _leaves(inputs, self.varied) + _leaves(lanes, self.changing)
        slopes = [*direction[:count], *slope[: len(self.changing)]]
        return jax.jvp(of_both, values, slopes)


def _changing(traced, lanes: Lanes, place: int) -> list[int]:
    """Return the leaves of lanes that change with a leaf of their inputs, in their
    state or, as constants, from the start."""
    varied = [i == place for i in range(len(traced.in_avals))]
    from_start = depends(traced.jaxpr, varied)
    state = {id(leaf) for leaf in jax.tree.leaves(lanes.state)}
    constants = {id(leaf) for leaf in jax.tree.leaves(lanes.problem)}
    return [
        i
        for i, leaf in enumerate(jax.tree.leaves(lanes))
        if jnp.issubdtype(leaf.dtype, jnp.inexact)
        and (id(leaf) in state or (id(leaf) in constants and from_start[i]))
    ]


def _leaves(tree, places: list[int]) -> list[Array]:
    leaves = jax.tree.leaves(tree)
    return [leaves[place] for place in places]


def _with_leaves(tree, places: list[int], values):
    leaves, structure = jax.tree.flatten(tree)
    for place, value in zip(places, values, strict=True):
        leaves[place] = value
    return jax.tree.unflatten(structure, leaves)

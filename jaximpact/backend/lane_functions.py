"""Lane functions: an impact, and its derivatives along directions, as functions in JAX
from which machine code is made.

They are imported only to compile: code that is kept on disk runs without them.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool

from .._gc_pause import collector_paused
from ..impact.history import History
from ..impact.problem import Assembly
from ..impact.specialize import depends
from ..impact.summary import ImpactSummary
from ..integrator.batched import Lanes, sample_lanes, start_lanes, step_lanes
from ..integrator.summarise import summarise_lanes
from .simd import Code, LaneFunctions, compile_code


@collector_paused()
def code_of_values(assembly: Assembly, sampled: bool) -> Code:
    """Compile the code of `native_backend.compile_native`."""
    lanes = _Lanes(assembly, sampled)
    functions = LaneFunctions(
        lambda inputs, _: (lanes.begin(inputs), ()),
        lambda state, _: _nothing_own(*lanes.step(state)),
        lambda inputs, _, state, __: (lanes.finish(inputs, state), ()),
        *(lambda state, _, time: (lanes.sample(state, time), ()), _time_of) * sampled,
    )
    return compile_code(functions, _inputs(assembly))


@collector_paused()
def code_of_derivatives(assembly: Assembly, directions: int, sampled: bool) -> Code:
    """Compile the code of `native_backend.compile_native_along`."""
    inputs = _inputs(assembly)
    lanes = _Along(assembly, inputs, sampled)
    functions = LaneFunctions(
        lanes.begin, lanes.step, lanes.finish, *(lanes.sample, _time_of) * sampled
    )
    direction = [inputs[1]] * (assembly.structure.num_leaves + sampled)
    return compile_code(functions, inputs, direction, directions)


def _nothing_own(state, going):
    return state, (), going


def _time_of(lanes: Lanes):
    return lanes.time


def _inputs(assembly: Assembly):
    """Placeholders for the scene, tolerance and floor of one lane."""
    one = jax.ShapeDtypeStruct((1,), float)
    scenes = jax.tree.unflatten(
        assembly.structure, [one] * assembly.structure.num_leaves
    )
    return scenes, one, one


class _Lanes(NamedTuple):
    """Functions of lanes that integrate impacts."""

    assembly: Assembly
    sampled: bool = False

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
    """

    def __init__(self, assembly: Assembly, inputs, sampled: bool = False):
        self.lanes = _Lanes(assembly, sampled)
        self.varied = list(range(assembly.structure.num_leaves))
        traced, lanes = jax.make_jaxpr(self.lanes.begin, return_shape=True)(inputs)
        places = (_changing(traced, lanes, place) for place in self.varied)
        self.changing = sorted(set().union(*places))

    def begin(self, inputs, direction):
        def of_leaves(*values):
            lanes = self.lanes.begin(_with_leaves(inputs, self.varied, values))
            return _leaves(lanes, self.changing), lanes

        by_leaves, by_time = self._split(direction, self.varied)
        _, slope, lanes = jax.jvp(
            of_leaves, _leaves(inputs, self.varied), by_leaves, has_aux=True
        )
        return lanes, [*slope, *by_time]

    def _split(self, derivatives, places: list[int]):
        """Split derivatives into those of leaves, and that of the times asked for."""
        return list(derivatives[: len(places)]), list(derivatives[len(places) :])

    def step(self, lanes, slope):
        def of_changing(*values):
            after, going = self.lanes.step(_with_leaves(lanes, self.changing, values))
            return _leaves(after, self.changing), (after, going)

        slope, by_time = self._split(slope, self.changing)
        _, slope, (after, going) = jax.jvp(
            of_changing, _leaves(lanes, self.changing), slope, has_aux=True
        )
        return after, [*slope, *by_time], going

    def sample(self, lanes, slope, times):
        def of_changing(times, *values):
            lanes_then = _with_leaves(lanes, self.changing, values)
            return self.lanes.sample(lanes_then, times)

        slope, by_time = self._split(slope, self.changing)
        values = times, *_leaves(lanes, self.changing)
        return jax.jvp(of_changing, values, (*by_time, *slope))

    def finish(self, inputs, direction, lanes, slope):
        count = len(self.varied)
        direction, _ = self._split(direction, self.varied)
        slope, _ = self._split(slope, self.changing)

        def of_both(*values):
            return self.lanes.finish(
                _with_leaves(inputs, self.varied, values[:count]),
                _with_leaves(lanes, self.changing, values[count:]),
            )

        values = _leaves(inputs, self.varied) + _leaves(lanes, self.changing)
        return jax.jvp(of_both, values, [*direction, *slope])


def _changing(traced, lanes: Lanes, place: int) -> list[int]:
    """Leaves of lanes that change with a leaf of their inputs, in their course or, as
    constants, from the start."""
    varied = [i == place for i in range(len(traced.in_avals))]
    from_start = depends(traced.jaxpr, varied)
    course = {id(leaf) for leaf in jax.tree.leaves(lanes.course)}
    constants = {id(leaf) for leaf in jax.tree.leaves(lanes.problem)}
    return [
        i
        for i, leaf in enumerate(jax.tree.leaves(lanes))
        if jnp.issubdtype(leaf.dtype, jnp.inexact)
        and (id(leaf) in course or (id(leaf) in constants and from_start[i]))
    ]


def _leaves(tree, places: list[int]) -> list[Array]:
    leaves = jax.tree.leaves(tree)
    return [leaves[place] for place in places]


def _with_leaves(tree, places: list[int], values):
    """The tree with other values of some leaves."""
    leaves, structure = jax.tree.flatten(tree)
    for place, value in zip(places, values, strict=True):
        leaves[place] = value
    return jax.tree.unflatten(structure, leaves)

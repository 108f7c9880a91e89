"""The XLA backend: for devices other than a CPU, for laws without machine code, and as
an independent check.

A single impact is integrated by diffrax. Of a batch a worker marches many lanes some
steps at a time: lanes that have ended change places with such as wait at their start;
once all that waited have ended their results are worked out together.
"""

import functools
import math
import threading
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import diffrax
import jax
import jax.numpy as jnp
import numpy as np
from diffrax import AbstractAdaptiveSolver

from .._jax_internals import broadcast_shapes
from .._types import Device
from ..accuracy import MAX_STEPS, Accuracy
from ..identity import clear_when_edited, tracing
from ..impact.problem import Assembly, assemble, pose
from ..impact.results import History, ImpactSummary, Solution, history_at
from ..integrator.batched import Lanes, march, march_and_sample, start_lanes
from ..integrator.diffrax_solvers import require_derivatives
from ..integrator.single import diffrax_arguments, integrate
from ..integrator.summarise import summarise, summarise_lanes
from ..scene import Scene
from .threads import thread_count
from .xla_compilation import compile_unfused, unfused_jit


def compute(
    assembly: Assembly,
    scene: Scene,
    tolerance,
    floor,
    solver: AbstractAdaptiveSolver | None = None,
) -> ImpactSummary:
    """Compute one impact; pure, differentiable in forward mode.

    Args:
        solver: solver of an `Engine`.
    """
    problem, vector = pose(scene, assembly, tolerance, floor)
    return summarise(scene, problem, integrate(problem, vector, solver))


def compute_lanes(assembly: Assembly, scenes: Scene, tolerance, floor) -> ImpactSummary:
    """Compute many impacts side by side, until the slowest ends; scene fields have
    shape (lanes,).

    Pure, differentiable in forward mode.
    """
    lanes = march(start_lanes(assembly, scenes, tolerance, floor))
    return summarise_lanes(scenes, lanes)


def compute_at(
    assembly: Assembly, scene: Scene, tolerance, floor, times
) -> tuple[ImpactSummary, History]:
    """Compute one impact, and its samples at times, NaN after its end.

    Pure, differentiable in forward mode.
    """
    scenes = jax.tree.map(lambda leaf: jnp.reshape(leaf, (1,)), scene)
    lanes = start_lanes(assembly, scenes, tolerance, floor, sampled=True)
    lanes, samples = march_and_sample(lanes, times)
    numbers = summarise_lanes(scenes, lanes)
    return jax.tree.map(lambda x: x[0], numbers), samples


def _compute_leaves(assembly, varied, solver, leaves, tolerance, floor, times):
    def of_varied(values):
        with_delay = [*leaves, 0.0]
        for place, value in zip(varied, values, strict=True):
            with_delay[place] = value
        *all_leaves, delay = with_delay
        scene = jax.tree.unflatten(assembly.structure, all_leaves)
        if times is None:
            solution = compute(assembly, scene, tolerance, floor, solver), None
        else:
            solution = compute_at(assembly, scene, tolerance, floor, times + delay)
        parts = [
            jnp.stack(jax.tree.leaves(part)) for part in solution if part is not None
        ]
        return parts, Solution(*solution)

    values = [(*leaves, 0.0)[place] for place in varied]
    if not varied:
        return of_varied(values)[1]
    columns, solution = jax.jacfwd(of_varied, has_aux=True)(values)
    return solution, list(zip(*columns, strict=True))


_compiled = unfused_jit(_compute_leaves, static_argnums=(0, 1, 2))


def in_xla(assembly, varied: tuple[int, ...], solver, leaves, tolerance, floor, times):
    """Compute a solution; with leaves in `varied` also the derivatives of all results
    and samples with respect to each.

    Leaves, and the leading axes of the times, broadcast to the shape of the results.

    Raises InputError for derivatives through a solver that gives none.
    """
    if varied:
        require_derivatives(solver)

    def of_lane(row, times):
        return _compiled(assembly, varied, solver, row, tolerance, floor, times)

    own = () if times is None else np.shape(times)[:-1]
    shape = broadcast_shapes(own, *map(np.shape, leaves))
    if not shape:
        return of_lane(leaves, times)
    lanes = math.prod(shape)
    rows = [jnp.broadcast_to(leaf, shape).reshape(lanes) for leaf in leaves]
    if times is not None:
        series = np.shape(times)[-1:]
        times = jnp.broadcast_to(times, shape + series).reshape(lanes, *series)
    found = jax.vmap(of_lane)(rows, times)

    def with_lanes(x, axis):
        return x.reshape(*x.shape[:axis], *shape, *x.shape[axis + 1 :])

    if not varied:
        return jax.tree.map(lambda x: with_lanes(x, 0), found)
    solution, columns = found
    columns = jax.tree.map(lambda x: with_lanes(jnp.moveaxis(x, 0, 1), 1), columns)
    return jax.tree.map(lambda x: with_lanes(x, 0), solution), columns


USUAL_STEPS = 20_000
"""Steps for which memory is reserved at first; all of `MAX_STEPS` take 200 MB."""


def _record(assembly, room, solver, scene, tolerance, floor):
    problem, vector = pose(scene, assembly, tolerance, floor)
    solution = diffrax.diffeqsolve(
        **diffrax_arguments(problem, vector, solver) | {"max_steps": room},
        saveat=diffrax.SaveAt(t0=True, steps=True),
    )
    courses: Any = solution.ys
    rows = jax.vmap(history_at, in_axes=(None, 0, 0, 0))(
        problem, solution.ts, courses.vector, courses.fold.work
    )
    full = solution.result == diffrax.RESULTS.max_steps_reached
    return rows, solution.stats["num_accepted_steps"], full


_record_compiled = unfused_jit(_record, static_argnums=(0, 1, 2))


def record_by_xla(scene: Scene, accuracy: Accuracy, solver) -> History:
    """Record the history that `derivative_rules.solve_recorded` gives."""
    for room in (USUAL_STEPS, MAX_STEPS):
        rows, steps, full = _record_compiled(
            assemble(scene),
            room,
            solver,
            scene,
            jnp.asarray(accuracy.tolerance),
            jnp.asarray(accuracy.floor),
        )
        if not full:
            break
    count = min(int(steps) + 1, room)
    return jax.tree.map(lambda series: np.asarray(series)[:count], rows)


WIDTH, SMALL_WIDTH = 512, 32
"""Impacts that a worker integrates side by side: fewer waste time on dispatch, more on
memory. Up to 32 impacts a core take the small program, whose steps are shorter."""
WIDTH_OF_ACCELERATOR = 32_768
"""Impacts that a worker integrates side by side on a GPU, which has that many threads;
not measured."""
STEPS = 16
"""Steps between two looks at which lanes have ended."""


class Programs(NamedTuple):
    """Programs of a worker, compiled for one width."""

    width: int
    start: Callable[..., Lanes]
    """Function from scenes, tolerance and floor."""
    march: Callable[[Lanes], Lanes]
    exchange: Callable[..., tuple[Lanes, Lanes]]
    """Permutes the lanes of two sets: `(going, waiting, order)`."""
    finish: Callable[[Scene, Lanes], ImpactSummary]


@functools.lru_cache(maxsize=64)
@tracing()
def compile_programs(assembly: Assembly, width: int, device: Device) -> Programs:
    """Compile the programs of an assembly of the model."""
    on_device = jax.sharding.SingleDeviceSharding(device)

    def start(scenes, tolerance, floor):
        return start_lanes(assembly, scenes, tolerance, floor)

    def exchange(going, waiting, order):
        both = jax.tree.map(
            lambda a, b: jnp.take(jnp.concatenate([a, b], -1), order, -1),
            going,
            waiting,
        )
        return (
            jax.tree.map(lambda x: x[..., :width], both),
            jax.tree.map(lambda x: x[..., width:], both),
        )

    def there(shapes):
        return jax.tree.map(
            lambda x: jax.ShapeDtypeStruct(x.shape, x.dtype, sharding=on_device), shapes
        )

    scenes = there(
        jax.tree.unflatten(
            assembly.structure,
            [jax.ShapeDtypeStruct((width,), float)] * assembly.structure.num_leaves,
        )
    )
    lanes = there(jax.eval_shape(start, scenes, 1.0, 1.0))
    order = there(jax.ShapeDtypeStruct((2 * width,), int))
    return Programs(
        width,
        compile_unfused(start, scenes, 1.0, 1.0),
        compile_unfused(lambda lanes: march(lanes, STEPS), lanes),
        compile_unfused(exchange, lanes, lanes, order),
        compile_unfused(summarise_lanes, scenes, lanes),
    )


clear_when_edited(compile_programs.cache_clear)


class Part(NamedTuple):
    """Scenes that wait to be integrated, or have been, with the lanes they took."""

    places: np.ndarray
    """Place of each lane in the batch; -1 for a lane that only fills up."""
    scenes: Scene
    lanes: Lanes


class MarchingWorker:
    """A worker that integrates parts of a batch, as it gets them, in XLA's programs."""

    engine = "XLA"

    def __init__(self, programs: Programs, scene: Scene, accuracy: Accuracy):
        self.programs, self.scene, self.accuracy = programs, scene, accuracy
        self.part = programs.width

    def start(self, places: np.ndarray) -> Part:
        """Make a part at its start, filled up with copies of its scenes, which do not
        count."""
        width = self.programs.width
        filled = np.resize(places, width)
        scenes = jax.tree.map(lambda leaf: np.asarray(leaf[filled]), self.scene)
        setting = self.accuracy
        lanes = self.programs.start(scenes, setting.tolerance, setting.floor)
        counted = np.where(np.arange(width) < len(places), filled, -1)
        return Part(counted, scenes, lanes)

    def finish(self, part: Part) -> tuple[np.ndarray, ImpactSummary]:
        """Return places and results of a part none of whose lanes is going."""
        numbers = self.programs.finish(part.scenes, part.lanes)
        counted = part.places >= 0
        return part.places[counted], jax.tree.map(
            lambda x: np.asarray(x)[counted], numbers
        )

    def run(
        self, parts: Iterator[np.ndarray], stop: threading.Event
    ) -> Iterator[tuple[np.ndarray, ImpactSummary]]:
        """Return the results of the parts, in the order in which lanes come to their
        ends."""
        first = next(parts, None)
        if first is None:
            return
        going, waiting = self.start(first), None
        width = self.programs.width
        fresh = np.zeros(width, bool)  # lanes of `waiting` that are still to be run
        while not stop.is_set():
            lanes = self.programs.march(going.lanes)
            going = going._replace(lanes=lanes)
            ended = ~np.asarray(lanes.going)
            if waiting is None:
                if np.all(ended):
                    yield self.finish(going)
                    return
                if np.sum(ended) < width // 8:
                    continue
                places = next(parts, None)
                if places is None:
                    continue
                waiting = self.start(places)
                fresh = waiting.places >= 0
            leave, enter = np.flatnonzero(ended), np.flatnonzero(fresh)
            count = min(len(leave), len(enter))
            if count:
                going, waiting = self._swap(
                    going, waiting, leave[:count], enter[:count]
                )
                fresh[enter[:count]] = False
            if not np.any(fresh):
                yield self.finish(waiting)
                waiting = None

    def _swap(self, going: Part, waiting: Part, leave, enter) -> tuple[Part, Part]:
        width = self.programs.width
        order = np.arange(2 * width)
        order[leave], order[width + enter] = width + enter, leave
        lanes = self.programs.exchange(going.lanes, waiting.lanes, order)

        places, scenes = jax.tree.map(
            lambda a, b: np.concatenate([a, b])[order], going[:2], waiting[:2]
        )
        halves = slice(width), slice(width, None)
        going, waiting = (
            Part(places[half], jax.tree.map(lambda x, half=half: x[half], scenes), own)
            for half, own in zip(halves, lanes, strict=True)
        )
        return going, waiting


def worker_devices() -> list[Device]:
    """List the device of each worker: a processor has one a core, of several devices
    each has one."""
    devices = jax.local_devices()
    if len(devices) == 1 and devices[0].platform == "cpu":
        return devices * thread_count()
    return devices


def lanes_of_worker(count: int, devices: list[Device]) -> int:
    """Return the lanes of each worker's programs, for so many scenes in all."""
    small = count <= SMALL_WIDTH * len(devices)
    wide = WIDTH if devices[0].platform == "cpu" else WIDTH_OF_ACCELERATOR
    return SMALL_WIDTH if small else wide

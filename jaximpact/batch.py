"""Many impacts: the same model over arrays of scenes, on every core.

Each worker keeps so many lanes going, and a lane that has ended gives its place to the
next scene, so that no lane waits for the slowest. With llvmlite on a CPU lanes run in
machine code of our own (`native`). Otherwise XLA's programs march them some steps at a
time; lanes that have ended change places with such as wait at their start, and once all
that waited have ended their results are worked out together.
"""

import concurrent.futures
import contextlib
import functools
import os
import threading
import time
from collections.abc import Callable, Iterator
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from .accuracy import DEFAULT_ACCURACY, Accuracy, get_accuracy
from .block import Block
from .checks import check_scene
from .compilation import compile_unfused
from .lanes import Lanes, march, start_lanes, step_lanes
from .laws import Laws
from .model import MODELS, Model, model_places
from .native import Kernel, compile_kernel, is_available
from .precision import require_float64
from .problem import Assembly
from .scene import Impact, Scene
from .simulation import ImpactResult, Numbers, summarise_lanes
from .soil import Soil

WIDTH, SMALL_WIDTH = 512, 32
"""Impacts that a worker integrates side by side: fewer waste time on dispatch, more on
memory. Up to 32 impacts a core take the small program, whose steps are shorter."""
CORES = os.cpu_count() or 1
STEPS = 16
"""Steps between two looks at which lanes have ended."""
NATIVE_PART = 128
"""Impacts that a worker takes at a time in machine code, some 10 ms of work."""


class Programs(NamedTuple):
    """What a worker runs, compiled for one width."""

    width: int
    start: Callable[..., Lanes]
    """From scenes, tolerance and floor."""
    march: Callable[[Lanes], Lanes]
    exchange: Callable[..., tuple[Lanes, Lanes]]
    """Permutes the lanes of two sets: `(going, waiting, order)`."""
    finish: Callable[[Scene, Lanes], Numbers]


@functools.lru_cache(maxsize=16)
def compile_programs(assembly: Assembly, width: int) -> Programs:
    """The programs of an assembly of the model."""

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

    scenes = jax.tree.map(
        lambda _: jax.ShapeDtypeStruct((width,), float),
        Scene(Block(), Soil(), Impact()),
    )
    lanes = jax.eval_shape(start, scenes, 1.0, 1.0)
    order = jax.ShapeDtypeStruct((2 * width,), int)
    return Programs(
        width,
        compile_unfused(start, scenes, 1.0, 1.0),
        compile_unfused(lambda lanes: march(lanes, STEPS), lanes),
        compile_unfused(exchange, lanes, lanes, order),
        compile_unfused(summarise_lanes, scenes, lanes),
    )


@functools.lru_cache(maxsize=16)
def compile_native(assembly: Assembly) -> Kernel:
    """Machine code for an assembly of the model, from scenes, tolerance and floor.

    Raises NotImplementedError if its laws do what has no native code.
    """

    def begin(inputs):
        scenes, tolerance, floor = inputs
        return start_lanes(assembly, scenes, tolerance[0], floor[0])

    def step(lanes):
        lanes = step_lanes(lanes)
        return lanes, lanes.going

    def finish(inputs, lanes):
        return summarise_lanes(inputs[0], lanes)

    one = jax.ShapeDtypeStruct((1,), float)
    scenes = jax.tree.map(lambda _: one, Scene(Block(), Soil(), Impact()))
    return compile_kernel(begin, step, finish, (scenes, one, one))


def broadcast_scene(scene: Scene) -> tuple[Scene, int]:
    """The scene with every field as an array of one length, and the length.

    Raises ValueError if the fields do not broadcast to one axis, or there are none.
    """
    shapes = [np.shape(leaf) for leaf in jax.tree.leaves(scene)]
    shape = np.broadcast_shapes(*shapes)
    if len(shape) > 1:
        raise ValueError(
            f"simulate_batch takes scenes along one axis, but their fields have shape "
            f"{shape}; flatten them first"
        )
    count = shape[0] if shape else 1
    if count == 0:
        raise ValueError("simulate_batch needs at least one scene, but got none")
    return jax.tree.map(
        lambda leaf: np.broadcast_to(np.asarray(leaf), (count,)), scene
    ), count


def order_by_effort(scene: Scene) -> np.ndarray:
    """An order of the scenes that puts the longest contacts first.

    At the end of a batch lanes stand empty while the last ones finish. Long are the
    contacts of little speed into the ground, in units of what gravity gives over a
    block's size.
    """
    speed = np.asarray(scene.impact.speed) * np.cos(np.asarray(scene.impact.angle))
    size = np.cbrt(np.asarray(scene.block.mass) / np.asarray(scene.block.density))
    return np.argsort(speed / np.sqrt(size), kind="stable")


class Part(NamedTuple):
    """Scenes that wait to be integrated, or have been, with the lanes they took."""

    places: np.ndarray
    """Where each belongs in the batch; -1 for a lane that only fills up."""
    scenes: Scene
    lanes: Lanes


class NativeWorker:
    """Integrates parts of a batch, as it gets them, in machine code."""

    part = NATIVE_PART

    def __init__(self, kernel: Kernel, scene: Scene, accuracy: Accuracy):
        self.kernel = kernel
        self.rows = [
            *jax.tree.leaves(scene),
            *(
                np.broadcast_to(x, np.shape(scene.impact.speed))
                for x in (accuracy.tolerance, accuracy.floor)
            ),
        ]

    def run(
        self, parts: Iterator[np.ndarray], stop: threading.Event
    ) -> Iterator[tuple[np.ndarray, Numbers]]:
        """Results of the parts, in the order in which lanes come to their ends."""
        workspace, nothing = self.kernel.workspace(), np.zeros(0, int)
        more = True
        while more and not stop.is_set():
            places = next(parts, nothing)
            more = len(places) > 0
            inputs = np.stack([row[places] for row in self.rows])
            ended, results = workspace.run(places, inputs, wait=more)
            if len(ended):
                yield ended, jax.tree.unflatten(self.kernel.structure, list(results))


class Worker:
    """Integrates parts of a batch, as it gets them, in XLA's programs."""

    def __init__(self, programs: Programs, scene: Scene, accuracy: Accuracy):
        self.programs, self.scene, self.accuracy = programs, scene, accuracy
        self.part = programs.width

    def start(self, places: np.ndarray) -> Part:
        """A part at the start; filled up with copies of its scenes, which do not
        count."""
        width = self.programs.width
        filled = np.resize(places, width)
        scenes = jax.tree.map(lambda leaf: np.asarray(leaf[filled]), self.scene)
        setting = self.accuracy
        lanes = self.programs.start(scenes, setting.tolerance, setting.floor)
        counted = np.where(np.arange(width) < len(places), filled, -1)
        return Part(counted, scenes, lanes)

    def finish(self, part: Part) -> tuple[np.ndarray, Numbers]:
        """Places and results of a part none of whose lanes is going."""
        numbers = self.programs.finish(part.scenes, part.lanes)
        counted = part.places >= 0
        return part.places[counted], jax.tree.map(
            lambda x: np.asarray(x)[counted], numbers
        )

    def run(
        self, parts: Iterator[np.ndarray], stop: threading.Event
    ) -> Iterator[tuple[np.ndarray, Numbers]]:
        """Results of the parts, in the order in which lanes come to their ends."""
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

        both = jax.tree.map(
            lambda a, b: np.concatenate([a, b])[order], going[:2], waiting[:2]
        )
        halves = slice(width), slice(width, None)
        return tuple(
            Part(*jax.tree.map(lambda x, half=half: x[half], both), of_half)
            for half, of_half in zip(halves, lanes, strict=True)
        )


def simulate_batch(
    scene: Scene,
    *,
    accuracy: str | Accuracy = DEFAULT_ACCURACY,
    laws: Laws | None = None,
    ledger: bool = False,
    progress: Callable[[int, int], None] | None = None,
    timing: dict | None = None,
) -> ImpactResult:
    """Simulate many impacts.

    Args:
        scene: fields that broadcast to one shape `(n,)`.
        accuracy, laws: as for `simulate`.
        ledger: also keep the energy ledger of each impact.
        progress: called as `progress(done, n)` as results come in.
        timing: a dictionary to be given `compile_s` and `run_s`.

    Returns:
        `ImpactResult` with arrays `(n,)` in the order given. A scene
        that cannot be integrated gets NaN and the outcome `failed`; the rest go on.
        Each result is what the scene gives by itself, to rounding, whatever its place.

    Not differentiable; for derivatives use `jax.vmap` around `simulate`.

    Raises ValueError for a value out of its range, naming the scene.
    """
    require_float64()
    setting = get_accuracy(accuracy)
    laws = laws or Laws()
    check_scene(scene, batched=True)
    scene, count = broadcast_scene(scene)
    timing = {} if timing is None else timing

    columns: Numbers | None = None
    done = 0
    lock = threading.Lock()

    def keep(places: np.ndarray, numbers: Numbers) -> None:
        nonlocal columns, done
        with lock:
            if columns is None:
                columns = jax.tree.map(lambda _: np.empty(count), numbers)
            for column, values in zip(
                jax.tree.leaves(columns), jax.tree.leaves(numbers), strict=True
            ):
                column[places] = values
            done += len(places)
            if progress is not None:
                progress(done, count)

    effort = order_by_effort(scene)
    places = model_places(scene)[effort]
    groups = [(MODELS[place], effort[places == place]) for place in np.unique(places)]

    def worker(group: tuple[Model, np.ndarray]) -> NativeWorker | Worker:
        model, chosen = group
        assembly = Assembly(laws, model, ledger)
        if is_available():
            # Laws of the user's own may do anything.
            with contextlib.suppress(NotImplementedError):
                return NativeWorker(compile_native(assembly), scene, setting)
        width = SMALL_WIDTH if len(chosen) <= SMALL_WIDTH * CORES else WIDTH
        return Worker(compile_programs(assembly, width), scene, setting)

    begin = time.perf_counter()
    with concurrent.futures.ThreadPoolExecutor(CORES) as pool:
        workers = list(pool.map(worker, groups))
    started = time.perf_counter()
    for (_, chosen), of_group in zip(groups, workers, strict=True):
        _run_on_every_core(of_group, chosen, keep)
    timing |= {
        "compile_s": started - begin,
        "run_s": time.perf_counter() - started,
    }
    return ImpactResult(**vars(columns), scene=scene, accuracy=setting)


def _run_on_every_core(
    worker: NativeWorker | Worker, chosen: np.ndarray, keep: Callable
) -> None:
    """Let several threads take parts of the chosen scenes until none are left."""
    # No larger parts than give every core one.
    size = min(worker.part, -(-len(chosen) // CORES))
    parts = iter([chosen[i : i + size] for i in range(0, len(chosen), size)])
    lock, stop = threading.Lock(), threading.Event()

    def take() -> Iterator[np.ndarray]:
        while True:
            with lock:
                part = next(parts, None)
            if part is None:
                return
            yield part

    def work() -> None:
        for places, numbers in worker.run(take(), stop):
            keep(places, numbers)

    with concurrent.futures.ThreadPoolExecutor(CORES) as pool:
        try:
            running = [pool.submit(work) for _ in range(CORES)]
            for future in concurrent.futures.as_completed(running):
                future.result()
        except BaseException:
            stop.set()
            raise

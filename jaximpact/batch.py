"""Many impacts: the same model over arrays of scenes, in chunks on every core."""

import concurrent.futures
import functools
import os
import time
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np

from .accuracy import Accuracy, get_accuracy
from .block import Block
from .checks import check_scene
from .compilation import compile_unfused
from .laws import Laws
from .precision import require_float64
from .scene import Impact, Scene
from .simulation import Assembly, ImpactResult, Numbers, compute
from .soil import Soil

CHUNK, SMALL_CHUNK = 256, 32
"""Impacts integrated in lockstep. Fewer waste time on dispatch, more on waiting for the
slowest. A chunk that is not full is filled up with copies; up to 32 impacts go in the
small one."""


def chunk_size(lanes: np.ndarray) -> int:
    """How many impacts the program that takes these lanes integrates at once."""
    return SMALL_CHUNK if len(lanes) <= SMALL_CHUNK else CHUNK


@functools.lru_cache(maxsize=16)
def _program(assembly: Assembly, size: int) -> Callable:
    """What computes one chunk, compiled: `(scenes, tolerance, floor)` to `Numbers`."""

    def compute_chunk(scenes, tolerance, floor):
        return jax.vmap(lambda scene: compute(assembly, scene, tolerance, floor))(
            scenes
        )

    shapes = jax.tree.map(
        lambda _: jax.ShapeDtypeStruct((size,), float), Scene(Block(), Soil(), Impact())
    )
    return compile_unfused(compute_chunk, shapes, 1.0, 1.0)


def broadcast_scene(scene: Scene) -> tuple[Scene, int]:
    """The scene with every field as an array of one length, and the length.

    Raises ValueError if the fields do not broadcast to one axis.
    """
    shapes = [np.shape(leaf) for leaf in jax.tree.leaves(scene)]
    shape = np.broadcast_shapes(*shapes)
    if len(shape) > 1:
        raise ValueError(
            f"simulate_batch takes scenes along one axis, but their fields have shape "
            f"{shape}; flatten them first"
        )
    count = shape[0] if shape else 1
    return jax.tree.map(
        lambda leaf: np.broadcast_to(np.asarray(leaf), (count,)), scene
    ), count


def order_by_effort(scene: Scene) -> np.ndarray:
    """An order of the scenes that puts like efforts side by side.

    Lanes of a chunk wait for the slowest. Slow are the contacts that last: those of
    little speed into the ground, in units of what gravity gives over a block's size.
    """
    speed = np.asarray(scene.impact.speed) * np.cos(np.asarray(scene.impact.angle))
    size = np.cbrt(np.asarray(scene.block.mass) / np.asarray(scene.block.density))
    return np.argsort(speed / np.sqrt(size), kind="stable")


def simulate_batch(
    scene: Scene,
    *,
    accuracy: str | Accuracy = "balanced",
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
        progress: called as `progress(done, n)` after each chunk.
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

    soil = scene.soil
    damped = (soil.eta_N > 0.0) | (soil.eta_T > 0.0) | (soil.eta_R > 0.0)
    effort = order_by_effort(scene)
    chunks = []
    for has_dashpots in (False, True):
        lanes = effort[damped[effort] == has_dashpots]
        assembly = Assembly(laws, has_dashpots, ledger)
        parts = [lanes[i : i + CHUNK] for i in range(0, len(lanes), CHUNK)]
        chunks += [(assembly, part) for part in parts]

    def run(lanes: np.ndarray, program: Callable) -> Numbers:
        filled = np.resize(lanes, chunk_size(lanes))  # repeats lanes to fill the chunk
        scenes = jax.tree.map(lambda leaf: jnp.asarray(leaf[filled]), scene)
        numbers = program(scenes, setting.tolerance, setting.floor)
        return jax.tree.map(lambda x: np.asarray(x)[: len(lanes)], numbers)

    columns: Numbers | None = None
    done = 0

    def keep(lanes, numbers: Numbers) -> None:
        nonlocal columns, done
        if columns is None:
            columns = jax.tree.map(lambda _: np.empty(count), numbers)

        def put(column, values):
            column[lanes] = values

        jax.tree.map(put, columns, numbers)
        done += len(lanes)
        if progress is not None:
            progress(done, count)

    start = time.perf_counter()
    programs = [_program(assembly, chunk_size(lanes)) for assembly, lanes in chunks]
    timing["compile_s"] = time.perf_counter() - start

    start = time.perf_counter()
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        running = {}
        try:
            for (_, lanes), program in zip(chunks, programs, strict=True):
                running[pool.submit(run, lanes, program)] = lanes
            for future in concurrent.futures.as_completed(running):
                keep(running[future], future.result())
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    timing["run_s"] = time.perf_counter() - start
    return ImpactResult(**columns._asdict(), scene=scene, accuracy=setting)

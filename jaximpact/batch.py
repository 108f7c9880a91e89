"""Many impacts: the same model over arrays of scenes, in chunks on every core."""

import concurrent.futures
import os
import time
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np

from .accuracy import Accuracy, get_accuracy
from .checks import check_scene
from .compilation import unfused_jit
from .laws import Laws
from .precision import require_float64
from .scene import Scene
from .simulation import Assembly, ImpactResult, Numbers, compute

CHUNK, SMALL_CHUNK = 256, 32
"""Impacts integrated in lockstep. Fewer waste time on dispatch, more on waiting for the
slowest. A chunk that is not full is filled up with copies; up to 32 impacts go in the
small one."""


def _compute_chunk(assembly, scenes, tolerance, floor):
    return jax.vmap(lambda scene: compute(assembly, scene, tolerance, floor))(scenes)


_compiled_chunk = unfused_jit(_compute_chunk, static_argnums=(0,))


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
    timing.update(compile_s=0.0, run_s=0.0)

    soil = scene.soil
    damped = (soil.eta_N > 0.0) | (soil.eta_T > 0.0) | (soil.eta_R > 0.0)
    effort = order_by_effort(scene)
    chunks = []
    for has_dashpots in (False, True):
        lanes = effort[damped[effort] == has_dashpots]
        assembly = Assembly(laws, has_dashpots, ledger)
        parts = [lanes[i : i + CHUNK] for i in range(0, len(lanes), CHUNK)]
        chunks += [(assembly, part) for part in parts]

    tolerance = jnp.asarray(setting.tolerance)
    floor = jnp.asarray(setting.floor)

    def run(assembly: Assembly, lanes: np.ndarray) -> Numbers:
        size = SMALL_CHUNK if len(lanes) <= SMALL_CHUNK else CHUNK
        filled = np.resize(lanes, size)  # repeats the lanes to fill the chunk
        scenes = jax.tree.map(lambda leaf: jnp.asarray(leaf[filled]), scene)
        numbers = _compiled_chunk(assembly, scenes, tolerance, floor)
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

    # The first chunk of each program compiles it; its run is counted as compilation.
    waiting, seen = [], set()
    for assembly, lanes in chunks:
        program = (assembly, len(lanes) <= SMALL_CHUNK)
        if program in seen:
            waiting.append((assembly, lanes))
            continue
        seen.add(program)
        start = time.perf_counter()
        numbers = run(assembly, lanes)
        first = time.perf_counter() - start
        start = time.perf_counter()
        numbers = run(assembly, lanes)
        again = time.perf_counter() - start
        timing["compile_s"] += max(first - again, 0.0)
        timing["run_s"] += again
        keep(lanes, numbers)

    start = time.perf_counter()
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        running = {}
        try:
            for assembly, lanes in waiting:
                running[pool.submit(run, assembly, lanes)] = lanes
            for future in concurrent.futures.as_completed(running):
                keep(running[future], future.result())
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    timing["run_s"] += time.perf_counter() - start
    return ImpactResult(**columns._asdict(), scene=scene, accuracy=setting)

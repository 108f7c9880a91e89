"""Many impacts: the same model over arrays of scenes, on every core or device.

Each worker keeps so many lanes going, and a lane that has ended gives its place to the
next scene, so that no lane waits for the slowest. On a CPU lanes run in machine code of
our own (`machine`); on other devices, and for laws that have none, in XLA's programs
(`marching`).
"""

import concurrent.futures
import contextlib
import dataclasses
import hashlib
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import jax
import numpy as np

from .accuracy import DEFAULT_ACCURACY, Accuracy, get_accuracy
from .block import Block
from .engines.machine import NativeWorker, compile_native, computes_on_cpu
from .engines.marching import (
    MarchingWorker,
    compile_programs,
    lanes_of_worker,
    worker_devices,
)
from .engines.threads import thread_count
from .errors import InputError
from .fields import real_number
from .formats.checks import check_scene
from .formats.journal import Journal
from .formats.provenance import versions
from .identity import part_names
from .mechanics.model import MODELS, model_places
from .mechanics.problem import Assembly
from .numbers import Numbers, numbers_of_no_value
from .precision import require_float64
from .scene import Impact, Scene, as_scene, shape_of
from .shapes import MixedShapes
from .simulation import ImpactResult
from .soil import Soil


def broadcast_scene(scene: Scene) -> tuple[Scene, int]:
    """The scene with every field as an array of one length, and the length.

    Raises ValueError if the fields do not broadcast to one axis, or there are none.
    """
    shape = shape_of(scene)
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


def by_shape(scene: Scene) -> list[tuple[Scene, np.ndarray]]:
    """The scenes as blocks of one shape each, and which lanes are of it.

    Lanes of another shape have the defaults of that one. A scene with one shape for all
    is given back as it is.

    Raises InputError for an index that is none.
    """
    shape = scene.block.shape
    if not isinstance(shape, MixedShapes):
        return [(scene, np.asarray(True))]
    index = np.asarray(shape.index)
    if not np.all(np.isin(index, np.arange(len(shape.kinds)))):
        raise InputError(
            f"the index of mixed shapes must be one of 0 to {len(shape.kinds) - 1}, "
            f"but holds {index[~np.isin(index, np.arange(len(shape.kinds)))].flat[0]:g}"
        )
    found = []
    for place in np.unique(index.astype(int)):
        block = dataclasses.replace(scene.block, shape=shape.alone(place))
        alone = Scene(block, scene.soil, scene.impact)
        found.append((jax.tree.map(np.asarray, alone), index == place))
    return found


def groups_of(
    scene: Scene, order: np.ndarray, model_tolerance: float, ledger: bool
) -> list[tuple[Assembly, np.ndarray]]:
    """Assemblies that scenes are computed with, and the scenes of each, for
    `run_groups`.

    Args:
        scene: fields `(n,)`. order: places of those that are to be computed.
    """
    groups = []
    for alone, chosen in by_shape(scene):
        places = model_places(alone, model_tolerance)
        places = np.where(chosen, places, -1)[order]
        groups += [
            (
                Assembly(jax.tree.structure(alone), MODELS[place], ledger),
                order[places == place],
            )
            for place in np.unique(places[places >= 0])
        ]
    return groups


def order_by_effort(scene: Scene) -> np.ndarray:
    """An order of the scenes that puts the longest contacts first.

    At the end of a batch lanes stand empty while the last ones finish. Long are the
    contacts of little speed into the ground, in units of what gravity gives over a
    block's size.
    """
    speed = np.asarray(scene.impact.speed) * np.cos(np.asarray(scene.impact.angle))
    size = np.cbrt(np.asarray(scene.block.mass) / np.asarray(scene.block.density))
    return np.argsort(speed / np.sqrt(size), kind="stable")


def simulate_batch(
    scene: Scene | Block,
    soil: Soil | None = None,
    impact: Impact | None = None,
    *,
    accuracy: str | Accuracy = DEFAULT_ACCURACY,
    ledger: bool = False,
    model_tolerance: float = 0.0,
    journal: Path | None = None,
    progress: Callable[[int, int], None] | None = None,
    timing: dict | None = None,
) -> ImpactResult:
    """Simulate many impacts.

    Args:
        scene, soil, impact: as for `simulate`, with fields that broadcast to one shape
            `(n,)`. Blocks may have different shapes (`MixedShapes`); each is computed
            as by itself.
        accuracy: as for `simulate`.
        ledger: also keep the energy ledger of each impact.
        model_tolerance: error in `e_n` and `e_bar` for which a model that leaves
            something out may be taken where it was measured to be within it; see
            `select_model`. 0: only where it is exact.
        journal: file that takes the results as they come. If it is there from a run
            that was cut short, its results are taken over and only the others are
            computed. It is left behind; remove it once the results are safe.
        progress: called as `progress(done, n)` as results come in.
        timing: a dictionary to be given `compile_s`, `run_s`, `impacts`, how many were
            computed, and `engine`, by what: "machine code" or "XLA".

    Returns:
        `ImpactResult` with arrays `(n,)` in the order given. A scene
        that cannot be integrated gets NaN and the outcome `failed`; the rest go on.
        Each result is what the scene gives by itself, to rounding, whatever its place.

    All cores are used, or all devices if JAX has several. Not differentiable; for
    derivatives use `simulate`, which takes arrays too.

    Raises:
        ValueError: a value out of its range, naming the scene.
        InputError: a journal of other scenes, settings, laws, shapes or versions.
    """
    require_float64()
    setting = get_accuracy(accuracy)
    real_number("model_tolerance", model_tolerance, least=0.0)
    scene = as_scene(scene, soil, impact)
    check_scene(scene, batched=True, warn=True)
    if isinstance(scene.block.shape, MixedShapes):
        for alone, _ in by_shape(scene):
            check_scene(alone, batched=True)
    scene, count = broadcast_scene(scene)
    timing = {} if timing is None else timing
    names, structure = _columns(numbers_of_no_value(ledger))
    numbers = np.empty((len(names), count))
    missing = np.ones(count, bool)
    done = 0
    lock = threading.Lock()

    with contextlib.ExitStack() as stack:
        kept = None
        if journal is not None:
            subject = _subject(scene, count, setting, model_tolerance)
            kept = stack.enter_context(Journal(journal, subject, names, count))
            places, rows = kept.rows()
            numbers[:, places], missing[places] = rows.T, False
            done = len(places)
            if progress is not None and done:
                progress(done, count)

        def keep(places: np.ndarray, of_places: Numbers) -> None:
            nonlocal done
            rows = np.stack(jax.tree.leaves(of_places), axis=-1)
            with lock:
                if kept is not None:
                    kept.append(places, rows)
                numbers[:, places] = rows.T
                done += len(places)
                if progress is not None:
                    progress(done, count)

        wanted = order_by_effort(scene)
        wanted = wanted[missing[wanted]]
        groups = groups_of(scene, wanted, model_tolerance, ledger)
        run_groups(scene, groups, setting, keep, timing)
    columns = jax.tree.unflatten(structure, list(numbers))
    return ImpactResult(
        **vars(columns),
        scene=scene,
        accuracy=setting,
        model_tolerance=model_tolerance,
    )


def _columns(template: Numbers) -> tuple[list[str], jax.tree_util.PyTreeDef]:
    """Names of the leaves, and the structure that they make up."""
    leaves, structure = jax.tree_util.tree_flatten_with_path(template)
    return [jax.tree_util.keystr(path)[1:] for path, _ in leaves], structure


def _subject(
    scene: Scene, count: int, accuracy: Accuracy, model_tolerance: float
) -> dict:
    """What the results depend on, ready for JSON."""
    digest = hashlib.sha256()
    for leaf in jax.tree.leaves(scene):
        digest.update(np.ascontiguousarray(leaf))
    names = part_names(scene.block, scene.soil)
    for slot, name in names.items():
        if "source not known" in name:
            raise InputError(
                f"a journal tells laws by their source, but {slot} is {name}; write "
                "its class into a file"
            )
    return {
        "scenes": {"count": count, "sha256": digest.hexdigest()},
        "accuracy": dataclasses.asdict(accuracy),
        "laws": names,
        "model_tolerance": model_tolerance,
        "versions": versions(),
    }


def run_groups(
    scene: Scene,
    groups: list[tuple[Assembly, np.ndarray]],
    accuracy: Accuracy,
    keep: Callable,
    timing: dict,
) -> None:
    """Compute groups of scenes, each with its assembly of the model.

    Args:
        scene: every field an array of one length; not checked.
        groups: assemblies, and places of the scenes that each is for. Where shapes are
            mixed, an assembly may be of the structure of one alone, as of `by_shape`.
        keep: called as `keep(places, numbers)`, from any thread, as results come.
        timing: is given what `simulate_batch` says.
    """
    begin = time.perf_counter()
    with concurrent.futures.ThreadPoolExecutor(thread_count()) as pool:
        prepared = list(
            pool.map(lambda group: _workers(scene, *group, accuracy), groups)
        )
    started = time.perf_counter()
    for (_, chosen), workers in zip(groups, prepared, strict=True):
        _run_side_by_side(workers, chosen, keep)
    engines = {workers[0].engine for workers in prepared}
    timing |= {
        "engine": " and ".join(sorted(engines)),
        "impacts": sum(len(chosen) for _, chosen in groups),
        "compile_s": started - begin,
        "run_s": time.perf_counter() - started,
    }


def _workers(
    scene: Scene, assembly: Assembly, chosen: np.ndarray, accuracy: Accuracy
) -> list[NativeWorker] | list[MarchingWorker]:
    """Workers for the chosen scenes, with what they run compiled."""
    if jax.tree.structure(scene) != assembly.structure:
        alone = (each for each, _ in by_shape(scene))
        scene = next(s for s in alone if jax.tree.structure(s) == assembly.structure)
    kernel = compile_native(assembly) if computes_on_cpu() else None
    if kernel is not None:
        return [NativeWorker(kernel, scene, accuracy)] * thread_count()
    devices = worker_devices()
    width = lanes_of_worker(len(chosen), devices)
    different = list(dict.fromkeys(devices))
    with concurrent.futures.ThreadPoolExecutor(len(different)) as pool:
        compiled = pool.map(
            lambda device: compile_programs(assembly, width, device), different
        )
        programs = dict(zip(different, compiled, strict=True))
    return [MarchingWorker(programs[device], scene, accuracy) for device in devices]


def _run_side_by_side(
    workers: list[NativeWorker] | list[MarchingWorker],
    chosen: np.ndarray,
    keep: Callable,
) -> None:
    """Let workers, each in its thread, take parts of the chosen scenes until none are
    left."""
    # No larger parts than give every worker one.
    size = min(workers[0].part, -(-len(chosen) // len(workers)))
    parts = iter([chosen[i : i + size] for i in range(0, len(chosen), size)])
    lock, stop = threading.Lock(), threading.Event()

    def take() -> Iterator[np.ndarray]:
        while True:
            with lock:
                part = next(parts, None)
            if part is None:
                return
            yield part

    def work(worker: NativeWorker | MarchingWorker) -> None:
        for places, numbers in worker.run(take(), stop):
            keep(places, numbers)

    with concurrent.futures.ThreadPoolExecutor(len(workers)) as pool:
        try:
            running = [pool.submit(work, worker) for worker in workers]
            for future in concurrent.futures.as_completed(running):
                future.result()
        except BaseException:
            stop.set()
            raise

"""Many impacts: the same model over arrays of scenes, on every core.

They are computed by `backend.rows` in parts, after each of which progress is reported
and results are kept, and a batch can be interrupted.
"""

import concurrent.futures
import contextlib
import dataclasses
import hashlib
import time
from pathlib import Path
from types import EllipsisType

import jax
import numpy as np
from jax.core import Tracer

from ._checks import truth
from ._packages import versions
from ._precision import require_float64
from ._settings import numpy_settings
from .accuracy import DEFAULT_ACCURACY, Accuracy, get_accuracy
from .backend.rows import compute_rows, in_parts, prepare
from .errors import InputError
from .identity import part_names
from .impact.dynamics import LedgerItems
from .impact.results import ImpactSummary, empty_summary
from .io.checks import check_scene
from .io.journal import Journal
from .progress import Progress, ProgressFunction, listening
from .scene import Block, Impact, Scene, Soil, as_scene, shape_of
from .shapes import MixedShapes, each_shape, shape_by_shape
from .simulation import ImpactResult
from .tasks import Task, computing, run_tasks

PARTS = 32
"""Parts that an executor gets of a batch, if they are neither small nor large."""
LEAST_PART = 256
"""Impacts of a part that are worth sending: some 20 ms of work."""
LARGEST_PART = 16_384
"""Impacts of a part that a worker may lose: about a second of work."""


def broadcast_scene(scene: Scene) -> tuple[Scene, int]:
    """Return the scene with every field as an array of one length, and the length.
    ValueError if the fields do not broadcast to one axis, or there are none."""
    if any(isinstance(leaf, Tracer) for leaf in jax.tree.leaves(scene)):
        raise InputError(
            "simulate_batch cannot be traced by jit, vmap or grad; take simulate, "
            "which is as fast there"
        )
    shape = shape_of(scene)
    if len(shape) > 1:
        raise ValueError(
            f"scenes must lie along one axis, but their fields have shape {shape}; "
            "flatten them first"
        )
    count = shape[0] if shape else 1
    if count == 0:
        raise ValueError("at least one scene is needed, but got none")
    return jax.tree.map(
        lambda leaf: np.broadcast_to(np.asarray(leaf), (count,)), scene
    ), count


def simulate_batch(
    scene: Scene | Block,
    soil: Soil | None = None,
    impact: Impact | None = None,
    *,
    accuracy: str | Accuracy = DEFAULT_ACCURACY,
    ledger: bool = False,
    journal: Path | None = None,
    progress: Progress | ProgressFunction | None = None,
    timing: dict | None = None,
    executor: concurrent.futures.Executor | None = None,
) -> ImpactResult:
    """Simulate many impacts.

    Args:
        scene, soil, impact: as for `simulate`, with fields that broadcast to one shape
            `(n,)`. Blocks may have different shapes (`MixedShapes`); each is computed
            as by itself.
        accuracy: as for `simulate`.
        ledger: also keep the energy ledger of each impact.
        journal: file that keeps the results as they come. A journal of an interrupted
            run is read, and only what is missing is computed. The file is left behind;
            remove it once the results are safe.
        progress: called as `progress(done, n)` as results come in.
        timing: a dictionary that receives `compile_s`, `run_s`, `impacts` (the number
            computed) and `engine` ("machine code", "XLA" or "executor").
        executor: computes parts of the scenes in other processes, each on one thread:
            a pool of processes that are no forks, `client.get_executor()` of a client
            of Dask, or another with the interface of `concurrent.futures.Executor`.
            No result depends on it.

    Returns:
        `ImpactResult` with arrays `(n,)` in the order given. A scene that cannot be
        integrated gets NaN and the outcome `failed`; the rest go on. Each result is, to
        rounding, the one that the scene gives by itself.

    All cores are used. Not differentiable; for derivatives use `simulate`, which takes
    arrays too.

    Raises:
        ValueError: a value out of its range, naming the scene; a `ledger` that is no
            truth value.
        InputError: a journal of other scenes, settings, laws, shapes or versions.
        IncompleteError: workers of the executor were lost for good.
    """
    require_float64()
    setting = get_accuracy(accuracy)
    ledger = ledger is not None and truth("ledger", ledger)
    scene = as_scene(scene, soil, impact)
    check_scene(scene, batched=True, warn=True)
    if isinstance(scene.block.shape, MixedShapes):
        for place in range(len(scene.block.shape.kinds)):
            shape = scene.block.shape.alone(place)
            block = dataclasses.replace(scene.block, shape=shape)
            check_scene(dataclasses.replace(scene, block=block), batched=True)
    scene, count = broadcast_scene(scene)
    template, structure = jax.tree_util.tree_flatten_with_path(empty_summary(ledger))
    names = [jax.tree_util.keystr(path)[1:] for path, _ in template]
    opened = contextlib.nullcontext()
    if journal is not None:
        subject = _subject(scene, count, setting)
        opened = Journal(journal, subject, names, count)
    with computing(progress=progress, executor=executor), opened as kept:
        collector = Collector(len(names), count, kept)
        missing = np.flatnonzero(collector.missing)
        begin = started = time.perf_counter()
        if executor is None:
            name = ""
            # Nothing is compiled for what a journal has already.
            if timing is not None and len(missing):
                name = _prepare(_at(scene, missing), setting, ledger)
            started = time.perf_counter()
            for part in in_parts(missing):
                rows = compute_part(_at(scene, part), len(part), setting, ledger)
                collector.take(part, rows.T)
        else:
            name = "executor"
            size = int(np.clip(-(-len(missing) // PARTS), LEAST_PART, LARGEST_PART))
            parts = [missing[i : i + size] for i in range(0, len(missing), size)]
            run_tasks(
                executor,
                (
                    Task(compute_part, _at(scene, part), len(part), setting, ledger)
                    for part in parts
                ),
                lambda number, rows: collector.take(parts[number], rows.T),
            )
    if timing is not None:
        timing |= {"engine": name, "impacts": len(missing)}
        timing["compile_s"] = started - begin
        timing["run_s"] = time.perf_counter() - started
    return ImpactResult(
        **vars(jax.tree.unflatten(structure, list(collector.numbers))),
        scene=scene,
        accuracy=setting,
    )


def _prepare(scene: Scene, accuracy: Accuracy, ledger: bool) -> str:
    """Compile what scenes need, and return the names of what computes them."""
    names = set()
    for alone, _ in each_shape(scene):
        leaves, structure = jax.tree.flatten(alone)
        names.add(prepare(structure, leaves, accuracy, ledger=ledger))
    return " and ".join(sorted(names))


def _at(scene: Scene, places: np.ndarray) -> Scene:
    """Return the scenes at some places; what is the same for all as one number."""
    return jax.tree.map(lambda leaf: _once(leaf, places), scene)


def _once(leaf: np.ndarray, places: np.ndarray | EllipsisType = ...) -> np.ndarray:
    """Return an array at some places, or its number where it holds one alone."""
    return leaf[0] if leaf.strides == (0,) else leaf[places]


@numpy_settings()
def compute_part(
    scene: Scene, count: int, accuracy: Accuracy, ledger: LedgerItems = False
) -> np.ndarray:
    """Compute scenes that were checked, whose fields broadcast to `(count,)`.

    Returns rows `(numbers, count)`, in the order of the fields of `ImpactSummary`.
    """

    def lanes_of(alone: Scene) -> np.ndarray:
        """Compute blocks of one shape; `(lanes, numbers)`."""
        leaves, structure = jax.tree.flatten(alone)
        leaves = [_once(np.asarray(leaf)) for leaf in leaves]
        rows, _ = compute_rows(structure, leaves, accuracy, ledger=ledger)
        # One number for all where all scenes are the same.
        return rows.T if rows.ndim > 1 else np.broadcast_to(rows, (count, len(rows)))

    return shape_by_shape(lanes_of, scene).T


def summary_of(rows: np.ndarray, ledger: LedgerItems = False) -> ImpactSummary:
    """Name the rows that `compute_part` gives."""
    return jax.tree.unflatten(jax.tree.structure(empty_summary(ledger)), list(rows))


class Collector:
    """Numbers of impacts, `width` of each, as they come, kept in a journal if there is
    one; what this holds already is not missing. `what` is what progress calls them."""

    def __init__(
        self,
        width: int,
        count: int,
        journal: Journal | None,
        what: str = "impacts",
    ):
        self.numbers = np.empty((width, count))
        self.missing = np.ones(count, bool)
        self._journal, self._progress = journal, listening()
        self._what, self._done = what, 0
        if journal is not None:
            self._add(*journal.rows())

    def take(self, places: np.ndarray, rows: np.ndarray) -> None:
        """Take the numbers of some impacts, shape (places, width)."""
        if self._journal is not None:
            self._journal.append(places, rows)
        self._add(places, rows)

    def under_way(self, done: int, total: int) -> None:
        """Tell the progress of a part, whose numbers come when all its `total` are
        done."""
        self._progress(self._what, self._done + done, len(self.missing))

    def _add(self, places: np.ndarray, rows: np.ndarray) -> None:
        if len(places):
            self.numbers[:, places], self.missing[places] = rows.T, False
            self._done += len(places)
            self._progress(self._what, self._done, len(self.missing))


def _subject(scene: Scene, count: int, accuracy: Accuracy) -> dict:
    digest = hashlib.sha256()
    for leaf in jax.tree.leaves(scene):
        digest.update(np.asarray(leaf).tobytes())
    names = part_names(scene.block, scene.soil)
    return {
        "scenes": {"count": count, "sha256": digest.hexdigest()},
        "accuracy": dataclasses.asdict(accuracy),
        "laws": names,
        "versions": versions(),
    }

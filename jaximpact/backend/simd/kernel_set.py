"""Sets of kernels: lanes side by side, each computed by the kernel that it names."""

import ctypes
import functools
import hashlib
import threading
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from .driver import (
    MAKE_READY,
    PROGRAMS,
    Course,
    Driver,
    Operation,
    Rows,
    compute_rows,
    driver_object,
    load_driver,
)
from .kernel import Kernel
from .target import thread_functions

USUAL_STEPS = 2_000
"""Steps for which there is room when a course is recorded; a lane that takes more runs
once more."""


ALONG_INPUTS = -1
"""Stands for a direction that is given by derivatives of the inputs, which are among
those that lanes have of their own: behind the inputs, in their order."""


class Waiting(NamedTuple):
    """Kernel that is compiled when the first lane of an operation of XLA needs it."""

    name: str
    """Name that no other kernel has, in any process."""
    compile: Callable[[], Kernel]


class KernelSet:
    """Kernels with the same rows of inputs and of results, by which lanes are computed
    and differentiated along so many directions, of those that the kernels have.

    Kernels may wait, but not all: when JAX traces it is not known which ones lanes
    need. What Python computes by itself needs every kernel.
    """

    def __init__(self, kernels: Sequence[Kernel | Waiting], directions: int = 0):
        if len(kernels) > PROGRAMS:
            raise ValueError(f"{len(kernels)} kernels, but there can be {PROGRAMS}")
        self.kernels, self.directions = tuple(kernels), directions
        self._first = next(k for k in kernels if isinstance(k, Kernel))
        first = self._first.program_along(directions)
        self.structure = self._first.structure
        self.result_rows, self.sampled_rows = first.result_rows, first.sampled_rows
        self.inputs = self._first.code.common_inputs
        self._every_place = np.arange(self.inputs, dtype=float)
        self._settings = Operation()
        self._fill(self._settings)
        self._along: dict[int, KernelSet] = {directions: self}

    def along(self, directions: int) -> "KernelSet":
        """Return the set of the same kernels along so many directions, always the
        same one: what JAX keeps is kept by it."""
        if directions not in self._along:
            others = KernelSet(self.kernels, directions)
            return self._along.setdefault(directions, others)
        return self._along[directions]

    def _fill(self, settings: Operation) -> None:
        settings.count = len(self.kernels)
        for place, kernel in enumerate(self.kernels):
            waits = isinstance(kernel, Waiting)
            settings.waiting[place] = waits
            known = self._first if waits else kernel
            settings.programs[place] = known.program_along(self.directions)
        settings.directions = self.directions
        settings.samples = self.sampled_rows > 0
        settings.leaves = self.inputs
        for field, address in thread_functions()._asdict().items():
            setattr(settings, field, address)

    @functools.cached_property
    def digest(self) -> str:
        """Name by content: what XLA keeps for other processes calls code by its name,
        which must never stand for other code."""
        digest = hashlib.sha256(driver_object())
        digest.update(f"{len(self.kernels)} {self.directions}".encode())
        for kernel in self.kernels:
            if isinstance(kernel, Waiting):
                digest.update(kernel.name.encode())
                continue
            digest.update(kernel.layout)
            for object_file in kernel.code.object_files:
                digest.update(object_file)
        return digest.hexdigest()[:32]

    def load_driver(self) -> Driver:
        """Load a driver whose handler serves XLA with these kernels."""
        driver = load_driver()
        self._fill(driver.operation)
        make_ready = MAKE_READY(_Compiler(self, driver.operation).make_ready)
        driver.operation.make_ready = ctypes.cast(make_ready, ctypes.c_void_p)
        return driver._replace(alive=make_ready)

    def compute(
        self,
        own: Float[np.ndarray, "own lanes"],
        threads: int,
        *,
        common: Float[np.ndarray, " inputs"] | None = None,
        places: Sequence[int] | None = None,
        effort: Float[np.ndarray, " lanes"] | None = None,
        program: Float[np.ndarray, " lanes"] | None = None,
        along: Sequence[int] = (),
        times: Float[np.ndarray, "lanes times"] | None = None,
    ) -> tuple[np.ndarray, np.ndarray | None]:
        """Compute lanes, on so many threads at most.

        Args:
            own: inputs that lanes have of their own.
            common: inputs, of which those that lanes have of their own do not count.
            places: places of the rows of `own` among the inputs; all by default.
            effort: less for lanes that take longer, which begin first; by default they
                begin in order.
            program: place of each lane's kernel, if there are several.
            along: input of each direction, or `ALONG_INPUTS` for the only one.
            times: at which samples are taken, increasing.

        Returns:
            Results `(result_rows, lanes)`, which end with those of the directions, and
            samples `(sampled_rows, lanes, times)`.
        """
        rows, results = self._rows(own, threads, common, places)
        samples = None
        if effort is not None:
            effort = np.ascontiguousarray(effort, float)
            rows.effort = effort.ctypes.data
        if program is not None:
            program = np.ascontiguousarray(program, float)
            rows.program = program.ctypes.data
        directions = np.array(along, float)
        rows.along = directions.ctypes.data
        if times is not None:
            times = np.ascontiguousarray(times, float)
            rows.times, rows.times_asked = times.shape[1], times.ctypes.data
            samples = np.empty((self.sampled_rows, *times.shape))
            rows.samples = samples.ctypes.data
        compute_rows(rows)
        return results, samples

    def record(
        self, inputs: Float[np.ndarray, " inputs"]
    ) -> tuple[np.ndarray, np.ndarray]:
        """Compute one lane by the first kernel, and sample it at its start and at the
        end of every step: results `(result_rows,)`, and samples `(sampled_rows, 1 +
        steps)`."""
        room = USUAL_STEPS
        while True:
            samples = np.empty((self.sampled_rows, room))
            course = Course(samples=samples.ctypes.data, room=room)
            rows, results = self._rows(inputs[:, None], 1, None, None)
            rows.course = ctypes.addressof(course)
            compute_rows(rows)
            if course.count <= room:
                return results[:, 0], samples[:, : course.count]
            room = course.count

    def _rows(self, own, threads: int, common, places) -> tuple[Rows, np.ndarray]:
        """Describe lanes to the driver; arrays live as long as the description."""
        own = np.ascontiguousarray(own, float)
        at = self._every_place if places is None else np.array(places, float)
        if own.shape[0] != len(at):
            raise ValueError(f"got {own.shape[0]} rows of inputs, need {len(at)}")
        common = np.zeros(self.inputs) if common is None else np.array(common, float)
        results = np.empty((self.result_rows, own.shape[1]))
        rows = Rows(
            operation=ctypes.addressof(self._settings),
            lanes=own.shape[1],
            threads=threads,
            own_inputs=len(at),
            common=common.ctypes.data,
            places=at.ctypes.data,
            own=own.ctypes.data,
            results=results.ctypes.data,
        )
        rows.alive = common, at, own
        return rows, results


class _Compiler:
    """Compiler of the kernels of a set that wait, for one operation."""

    def __init__(self, kernels: KernelSet, operation: Operation):
        self.kernels, self.operation = kernels, operation
        self.compiled: dict[int, Kernel] = {}
        self.problem: ctypes.Array | None = None
        self.lock = threading.Lock()

    def make_ready(self, place: int) -> bool:
        """Compile a kernel, and put its program in its place. Returns True if it is
        there; else `problem` of the operation says why it is not."""
        try:
            with self.lock:
                if place not in self.compiled:
                    waiting: Any = self.kernels.kernels[place]
                    kernel = waiting.compile()
                    program = kernel.program_along(self.kernels.directions)
                    self.operation.programs[place] = program
                    self.compiled[place] = kernel
        except BaseException as problem:  # none passes through C; XLA's error tells it
            text = f"jaximpact: no machine code, which lanes need: {problem!r}"
            self.problem = ctypes.create_string_buffer(text.encode())
            self.operation.problem = ctypes.addressof(self.problem)
            return False
        return True

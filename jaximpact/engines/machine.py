"""The model in machine code, for lanes on a CPU."""

import functools
import hashlib
import inspect
import os
import threading
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path

import jax
import numpy as np

from ..accuracy import MAX_STEPS, RETRIES, Accuracy
from ..errors import IncompleteError, NoMachineCodeWarning
from ..formats.provenance import versions
from ..identity import described
from ..mechanics.outcomes import Outcome
from ..mechanics.problem import Assembly
from ..numbers import Numbers, numbers_of_no_value
from ..scene import Scene
from .native import (
    Code,
    Kernel,
    NoMachineCode,
    Retries,
    host,
    kept,
)

NATIVE_PART = 128
"""Impacts that a worker takes at a time in machine code, some 10 ms of work."""


def computes_on_cpu() -> bool:
    """Whether machine code is for what JAX computes on."""
    return jax.default_backend() == "cpu"


def _kept_here(compile_kernel: Callable) -> Callable:
    """A function that compiles, with what it made kept for this process; None where
    there is no machine code, which is refused, or warned of, each time it is asked."""

    @functools.lru_cache(maxsize=32)
    def kernel_or_problem(*arguments):
        try:
            return compile_kernel(*arguments)
        except NoMachineCode as problem:
            return problem

    signature = inspect.signature(compile_kernel)
    locks: dict[tuple, threading.Lock] = {}

    @functools.wraps(compile_kernel)
    def compiled(*given, **by_name) -> Kernel | None:
        arguments = signature.bind(*given, **by_name)
        arguments.apply_defaults()  # that a kernel has one key, however it is asked for
        # Of threads that ask at once, one compiles.
        with locks.setdefault(arguments.args, threading.Lock()):
            found = kernel_or_problem(*arguments.args)
        if isinstance(found, NoMachineCode):
            without_machine_code(found)
            return None
        return found

    compiled.cache_clear = kernel_or_problem.cache_clear
    return compiled


@_kept_here
def compile_native(assembly: Assembly, sampled: bool = False) -> Kernel | None:
    """Machine code for an assembly of the model, from scenes, tolerance and floor. None
    if its laws, which may be the user's own, do what has no machine code.

    Args:
        sampled: also gives a `History` at times asked for on the way.
    """

    def compile_lanes() -> Code:
        # It loads diffrax, which takes a while.
        from .lane_functions import code_of_values

        return code_of_values(assembly, sampled)

    code = _kept_or_compiled(assembly, "sampled" if sampled else None, compile_lanes)
    structure = jax.tree.structure(numbers_of_no_value(assembly.ledger))
    return Kernel(code, structure, _retries(assembly))


def _retries(assembly: Assembly) -> Retries:
    """Impacts that fail are computed again with finer tolerances; not those that ran
    out of steps, and would do so again."""
    structure = jax.tree.structure(numbers_of_no_value(assembly.ledger))
    rows = jax.tree.unflatten(structure, range(structure.num_leaves))
    return Retries(
        assembly.structure.num_leaves,  # behind the leaves of a scene
        rows.outcome_code,
        rows.steps,
        float(Outcome.failed),
        MAX_STEPS,
        RETRIES,
    )


@_kept_here
def compile_native_along(
    assembly: Assembly, directions: int = 1, sampled: bool = False
) -> Kernel | None:
    """Machine code for an assembly of the model, from scenes, tolerance and floor, and
    directions along which it is differentiated. None as for `compile_native`.

    Args:
        directions: how many. Inputs end with a row for each leaf of the scene, its
            derivative along the direction, for each of them. They share steps, their
            control and branches, and all that the value needs. The code is the same
            whatever the leaves, so that it is compiled once. Results are a pair:
            numbers, and a tuple of their derivatives along the directions.
        sampled: as for `compile_native`; then each direction has a row more, behind
            its leaves, for the times asked for.

    Of the state, course and constants of the problem are differentiated; widths of
    steps, and with them the time, are not.
    """

    def compile_lanes() -> Code:
        from .lane_functions import code_of_derivatives

        return code_of_derivatives(assembly, directions, sampled)

    choice = "along", directions, *("sampled",) * sampled
    code = _kept_or_compiled(assembly, choice, compile_lanes)
    numbers = numbers_of_no_value(assembly.ledger)
    structure = jax.tree.structure((numbers, (numbers,) * directions))
    return Kernel(code, structure, _retries(assembly))


def _kept_or_compiled(
    assembly: Assembly, choice, compile_lanes: Callable[[], Code]
) -> Code:
    """The code of an assembly, from the disk if it is there."""
    key = _key(assembly, choice)
    if key is None:
        return compile_lanes()
    return Code.unpacked(kept(key, lambda: compile_lanes().packed()))


def without_machine_code(problem: NoMachineCode) -> None:
    """Warn that XLA computes what has no machine code, or refuse it if that is asked
    for."""
    reason = f"{problem} ({problem.place})" if problem.place else str(problem)
    if os.environ.get(REQUIRED):
        raise IncompleteError(
            f"the laws have no machine code, which {REQUIRED} asks for: {reason}"
        ) from problem
    _tell_slower_way(reason)


REQUIRED = "JAXIMPACT_REQUIRE_MACHINE_CODE"
"""Variable of the environment; where it is set, the slower way is not taken."""


@functools.cache
def _tell_slower_way(reason: str) -> None:
    """Warn, once for each reason, that impacts are computed by XLA."""
    warnings.warn(
        f"the laws have no machine code, and are computed by XLA: 10 to 20 times "
        f"slower, after half a minute of compiling: {reason}; set {REQUIRED}=1 to "
        "refuse this",
        NoMachineCodeWarning,
        stacklevel=2,
    )


def _key(assembly: Assembly, choice) -> str | None:
    """Names all that the code of an assembly depends on; None if the source of a law
    of the user's is not known, as in an interactive session."""
    structure = assembly.structure
    parts = described(jax.tree.unflatten(structure, list(range(structure.num_leaves))))
    if parts is None:
        return None
    choices = assembly._replace(structure=None), parts, choice
    return repr((choices, host(), *installed()))


@functools.cache
def installed() -> tuple[dict[str, str], str]:
    """Versions, and a digest of this package's source."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parents[1].rglob("*")):
        if path.suffix in (".py", ".ll"):
            digest.update(path.read_bytes())
    return versions(), digest.hexdigest()


def kernel_inputs(scene: Scene, accuracy: Accuracy) -> list[np.ndarray]:
    """Rows of inputs of the machine code, by the lanes of a scene of arrays."""
    setting = _setting(accuracy, len(scene.impact.speed))
    return [*jax.tree.leaves(scene), *setting]


def with_setting(leaves: np.ndarray, accuracy: Accuracy) -> np.ndarray:
    """The same of leaves of scenes `(leaves, lanes)`, as one array."""
    return np.concatenate([leaves, _setting(accuracy, leaves.shape[1])])


def _setting(accuracy: Accuracy, lanes: int) -> np.ndarray:
    """Tolerance and floor, `(2, lanes)`."""
    setting = np.array([[accuracy.tolerance], [accuracy.floor]])
    return np.broadcast_to(setting, (2, lanes))


def solve_alone(kernel: Kernel, inputs: list):
    """Results of one impact.

    Args:
        inputs: leaves of the scene, tolerance and floor: scalars.
    """
    results = solve_rows(kernel, np.array(inputs, float)[:, None])
    return jax.tree.map(lambda row: row[0], results)


def solve_by_leaves(kernel: Kernel, inputs: list, leaves: tuple[int, ...]):
    """Results of one impact, and a list of their derivatives by leaves of the scene.

    Args:
        kernel: of `compile_native_along`, by all leaves.
        inputs: as for `solve_alone`.
        leaves: one or more.
    """
    column = np.array(inputs, float)[:, None]
    rows = np.repeat(column, len(leaves), axis=1)
    numbers, along = solve_rows(kernel, along_leaves(rows, leaves))
    by_leaf = [jax.tree.map(lambda x, k=k: x[k], along) for k in range(len(leaves))]
    return jax.tree.map(lambda x: x[0], numbers), by_leaf


def along_leaves(inputs: np.ndarray, leaves) -> np.ndarray:
    """Rows of inputs of the code of `compile_native_along`, by all leaves.

    Args:
        inputs: `(rows, lanes)`, of the code without a direction.
        leaves: by which each lane is differentiated, `(lanes,)`, or one for all.
    """
    rows, lanes = inputs.shape
    directions = np.zeros((rows - 2, lanes))  # but tolerance and floor
    directions[leaves, np.arange(lanes)] = 1.0
    return np.concatenate([inputs, directions])


def solve_side_by_side(kernel: Kernel, scene: Scene, accuracy: Accuracy):
    """Results of scenes `(lanes,)`, in their order, by one core."""
    return solve_rows(kernel, np.stack(kernel_inputs(scene, accuracy)))


def solve_rows(kernel: Kernel, inputs: np.ndarray):
    """Results of inputs `(rows, lanes)`, in their order, by one core."""
    names = np.arange(inputs.shape[1])
    ended, results = kernel.workspace().run(names, inputs, wait=False)
    ordered = np.empty_like(results)
    ordered[:, ended] = results
    return jax.tree.unflatten(kernel.structure, list(ordered))


class NativeWorker:
    """Integrates parts of a batch, as it gets them, in machine code."""

    engine = "machine code"
    part = NATIVE_PART

    def __init__(self, kernel: Kernel, scene: Scene, accuracy: Accuracy):
        self.kernel = kernel
        self.rows = kernel_inputs(scene, accuracy)

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

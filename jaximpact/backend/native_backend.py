"""The native backend: the model in machine code, for lanes on a CPU."""

import concurrent.futures
import contextlib
import contextvars
import functools
import hashlib
import inspect
import os
import pickle
import threading
import warnings
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import jax

from .._packages import versions
from .._settings import thread_settings
from ..accuracy import MAX_STEPS, RETRIES
from ..errors import IncompleteError, NoMachineCodeWarning
from ..identity import clear_when_edited, described, heed_edits, tracing, users_code
from ..impact.events import Outcome
from ..impact.problem import Assembly, naming
from ..impact.results import empty_summary
from ..progress import tell
from ..progress_lines import showing
from ..store import kept
from .shipped import shipped_code
from .simd import (
    MOST_DIRECTIONS,
    Code,
    Kernel,
    Mode,
    NoMachineCode,
    Retries,
    host,
    keep_objects,
)

keep_objects(kept)

_COMPILING = threading.Lock()
"""Held by the kernel that tells that code is compiled."""
REQUIRED = "JAXIMPACT_REQUIRE_MACHINE_CODE"
"""Environment variable; where it is set, XLA does not stand in for machine code."""


def computes_on_cpu() -> bool:
    """Tell whether JAX computes on the CPU, for which machine code is."""
    return jax.default_backend() == "cpu"


def _kept_here(compile_kernel: Callable) -> Any:
    """Keep what a compiling function makes for this process; None where there is no
    machine code, which is refused, or warned of, at each call."""

    @functools.lru_cache(maxsize=32)
    def kernel_or_problem(*arguments):
        try:
            with tracing():
                return compile_kernel(*arguments)
        except NoMachineCode as problem:
            return problem

    signature = inspect.signature(compile_kernel)
    locks: dict[tuple, threading.Lock] = {}

    @functools.wraps(compile_kernel)
    def compiled(*positional, **by_name) -> Kernel | None:
        arguments = signature.bind(*positional, **by_name)
        arguments.apply_defaults()  # that a kernel has one key, however it is asked for
        heed_edits(arguments.args[0].structure)
        # Of threads that ask at once, one compiles.
        with locks.setdefault(arguments.args, threading.Lock()):
            kernel = kernel_or_problem(*arguments.args)
        if isinstance(kernel, NoMachineCode):
            if arguments.arguments.get("mode") == Mode.REVERSE:
                _tell_slower_way(GRADIENT_FORWARDS, reason_of(kernel))
            else:
                without_machine_code(kernel)
            return None
        return kernel

    function: Any = compiled
    function.cache_clear = kernel_or_problem.cache_clear
    clear_when_edited(kernel_or_problem.cache_clear)
    return function


@_kept_here
def compile_native(
    assembly: Assembly, mode: Mode = Mode.VALUES, sampled: bool = False
) -> Kernel | None:
    """Compile an assembly of the model, from scenes, tolerance and floor, or load its
    code from the disk. None if its laws, which may be the user's own, do what has no
    machine code.

    Args:
        mode: what it gives beside the numbers. `FORWARD` gives their derivatives along
            `MOST_DIRECTIONS` directions. Inputs then end with a row for each leaf of
            the scene, its derivative along the direction, for each of them. They share
            steps, their control and branches, and all that the value needs. The code
            is the same whatever the leaves, so that it is compiled once. Results are a
            pair: numbers, and a tuple of their derivatives along the directions.
            `REVERSE` gives a gradient: inputs end with a cotangent of each number, and
            results are a pair, numbers and cotangents of the leaves of the scene.
        sampled: whether it also gives a `History` at times asked for on the way; then
            each direction has a row more, behind its leaves, for these times.

    State of the solver and constants of the problem are differentiated; widths of
    steps, and with them the time, are not.
    """
    what, tree = naming(assembly, mode, sampled)

    def compile_lanes() -> Code:
        # It loads diffrax, which takes a while.
        from .lane_functions import code_of_lanes

        with _telling_how_long(mode, bool(users_code(tree))):
            return code_of_lanes(assembly, mode, sampled)

    code = kept_code(what, tree, compile_lanes)
    numbers = empty_summary(assembly.ledger)
    results = {
        Mode.VALUES: numbers,
        Mode.FORWARD: (numbers, (numbers,) * MOST_DIRECTIONS),
        Mode.REVERSE: (numbers, tree),
    }[mode]
    structure = jax.tree.structure(numbers)
    rows = jax.tree.unflatten(structure, range(structure.num_leaves))
    retries = Retries(
        assembly.structure.num_leaves,  # behind the leaves of a scene
        rows.outcome_code,
        rows.steps,
        float(Outcome.failed),
        MAX_STEPS,
        RETRIES,
    )
    return Kernel(code, jax.tree.structure(results), retries)


@contextlib.contextmanager
def _telling_how_long(mode: Mode, of_user: bool) -> Iterator[None]:
    """Tell that code is compiled, and how long that takes; of kernels that are compiled
    at once, the first one tells it."""
    if not _COMPILING.acquire(blocking=False):
        yield
        return
    try:
        # Code of a user's law is traced by each process, and LLVM's part is kept.
        what, low, high = {
            Mode.VALUES: ("values", 2, 4),
            Mode.FORWARD: ("derivatives", 3, 6),
            Mode.REVERSE: ("gradients", 6, 12),
        }[mode]
        low = low // 2 if of_user else low
        with showing(None, delay=0.0):
            tell(
                f"compiling machine code for {what}, once: {low} to {high} s on two "
                "idle cores"
            )
            yield
    finally:
        _COMPILING.release()


def compile_side_by_side(
    assemblies: Sequence[Assembly], mode: Mode = Mode.VALUES, sampled: bool = False
) -> list[Kernel | None]:
    """Compile assemblies of one structure as `compile_native` does, the largest model
    first: while LLVM compiles one of them in other processes, the next one is traced.

    Even a single one is traced in a thread of its own. Deep in the calls of JAX,
    Python 3.11 and later come to a point at which each further call asks the system for
    memory and gives it back, which makes tracing half as slow again.
    """
    structure = assemblies[0].structure
    context = contextvars.copy_context()

    def compile_in_thread(assembly: Assembly) -> Kernel | None:
        with thread_settings():
            return context.copy().run(compile_native, assembly, mode, sampled)

    # What a user's law changes as it is traced must not meet another trace.
    tree = jax.tree.unflatten(structure, range(structure.num_leaves))
    threads = 1 if users_code(tree) else len(assemblies)
    with concurrent.futures.ThreadPoolExecutor(threads) as pool:
        kernels = pool.map(compile_in_thread, reversed(assemblies))
        return list(kernels)[::-1]


BY_XLA = (
    "there is no machine code, and XLA computes: 10 to 20 times slower, after half a "
    f"minute of compiling: {{}}; set {REQUIRED}=1 to refuse this"
)
GRADIENT_FORWARDS = (
    "there is no machine code for gradients in reverse mode, and derivatives are taken "
    "one by one, each in about the time of the value: {}"
)


def without_machine_code(problem: NoMachineCode) -> None:
    """Warn that XLA computes what has no machine code, or refuse it if that is asked
    for."""
    if os.environ.get(REQUIRED):
        raise IncompleteError(
            f"there is no machine code, which {REQUIRED} asks for: {reason_of(problem)}"
        ) from problem
    _tell_slower_way(BY_XLA, reason_of(problem))


def reason_of(problem: NoMachineCode) -> str:
    """Say why there is no machine code, and where that stands."""
    return f"{problem} ({problem.place})" if problem.place else str(problem)


@functools.cache
def _tell_slower_way(how: str, reason: str) -> None:
    """Warn of a slower way, once for each reason."""
    warnings.warn(how.format(reason), NoMachineCodeWarning, stacklevel=2)


def kept_code(what: tuple, tree, make: Callable[[], Any]) -> Any:
    """Return the code that `make` compiles, or that was compiled before for the same.

    Where all is the package's, the code was shipped, or is kept on disk under the
    version and the source of the package. A user's law is traced by each process, since
    only then it is known what it computes; LLVM's part is kept all the same, under the
    text of the program.

    Args:
        what: names the code among all that is compiled for such a tree.
        tree: inputs of the code; its leaves do not count.
        make: gives what can be pickled.
    """
    if users_code(tree):
        return make()
    description = described(tree)
    if (shipped := shipped_code(what, description)) is not None:
        return shipped
    key = repr((what, description, host(), *installed()))
    return pickle.loads(kept(key, lambda: pickle.dumps(make())))


@functools.cache
def installed() -> tuple[dict[str, str], str]:
    """Return the versions of packages, and a digest of this package's source."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parents[1].rglob("*")):
        if path.suffix in (".py", ".ll"):
            digest.update(path.read_bytes())
    return versions(), digest.hexdigest()

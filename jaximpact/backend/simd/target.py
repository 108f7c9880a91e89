"""The processor and the operating system that machine code is made for, and the
functions of the system that it calls: for memory, for sorting, and for threads.

Only Linux on x86 was at hand. Code for others is made and looked at there, since
LLVM makes it for all: tests/unit/test_targets.py.
"""

import contextlib
import contextvars
import ctypes
import functools
from collections.abc import Callable, Iterator
from typing import NamedTuple

import llvmlite.binding as llvm

from .compiler import Machine, compile_module
from .graph import NoMachineCode

LEVELS = {
    "x86-64-v4": "avx2 bmi bmi2 f16c fma lzcnt movbe "
    "avx512f avx512bw avx512cd avx512dq avx512vl",
    "x86-64-v3": "avx2 bmi bmi2 f16c fma lzcnt movbe",
}
"""Levels of the processors of x86 and their features, the best first. Code for a level
runs as fast as code for one model, and takes half to three quarters of the time to
compile, as LLVM knows less of its instructions."""


class Target(NamedTuple):
    """A processor and an operating system, in LLVM's words."""

    triple: str
    cpu: str
    features: str

    @property
    def processor(self) -> str:
        """Family of the processor: "x86", "aarch64", or LLVM's name of another one."""
        name = self.triple.partition("-")[0]
        return {"x86_64": "x86", "arm64": "aarch64"}.get(name, name)

    @property
    def is_windows(self) -> bool:
        return "windows" in self.triple

    @property
    def object_triple(self) -> str:
        """Triple of object files. On Windows they are of ELF, as LLVM's loader takes
        them best; functions are called as Windows has it all the same."""
        is_coff = self.is_windows and not self.triple.endswith("-elf")
        return f"{self.triple}-elf" if is_coff else self.triple

    def has_small_code_model(self, external_calls: bool) -> bool:
        """Tell whether code reads its constants by relative addresses, LLVM's small
        code model, which takes 3 % less time than full addresses.

        Code with external calls does not, nor does a processor without fused
        multiply-adds, for which LLVM calls a library. On Windows code calls a function
        that touches its stack. It was tried on Linux on x86 only.
        """
        fused = "+fma" in self.features.split(",")
        tried = self.processor == "x86" and "linux" in self.triple
        return not external_calls and fused and tried

    @property
    def has_long_vectors(self) -> bool:
        """Tell whether a register holds eight numbers."""
        return "+avx512f" in self.features.split(",")

    def machine(self, external_calls: bool) -> Machine:
        """Describe this target to LLVM's compiler."""
        small = self.has_small_code_model(external_calls)
        return Machine(
            self.object_triple,
            self.cpu,
            self.features,
            relocation="pic" if small else "default",
            code_model="small" if small else "large",
        )

    def object_file(self, text: str, external_calls: bool) -> bytes:
        """Compile a text in LLVM's language, which names no target, to an object
        file."""
        return compile_module(self.machine(external_calls), text)


_level: contextvars.ContextVar[str | None] = contextvars.ContextVar(
    "level", default=None
)


@contextlib.contextmanager
def compiling_for(level: str) -> Iterator[None]:
    """Have code made for a level, whatever the processor."""
    token = _level.set(level)
    try:
        yield
    finally:
        _level.reset(token)


def host() -> tuple[str, str]:
    """Return name, or level, and features of the processor for which code is made."""
    has, asked = llvm.get_host_cpu_features(), _level.get()
    for level, features in LEVELS.items():
        needed = features.split()
        if asked == level or (asked is None and all(map(has.get, needed))):
            return level, ",".join(f"+{feature}" for feature in needed)
    return llvm.get_host_cpu_name(), has.flatten()


def this_target() -> Target:
    """Return the target that this process runs on, ready for code to be made and run.

    Raises NoMachineCode where there can be none.
    """
    target = Target(llvm.get_default_triple(), *host())
    _make_ready(target)
    return target


@functools.cache
def _make_ready(target: Target) -> None:
    if target.is_windows and target.processor != "x86":
        raise NoMachineCode(f"none is made for {target.processor} under Windows")
    try:
        llvm.check_jit_execution()
        if target.is_windows:
            register_functions(llvm.add_symbol)
    except (MissingFunction, OSError) as problem:
        raise NoMachineCode(str(problem)) from problem
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()


# --- Functions of the operating system.

FUNCTIONS_OF_WINDOWS = {
    # The driver calls the first ones; fma where the processor has no such instruction.
    "ucrtbase": ("malloc", "calloc", "free", "qsort", "memset", "memcpy", "fma"),
    # Touches each page of a stack frame of more than 4 KiB, which Windows asks for.
    "ntdll": ("__chkstk",),
}
"""Libraries of Windows, and what machine code calls there. Elsewhere LLVM finds
functions by itself; on Windows it would take them from any library of the process,
where memory may be kept otherwise."""


class MissingFunction(LookupError):
    """A function that the operating system does not have; the message is one line."""


class ThreadFunctions(NamedTuple):
    """Addresses of the functions that start a thread and wait for its end, as the
    driver takes them; None for what the system does not have."""

    create: int | None = None
    join: int | None = None
    """`pthread_create` and `pthread_join`."""
    create_thread: int | None = None
    wait: int | None = None
    close: int | None = None
    """`CreateThread`, `WaitForSingleObject` and `CloseHandle` of Windows."""


def register_functions(register: Callable[[str, int], None]) -> None:
    """Tell LLVM the names and addresses of the functions of Windows."""
    for library, names in FUNCTIONS_OF_WINDOWS.items():
        for name, address in zip(names, _addresses(library, *names), strict=True):
            register(name, address)


def thread_functions() -> ThreadFunctions:
    """Find the functions of threads. Where the system has none, lanes are computed by
    the thread that asks for them."""
    try:
        return ThreadFunctions(*_addresses(None, "pthread_create", "pthread_join"))
    except MissingFunction:
        pass
    names = "CreateThread", "WaitForSingleObject", "CloseHandle"
    try:
        return ThreadFunctions(None, None, *_addresses("kernel32", *names))
    except MissingFunction:
        return ThreadFunctions()


def _addresses(library: str | None, *names: str) -> list[int]:
    """Find functions of a library; None for what the process has loaded."""
    try:
        loaded = ctypes.CDLL(library)
        addresses = [
            ctypes.cast(getattr(loaded, n), ctypes.c_void_p).value for n in names
        ]
    except (AttributeError, OSError, TypeError) as problem:
        raise MissingFunction(
            f"{library or 'this system'} lacks a function that machine code calls: "
            f"{problem}"
        ) from None
    return [address for address in addresses if address is not None]

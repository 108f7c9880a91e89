"""Functions of the operating system that machine code calls: for memory, for sorting,
and for threads."""

import ctypes
from collections.abc import Callable
from typing import NamedTuple

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
    """Tell LLVM where the functions of Windows are.

    Args:
        register: takes the name and the address of a function.
    """
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

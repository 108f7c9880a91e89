"""The driver of driver.c: loading, and the structures that Python fills in."""

import ctypes
import functools
import importlib.resources
import threading
from typing import Any, NamedTuple

from llvmlite.binding import ExecutionEngine

from .object_files import compile_text, load
from .target import ThreadFunctions, this_target

PACKAGE = __name__.rpartition(".")[0]
PROGRAMS, MOST_RETRIES = 32, 7
POINTER, INTEGER, DOUBLE = ctypes.c_void_p, ctypes.c_int64, ctypes.c_double


class Program(ctypes.Structure):
    """Compiled lane functions; see driver.c."""

    _fields_ = (
        *((name, POINTER) for name in ("begin", "step", "finish", "sample")),
        *((name, INTEGER) for name in ("rows", "input_rows")),
        *((name, INTEGER) for name in ("results_row", "result_rows")),
        *((name, INTEGER) for name in ("tolerance", "outcome", "steps")),
        *((name, INTEGER) for name in ("time", "asked")),
        *((name, INTEGER) for name in ("sampled_row", "sampled_rows")),
        *((name, DOUBLE) for name in ("failed", "most_steps")),
        ("retries", DOUBLE * MOST_RETRIES),
        *((name, POINTER) for name in ("from_end", "over_step", "to_start")),
        ("taped_rows", POINTER),
        *((name, INTEGER) for name in ("taped", "accepted")),
    )


class Operation(ctypes.Structure):
    """Programs, and what they are computed for; see driver.c."""

    _fields_ = (
        ("count", INTEGER),
        ("programs", Program * PROGRAMS),
        ("waiting", INTEGER * PROGRAMS),
        *((name, POINTER) for name in ("make_ready", "problem")),
        *((name, INTEGER) for name in ("leaves", "directions", "samples")),
        ("threads", INTEGER),
        *((name, POINTER) for name in ThreadFunctions._fields),
    )


class Course(ctypes.Structure):
    """Samples of one lane at its start and after every step; see driver.c."""

    _fields_ = (
        ("samples", POINTER),
        ("room", INTEGER),
        ("count", INTEGER),
        ("reached", DOUBLE),
    )


class Rows(ctypes.Structure):
    """Lanes to compute, and where their results go; see driver.c."""

    _fields_ = (
        ("operation", POINTER),
        *((name, INTEGER) for name in ("lanes", "threads", "own_inputs", "times")),
        *((name, POINTER) for name in ("common", "places", "own", "effort", "program")),
        *((name, POINTER) for name in ("along", "times_asked")),
        *((name, POINTER) for name in ("results", "samples", "course")),
    )


COMPUTE_ROWS = ctypes.CFUNCTYPE(INTEGER, POINTER)
MAKE_READY = ctypes.CFUNCTYPE(INTEGER, INTEGER)
FLOAT_MODE = {
    "x86": """
declare void @llvm.x86.sse.stmxcsr(ptr)
declare void @llvm.x86.sse.ldmxcsr(ptr)
define i64 @enter_float_mode() {
  %at = alloca i32
  call void @llvm.x86.sse.stmxcsr(ptr %at)
  %before = load i32, ptr %at
  store i32 8064, ptr %at
  call void @llvm.x86.sse.ldmxcsr(ptr %at)
  %result = zext i32 %before to i64
  ret i64 %result
}
define void @leave_float_mode(i64 %before) {
  %at = alloca i32
  %mode = trunc i64 %before to i32
  store i32 %mode, ptr %at
  call void @llvm.x86.sse.ldmxcsr(ptr %at)
  ret void
}
""",
    "aarch64": """
declare i64 @llvm.aarch64.get.fpcr()
declare void @llvm.aarch64.set.fpcr(i64)
define i64 @enter_float_mode() {
  %before = call i64 @llvm.aarch64.get.fpcr()
  call void @llvm.aarch64.set.fpcr(i64 0)
  ret i64 %before
}
define void @leave_float_mode(i64 %before) {
  call void @llvm.aarch64.set.fpcr(i64 %before)
  ret void
}
""",
    "": """
define i64 @enter_float_mode() {
  ret i64 0
}
define void @leave_float_mode(i64 %before) {
  ret void
}
""",
}
"""Functions, by processor, that set arithmetic as the standard has it. XLA has its
threads flush small numbers to zero, and results would depend on the thread."""


class Driver(NamedTuple):
    """The driver as loaded for one operation of XLA."""

    engine: ExecutionEngine
    operation: Operation
    alive: Any = None
    """What the operation points to."""

    @property
    def handler(self) -> int:
        """Address of the function that serves XLA."""
        return self.engine.get_function_address("impacts")


@functools.cache
def driver_object() -> bytes:
    """Compile the driver into an object file."""
    return compile_text(driver_text(this_target().processor), external_calls=True)


def driver_text(processor: str) -> str:
    """Return the driver in LLVM's language, for any operating system."""
    text = (importlib.resources.files(PACKAGE) / "driver.ll").read_text("utf-8")
    return text + FLOAT_MODE.get(processor, FLOAT_MODE[""])


def load_driver() -> Driver:
    """Load the driver, with an operation of its own that is still to be filled in."""
    engine = load([driver_object()], external_calls=True)
    address = engine.get_global_value_address("operation")
    return Driver(engine, Operation.from_address(address))


_shared: list = []
_lock = threading.Lock()


def compute_rows(rows: Rows) -> None:
    """Compute lanes; other threads of Python go on meanwhile. Raises MemoryError."""
    # One driver for all, never unloaded: threads that start at once must not load two
    # of which one is thrown away under the other's feet.
    with _lock:
        if not _shared:
            engine = load_driver().engine
            address = engine.get_function_address("compute_rows")
            _shared.extend((COMPUTE_ROWS(address), engine))
    if _shared[0](ctypes.addressof(rows)):
        raise MemoryError(f"too little memory for {rows.lanes} impacts at once")

"""Machine code for systems that are not at hand: what LLVM makes for them, and the
functions of theirs that it calls."""

import ctypes
import threading
import types

import jax.numpy as jnp
import llvmlite.binding as llvm
import numpy as np
import pytest
from object_symbols import undefined

from jaximpact.backend import operation
from jaximpact.backend.simd import (
    KernelSet,
    NoMachineCode,
    compile_kernel,
    kernel,
    target,
)
from jaximpact.backend.simd import target as functions
from jaximpact.backend.simd.driver import driver_text
from jaximpact.backend.simd.object_files import module_of
from jaximpact.backend.simd.tables import entries
from jaximpact.backend.simd.target import Target

WINDOWS = Target("x86_64-pc-windows-msvc", "x86-64-v3", "+fma,+avx2")
WITHOUT_FUSED = Target("x86_64-pc-windows-msvc", "x86-64", "+sse2")
MACOS = Target("arm64-apple-darwin23.4.0", "apple-m1", "")
LINUX = Target("x86_64-unknown-linux-gnu", "x86-64-v3", "+fma,+avx2")

ALLOWED = {
    WINDOWS: {
        name for names in functions.FUNCTIONS_OF_WINDOWS.values() for name in names
    },
    # bzero is how LLVM fills with zeros there.
    MACOS: {"_malloc", "_calloc", "_free", "_qsort", "_memset", "_memcpy", "_bzero"},
}
ALLOWED[WITHOUT_FUSED] = ALLOWED[WINDOWS]
MACHINES = {WINDOWS: (18, b"\x3e\0"), MACOS: (4, b"\x0c\0\0\x01")}
"""Where an object file names its processor, and what stands there."""


@pytest.fixture(scope="module", autouse=True)
def all_targets():
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()


@pytest.fixture(scope="module")
def text():
    """A kernel in LLVM's language: with a loop, elementary functions, quotients
    and a table."""
    made, compile_functions = [], kernel.compile_functions

    def noted(functions, *how):
        made.append(module_of(functions))
        return compile_functions(functions, *how)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(kernel, "compile_functions", noted)
        compile_kernel(
            lambda x: (x, jnp.zeros(1)),
            lambda s: ((s[0] - 1.0, s[1] + jnp.exp(-s[0]) / (1.0 + s[0])), s[0] > 0.0),
            lambda x, s: jnp.sin(s[1]) + jnp.sqrt(x) + entries(x, s[0], 1)[0],
            jnp.zeros(1),
        )
    return made[0]


@pytest.mark.parametrize(
    "target", ALLOWED, ids=lambda each: f"{each.triple} {each.cpu}"
)
def test_code_calls_only_what_the_system_has(target, text):
    of_kernel = target.object_file(text, external_calls=False)
    of_driver = target.object_file(driver_text(target.processor), external_calls=True)
    assert undefined(of_kernel) <= ALLOWED[target] - {"malloc", "calloc", "qsort"}
    # Of the driver the least are known too, so that no empty table of symbols passes.
    least = {"calloc", "free", "malloc", "qsort"}
    assert {name.lstrip("_") for name in undefined(of_driver)} >= least
    assert undefined(of_driver) <= ALLOWED[target]
    if target in MACHINES:
        place, machine = MACHINES[target]
        assert of_kernel[place : place + len(machine)] == machine
        assert of_driver[place : place + len(machine)] == machine


def test_the_processor_without_fused_multiply_adds_calls_for_them(text):
    assert "fma" in undefined(WITHOUT_FUSED.object_file(text, False))
    assert "fma" not in undefined(WINDOWS.object_file(text, False))


def test_a_large_frame_on_windows_is_touched_page_by_page():
    """Windows gives a stack page by page, and ends a process that leaves one out."""
    text = """
    define void @begin(ptr %out) {
      %frame = alloca [1024 x i64]
      store volatile i64 1, ptr %frame
      %read = load volatile i64, ptr %frame
      store i64 %read, ptr %out
      ret void
    }"""
    assert undefined(WINDOWS.object_file(text, False)) == {"__chkstk"}
    assert undefined(MACOS.object_file(text, False)) == set()


@pytest.mark.parametrize(
    ("target", "register"),
    [(WINDOWS, "(%rcx)"), (LINUX, "(%rdi)"), (MACOS, "[x0]")],
    ids=["Windows", "Linux", "macOS"],
)
def test_arguments_are_where_the_system_has_them(target, register):
    text = "define i64 @f(ptr %a) {\n %r = load i64, ptr %a\n ret i64 %r\n}"
    assert register in target.machine(False).make().emit_assembly(
        llvm.parse_assembly(text)
    )


@pytest.mark.parametrize(
    ("target", "expected"),
    [
        (WINDOWS, ("x86", "x86_64-pc-windows-msvc-elf", False)),
        (
            Target("x86_64-pc-windows-msvc-elf", "x86-64-v3", "+fma"),
            ("x86", "x86_64-pc-windows-msvc-elf", False),
        ),
        (MACOS, ("aarch64", "arm64-apple-darwin23.4.0", False)),
        (
            Target("x86_64-apple-darwin23.4.0", "", "+fma"),
            ("x86", "x86_64-apple-darwin23.4.0", False),
        ),
        (LINUX, ("x86", "x86_64-unknown-linux-gnu", True)),
        (
            Target("aarch64-unknown-linux-gnu", "", "+fma"),
            ("aarch64", "aarch64-unknown-linux-gnu", False),
        ),
        (
            Target("riscv64-unknown-linux-gnu", "", ""),
            ("riscv64", "riscv64-unknown-linux-gnu", False),
        ),
    ],
    ids=lambda each: each.triple if isinstance(each, Target) else "",
)
def test_how_code_is_made_for_a_target(target, expected):
    processor, triple, small = expected
    assert target.processor == processor
    assert target.object_triple == triple
    assert target.has_small_code_model(external_calls=False) is small
    assert not target.has_small_code_model(external_calls=True)


# --- Where there can be no machine code.


def no_memory():
    raise OSError(13, "cannot allocate executable memory")


@pytest.mark.parametrize(
    ("triple", "check", "told"),
    [
        ("aarch64-pc-windows-msvc", None, "none is made for aarch64 under Windows"),
        ("x86_64-pc-windows-msvc", None, "ucrtbase lacks a function"),
        (None, no_memory, "cannot allocate executable memory"),
    ],
)
def test_where_there_can_be_none_it_says_why(monkeypatch, triple, check, told):
    if triple:
        monkeypatch.setattr(llvm, "get_default_triple", lambda: triple)
    if check:
        monkeypatch.setattr(llvm, "check_jit_execution", check)
    target._make_ready.cache_clear()
    with pytest.raises(NoMachineCode, match=told):
        compile_kernel(lambda x: x, lambda x: (x, x > 0.0), lambda _, x: x, jnp.ones(1))
    target._make_ready.cache_clear()


# --- The functions of Windows.

HANDLE = 0x7700000001
"""Of a first thread: does not fit into 32 bits."""


class Threads:
    """`CreateThread`, `WaitForSingleObject` and `CloseHandle`, by threads of Python."""

    def __init__(self, most=100):
        self.running, self.closed, self.most = {}, [], most
        pointer, number = ctypes.c_void_p, ctypes.c_uint32
        self.work = ctypes.CFUNCTYPE(number, pointer)
        of_create = pointer, ctypes.c_size_t, pointer, pointer, number, pointer
        self.CreateThread = ctypes.CFUNCTYPE(pointer, *of_create)(self.create)
        self.WaitForSingleObject = ctypes.CFUNCTYPE(number, pointer, number)(self.wait)
        self.CloseHandle = ctypes.CFUNCTYPE(ctypes.c_int, pointer)(self.close)

    def create(self, security, stack, work, argument, flags, name):
        assert (security, stack, flags, name) == (None, 0, 0, None)
        if len(self.running) == self.most:
            return None
        handle = HANDLE + len(self.running)
        work = self.work(work)
        self.running[handle] = threading.Thread(target=work, args=(argument,))
        self.running[handle].start()
        return handle

    def wait(self, handle, milliseconds):
        assert milliseconds == 0xFFFFFFFF
        self.running[handle].join()
        return 0

    def close(self, handle):
        assert not self.running[handle].is_alive()
        self.closed.append(handle)
        return 1


def windows(monkeypatch, **libraries):
    """Puts the libraries of Windows in place of those that there are."""

    def load(name):
        if name is None:
            raise TypeError("LoadLibrary() argument 1 must be str, not None")
        if name not in libraries:
            raise FileNotFoundError(f"Could not find module {name!r}")
        return libraries[name]

    monkeypatch.setattr(ctypes, "CDLL", load)


@pytest.mark.parametrize("most", [100, 1, 0])
def test_the_driver_starts_threads_of_windows(monkeypatch, most):
    """As many as it is given, and waits for each of them."""
    lanes = np.linspace(1.0, 50.0, 100)
    # Another sum for each case, since an operation is made once for the same code.
    made = compile_kernel(
        lambda x: (x, jnp.zeros(1)),
        lambda s: ((s[0] - 1.0, s[1] + (most + 1.0) / s[0]), s[0] > 1.0),
        lambda x, s: s[1],
        jnp.zeros(1),
    )
    (sums,), _ = KernelSet([made]).compute(lanes[None], threads=1)
    threads = Threads(most)
    windows(monkeypatch, kernel32=threads)
    monkeypatch.setattr(operation, "thread_count", lambda: 4)
    common, effort, program = jnp.zeros(1), -lanes, np.zeros(100)
    sum_ = KernelSet([made])
    (found,) = operation.call(sum_, common, [0], [lanes], effort, program)
    np.testing.assert_array_equal(np.asarray(found), sums)
    assert len(threads.running) == min(most, 3)
    assert sorted(threads.closed) == sorted(threads.running)


def test_where_there_are_no_threads_one_computes(monkeypatch):
    windows(monkeypatch)
    assert functions.thread_functions() == functions.ThreadFunctions()


def test_functions_of_windows_are_told_by_their_addresses(monkeypatch):
    function = ctypes.CFUNCTYPE(None)(lambda: None)
    address = ctypes.cast(function, ctypes.c_void_p).value
    libraries = {
        library: types.SimpleNamespace(**dict.fromkeys(names, function))
        for library, names in functions.FUNCTIONS_OF_WINDOWS.items()
    }
    windows(monkeypatch, **libraries)
    told = {}
    functions.register_functions(told.__setitem__)
    assert told == dict.fromkeys(ALLOWED[WINDOWS], address)
    del libraries["ntdll"].__chkstk
    with pytest.raises(functions.MissingFunction, match=r"ntdll lacks .*__chkstk"):
        functions.register_functions(told.__setitem__)

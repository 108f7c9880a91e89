"""Object files: machine code compiled, or kept from another time, and loaded."""

import pickle
from collections.abc import Callable, Sequence
from importlib.metadata import version

import llvmlite.binding as llvm
import numpy as np

from ..threads import thread_count
from .compiler import compile_apart, compile_module
from .functions import Function
from .llvm_ir import DECLARATIONS, HALF, PACK, Vectors
from .target import this_target

APART = 5_000
"""Lines for which a process is started to compile them: it takes 0.1 s to start, and
they some 0.2 s. Fewer are compiled here."""

Keep = Callable[[str, Callable[[], bytes]], bytes]
_keep: Keep = lambda _, make: make()  # noqa: E731


def keep_objects(keep: Keep) -> None:
    """Have object files kept, since LLVM takes seconds: `keep` gives what is kept under
    a key, or what a function makes and it keeps."""
    global _keep
    _keep = keep


def lanes_for(differentiated: bool) -> int:
    """Choose how many lanes the vectors of functions have, with derivatives or without.

    Where a register holds four numbers, there are sixteen of them: vectors of eight
    take two each, and what derivatives need at once does not fit. With vectors of four
    they run a fifth faster, and compile in a third of the time. Values alone would run
    a fifth slower: half of the lanes does not keep the processor busy.
    """
    halves = differentiated and not this_target().has_long_vectors
    return HALF if halves else PACK


def vectors_of(lanes: int) -> Vectors:
    """Return the types of vectors of so many lanes, for this processor."""
    return Vectors(lanes, lanes == PACK and this_target().has_long_vectors)


def compile_text(text: str, external_calls: bool = False) -> bytes:
    """Return the machine code for this computer, as an object file.

    External calls are those of functions of libraries.

    Raises NoMachineCode where this computer can run none.
    """
    target = this_target()
    return _kept(text, external_calls, lambda: target.object_file(text, external_calls))


def compile_functions(
    functions: Sequence[Function], differentiated: bool, thorough: bool = False
) -> list[bytes]:
    """Return the machine code of functions, with derivatives or without, as object
    files in the order in which they are to be loaded. What is `thorough` takes longer
    to compile, and runs faster.

    Raises NoMachineCode where this computer can run none.
    """
    target = this_target()
    text = module_of(functions)

    def make() -> bytes:
        machine, objects = target.machine(external_calls=False), None
        count = min(text.count("\n") // APART, thread_count())
        # Without LLVM's scheduling values alone run slower: a tenth where a register
        # holds eight numbers, some 5 % where it holds four.
        scheduled = thorough or target.has_long_vectors
        if count and (differentiated or not scheduled):
            objects = compile_apart(machine, _modules(functions, count))
        if objects is None:
            objects = [compile_module(machine, text)]
        elif heads := "\n".join(f.head + f.declarations for f in functions):
            objects.append(compile_module(machine, heads))
        return pickle.dumps(objects)

    return pickle.loads(_kept(text, False, make))


def _kept(text: str, external_calls: bool, make: Callable[[], bytes]) -> bytes:
    """Return what is made of a text, or was another time.

    The key is the text itself, with every constant in it: whatever a user's law refers
    to, other numbers are other code.
    """
    how = external_calls, this_target(), version("llvmlite")
    return _keep(repr(("object", *how, text)), make)


def module_of(functions: Sequence[Function]) -> str:
    """Write functions as one module."""
    texts = [part for function in functions for part in function.parts]
    heads = (function.head for function in functions)
    return "\n".join([*texts, *heads, DECLARATIONS])


def _modules(functions: Sequence[Function], count: int) -> list[str]:
    """Write the parts of functions as at most so many modules of about the same
    length."""
    parts = [part for function in functions for part in function.parts]
    ends = np.cumsum([len(part) for part in parts])
    modules: list[list[str]] = [[] for _ in range(count)]
    for part, end in zip(parts, ends, strict=True):
        modules[count * int(end - 1) // int(ends[-1])].append(part)
    return ["\n".join([*texts, DECLARATIONS]) for texts in modules if texts]


def load(objects: Sequence[bytes], external_calls: bool = False):
    """Make an engine of LLVM with machine code put to where it can run; the code is
    there as long as the engine lives."""
    target = this_target()
    small = target.has_small_code_model(external_calls)
    # Relative addresses reach 2 GB. llvmlite's memory manager keeps constants beside
    # the code, but aborts the process where code has external calls.
    engine = llvm.create_mcjit_compiler(
        llvm.parse_assembly(""),
        target.machine(external_calls).make(),
        use_lmm=small or None,
    )
    for object_file in objects:
        engine.add_object_file(llvm.ObjectFileRef.from_data(object_file))
    engine.finalize_object()
    return engine

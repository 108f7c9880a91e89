"""Compilation by LLVM, here or in processes of its own.

LLVM compiles one module at a time in a process (llvmlite), and its options hold for all
that a process compiles, other packages' code too. So long code is compiled by child
processes, side by side and with options of their own. A child runs this file as a
script and imports llvmlite alone, in a tenth of a second.
"""

import pickle
import signal
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

if __name__ == "__main__":  # in a child, which finds no packages by itself
    sys.path.insert(0, sys.argv[1])

import llvmlite.binding as llvm

NO_SCHEDULING = "-enable-misched=false"
"""Option without LLVM's scheduling of instructions. Of derivatives it takes a fifth of
the time to compile, and what comes out runs slower: the order in which nodes are made
is better."""


class Machine(NamedTuple):
    """What code is compiled for, in LLVM's words."""

    triple: str
    cpu: str
    features: str
    relocation: str
    code_model: str

    def make(self) -> llvm.TargetMachine:
        return llvm.Target.from_triple(self.triple).create_target_machine(
            cpu=self.cpu,
            features=self.features,
            opt=2,
            reloc=self.relocation,
            codemodel=self.code_model,
            jit=True,
        )


def compile_module(machine: Machine, text: str) -> bytes:
    """Compile a module in LLVM's language, which names no target, to an object file."""
    made, module = machine.make(), llvm.parse_assembly(text)
    # With them come the names that the system has for functions: `_malloc`.
    module.triple = made.triple
    module.data_layout = str(made.target_data)
    return made.emit_object(module)


def compile_apart(machine: Machine, texts: Sequence[str]) -> list[bytes] | None:
    """Compile modules in child processes, without scheduling; None where no child can
    be started, or one fails."""
    # What embeds Python, or is frozen, is no interpreter that could run a script.
    if not Path(sys.executable or "").stem.lower().startswith("python"):
        return None
    packages = str(Path(llvm.__file__).parents[2])
    command = [sys.executable, "-I", "-S", __file__, packages]
    children, objects = [], []
    try:
        for text in texts:
            child = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
            )
            children.append(child)
            assert child.stdin is not None
            # A child reads all before it writes: none waits for another.
            with child.stdin as to_child:
                pickle.dump((tuple(machine), text), to_child)
        for child in children:
            assert child.stdout is not None
            with child.stdout as from_child:
                objects.append(from_child.read())
            if child.wait() or not objects[-1]:
                return None
    except OSError:
        return None
    finally:
        for child in children:
            child.kill()
            child.wait()
    return objects


def main() -> None:
    """Compile the module that stands in the standard input."""
    # Ctrl-C is the parent's, which waits no longer than for this one module.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    machine, text = pickle.load(sys.stdin.buffer)
    llvm.set_option("", NO_SCHEDULING)
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    sys.stdout.buffer.write(compile_module(Machine(*machine), text))


if __name__ == "__main__":
    main()

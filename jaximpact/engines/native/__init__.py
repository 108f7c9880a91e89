"""Machine code for many lanes, by LLVM, from the functions of the model in JAX."""

from .code import host
from .kept import kept
from .kernel import (
    Code,
    Kernel,
    LaneFunctions,
    Retries,
    Workspace,
    compile_code,
    compile_kernel,
)
from .translation import NoMachineCode

__all__ = [
    "Code",
    "Kernel",
    "LaneFunctions",
    "NoMachineCode",
    "Retries",
    "Workspace",
    "compile_code",
    "compile_kernel",
    "host",
    "kept",
]

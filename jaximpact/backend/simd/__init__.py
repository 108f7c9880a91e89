"""Machine code for many lanes, by LLVM, from the functions of the model in JAX."""

from .kernel import (
    MOST_DIRECTIONS,
    Code,
    Derivatives,
    Kernel,
    LaneFunctions,
    Retries,
    compile_code,
    compile_kernel,
)
from .kernel_set import KernelSet, Waiting
from .lower_jaxpr import NoMachineCode
from .object_files import keep_objects
from .target import LEVELS, compiling_for, host

__all__ = [
    "LEVELS",
    "MOST_DIRECTIONS",
    "Code",
    "Derivatives",
    "Kernel",
    "KernelSet",
    "LaneFunctions",
    "NoMachineCode",
    "Retries",
    "Waiting",
    "compile_code",
    "compile_kernel",
    "compiling_for",
    "host",
    "keep_objects",
]

"""Machine code for many lanes, by LLVM, from the functions of the model in JAX."""

from .kernel import (
    Code,
    Derivatives,
    Kernel,
    LaneFunctions,
    Retries,
    compile_code,
    compile_kernel,
)
from .kernel_set import KernelSet
from .lower_jaxpr import NoMachineCode
from .object_files import keep_objects
from .target import host

__all__ = [
    "Code",
    "Derivatives",
    "Kernel",
    "KernelSet",
    "LaneFunctions",
    "NoMachineCode",
    "Retries",
    "compile_code",
    "compile_kernel",
    "host",
    "keep_objects",
]

"""Machine code for many lanes, by LLVM, from the functions of the model in JAX."""

from .graph import NoMachineCode
from .kernel import (
    MOST_DIRECTIONS,
    Code,
    Derivatives,
    Kernel,
    LaneFunctions,
    Mode,
    Retries,
    compile_code,
    compile_kernel,
    compile_reverse,
)
from .kernel_set import ALONG_INPUTS, KernelSet, Waiting
from .object_files import keep_objects
from .reverse import Reverse
from .target import LEVELS, compiling_for, host

__all__ = [
    "ALONG_INPUTS",
    "LEVELS",
    "MOST_DIRECTIONS",
    "Code",
    "Derivatives",
    "Kernel",
    "KernelSet",
    "LaneFunctions",
    "Mode",
    "NoMachineCode",
    "Retries",
    "Reverse",
    "Waiting",
    "compile_code",
    "compile_kernel",
    "compile_reverse",
    "compiling_for",
    "host",
    "keep_objects",
]

"""Machine code for many lanes, by LLVM, from the functions of the model in JAX."""

from .kernel import Kernel, Workspace, compile_kernel

__all__ = ["Kernel", "Workspace", "compile_kernel"]

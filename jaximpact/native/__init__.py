"""Machine code for many lanes, by LLVM, from the functions of the model in JAX.

An accelerator that may be missing: it needs llvmlite (`pip install jaximpact[native]`).
"""

from .kernel import Kernel, Workspace, compile_kernel, is_available

__all__ = ["Kernel", "Workspace", "compile_kernel", "is_available"]

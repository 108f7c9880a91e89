"""Speed against accuracy, measured: this solver and others on the same impacts."""

from .run import run_benchmark
from .section import Settings

__all__ = ["Settings", "run_benchmark"]

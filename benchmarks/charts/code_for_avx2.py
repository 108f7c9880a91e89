"""This solver with the code for AVX2, which processors without AVX-512 take."""

import concurrent.futures
import functools
from collections.abc import Callable

import jax
import numpy as np

from jaximpact.backend.simd import compiling_for, host
from jaximpact.scene import Scene

from ..impacts import Answer
from ..processes import process_pool
from .gradients import forward_gradient
from .methods import Ours

LEVEL = "x86-64-v3"


class OursForAvx2:
    """`simulate` and `simulate_batch` in a process of their own, since a process keeps
    code for one level of processors."""

    name = "jaximpact, code for AVX2"
    family = Ours.family
    tolerances = Ours.tolerances

    def solve(self, scenes: Scene, tolerance: float, batch: bool) -> Answer:
        """Impacts all at once on every core, or one after another."""
        return _in_process(Ours().solve, scenes, tolerance, batch)

    def gradient(
        self, scenes: Scene, batch: bool, tolerance: float
    ) -> tuple[np.ndarray, float]:
        """As `forward_gradient`."""
        return _in_process(forward_gradient, scenes, batch, tolerance)


def methods_for_avx2() -> list[OursForAvx2]:
    """The method, where the processor would take other code."""
    return [OursForAvx2()] if host()[0] == "x86-64-v4" else []


@functools.cache
def _process() -> concurrent.futures.ProcessPoolExecutor:
    return process_pool(1)


def _in_process(function: Callable, scenes: Scene, *more):
    scenes = jax.tree.map(np.asarray, scenes)
    return _process().submit(_with_code_for_avx2, function, scenes, *more).result()


def _with_code_for_avx2(function: Callable, *arguments):
    with jax.enable_x64(True), compiling_for(LEVEL):
        return function(*arguments)

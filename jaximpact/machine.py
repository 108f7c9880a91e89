"""The model in machine code, for lanes on a CPU."""

import functools
import hashlib
from pathlib import Path

import jax
import numpy as np

from .accuracy import Accuracy
from .block import Block
from .lanes import start_lanes, step_lanes
from .laws import Laws
from .native import Code, Kernel, compile_code, host, kept
from .problem import Assembly
from .provenance import versions
from .scene import Impact, Scene
from .soil import Soil
from .summary import Numbers, numbers_of_no_value, summarise_lanes


def computes_on_cpu() -> bool:
    """Whether machine code is for what JAX computes on."""
    return jax.default_backend() == "cpu"


@functools.lru_cache(maxsize=16)
def compile_native(assembly: Assembly) -> Kernel:
    """Machine code for an assembly of the model, from scenes, tolerance and floor.

    Raises NotImplementedError if its laws do what has no native code.
    """
    structure = jax.tree.structure(numbers_of_no_value(assembly.ledger))
    if assembly.laws != Laws():
        # Functions of the user's own have no key.
        return Kernel(_compile(assembly), structure)
    return Kernel(kept(_key(assembly), lambda: _compile(assembly)), structure)


def _key(assembly: Assembly) -> str:
    """Names all that the code of an assembly of the usual laws depends on."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.rglob("*")):
        if path.suffix in (".py", ".ll"):
            digest.update(path.read_bytes())
    choices = assembly._replace(laws=None)
    return repr((choices, host(), versions(), digest.hexdigest()))


def _compile(assembly: Assembly) -> Code:
    def begin(inputs):
        scenes, tolerance, floor = inputs
        return start_lanes(assembly, scenes, tolerance[0], floor[0])

    def step(lanes):
        lanes = step_lanes(lanes)
        return lanes, lanes.going

    def finish(inputs, lanes):
        return summarise_lanes(inputs[0], lanes)

    one = jax.ShapeDtypeStruct((1,), float)
    scenes = jax.tree.map(lambda _: one, Scene(Block(), Soil(), Impact()))
    return compile_code(begin, step, finish, (scenes, one, one))


def kernel_inputs(scene: Scene, accuracy: Accuracy) -> list[np.ndarray]:
    """Rows of inputs of the machine code, by the lanes of a scene of arrays."""
    lanes = np.shape(scene.impact.speed)
    setting = (np.broadcast_to(x, lanes) for x in (accuracy.tolerance, accuracy.floor))
    return [*jax.tree.leaves(scene), *setting]


def solve_alone(assembly: Assembly, scene: Scene, accuracy: Accuracy) -> Numbers:
    """Numbers of one impact.

    Raises NotImplementedError if the laws do what has no machine code.
    """
    kernel = compile_native(assembly)
    inputs = np.stack(kernel_inputs(scene, accuracy))[:, None]
    _, results = kernel.workspace().run(np.zeros(1, int), inputs, wait=False)
    return jax.tree.unflatten(kernel.structure, list(results[:, 0]))

"""Which kernels compute impacts: of each lane the cheapest model that is exact."""

import functools
import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import jax
import numpy as np

from .._jax_internals import Tracer, namespace_of, number_in
from .._types import Structure
from ..errors import IncompleteError
from ..identity import clear_when_edited, described, users_code
from ..impact.dynamics import LedgerItems
from ..impact.problem import Assembly, naming
from ..impact.reduced_models import MODELS, PLANAR, PLANAR_DAMPED, exact_models
from ..scene import Scene
from .native_backend import compile_side_by_side, computes_on_cpu
from .request import Request
from .simd import Kernel, KernelSet, Mode, Waiting


def choose(
    wanted: Request, values: list, varied: Sequence[int], mode: Mode = Mode.VALUES
):
    """Choose the kernels, and give the effort of each lane and the index of its kernel;
    None where there is no machine code, or none is asked for."""
    if not (wanted.engine.is_machine_code and computes_on_cpu()):
        return None
    # A derivative leaves the symmetry that a cheaper model rests on.
    known = [x if isinstance(x, Tracer) else np.asarray(x) for x in values]
    leaves = wanted.leaves(known)
    many = any(isinstance(x, Tracer) or x.ndim for x in known)
    if many:
        scene = jax.tree.unflatten(wanted.structure, leaves)
        # What is one number for all lanes decides as that number does.
        known = [number_in(x) if isinstance(x, Tracer) else x for x in known]
        leaves = wanted.leaves(known, varied)
        models, possible = exact_models(jax.tree.unflatten(wanted.structure, leaves))
    else:
        models, possible = _exact_model(
            wanted.structure,
            tuple(
                math.nan if place in varied else float(leaves[place])
                for place in _deciding(wanted.structure)
            ),
        )
    key = _Key(
        structure=wanted.structure,
        ledger=wanted.ledger,
        sampled=wanted.sampled,
        possible=tuple(possible),
        mode=mode,
        certain=not isinstance(models, Tracer),
    )
    kernels = _kernels(key)
    if kernels is None:
        return None
    program = sum(((models > place) * 1.0 for place in possible[:-1]), 0.0)
    return kernels, _effort(scene) if many else 0.0, program


@functools.lru_cache(maxsize=256)
def _deciding(structure) -> tuple[int, ...]:
    posture, damping, _ = groups_of_leaves(structure)
    return tuple(sorted(posture | damping))


@functools.lru_cache(maxsize=1024)
def _exact_model(structure, deciding: tuple[float, ...]):
    """`exact_models` of a single impact, by the values that decide."""
    leaves = [np.nan] * structure.num_leaves
    for place, value in zip(_deciding(structure), deciding, strict=True):
        leaves[place] = np.float64(value)
    return exact_models(jax.tree.unflatten(structure, leaves))


clear_when_edited(_exact_model.cache_clear)


@functools.lru_cache(maxsize=256)
def groups_of_leaves(structure) -> tuple[set[int], set[int], set[int]]:
    """Return the leaves of a scene: those that may leave the symmetry, of dashpots,
    others."""
    scene = jax.tree.unflatten(structure, range(structure.num_leaves))
    posture = {*jax.tree.leaves((scene.block.shape, scene.impact))}
    posture -= {scene.impact.speed}
    damping = {*jax.tree.leaves(scene.soil.damping)}
    return posture, damping, {*range(structure.num_leaves)} - posture - damping


def _effort(scene: Scene):
    """Compute a number that is larger for shorter contacts, to begin the longest ones
    first, so that few lanes stand empty at the end.

    Contacts are long where the speed into the ground is small beside what gravity gives
    over the size of a block.
    """
    block, impact = scene.block, scene.impact
    xp = namespace_of(*jax.tree.leaves(scene))
    with np.errstate(all="ignore"):  # of values out of their ranges
        size = xp.cbrt(block.mass / block.density)
        return impact.speed * xp.cos(impact.angle) / xp.sqrt(size)


class _Key(NamedTuple):
    """What a set of kernels is for."""

    structure: Structure
    ledger: LedgerItems
    sampled: bool
    possible: tuple[int, ...]
    """Places in `MODELS` of those that lanes may need."""
    mode: Mode
    certain: bool
    """Whether it is known that lanes need all of these models."""

    def compile(self, assemblies: list[Assembly]) -> list[Kernel | None]:
        return compile_side_by_side(assemblies, self.mode, self.sampled)


_kernel_sets: dict[_Key, KernelSet] = {}
clear_when_edited(_kernel_sets.clear)


def _kernels(key: _Key) -> KernelSet | None:
    """Return the kernels of the possible models; None where one of them has no machine
    code. If it is not certain that lanes need them all, the planar model is compiled at
    once, without dashpots if that is possible, and the others wait."""
    if key not in _kernel_sets:
        assemblies = [
            Assembly(key.structure, MODELS[k], key.ledger) for k in key.possible
        ]
        at_once = assemblies
        waiting: dict[Assembly, Any] = {}
        if not key.certain:
            planar = [one for one in assemblies if one.model in (PLANAR, PLANAR_DAMPED)]
            first = (planar or assemblies)[0]
            waiting = {one: _waiting(key, one) for one in assemblies if one != first}
            # All at once where one may not wait
            at_once = assemblies if None in waiting.values() else [first]
        compiled = key.compile(at_once)
        if None in compiled:
            return None
        ready = dict(zip(at_once, compiled, strict=True))
        kernels = [ready.get(one) or waiting[one] for one in assemblies]
        _kernel_sets[key] = KernelSet(kernels)
    return _kernel_sets[key]


def _waiting(key: _Key, assembly: Assembly) -> Waiting | None:
    """Describe a kernel that is compiled later; None if it is not known what all it
    depends on, or if dashpots are a user's, which might have no machine code."""
    what, tree = naming(assembly, key.mode, key.sampled)
    description = described(tree)
    if description is None or users_code(tree.soil.damping):
        return None
    compile_it = functools.partial(_compile_later, key, assembly)
    return Waiting(repr((what, description)), compile_it)


def _compile_later(key: _Key, assembly: Assembly) -> Kernel:
    (kernel,) = key.compile([assembly])
    if key not in _kernel_sets:
        # Its other kernels are of the laws as they were.
        raise IncompleteError("a law was edited since JAX compiled this; call it again")
    if kernel is None:
        raise IncompleteError(f"there is none for the {assembly.model.name} model")
    return kernel

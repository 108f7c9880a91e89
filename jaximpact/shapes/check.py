"""Checks of users' shapes, before they are used."""

import functools
import math
import os
import traceback
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np

from ..errors import InputError
from ..identity import PACKAGE, clear_when_edited, tracing
from ..interruption import is_interrupt
from ..parameters import Part, declared_of
from .base import AbstractShape, Section

RATIOS = {"aspect_ratio": "H/R", "out_of_plane_ratio": "W/R"}
ANGLES = (0.0, 0.3, 0.25 * math.pi, 1.2, 0.5 * math.pi, 2.0, math.pi, -0.7)
"""Orientations at which a shape is tried [rad]."""
DEPTHS = (-0.1, 0.0, 1e-6, 0.1, 0.9, 1.0, 1.3, 2.0, 2.5)
"""Depths of the lowest point at which a shape is tried, over the support [-]."""
TRACED = (
    jax.errors.ConcretizationTypeError,
    jax.errors.TracerArrayConversionError,
    jax.errors.TracerBoolConversionError,
    jax.errors.TracerIntegerConversionError,
)


def check_shape(shape: AbstractShape) -> None:
    """Try a user's shape, once for each class and its static fields.

    Raises InputError that names class and function, says what came and what is needed:
    for a missing ratio, NumPy on what is differentiated, results that are not scalars,
    values or derivatives that are not finite, and half sizes that the support does not
    have.
    """
    for kind in getattr(type(shape), "kinds", (type(shape),)):
        if kind.__module__.partition(".")[0] != PACKAGE:
            same = isinstance(shape, kind)
            # The first call may stand inside of a `jax.jit`.
            with jax.ensure_compile_time_eval():
                _check_shape(jax.tree.structure(shape if same else kind()))


@functools.cache
@tracing()
def _check_shape(structure) -> None:
    shape = with_defaults(structure)
    kind = type(shape)
    for name, meaning in RATIOS.items():
        if name not in declared_of(kind):
            raise InputError(
                f"{kind.__name__} has no parameter {name}; declare it: {name}: Scalar "
                f'= parameter(1.0, "-", "(0, inf)", "{meaning}")'
            )
    turn, depth = (np.ravel(x) for x in np.meshgrid(ANGLES, DEPTHS))
    axes, volume, inertia = tried(shape, "unit_volume", _sizes, ())
    for name, value in (("unit_volume", volume), ("unit_inertia", inertia)):
        if not value > 0.0:
            raise InputError(
                f"{kind.__name__}.{name} must be positive, but is {value:g}"
            )

    def support(shape, angle):
        return shape.support(shape.semi_axes(1.0, 1.0), jnp.sin(angle), jnp.cos(angle))

    def arm(shape, angle):
        return shape.tangency_arm(
            shape.semi_axes(1.0, 1.0), jnp.sin(angle), jnp.cos(angle)
        )

    def section(shape, angle, depth):
        axes = shape.semi_axes(1.0, 1.0)
        sin, cos = jnp.sin(angle), jnp.cos(angle)
        height = shape.support(axes, sin, cos)
        found = shape.section(axes, sin, cos, height * (1.0 - depth), height * depth)
        if not (isinstance(found, tuple) and len(found) == len(Section._fields)):
            raise InputError(
                f"{kind.__name__}.section must return Section(left, right, width), but "
                f"returns {type(found).__name__}"
            )
        return Section(*found)

    heights = tried(shape, "support", support, (turn,))
    tried(shape, "tangency_arm", arm, (turn,))
    found = tried(shape, "section", section, (turn, depth))
    _check_half_sizes(kind, axes, support, shape)
    if not np.all(heights > 0.0):
        raise InputError(f"{kind.__name__}.support must be positive")
    cut = (depth > 0.0) & (depth < 2.0)
    bad = cut & ((found.right < found.left) | (found.width < 0.0))
    if np.any(bad):
        place = int(np.argmax(bad))
        raise InputError(
            f"{kind.__name__}.section must return left <= right and a width that is "
            f"not negative, but returns left {found.left[place]:g}, right "
            f"{found.right[place]:g}, width {found.width[place]:g}{_where(turn, place)}"
        )


clear_when_edited(_check_shape.cache_clear)


def _sizes(shape):
    return shape.semi_axes(1.0, 1.0), shape.unit_volume, shape.unit_inertia


def _check_half_sizes(kind, axes, support, shape) -> None:
    """Raise InputError unless H and R are the supports along the axes, and the block is
    symmetric."""
    for angle, name, size in ((0.0, "H", axes.major), (90.0, "R", axes.minor)):
        found = float(support(shape, jnp.radians(angle)))
        if not math.isclose(found, size, rel_tol=1e-6):
            raise InputError(
                f"{kind.__name__}.support at {angle:g} degrees must be the half size "
                f"{name}, {size:.6g}, but is {found:.6g}"
            )
    for angle in (0.3, 1.2):
        here = float(support(shape, angle))
        for other in (-angle, angle + math.pi):
            there = float(support(shape, other))
            if not math.isclose(here, there, rel_tol=1e-6):
                raise InputError(
                    f"{kind.__name__}.support must be that of a block symmetric about "
                    f"its axes, but is {here:.6g} at {math.degrees(angle):.3g} degrees "
                    f"and {there:.6g} at {math.degrees(other):.3g}"
                )


def with_defaults(structure) -> Part:
    """Make the part of a tree structure, with the default of each parameter."""
    count = structure.num_leaves
    part = jax.tree.unflatten(structure, [jnp.zeros(())] * count)
    usual = {
        name: type(part).__dataclass_fields__[name].default
        for name in declared_of(type(part))
    }
    for name, value in usual.items():
        object.__setattr__(part, name, jnp.asarray(value, float))
    return part


def tried(part: Part, name: str, function: Callable, inputs: tuple[np.ndarray, ...]):
    """Try a function of a part, scalar by scalar over arrays of inputs.

    Args:
        name: name of the method that is tried, for errors.
        function: from the part and one number of each input to a tree of scalars.

    Raises InputError for what cannot be traced or differentiated, is not a scalar, or
    is not finite.
    """
    told = f"{type(part).__name__}.{name}"
    numbers = [jnp.zeros(()) for _ in inputs]
    try:
        shapes = jax.eval_shape(function, part, *numbers)
    except InputError:
        raise
    except TRACED as error:
        raise InputError(
            f"{told} uses NumPy, float() or `if` on a value that is being traced"
            f"{_line(error)}; use jax.numpy, and jnp.where in place of `if`"
        ) from error
    except BaseException as error:
        if is_interrupt(error):
            raise
        raise InputError(
            f"{told} cannot be computed: {type(error).__name__}: {error}{_line(error)}"
        ) from error
    for path, leaf in jax.tree_util.tree_leaves_with_path(shapes):
        place = f" ({path[-1].name})" if path and hasattr(path[-1], "name") else ""
        shape, kind = np.shape(leaf), np.result_type(leaf)
        if shape != () or kind.kind != "f":
            came = f"an array of shape {shape}" if shape else f"a value of type {kind}"
            raise InputError(
                f"{told}{place} must return a number, but returns {came} for numbers"
            )

    def flat(part, *numbers):
        return jax.tree.map(jnp.asarray, function(part, *numbers))

    along = (None, *[0] * len(inputs))
    values = flat(part) if not inputs else jax.vmap(flat, along)(part, *inputs)
    slopes = jax.jacfwd(flat, argnums=tuple(range(len(inputs) + 1)))
    slopes = slopes(part) if not inputs else jax.vmap(slopes, along)(part, *inputs)
    for what, tree in (("", values), (" has a derivative that", slopes)):
        for leaf in jax.tree.leaves(tree):
            bad = ~np.isfinite(np.asarray(leaf))
            if np.any(bad):
                place = int(np.argmax(bad))
                where = _where(inputs[0], place) if inputs else ""
                raise InputError(
                    f"{told}{what} is not finite{where}; where a root or a quotient is "
                    "not needed, give it a harmless argument by jnp.where before it is "
                    "taken"
                )
    return jax.tree.map(np.asarray, values)


def _where(turn, place: int) -> str:
    return f" at an orientation of {math.degrees(turn[place]):.3g} degrees"


def _line(error: BaseException) -> str:
    """Find the line of the user's file in which an error arose."""
    frames = traceback.extract_tb(error.__traceback__)
    ours = [f for f in frames if not _is_installed(f.filename)]
    return f" ({ours[-1].filename}, line {ours[-1].lineno})" if ours else ""


def _is_installed(file: str) -> bool:
    root = os.path.dirname(__file__)
    return "site-packages" in file or file.startswith((root, "<"))

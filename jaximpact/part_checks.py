"""Checks of users' laws and shapes, before they are used."""

import concurrent.futures
import functools
import inspect
import math
import re
import sys
import traceback
from collections.abc import Callable
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from ._settings import thread_settings
from .errors import InputError
from .finding import describe_error
from .identity import clear_when_edited, is_ours, made_of, tracing
from .interruption import is_interrupt
from .laws.bearing import AbstractBearing, AbstractPeakFriction
from .laws.branch import Branch
from .laws.elasticity import AbstractDamping, AbstractElasticity, Damping, Stiffness
from .laws.flow import AbstractFlow, FlowRate
from .laws.hardening import AbstractHardening
from .laws.kinematics import AbstractKinematics
from .laws.loading_surface import AbstractLoadingSurface, Forces, Load
from .laws.slider import AbstractSlider
from .parameters import Part, declared_of
from .shapes import AbstractShape, Foundation, Section, SemiAxes

LANES = 2
"""Numbers in the arrays that laws are tried with, one for each impact."""
CENTRAL_LOADS = (0.005, 0.02, 0.5)
"""Sizes of central loads: below yield at the start of a contact, and above."""
RATIOS = {"aspect_ratio": "H/R", "out_of_plane_ratio": "W/R"}
ASPECT_RATIOS = (0.5, 2.0)
"""Aspect ratios at which a shape is tried, beside its default, if they are in range:
errors may not show in a round block."""
ANGLES = (0.0, 0.3, 0.25 * math.pi, 1.2, 0.5 * math.pi, 2.0, math.pi, -0.7)
"""Orientations at which a shape is tried [rad]."""
DEPTHS = (-0.1, 0.0, 1e-6, 0.1, 0.9, 1.0, 1.3, 2.0, 2.5)
"""Depths of the lowest point at which a shape is tried, over the support [-]."""


def check_part(slot: str, part: Part) -> None:
    """Try a law or a shape of a user's, once for each class and its static fields, with
    the defaults of its parameters, whatever its numbers are. A shape is tried elongated
    and flattened too.

    Raises InputError, naming the part, what it does and the cure, unless it can be
    computed with, and differentiated, as the model does it.
    """
    for kind in made_of(type(part)) or (type(part),):
        if not is_ours(kind):
            alone = part if isinstance(part, kind) else kind()
            _check_once(slot, jax.tree.structure(alone))


@functools.lru_cache(maxsize=256)
def _check_once(slot: str, structure: Any) -> None:
    # The first call may stand inside of a `jax.jit`; a new thread is outside of it.
    with concurrent.futures.ThreadPoolExecutor(1) as pool:
        pool.submit(_check, slot, structure).result()


def _check(slot: str, structure: Any) -> None:
    with thread_settings(), tracing():
        _try_part(slot, structure)


def _try_part(slot: str, structure: Any) -> None:
    part = jax.tree.unflatten(structure, [jnp.zeros(())] * structure.num_leaves)
    for parameter, declared in declared_of(type(part)).items():
        object.__setattr__(part, parameter, jnp.asarray(declared.si_default, float))
    name = f"{slot} {type(part).__name__}"
    check = _check_shape if isinstance(part, AbstractShape) else _check_law
    try:
        check(name, part)
    except InputError:
        raise
    except BaseException as error:
        if is_interrupt(error):
            raise
        raise InputError(f"{name}: {_problem(type(part), error)}") from error


clear_when_edited(_check_once.cache_clear)


def _problem(kind: type, error: BaseException) -> str:
    """Describe an error inside a part, where it stands, and the cure."""
    frames = traceback.extract_tb(error.__traceback__)
    module = getattr(sys.modules.get(kind.__module__), "__file__", None)
    lines = [frame.lineno for frame in frames if frame.filename == module]
    where = f" in line {lines[-1]} of {module}" if lines else ""
    said = describe_error(error)
    looked_at = "truth value of an array" in said or "Only scalar arrays" in said
    if isinstance(error, jax.errors.TracerArrayConversionError):
        return (
            f"numpy is used{where} on values of JAX; use jax.numpy, which has the same "
            "functions"
        )
    if looked_at or isinstance(error, jax.errors.ConcretizationTypeError):
        return (
            f"a value is looked at{where}, by if, float() or a function of math, which "
            "is not known when it is compiled; use jnp.where and jax.numpy"
        )
    if isinstance(error, TypeError) and not lines:
        methods = {
            name: getattr(base, name)
            for base in reversed(kind.__mro__)
            for name in sorted(getattr(base, "__abstractmethods__", ()))
            if callable(getattr(base, name))
        }
        named = methods.keys() & {*re.findall(r"(\w+)\(\)", said)}
        needed = (
            f"{n}{_arguments(methods[n])}" for n in methods if n in named or not named
        )
        return f"{said}; the model calls {' and '.join(needed)}"
    return f"{said}{where}"


def _arguments(method) -> str:
    signature = inspect.signature(method)
    plain = [
        parameter.replace(annotation=inspect.Parameter.empty)
        for parameter in signature.parameters.values()
    ]
    return str(inspect.Signature(plain))


def _kind(value) -> str:
    if isinstance(value, jax.Array):
        return f"an array of {value.dtype}"
    if isinstance(value, tuple):
        return f"a {type(value).__name__} of {len(value)}"
    return f"{value!r} ({type(value).__name__})"


# --- Laws.


class Call(NamedTuple):
    """A call of a method of a law, as the model makes it."""

    method: str
    arguments: tuple
    keywords: dict
    result: type | None
    """A tuple of named fields, or None for one number."""


def _calls(law: Part, x) -> list[Call]:
    foundation = Foundation(*[x] * 6)
    on = {"branch": Branch(*[x > 0.0] * (len(Branch._fields) - 1))}
    flow, stiffness = FlowRate(x, x, x), Stiffness(x, x, x)
    if isinstance(law, AbstractElasticity):
        return [Call("__call__", (foundation, x, x), on, Stiffness)]
    if isinstance(law, AbstractDamping):
        return [Call("__call__", (stiffness, x, x), {}, Damping)]
    if isinstance(law, AbstractPeakFriction):
        return [Call("__call__", (x, x), {}, None)]
    if isinstance(law, AbstractBearing):
        return [Call("__call__", (foundation, x, law.factors(x)), on, None)]
    if isinstance(law, AbstractLoadingSurface):
        return [Call("__call__", (Forces(x, x, x), x, foundation, x), {}, Load)]
    if isinstance(law, AbstractFlow):
        return [Call("__call__", (Load(*[x] * 6), x, foundation), on, FlowRate)]
    if isinstance(law, AbstractHardening):
        return [Call("__call__", (x, flow, foundation), on, None)]
    if isinstance(law, AbstractKinematics):
        return [Call("sinking_arm", (foundation,), {}, None)]
    assert isinstance(law, AbstractSlider), type(law)
    return [
        Call("friction", (x,), {}, None),
        Call("__call__", (x, x, x, x), on, None),
    ]


def _check_law(name: str, law: Part) -> None:
    structure = jax.tree.structure(law)

    def called(x):
        of_lanes = jax.tree.unflatten(structure, [x] * structure.num_leaves)
        results = []
        for call in _calls(of_lanes, x):
            result = getattr(of_lanes, call.method)(*call.arguments, **call.keywords)
            _check_result(name, call, result)
            results.append(result)
        return results

    x = jax.ShapeDtypeStruct((LANES,), float)
    jax.eval_shape(lambda x: jax.jvp(called, (x,), (x,)), x)
    if isinstance(law, AbstractFlow):
        _check_flow(name, law)


def _check_result(name: str, call: Call, result) -> None:
    if call.result is not None:
        fields = call.result._fields
        if not all(hasattr(result, field) for field in fields):
            raise InputError(
                f"{name}: {call.method} returned {_kind(result)}, but "
                f"{call.result.__name__}({', '.join(fields)}) is needed"
            )
        values = {f"{call.result.__name__}.{f}": getattr(result, f) for f in fields}
    else:
        values = {"the result": result}
    for what, value in values.items():
        is_array = isinstance(value, np.ndarray | np.number | jax.Array)
        plain = isinstance(value, int | float) and not isinstance(value, bool)
        if not plain and not (is_array and value.dtype == np.float64):
            raise InputError(
                f"{name}: {call.method} gave {_kind(value)} for {what}, but a float64 "
                "number is needed"
            )
        shape = np.shape(value)
        if not plain and shape != (LANES,):
            raise InputError(
                f"{name}: {call.method} was given arrays of shape ({LANES},), one "
                f"number for each impact, and gave shape {shape} for {what}; use "
                "functions that work place by place (jnp.where, jnp.maximum)"
            )


def _check_flow(name: str, law: AbstractFlow) -> None:
    """Raise InputError where a central load makes the ground flow aside, or below yield
    though the law says that nothing flows there."""
    size, one = np.array(CENTRAL_LOADS), np.ones(len(CENTRAL_LOADS))
    load = Load(size, one, 0.0 * one, 0.0 * one, one, one)
    foundation = Foundation(one, one, 0.1 * one, one, 0.0 * one, 0.0 * one)
    yields_at = 0.01
    # One program of XLA, where each operation by itself would be compiled alone.
    flow = jax.jit(lambda *arguments: law(*arguments))(
        load, yields_at * one, foundation
    )
    aside = np.abs(flow.tangential) + np.abs(flow.rotational)
    if np.any(aside > 0.0):
        raise InputError(
            f"{name}: gives a tangential or rotational rate of {np.max(aside):.3g} "
            "under a central load; it must be zero there, by symmetry"
        )
    early = np.where(size < yields_at, np.abs(flow.normal), 0.0)
    if not law.flows_below_yield and np.any(early > 0.0):
        raise InputError(
            f"{name}: says flows_below_yield = False, but flows at "
            f"{np.max(early):.3g} m/s below yield; remove flows_below_yield = False"
        )


# --- Shapes.


def _check_shape(name: str, shape: AbstractShape) -> None:
    for ratio, meaning in RATIOS.items():
        if ratio not in declared_of(type(shape)):
            raise InputError(
                f"{name} has no parameter {ratio}; declare it: {ratio}: Scalar "
                f'= parameter(1.0, "-", "(0, inf)", "{meaning}")'
            )
    ratios = _aspect_ratios(type(shape))
    ratio, turn, depth = (
        np.ravel(x) for x in np.meshgrid(ratios, ANGLES, DEPTHS, indexing="ij")
    )

    def semi_axes(shape, ratio):
        return _elongated(shape, ratio).semi_axes(1.0, 1.0)

    def support(shape, ratio, angle):
        shape = _elongated(shape, ratio)
        return shape.support(shape.semi_axes(1.0, 1.0), jnp.sin(angle), jnp.cos(angle))

    def arm(kind, shape, ratio, angle):
        shape = _elongated(shape, ratio)
        axes = shape.semi_axes(1.0, 1.0)
        return kind.tangency_arm(shape, axes, jnp.sin(angle), jnp.cos(angle))

    def section(shape, ratio, angle, depth):
        shape = _elongated(shape, ratio)
        axes, sin, cos = shape.semi_axes(1.0, 1.0), jnp.sin(angle), jnp.cos(angle)
        height = shape.support(axes, sin, cos)
        cut = shape.section(axes, sin, cos, height * (1.0 - depth), height * depth)
        if not (isinstance(cut, tuple) and len(cut) == len(Section._fields)):
            raise InputError(
                f"{name}: section must return Section(left, right, width), but returns "
                f"{_kind(cut)}"
            )
        return Section(*cut)

    for what in ("unit_volume", "unit_inertia"):

        def of_unit_size(shape, ratio, what=what):
            return getattr(_elongated(shape, ratio), what)

        values = _try(f"{name}: {what}", shape, of_unit_size, ratios)
        bad = ~(values > 0.0)
        if np.any(bad):
            raise InputError(
                f"{name}: {what} must be positive, but is {values[np.argmax(bad)]:g}"
                f"{_where(bad, ratios)}"
            )
    axes = _try(f"{name}: semi_axes", shape, semi_axes, ratios)
    heights = _try(f"{name}: support", shape, support, ratio, turn)
    arms, slopes = (
        _try(f"{name}: tangency_arm", shape, functools.partial(arm, kind), ratio, turn)
        for kind in (type(shape), AbstractShape)
    )
    _check_arms(name, arms, slopes, ratio, turn)
    sections = _try(f"{name}: section", shape, section, ratio, turn, depth)
    _check_half_sizes(name, ratios, axes, jax.jit(functools.partial(support, shape)))
    if not np.all(heights > 0.0):
        raise InputError(f"{name}: support must be positive")
    cut = (depth > 0.0) & (depth < 2.0)
    bad = cut & ((sections.right < sections.left) | (sections.width < 0.0))
    if np.any(bad):
        left, right, width = (of[np.argmax(bad)] for of in sections)
        raise InputError(
            f"{name}: section must return left <= right and a width that is not "
            f"negative, but returns left {left:g}, right {right:g}, width {width:g}"
            f"{_where(bad, ratio, turn)}"
        )


def _check_arms(
    name: str,
    arms: np.ndarray,
    slopes: np.ndarray,
    ratio: np.ndarray,
    turn: np.ndarray,
) -> None:
    """Raise InputError where tangency arms are not the slopes of the support, but at
    orientations where a face may be level."""
    tilted = np.abs(np.sin(4.0 * turn)) > 1e-6
    # By far more than the rounding of sizes near 1 m.
    bad = tilted & (np.abs(arms - slopes) > 1e-6)
    if np.any(bad):
        first = np.argmax(bad)
        raise InputError(
            f"{name}: tangency_arm must be the derivative of support by the "
            f"orientation, {slopes[first]:.6g}, but is {arms[first]:.6g}"
            f"{_where(bad, ratio, turn)}"
        )


def _aspect_ratios(kind: type) -> np.ndarray:
    declared = declared_of(kind)["aspect_ratio"]
    lower, upper = declared.ends
    others = [ratio for ratio in ASPECT_RATIOS if lower < ratio < upper]
    return np.array([declared.si_default, *others])


def _elongated(shape: AbstractShape, ratio) -> AbstractShape:
    return eqx.tree_at(lambda shape: shape.aspect_ratio, shape, ratio)


def _check_half_sizes(
    name: str, ratios: np.ndarray, axes: SemiAxes, support: Callable
) -> None:
    for ratio, major, minor in zip(ratios, axes.major, axes.minor, strict=True):
        for angle, half, size in ((0.0, "H", major), (90.0, "R", minor)):
            here = float(support(ratio, math.radians(angle)))
            if not math.isclose(here, size, rel_tol=1e-6):
                raise InputError(
                    f"{name}: support at {angle:g} degrees must be the half size "
                    f"{half}, {size:.6g}, but is {here:.6g} at an aspect ratio of "
                    f"{ratio:g}"
                )
        for angle in (0.3, 1.2):
            here = float(support(ratio, angle))
            for other in (-angle, angle + math.pi):
                there = float(support(ratio, other))
                if not math.isclose(here, there, rel_tol=1e-6):
                    raise InputError(
                        f"{name}: support must be that of a block symmetric about its "
                        f"axes, but is {here:.6g} at {math.degrees(angle):.3g} degrees "
                        f"and {there:.6g} at {math.degrees(other):.3g}, at an aspect "
                        f"ratio of {ratio:g}"
                    )


def _try(name: str, shape: AbstractShape, function: Callable, *inputs: np.ndarray):
    """Try a function of a shape and of one number of each input, scalar by scalar over
    arrays of inputs, and return its values. Inputs are aspect ratio, orientation and
    depth, or the first of them.

    Raises InputError for what is no scalar, or is not finite; and whatever the function
    raises as it is traced or differentiated.
    """
    numbers = [jnp.zeros(()) for _ in inputs]
    results = jax.eval_shape(function, shape, *numbers)
    for path, leaf in jax.tree_util.tree_leaves_with_path(results):
        place = f" ({path[-1].name})" if path and hasattr(path[-1], "name") else ""
        if leaf.shape != () or leaf.dtype.kind != "f":
            came = f"an array of shape {leaf.shape}" if leaf.shape else str(leaf.dtype)
            raise InputError(
                f"{name}{place} must return a number, but returns {came} for numbers"
            )

    def arrays(shape, *numbers):
        return jax.tree.map(jnp.asarray, function(shape, *numbers))

    slopes = jax.jacfwd(arrays, argnums=tuple(range(len(inputs) + 1)))
    along = (None, *[0] * len(inputs))

    # One program of XLA, where each operation by itself would be compiled alone.
    @jax.jit
    def computed(*arguments):
        return tuple(jax.vmap(f, along)(*arguments) for f in (arrays, slopes))

    values, slopes = computed(shape, *inputs)
    for what, tree in (("", values), (" has a derivative that", slopes)):
        for leaf in jax.tree.leaves(tree):
            bad = ~np.isfinite(np.asarray(leaf))
            if np.any(bad):
                where = _where(bad, *inputs)
                raise InputError(
                    f"{name}{what} is not finite{where}; where a root or a quotient is "
                    "not needed, give it a harmless argument by jnp.where before it is "
                    "taken"
                )
    return jax.tree.map(np.asarray, values)


def _where(bad: np.ndarray, ratio: np.ndarray, *inputs: np.ndarray) -> str:
    first = int(np.argmax(bad))
    words = f" at an aspect ratio of {ratio[first]:g}"
    if inputs:
        angle = math.degrees(inputs[0][first])
        words += f" and an orientation of {angle:.3g} degrees"
    return words

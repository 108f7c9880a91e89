"""Checks of users' laws, before they are used."""

import inspect
import sys
import traceback
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..errors import InputError
from ..interruption import is_interrupt
from ..parameters import Part
from ..shapes import Foundation
from .bearing import AbstractBearing, AbstractPeakFriction
from .branch import Branch
from .elasticity import AbstractDamping, AbstractElasticity, Damping, Stiffness
from .flow import AbstractFlow, FlowRate
from .hardening import AbstractHardening
from .kinematics import AbstractKinematics
from .loading_surface import AbstractLoadingSurface, Forces, Load
from .slider import AbstractSlider

LANES = 2
"""Numbers in the arrays that laws are tried with, one for each impact."""
CENTRAL_LOADS = (0.005, 0.02, 0.5)
"""Sizes of central loads: below yield at the start of a contact, and above."""


class Call(NamedTuple):
    """A call of a method of a law, as the model makes it."""

    method: str
    arguments: tuple
    keywords: dict
    result: type | None
    """A tuple of named fields, or None for one number."""


def _calls(law: Part, x) -> list[Call]:
    """Return the calls that the model makes, with one array for every number."""
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


def check_law(slot: str, law: Part) -> None:
    """Raise InputError, naming the law, what it does and the cure, unless its methods
    can be called, and differentiated, as the model does it.

    Args:
        slot: what the law is for, as in "flow".
        law: whatever its numbers are.
    """
    name = f"{slot} {type(law).__name__}"
    structure = jax.tree.structure(law)

    def called(x):
        of_lanes = jax.tree.unflatten(structure, [x] * structure.num_leaves)
        found = []
        for call in _calls(of_lanes, x):
            result = getattr(of_lanes, call.method)(*call.arguments, **call.keywords)
            _check_result(name, call, result)
            found.append(result)
        return found

    x = jax.ShapeDtypeStruct((LANES,), float)
    try:
        jax.eval_shape(lambda x: jax.jvp(called, (x,), (x,)), x)
        if isinstance(law, AbstractFlow):
            _check_symmetry(name, law)
    except InputError:
        raise
    except BaseException as error:
        if is_interrupt(error):
            raise
        raise InputError(f"{name}: {_problem(type(law), error)}") from error


def _check_result(name: str, call: Call, result) -> None:
    """Raise InputError unless a call gave what it must."""
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


def _check_symmetry(name: str, law: AbstractFlow) -> None:
    """Raise InputError where a central load makes the ground flow aside."""
    size, one = jnp.array(CENTRAL_LOADS), jnp.ones(len(CENTRAL_LOADS))
    load = Load(size, one, 0.0 * one, 0.0 * one, one, one)
    foundation = Foundation(one, one, 0.1 * one, one, 0.0 * one, 0.0 * one)
    flow = law(load, 0.01 * one, foundation)
    aside = np.abs(flow.tangential) + np.abs(flow.rotational)
    if np.any(aside > 0.0):
        raise InputError(
            f"{name}: gives a tangential or rotational rate of {np.max(aside):.3g} "
            "under a central load; it must be zero there, by symmetry"
        )


def _kind(value) -> str:
    if isinstance(value, jax.Array):
        return f"an array of {value.dtype}"
    if isinstance(value, tuple):
        return f"a {type(value).__name__} of {len(value)}"
    return f"{value!r} ({type(value).__name__})"


def _problem(kind: type, error: BaseException) -> str:
    """Describe an error inside a law, where it stands, and the cure."""
    frames = traceback.extract_tb(error.__traceback__)
    module = getattr(sys.modules.get(kind.__module__), "__file__", None)
    lines = [frame.lineno for frame in frames if frame.filename == module]
    where = f" in line {lines[-1]} of {module}" if lines else ""
    told = str(error).partition("\n")[0]
    looked_at = "truth value of an array" in told or "Only scalar arrays" in told
    if isinstance(error, jax.errors.TracerArrayConversionError):
        return (
            f"numpy is used{where} on values of JAX; use jax.numpy, which has the same "
            "functions"
        )
    if looked_at or isinstance(error, jax.errors.ConcretizationTypeError):
        return (
            f"a value is looked at{where}, by if, float() or a function of math, which "
            "is not known when a law is compiled; use jnp.where and jax.numpy"
        )
    if isinstance(error, TypeError) and not lines:
        base = [b for b in kind.__mro__ if "Abstract" in b.__name__][-1]
        needed = " and ".join(
            f"{method}{_arguments(getattr(base, method))}"
            for method in sorted(base.__abstractmethods__)
        )
        return f"{told}; the model calls {needed}"
    return f"{type(error).__name__}{where}: {told}"


def _arguments(method) -> str:
    signature = inspect.signature(method)
    plain = [
        parameter.replace(annotation=inspect.Parameter.empty)
        for parameter in signature.parameters.values()
    ]
    return str(inspect.Signature(plain))

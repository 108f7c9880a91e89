"""Specialisation of traced functions: arguments known to be zero, and dependences.

A model with fewer unknowns is the same equations with zeros put in. XLA keeps the
arithmetic on them, because 0 times x is not 0 for every float; here it is left out.
"""

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np

from .._jax_internals import ClosedJaxpr, Jaxpr, Literal, bind, called, walk

_ZERO_TIMES = {"mul": (0, 1), "div": (0,)}
"""Operations that give zero if one of these operands is, the others being finite."""
_NEUTRAL = {
    "add": ((0, 0.0), (1, 0.0)),
    "sub": ((1, 0.0),),
    "mul": ((0, 1.0), (1, 1.0)),
    "div": ((1, 1.0),),
}
"""Operands, and the value of each that leaves the other as it is."""
_IN_NUMPY = {
    "abs": np.abs,
    "add": np.add,
    "and": np.bitwise_and,
    "convert_element_type": np.asarray,
    "cos": np.cos,
    "div": np.divide,
    "eq": np.equal,
    "exp": np.exp,
    "ge": np.greater_equal,
    "gt": np.greater,
    "integer_pow": np.power,
    "le": np.less_equal,
    "log": np.log,
    "lt": np.less,
    "max": np.maximum,
    "min": np.minimum,
    "mul": np.multiply,
    "ne": np.not_equal,
    "neg": np.negative,
    "not": np.invert,
    "or": np.bitwise_or,
    "pow": np.power,
    "sign": np.sign,
    "sin": np.sin,
    "sqrt": np.sqrt,
    "square": np.square,
    "sub": np.subtract,
}
"""Operations on floats and truths that are evaluated at once where all operands are
known. JAX would compile a program for each of them, a third of a second in all."""


class _Known:
    """A scalar known when the program is built, standing for an array of it."""

    def __init__(self, value, aval):
        self.value, self.aval = np.asarray(value, aval.dtype), aval

    def array(self):
        return jnp.full(self.aval.shape, self.value)


def leave_out_known(function: Callable, known: dict[int, float]) -> Callable:
    """Fix some arguments of a function, without arithmetic on them.

    Args:
        function: of arrays, to a pytree of arrays.
        known: place of an argument -> its value. It takes the shape and type of the
            first argument that is not known. Zeros that the function itself makes are
            left out too.

    Returns:
        A function of all arguments but those known. It gives what `function` does, as
        long as everything in between is finite. Differentiable as `function` is, but
        that a `custom_jvp` that meets known values is differentiated as it is written.
    """

    def with_known(*arguments):
        rest = iter(arguments)
        values = [
            _Known(known[place], arguments[0].aval) if place in known else next(rest)
            for place in range(len(arguments) + len(known))
        ]
        closed, out = jax.make_jaxpr(function, return_shape=True)(
            *map(_as_array, values)
        )
        results = [_as_array(x) for x in _evaluate(closed, values)]
        return jax.tree.unflatten(jax.tree.structure(out), results)

    return with_known


def _as_array(value):
    return value.array() if isinstance(value, _Known) else value


def _evaluate(closed: ClosedJaxpr, arguments) -> list:
    return walk(closed.jaxpr, closed.consts, arguments, _literal, _apply)


def _literal(atom: Literal):
    return _Known(atom.val, atom.aval) if np.ndim(atom.val) == 0 else atom.val


def _apply(equation, operands) -> list:
    """Return the results of one operation, as `_Known` where they can be."""
    name = equation.primitive.name
    if not any(isinstance(x, _Known) for x in operands):
        return bind(equation, operands)
    if (inner := called(equation)) is not None:
        return _evaluate(inner, operands)
    aval = equation.outvars[0].aval
    if all(isinstance(x, _Known) for x in operands):
        if name in ("broadcast_in_dim", "reshape"):
            return [_Known(operands[0].value, aval)]
        if name in _IN_NUMPY:
            powers = [equation.params["y"]] if name == "integer_pow" else []
            with np.errstate(all="ignore"):
                value = _IN_NUMPY[name](*[x.value for x in operands], *powers)
            return [_Known(value, aval)]
    if any(_is(operands[i], 0.0) for i in _ZERO_TIMES.get(name, ())):
        return [_Known(0.0, aval)]
    for place, neutral in _NEUTRAL.get(name, ()):
        if _is(operands[place], neutral):
            return [jnp.broadcast_to(operands[1 - place], aval.shape)]
    if name == "select_n" and isinstance(operands[0], _Known):
        return [operands[1 + int(operands[0].value)]]
    return bind(equation, [_as_array(x) for x in operands])


def _is(operand, value: float) -> bool:
    return isinstance(operand, _Known) and operand.value == value


def depends(jaxpr: Jaxpr, varied: list[bool]) -> list[bool]:
    """Tell for each result whether it may change, to first order, with the arguments
    that are varied.

    Errs towards True: of an operation that is not looked into all results count.
    """

    def of_equation(equation, inputs: list[bool]) -> list[bool]:
        count = len(equation.outvars)
        if not any(inputs) or equation.primitive.name == "stop_gradient":
            return [False] * count
        inner = called(equation)
        return [True] * count if inner is None else depends(inner.jaxpr, inputs)

    constants = [False] * len(jaxpr.constvars)
    return walk(jaxpr, constants, varied, lambda _: False, of_equation)

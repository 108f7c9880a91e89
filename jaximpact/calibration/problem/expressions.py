"""Parameters that are tied to others: expressions such as `2 * c_v`.

An expression is parsed with `ast`; only numbers, names, `+ - * / **` and a few
functions are allowed, so that nothing else can be run.
"""

import ast
import dataclasses
import functools
import operator
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ..._jax_internals import namespace_of
from ...errors import did_you_mean
from ...io.toml import Key
from ...quantities import InputColumn

OPERATORS: dict[type[ast.operator], Callable] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}
FUNCTIONS = ("exp", "log", "sqrt", "sin", "cos", "tan")
"""Functions that an expression may call."""


@dataclasses.dataclass(frozen=True)
class Tied:
    """Soil parameter that follows from others, in the unit of its column."""

    name: str
    text: str
    constants: Mapping[str, float]
    """Values of the names that are not fitted."""

    def __hash__(self) -> int:
        return hash((self.name, self.text))

    @functools.cached_property
    def tree(self) -> ast.expr:
        """The parsed expression."""
        return ast.parse(self.text, mode="eval").body

    def evaluate(self, values: Mapping[str, Any]) -> Any:
        """Compute the value from those of the fitted parameters, by name: numbers or
        arrays of NumPy or JAX."""
        xp = namespace_of(*values.values())
        with np.errstate(all="ignore"):
            return _value(self.tree, xp, {**values, **self.constants})


def _value(node: ast.expr, xp, values: Mapping[str, Any]) -> Any:
    match node:
        case ast.Constant(value=int() | float() as number):
            # Which divides by zero, and takes roots, without an exception.
            return np.float64(number)
        case ast.Name(id=name):
            return values[name]
        case ast.UnaryOp(op=ast.UAdd(), operand=inner):
            return _value(inner, xp, values)
        case ast.UnaryOp(op=ast.USub(), operand=inner):
            return -_value(inner, xp, values)
        case ast.Call(func=ast.Name(id=name), args=[inner]):
            return getattr(xp, name)(_value(inner, xp, values))
        case ast.BinOp(left=left, op=sign, right=right):
            pair = _value(left, xp, values), _value(right, xp, values)
            return OPERATORS[type(sign)](*pair)
    raise AssertionError(ast.dump(node))  # `_names` has refused it


def read_tied(
    key: Key,
    name: str,
    text,
    fitted: Mapping[str, tuple[float, float, float]],
    constants: Mapping[str, float],
    column: InputColumn,
) -> Tied:
    """Read the expression of a parameter, `name`, from lower bound, upper bound and
    start of the fitted parameters, and values of fixed ones.

    Raises InputError, naming file and key, for what is no expression, names what is not
    known, or leaves the range of the column within the bounds.
    """
    if not isinstance(text, str) or len(text) > 500:
        raise key.error(f"must be a text like '2 * c_v', but is {str(text)[:40]!r}")
    try:
        tree = ast.parse(text, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise key.error(f"{text!r} is no expression; write 2 * c_v") from error
    used = _names(key, tree, text, (*fitted, *constants))
    tied = Tied(name, text, {n: constants[n] for n in used if n in constants})
    names = tuple(fitted)
    low, high, start = np.array([fitted[n] for n in names]).T
    random = np.random.default_rng(0)
    # Half of the coordinates are at a bound.
    inside = random.random((512, len(names)))
    corners = np.where(random.random(inside.shape) < 0.5, np.round(inside), inside)
    points = low + corners * (high - low)
    # Between bounds decades apart these leave out the small ones.
    decades = low > 0.0
    ratio = np.where(decades, high, 1.0) / np.where(decades, low, 1.0)
    points[::2] = np.where(decades, low * ratio**corners, points)[::2]
    points[0] = start
    values = tied.evaluate(dict(zip(names, points.T, strict=True)))
    values = np.broadcast_to(values, len(points))
    wrong = ~column.is_allowed(values)
    if np.any(wrong):
        raise key.error(
            f"{text!r} is {values[wrong][0]:.3g} within the bounds of its parameters, "
            f"but {name} must be {column.requirement}; narrow the bounds"
        )
    return tied


def _names(key: Key, tree: ast.expr, text: str, known: tuple[str, ...]) -> list[str]:
    """List the parameters that an expression names. Raises InputError for anything that
    it must not hold."""
    called, used = set(), []
    for node in ast.walk(tree):
        match node:
            case ast.Call(func=ast.Name(id=name) as function, args=[_], keywords=[]):
                if name not in FUNCTIONS:
                    raise key.error(f"calls {name}; known are {', '.join(FUNCTIONS)}")
                called.add(function)
            case ast.Name(id=name):
                if node in called:
                    continue
                if name not in known:
                    raise key.error(
                        f"names {name!r}, which is not fitted and has no fixed value; "
                        f"{did_you_mean(name, known, repr)}"
                    )
                used.append(name)
            case ast.Constant(value=bool()):
                raise key.error(f"{text!r} holds a truth value")
            case ast.Constant(value=int() | float() as number):
                if abs(number) > np.finfo(float).max:
                    raise key.error(f"{text!r} holds a number that is too large")
            case ast.BinOp(op=sign) if type(sign) in OPERATORS:
                pass
            case ast.UnaryOp(op=ast.UAdd() | ast.USub()):
                pass
            case ast.operator() | ast.unaryop() | ast.expr_context():
                pass
            case _:
                raise key.error(
                    f"{text!r} must hold numbers, parameters, + - * / ** and "
                    f"{', '.join(FUNCTIONS)} alone"
                )
    return list(dict.fromkeys(used))

"""Parameters that are tied to others: expressions such as `2 * c_v`.

An expression is parsed with `ast`; only numbers, names, `+ - * / **` and a few
functions are allowed, so that nothing else can be run. Its value and its derivatives
with respect to the fitted parameters are computed together.
"""

import ast
import dataclasses
import functools
import operator
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ..._jax_internals import namespace_of
from ...errors import nearest
from ...io.toml import Key
from ...quantities import InputColumn

LONGEST = 500
"""Characters of an expression: far more than any needs."""
CORNERS = 256
"""Points within the bounds at which a tied parameter is checked."""

OPERATORS: dict[type[ast.operator], Callable] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
}
Dual = tuple[np.ndarray, np.ndarray]
"""Value (lanes,) and derivatives (lanes, parameters)."""
FUNCTIONS: dict[str, tuple[Callable, Callable]] = {
    "exp": (np.exp, np.exp),
    "log": (np.log, lambda v: 1.0 / v),
    "sqrt": (np.sqrt, lambda v: 0.5 / np.sqrt(v)),
    "sin": (np.sin, np.cos),
    "cos": (np.cos, lambda v: -np.sin(v)),
    "tan": (np.tan, lambda v: 1.0 / np.cos(v) ** 2),
}
"""Functions that an expression may call, with their derivatives."""


@dataclasses.dataclass(frozen=True)
class Tied:
    """Soil parameter that follows from others, in the unit of its column."""

    name: str
    text: str
    constants: Mapping[str, float]
    """Values of the names that are not fitted."""

    @functools.cached_property
    def tree(self) -> ast.expr:
        """The parsed expression."""
        return ast.parse(self.text, mode="eval").body

    def value_of(self, values: Mapping[str, Any]) -> Any:
        """Compute the value from those of the fitted parameters, by name: numbers or
        arrays of NumPy or JAX."""
        xp = namespace_of(*values.values())
        with np.errstate(all="ignore"):
            return _value(self.tree, xp, {**values, **self.constants})

    def evaluate(self, names: tuple[str, ...], p: np.ndarray) -> Dual:
        """Compute the value and its derivatives with respect to the parameters.

        Args:
            names: names of the fitted parameters.
            p: their values in the units of their columns, shape (lanes, parameters).

        Returns:
            Value, shape (lanes,), and derivatives, shape (lanes, parameters); NaN where
            the expression is undefined.
        """
        duals: dict[str, Dual] = {}
        for place, name in enumerate(names):
            rate = np.zeros(p.shape)
            rate[:, place] = 1.0
            duals[name] = p[:, place], rate
        for name, value in self.constants.items():
            duals[name] = np.full(len(p), value), np.zeros(p.shape)
        with np.errstate(all="ignore"):
            return _evaluate(self.tree, duals, p.shape)


def _value(node: ast.expr, xp, values: Mapping[str, Any]) -> Any:
    match node:
        case ast.Constant(value=int() | float() as number):
            return float(number)
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


def _evaluate(node: ast.expr, names: Mapping[str, Dual], shape) -> Dual:
    match node:
        case ast.Constant(value=int() | float() as number):
            return np.full(shape[0], float(number)), np.zeros(shape)
        case ast.Name(id=name):
            return names[name]
        case ast.UnaryOp(op=ast.UAdd(), operand=inner):
            return _evaluate(inner, names, shape)
        case ast.UnaryOp(op=ast.USub(), operand=inner):
            value, rate = _evaluate(inner, names, shape)
            return -value, -rate
        case ast.Call(func=ast.Name(id=name), args=[inner]):
            value, rate = _evaluate(inner, names, shape)
            function, slope = FUNCTIONS[name]
            return function(value), slope(value)[:, None] * rate
        case ast.BinOp(left=left, op=operator, right=right):
            pair = _evaluate(left, names, shape), _evaluate(right, names, shape)
            return _combined(operator, *pair)
    raise AssertionError(ast.dump(node))  # `_check` has refused it


def _combined(operator: ast.operator, left: Dual, right: Dual) -> Dual:
    (a, da), (b, db) = left, right
    match operator:
        case ast.Add():
            return a + b, da + db
        case ast.Sub():
            return a - b, da - db
        case ast.Mult():
            return a * b, a[:, None] * db + b[:, None] * da
        case ast.Div():
            return a / b, (da - (a / b)[:, None] * db) / b[:, None]
    value = a**b
    by_base = (b * a ** (b - 1.0))[:, None] * da
    # The logarithm of a negative base counts only where the exponent varies.
    by_exponent = np.where(db != 0.0, (value * np.log(a))[:, None] * db, 0.0)
    return value, by_base + by_exponent


def read_tied(
    key: Key,
    name: str,
    text,
    fitted: Mapping[str, tuple[float, float]],
    constants: Mapping[str, float],
    column: InputColumn,
) -> Tied:
    """Read the expression of a parameter, `name`, from bounds of the fitted parameters
    and values of fixed ones.

    Raises InputError, naming file and key, for what is no expression, names what is not
    known, or leaves the range of the column within the bounds.
    """
    if not isinstance(text, str) or len(text) > LONGEST:
        raise key.error(f"must be a text like '2 * c_v', but is {str(text)[:40]!r}")
    try:
        tree = ast.parse(text, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise key.error(f"{text!r} is no expression; write 2 * c_v") from error
    used = _names(key, tree, text, (*fitted, *constants))
    tied = Tied(name, text, {n: constants[n] for n in used if n in constants})
    names = tuple(fitted)
    ends = np.array([fitted[n] for n in names])
    random = np.random.default_rng(0)
    inside = random.random((CORNERS, len(names)))
    corners = np.where(random.random(inside.shape) < 0.5, np.round(inside), inside)
    values, _ = tied.evaluate(names, ends[:, 0] + corners * np.ptp(ends, axis=1))
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
    operators = ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Pow
    called, found = set(), []
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
                        f"did you mean {nearest(name, known)!r}?"
                    )
                found.append(name)
            case ast.Constant(value=bool()):
                raise key.error(f"{text!r} holds a truth value")
            case ast.Constant(value=int() | float()):
                pass
            case ast.BinOp(op=operator) if isinstance(operator, operators):
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
    return list(dict.fromkeys(found))

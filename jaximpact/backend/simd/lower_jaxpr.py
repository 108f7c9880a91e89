"""Lowering of the jaxpr of one lane to a graph.

Arrays of the jaxpr are numpy arrays of values (`graph.Value`), one a lane. Loops of a
known number of turns are written out, but for long jitted functions that they call:
from the second turn on these are a body of code that is called (`graph.Body`).
"""

import math
from collections.abc import Callable, Iterable, Sequence
from functools import reduce
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ..._jax_internals import Literal, bind, called, place_of, scan_counts, walk
from . import math_functions as elementary
from .arrangement import STRUCTURE
from .arrays import Dual, Values, values_of
from .graph import (
    FLOAT,
    INTEGER,
    NUMPY,
    TRUTH,
    Graph,
    Node,
    NoMachineCode,
    Value,
    kind_of,
)
from .math_functions import REWRITTEN
from .repeated import Repeated, is_long


def _each(function: Callable, *arrays: Values) -> Values:
    shape = arrays[0].shape
    if arrays[0].size == 1 and all(array.shape == shape for array in arrays):
        # Nearly all arrays of a lane: NumPy takes its time to go through one number.
        values = np.empty(shape, object)
        values.flat[0] = function(*(array.flat[0] for array in arrays))
        return values
    made = np.frompyfunc(function, len(arrays), 1)(*arrays)
    values = np.empty(np.shape(made), object)
    values[...] = made
    return values


def _as_array(values) -> Values:
    """Make an array of values, which NumPy gives as one value where there are no
    axes."""
    if isinstance(values, np.ndarray):
        return values
    array = np.empty((), object)
    array[()] = values
    return array


def _first(arrays: list[Values]) -> list[Value]:
    return [array.flat[0] for array in arrays if array.size]


def _literal(atom: Literal) -> Values:
    aval: Any = atom.aval
    return values_of(np.asarray(atom.val, aval.dtype))


class Translator:
    """A walk through a jaxpr, equation by equation, with derivatives along one
    direction.

    The rule of an equation is JAX's, but for quotients: the jaxpr of its `jvp`, traced
    once for all equations that are alike. That takes a third of the time of a `jvp` of
    the whole.
    """

    def __init__(self, graph: Graph):
        self.graph = graph
        self.repeated: dict[int, Repeated] | None = None
        """Functions that the loop under way calls, by the names of their equations;
        None outside of loops, and where calls are written out."""
        self.writes_calls_out = False

    def run(self, jaxpr, constants, arguments: Iterable[Dual]) -> list[Dual]:
        """Compute the outputs of a jaxpr."""
        constants = [Dual(values_of(constant)) for constant in constants]
        literal = lambda atom: Dual(_literal(atom))  # noqa: E731
        return walk(jaxpr, constants, arguments, literal, self.outputs)

    def outputs(self, equation, operands: list[Dual]) -> list[Dual]:
        """Compute the outputs of one equation; an error names its place."""
        name, inner = equation.primitive.name, called(equation)
        varied = any(operand.tangent is not None for operand in operands)
        try:
            if name == "scan":
                return self.scan(equation, operands)
            if (
                self.repeated is not None
                and inner is not None
                and name != "custom_jvp_call"
                and is_long(inner.jaxpr)
            ):
                return self.repeat(equation, inner, operands)
            # Of a function that has its own derivative the values alone are those of
            # what it calls.
            if inner is not None and not (varied and name == "custom_jvp_call"):
                return self.run(inner.jaxpr, inner.consts, operands)
            values = [operand.values for operand in operands]
            if inner is not None:
                plain = self.run(inner.jaxpr, inner.consts, map(Dual, values))
                results = [dual.values for dual in plain]
            else:
                results = list(map(_as_array, self.apply(equation, values)))
            if not varied or name == "stop_gradient":
                return list(map(Dual, results))
            return list(map(Dual, results, self.tangents(equation, operands)))
        except NoMachineCode as problem:
            problem.place = problem.place or place_of(equation)
            raise
        except (AttributeError, IndexError, KeyError, TypeError, ValueError) as error:
            # A version of JAX to come may describe its operations otherwise.
            problem = NoMachineCode(
                f"JAX {jax.__version__} describes the primitive "
                f"'{equation.primitive.name}' in a way that is not known: {error!r}"
            )
            problem.place = place_of(equation)
            raise problem from error

    def apply(self, equation, inputs: list[Values]) -> list[Values]:
        """Compute values of the outputs of one equation."""
        name, params = equation.primitive.name, equation.params
        if name in STRUCTURE:
            arranged = STRUCTURE[name](params, *inputs)
            return arranged if isinstance(arranged, list) else [arranged]
        if name in ELEMENTWISE:
            function = ELEMENTWISE[name]
            return [_each(lambda *x: function(self.graph, *x), *inputs)]
        if name in REWRITTEN and all(kind_of(x) == FLOAT for x in _first(inputs)):
            avals = [atom.aval for atom in equation.invars]
            written = jax.make_jaxpr(REWRITTEN[name])(*avals)
            results = self.run(written.jaxpr, written.consts, map(Dual, inputs))
            return [result.values for result in results]
        if name in REDUCTIONS:
            return [self.reduce(REDUCTIONS[name], params["axes"], *inputs)]
        method = getattr(self, f"_{name.replace('-', '_')}", None)
        if method is None:
            raise NoMachineCode(f"no native code for the primitive '{name}'")
        return [method(params, *inputs).reshape(equation.outvars[0].aval.shape)]

    def tangents(self, equation, operands: list[Dual]) -> list[Values | None]:
        """Compute the derivatives of the outputs of one equation, one of whose operands
        has a derivative."""
        is_float = [np.issubdtype(v.aval.dtype, np.floating) for v in equation.outvars]
        if not any(is_float):
            return [None] * len(is_float)
        if equation.primitive.name in STRUCTURE:
            tangents = [
                _tangent_of(operand) if _is_float(atom) else operand.values
                for operand, atom in zip(operands, equation.invars, strict=True)
            ]
            return list(map(_as_array, self.apply(equation, tangents)))
        varied = tuple(k for k, x in enumerate(operands) if x.tangent is not None)
        rule = _rule_of(equation, varied)
        given = [Dual(operand.values) for operand in operands]
        given += [Dual(_tangent_of(operands[k])) for k in varied]
        try:
            results = iter(self.run(rule.jaxpr, rule.consts, given))
        except NoMachineCode as problem:
            problem.place = ""  # that of the equation is the user's
            raise
        return [next(results).values if of_float else None for of_float in is_float]

    def scan(self, equation, operands: list[Dual]) -> list[Dual]:
        params = equation.params
        inner, (count, carried) = params["jaxpr"], scan_counts(equation)
        first = count + carried
        constants, carry = operands[:count], operands[count:first]
        turns = list(range(params["length"]))
        if params["reverse"]:
            turns.reverse()
        rows: list[list[Dual]] = [[]] * len(turns)
        outer = self.repeated
        if not self.writes_calls_out:
            self.repeated = {}
        for i in turns:
            series = (_turn(operand, i) for operand in operands[first:])
            outputs = self.run(inner.jaxpr, inner.consts, [*constants, *carry, *series])
            carry, rows[i] = outputs[:carried], outputs[carried:]
        self.repeated = outer
        return [*carry, *map(_stacked, zip(*rows, strict=True))]

    def repeat(self, equation, inner, operands: list[Dual]) -> list[Dual]:
        """Compute what a jitted function gives that a loop calls. In the first turn it
        is written out: it may share much with what stands before the loop."""
        repeated = self.repeated
        assert repeated is not None, "in a loop"

        def run(operands: list[Dual]) -> list[Dual]:
            self.repeated, self.writes_calls_out = None, True
            results = self.run(inner.jaxpr, inner.consts, operands)
            self.repeated, self.writes_calls_out = repeated, False
            return results

        if id(equation) not in repeated:
            repeated[id(equation)] = Repeated(equation, operands)
            return run(operands)
        function = repeated[id(equation)]
        if function.body is None:
            function.make(self.graph, operands, run)
        arguments = function.arguments(operands)
        if arguments is None:
            return run(operands)
        return function.call(self.graph, arguments)

    def reduce(self, function: Callable, axes, values: Values) -> Values:
        for axis in sorted(axes, reverse=True):
            rows = np.moveaxis(values, axis, 0)
            values = reduce(
                lambda a, b: _each(lambda *x: function(self.graph, *x), a, b), rows
            )
        return values

    def _integer_pow(self, params, values: Values) -> Values:
        graph, exponent = self.graph, params["y"]

        def power(x: Value) -> Value:
            if kind_of(x) != FLOAT:
                raise NoMachineCode(f"no native powers of {kind_of(x)}")
            if exponent < 0:  # by the inverse, which other quotients may share
                x = graph.apply("divide", 1.0, x)
            result, square, left = 1.0, x, abs(exponent)
            while left:
                if left & 1:
                    result = graph.apply("multiply", result, square)
                square, left = graph.apply("multiply", square, square), left >> 1
            return result

        return _each(power, values)

    def _convert_element_type(self, params, values: Values) -> Values:
        graph = self.graph
        kind = NUMPY[np.dtype(params["new_dtype"]).kind]

        def convert(x: Value) -> Value:
            if kind_of(x) == kind:
                return x
            if kind_of(x) == TRUTH:
                one, zero = (1.0, 0.0) if kind == FLOAT else (1, 0)
                return graph.choose(x, one, zero)
            if kind_of(x) == INTEGER and kind == FLOAT:
                return graph.apply("to_float", x)
            raise NoMachineCode(f"no native conversion of {kind_of(x)} to {kind}")

        return _each(convert, values)

    def _dot_general(self, params, left: Values, right: Values) -> Values:
        contracted, batch = params["dimension_numbers"]

        def arranged(values: Values, summed, over) -> Values:
            """Arrange axes as batch, free, summed."""
            summed, over = list(map(int, summed)), list(map(int, over))
            free = [a for a in range(values.ndim) if a not in summed + over]
            return np.transpose(values, over + free + summed)

        left = arranged(left, contracted[0], batch[0])
        right = arranged(right, contracted[1], batch[1])
        batches, sums = len(batch[0]), len(contracted[0])
        shape = (
            left.shape[: left.ndim - sums] + right.shape[batches : right.ndim - sums]
        )
        pairs = zip(
            *(
                x.reshape(
                    int(np.prod(x.shape[:batches])),
                    -1,
                    int(np.prod(x.shape[x.ndim - sums :])),
                )
                for x in (left, right)
            ),
            strict=True,
        )
        at = self.graph.apply
        values = np.empty(int(np.prod(shape)), object)
        values[:] = [
            reduce(
                lambda x, y: at("add", x, y),
                [at("multiply", *factors) for factors in zip(a, b, strict=True)],
            )
            for rows, columns in pairs
            for a in rows
            for b in columns
        ]
        return values.reshape(shape)

    def _argmin(self, params, values: Values) -> Values:
        (axis,) = params["axes"]
        at = self.graph.apply
        rows = np.moveaxis(values, axis, 0)
        if kind_of(values.flat[0]) != FLOAT:
            raise NoMachineCode(f"no native argmin of {kind_of(values.flat[0])}")
        least, place = rows[0], _each(lambda _: 0, rows[0])
        for i, row in enumerate(rows[1:], 1):
            # The first NaN is least.
            better = _each(
                lambda x, m: at(
                    "and",
                    at("or", at("less", x, m), at("unlike", x, x)),
                    at("equal", m, m),
                ),
                row,
                least,
            )
            least = _each(self.graph.choose, better, row, least)
            place = _each(lambda b, p, i=i: self.graph.choose(b, i, p), better, place)
        return place

    def _gather(self, params, operand: Values, indices: Values) -> Values:
        axes, mode = params["dimension_numbers"].start_index_map, params["mode"]
        modes = jax.lax.GatherScatterMode
        if _is_row(params["dimension_numbers"], params["slice_sizes"], operand):
            index = indices.item()
            if not isinstance(index, Node) and 0 <= index < len(operand):
                return operand[index]
        if (
            indices.size != 1
            or len(axes) != 1
            or operand.size != operand.shape[axes[0]]
            or mode not in (modes.FILL_OR_DROP, modes.CLIP)
        ):
            raise NoMachineCode("no native gather but of one entry of a row")
        row, index = operand.ravel(), indices.item()
        at, kind = self.graph.apply, kind_of(row[0])
        if mode == modes.CLIP:  # beyond its ends a row goes on as it ends
            result, chosen = row[0], "integer_at_most"
        else:
            outside = {FLOAT: math.nan, INTEGER: -(2**63), TRUTH: True}
            result, chosen = outside[kind], "integer_equal"
        for i, value in enumerate(row):
            result = self.graph.choose(at(chosen, i, index), value, result)
        return _each(lambda _: result, indices)

    def _table_entry(self, params, table: Values, row: Values) -> Values:
        at, size = self.graph.apply, 8.0 * params["width"]

        def entry(table: Value, row: Value) -> Value:
            # Addresses are floats until here, exact below 2^52: so is their sum with
            # that, whose lower bits are the address.
            place = at("add", table, at("multiply", size, row))
            bits = at("to_bits", at("add", place, 2.0**52))
            address = at("bits_and", bits, 2**52 - 1)
            return at("entry", at("integer_add", address, 8 * params["column"]))

        return _each(entry, table, row)

    def _scatter(self, params, operand: Values, indices: Values, updates: Values):
        numbers = params["dimension_numbers"]
        rows = tuple(range(operand.ndim - 1))
        index = indices.item()
        if (
            isinstance(index, Node)
            or tuple(numbers.update_window_dims) != rows
            or tuple(numbers.inserted_window_dims) != (0,)
            or tuple(numbers.scatter_dims_to_operand_dims) != (0,)
        ):
            raise NoMachineCode("no native scatter but one row's at a known place")
        result = operand.copy()
        result[index] = updates
        return result

    def _scatter_add(self, params, operand: Values, indices: Values, updates: Values):
        """Add a number to one entry of a row; beyond its ends nothing is added."""
        axes = params["dimension_numbers"].scatter_dims_to_operand_dims
        if (
            indices.size != 1
            or updates.size != 1
            or len(axes) != 1
            or operand.size != operand.shape[axes[0]]
            or params["mode"] != jax.lax.GatherScatterMode.FILL_OR_DROP
        ):
            raise NoMachineCode("no native scatter-add but to one entry of a row")
        at, index, update = self.graph.apply, indices.item(), updates.item()
        result = operand.copy()
        for i, value in enumerate(operand.flat):
            chosen = self.graph.choose(at("integer_equal", i, index), update, 0.0)
            result.flat[i] = at("add", value, chosen)
        return result


def _is_row(numbers, sizes, operand: Values) -> bool:
    """Tell whether a gather takes one row of the first axis, whole."""
    return (
        tuple(numbers.start_index_map) == (0,)
        and tuple(numbers.collapsed_slice_dims) == (0,)
        and tuple(sizes) == (1, *operand.shape[1:])
    )


def _is_float(atom) -> bool:
    return np.issubdtype(atom.aval.dtype, np.floating)


def _tangent_of(operand: Dual) -> Values:
    """Return the derivative of an operand, zeros where it has none."""
    if operand.tangent is not None:
        return operand.tangent
    return _each(lambda _: 0.0, operand.values)


def _turn(series: Dual, turn: int) -> Dual:
    """Take what a turn of a loop is given of a series."""
    tangent = None if series.tangent is None else _as_array(series.tangent[turn])
    return Dual(_as_array(series.values[turn]), tangent)


def _stacked(turns: Sequence[Dual]) -> Dual:
    """Put what the turns of a loop gave into one array."""
    values = np.stack([turn.values for turn in turns])
    if all(turn.tangent is None for turn in turns):
        return Dual(values)
    return Dual(values, np.stack([_tangent_of(turn) for turn in turns]))


_rules: dict = {}
"""Rules by what the equations have in common."""


def _rule_of(equation, varied: tuple[int, ...]):
    """Return the jaxpr that computes, from the operands of an equation and the
    derivatives of those that vary, the derivatives of the outputs that are floats."""
    avals = [atom.aval for atom in equation.invars]
    kinds = tuple((aval.shape, aval.dtype) for aval in avals)
    key = equation.primitive, tuple(sorted(equation.params.items())), kinds, varied
    # A function with a derivative of its own is one of its kind.
    is_alone = called(equation) is not None
    try:
        if not is_alone and key in _rules:
            return _rules[key]
    except TypeError:  # of parameters without a hash
        is_alone = True

    def tangents_of(*operands_and_tangents):
        operands = operands_and_tangents[: len(avals)]
        tangents = operands_and_tangents[len(avals) :]
        if equation.primitive.name == "div":
            x, y = operands
            return [_of_quotient(x, y, dict(zip(varied, tangents, strict=True)))]

        def of_varied(*values):
            given = dict(zip(varied, values, strict=True))
            results = bind(equation, [given.get(k, x) for k, x in enumerate(operands)])
            return [x for x in results if jnp.issubdtype(x.dtype, jnp.floating)]

        return jax.jvp(of_varied, [operands[k] for k in varied], list(tangents))[1]

    of_tangents = [avals[k] for k in varied]
    structs = [jax.ShapeDtypeStruct(x.shape, x.dtype) for x in [*avals, *of_tangents]]
    rule = jax.make_jaxpr(tangents_of)(*structs)
    if not is_alone:
        _rules[key] = rule
    return rule


def _of_quotient(x, y, tangents: dict):
    """Compute the derivative of x / y in fewer operations than JAX takes, from those of
    x (0) and of y (1)."""
    if 1 not in tangents:
        return tangents[0] / y
    if 0 not in tangents:
        return tangents[1] * -(x / y / y)
    return (tangents[0] - tangents[1] * (x / y)) / y


def _plain(name: str, integer: str | None = None, truth: str | None = None) -> Callable:

    def apply(graph: Graph, *x: Value) -> Value:
        names = {FLOAT: name, INTEGER: integer, TRUTH: truth}
        chosen = names[kind_of(x[-1])]
        if chosen is None:
            raise NoMachineCode(f"no native '{name}' of {kind_of(x[-1])}")
        return graph.apply(chosen, *x)

    return apply


def _only(kind: str, function: Callable) -> Callable:

    def apply(graph: Graph, *x: Value) -> Value:
        others = {kind_of(value) for value in x} - {kind}
        if others:
            raise NoMachineCode(f"no native '{function.__name__}' of {others}")
        return function(graph, *x)

    return apply


def _swapped(function: Callable) -> Callable:
    return lambda graph, a, b: function(graph, b, a)


def _larger(graph: Graph, a: Value, b: Value, is_less: Callable) -> Value:
    """`a` or `b`; NaN if either is. Of two choices LLVM makes one instruction, which
    takes its second operand where either is NaN."""
    if isinstance(a, Node) and not isinstance(b, Node):
        a, b = b, a
    chosen = graph.choose(is_less(b, a), a, b)
    if not isinstance(a, Node):
        return chosen
    return graph.choose(graph.apply("unlike", a, a), a, chosen)


def _maximum(graph: Graph, a: Value, b: Value) -> Value:
    return _larger(graph, a, b, lambda x, y: graph.apply("less", x, y))


def _minimum(graph: Graph, a: Value, b: Value) -> Value:
    return _larger(graph, a, b, lambda x, y: graph.apply("less", y, x))


def _sign(graph: Graph, x: Value) -> Value:
    at = graph.apply
    negative = graph.choose(at("less", x, 0.0), -1.0, x)
    return graph.choose(at("less", 0.0, x), 1.0, negative)


def _square(graph: Graph, x: Value) -> Value:
    return graph.apply("multiply", x, x)


def _is_finite(graph: Graph, x: Value) -> Value:
    return graph.apply("less", graph.apply("magnitude", x), math.inf)


def _not(graph: Graph, x: Value) -> Value:
    return graph.apply("differ", x, True)


def _select(graph: Graph, which: Value, *cases: Value) -> Value:
    if kind_of(which) != TRUTH:
        raise NoMachineCode("no native choice between cases by their number")
    no, yes = cases
    return graph.choose(which, yes, no)


LESS = _plain("less", "integer_less")
AT_MOST = _plain("at_most", "integer_at_most")
ELEMENTWISE = {
    "add": _plain("add", "integer_add"),
    "add_any": _plain("add", "integer_add"),
    "sub": _plain("subtract", "integer_subtract"),
    "mul": _plain("multiply", "integer_multiply"),
    "div": _plain("divide"),
    "neg": _plain("negate"),
    "abs": _plain("magnitude"),
    "sqrt": _plain("root"),
    "lt": LESS,
    "le": AT_MOST,
    "gt": _swapped(LESS),
    "ge": _swapped(AT_MOST),
    "eq": _plain("equal", "integer_equal"),
    "ne": _plain("unlike", truth="differ"),
    "and": _plain("bits_and", "bits_and", "and"),
    "or": _plain("bits_or", "bits_or", "or"),
    "not": _only(TRUTH, _not),
    "select_n": _select,
    "max": _only(FLOAT, _maximum),
    "min": _only(FLOAT, _minimum),
    "sign": _only(FLOAT, _sign),
    "square": _only(FLOAT, _square),
    "is_finite": _is_finite,
    "exp": elementary.exp,
    "log": elementary.log,
    "sin": elementary.sin,
    "cos": elementary.cos,
    "tan": elementary.tan,
    "atan": elementary.atan,
    "cbrt": elementary.cbrt,
}
REDUCTIONS = {
    "reduce_sum": ELEMENTWISE["add"],
    "reduce_min": ELEMENTWISE["min"],
    "reduce_max": ELEMENTWISE["max"],
    "reduce_or": ELEMENTWISE["or"],
    "reduce_and": ELEMENTWISE["and"],
}

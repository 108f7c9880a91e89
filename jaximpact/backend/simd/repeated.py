"""Jitted functions that a loop calls in each turn, as bodies of code.

The operands of the first turn, beside those of the second, tell what changes from turn
to turn: these are the parameters of the body, and all else is the same at each call.
"""

from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from typing import Any, NamedTuple

from ..._jax_internals import called
from .arrays import Dual, Values
from .graph import Body, Graph, Node, Value, bits_of, kind_of

LEAST_BODY = 100
"""Equations of a function from which on it is called, and not written out each time."""


class _Entry(NamedTuple):
    """A place among the values and derivatives of operands."""

    array: int
    """Its number: values are even, derivatives odd."""
    place: int


class Repeated:
    """A function that a loop calls in each turn."""

    def __init__(self, equation, operands: list[Dual]):
        self.equation = equation
        """The call; kept, since it is known by its name in memory."""
        self.before = _entries(operands)
        """What the operands were in the turn before, or are in each."""
        self.body: Body | None = None
        self.parameters: list[_Entry] = []
        self.results: list[Dual] = []

    def make(self, graph: Graph, operands: list[Dual], run: Callable) -> None:
        """Make the body, from the operands of the second turn; `run` gives the results
        of the function."""
        now = _entries(operands)
        self.parameters = [
            entry
            for entry, value in now.items()
            if entry not in self.before or not _is_same(value, self.before[entry])
        ]
        self.before = now
        body = graph.begin_body(
            [(kind_of(now[entry]), entry.array % 2 == 1) for entry in self.parameters]
        )
        given = now | dict(zip(self.parameters, body.parameters, strict=True))
        self.results = run(_filled(operands, given.values()))
        graph.end_body(body, list(_entries(self.results).values()))
        self.body = body

    def arguments(self, operands: list[Dual]) -> list[Value] | None:
        """List the values of the parameters; None where another operand is not what it
        was before."""
        now, parameters = _entries(operands), set(self.parameters)
        same = now.keys() == self.before.keys() and all(
            entry in parameters or _is_same(value, self.before[entry])
            for entry, value in now.items()
        )
        return [now[entry] for entry in self.parameters] if same else None

    def call(self, graph: Graph, arguments: list[Value]) -> list[Dual]:
        """Return the results for values of the parameters."""
        assert self.body is not None, "made before"
        return _filled(self.results, graph.call(self.body, arguments))


def _entries(duals: Iterable[Dual]) -> dict[_Entry, Value]:
    arrays = [array for dual in duals for array in dual]
    return {
        _Entry(number, place): value
        for number, array in enumerate(arrays)
        if array is not None
        for place, value in enumerate(array.flat)
    }


def _filled(like: Iterable[Dual], values: Iterable[Value]) -> list[Dual]:
    """Make arrays of the shapes of others, from values as `_entries` has them."""
    remaining = iter(values)
    return [Dual(*_of_shapes(dual, remaining)) for dual in like]


def _of_shapes(arrays: Iterable[Values | None], values: Iterator[Value]) -> list[Any]:
    made = []
    for array in arrays:
        if array is not None:
            array = array.copy()
            array.ravel()[:] = list(islice(values, array.size))
        made.append(array)
    return made


def _is_same(a: Value, b: Value) -> bool:
    if isinstance(a, Node) or isinstance(b, Node):
        return a is b
    if isinstance(a, float) and isinstance(b, float):
        return bits_of(a) == bits_of(b)
    return type(a) is type(b) and a == b


def is_long(jaxpr) -> bool:
    """Tell whether a jaxpr has so many equations, with those of what it calls, that it
    is worth a body."""
    count, jaxprs = 0, [jaxpr]
    while jaxprs and count < LEAST_BODY:
        for equation in jaxprs.pop().eqns:
            inner = called(equation)
            if inner is None:
                count += 1
            else:
                jaxprs.append(inner.jaxpr)
    return count >= LEAST_BODY

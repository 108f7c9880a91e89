"""Straight-line arithmetic as a graph in which equal values are one node.

A value is a `Node`, or a Python number where it is known when the kernel is built.
Values are 64-bit floats, 64-bit integers or truths, one a lane.
"""

import math
import operator
import struct
from collections.abc import Callable
from typing import NamedTuple

FLOAT, INTEGER, TRUTH = "double", "i64", "i1"
INPUT = "input"
"""Operation of a value that is given."""
PARAMETER, RESULT = "parameter", "result"
"""Operations of a value that a body is called with, and of one that a call gives."""
KINDS = {float: FLOAT, int: INTEGER, bool: TRUTH}
PYTHON = {kind: python for python, kind in KINDS.items()}
NUMPY = {"f": FLOAT, "i": INTEGER, "u": INTEGER, "b": TRUTH}
"""Kind of a NumPy type -> kind of a value."""

Number = float | int | bool


class NoMachineCode(NotImplementedError):
    """An operation that has no machine code."""

    place = ""
    """File, line and function that it stands in, where that is known."""


class Node:
    """The result of one operation."""

    __slots__ = ("along", "arguments", "kind", "number", "operation")

    def __init__(
        self, operation: str, kind: str, arguments: tuple, number: int, along: bool
    ):
        self.operation, self.kind, self.arguments = operation, kind, arguments
        self.number = number
        """Place in the order of making: higher than its arguments'."""
        self.along = along
        """True for a derivative along a direction, which is linear in others; a value
        is the same for all directions."""


Value = Node | Number


def is_along(value: Value) -> bool:
    """Tell whether a value is a derivative along a direction."""
    return isinstance(value, Node) and value.along


def kind_of(value: Value) -> str:
    return value.kind if isinstance(value, Node) else KINDS[type(value)]


def bits_of(number: float) -> int:
    """Return the 64 bits of a float, as a signed integer."""
    return struct.unpack("<q", struct.pack("<d", number))[0]


def float_of(bits: int) -> float:
    return struct.unpack("<d", struct.pack("<q", bits))[0]


def _wrapped(integer: int) -> int:
    return (integer + 2**63) % 2**64 - 2**63


def _divided(a: float, b: float) -> float:
    if b != 0.0:
        return a / b
    if a == 0.0 or math.isnan(a):
        return math.nan
    return math.copysign(math.inf, a) * math.copysign(1.0, b)


class Instruction(NamedTuple):
    """An operation: its result for numbers, and its text in LLVM for vectors."""

    kind: str
    fold: Callable
    text: str
    """Template with `{f}`, `{i}`, `{t}` for the vector types, `{n}` for their length,
    and operands by place."""
    commutes: bool = False


def _select(condition: bool, yes: Number, no: Number) -> Number:
    return yes if condition else no


def _read(address: int) -> float:
    raise AssertionError("memory is read while kernels run, not while they are built")


def _compare(fold: Callable, predicate: str, commutes: bool = False) -> Instruction:
    return Instruction(TRUTH, fold, f"fcmp {predicate} {{f}} {{0}}, {{1}}", commutes)


# LLVM is not to put products and sums into one instruction: `llvm_ir` says which may.
OPERATIONS = {
    "add": Instruction(FLOAT, operator.add, "fadd {f} {0}, {1}", True),
    "subtract": Instruction(FLOAT, operator.sub, "fsub {f} {0}, {1}"),
    "multiply": Instruction(FLOAT, operator.mul, "fmul {f} {0}, {1}", True),
    "divide": Instruction(FLOAT, _divided, "fdiv {f} {0}, {1}"),
    "negate": Instruction(FLOAT, operator.neg, "fneg {f} {0}"),
    "magnitude": Instruction(FLOAT, abs, "call {f} @llvm.fabs.v{n}f64({f} {0})"),
    "root": Instruction(
        FLOAT,
        lambda x: math.sqrt(x) if x >= 0.0 else math.nan,
        "call {f} @llvm.sqrt.v{n}f64({f} {0})",
    ),
    "fused": Instruction(
        FLOAT,
        lambda a, b, c: a * b + c,
        "call {f} @llvm.fma.v{n}f64({f} {0}, {f} {1}, {f} {2})",
    ),
    "less": _compare(operator.lt, "olt"),
    "at_most": _compare(operator.le, "ole"),
    "equal": _compare(operator.eq, "oeq", True),
    "unlike": _compare(operator.ne, "une", True),
    "and": Instruction(TRUTH, operator.and_, "and {t} {0}, {1}", True),
    "or": Instruction(TRUTH, operator.or_, "or {t} {0}, {1}", True),
    "differ": Instruction(TRUTH, operator.ne, "xor {t} {0}, {1}", True),
    "choose_float": Instruction(FLOAT, _select, "select {t} {0}, {f} {1}, {f} {2}"),
    "choose_integer": Instruction(INTEGER, _select, "select {t} {0}, {i} {1}, {i} {2}"),
    "choose_truth": Instruction(TRUTH, _select, "select {t} {0}, {t} {1}, {t} {2}"),
    "integer_add": Instruction(
        INTEGER, lambda a, b: _wrapped(a + b), "add {i} {0}, {1}", True
    ),
    "integer_subtract": Instruction(
        INTEGER, lambda a, b: _wrapped(a - b), "sub {i} {0}, {1}"
    ),
    "integer_multiply": Instruction(
        INTEGER, lambda a, b: _wrapped(a * b), "mul {i} {0}, {1}", True
    ),
    "integer_less": Instruction(TRUTH, operator.lt, "icmp slt {i} {0}, {1}"),
    "integer_at_most": Instruction(TRUTH, operator.le, "icmp sle {i} {0}, {1}"),
    "integer_equal": Instruction(TRUTH, operator.eq, "icmp eq {i} {0}, {1}", True),
    "bits_and": Instruction(INTEGER, operator.and_, "and {i} {0}, {1}", True),
    "bits_or": Instruction(INTEGER, operator.or_, "or {i} {0}, {1}", True),
    "bits_differ": Instruction(INTEGER, operator.xor, "xor {i} {0}, {1}", True),
    "shift_left": Instruction(
        INTEGER, lambda a, b: _wrapped(a << b), "shl {i} {0}, {1}"
    ),
    "shift_right": Instruction(INTEGER, operator.rshift, "ashr {i} {0}, {1}"),
    "to_float": Instruction(FLOAT, float, "sitofp {i} {0} to {f}"),
    "to_bits": Instruction(INTEGER, bits_of, "bitcast {f} {0} to {i}"),
    "from_bits": Instruction(FLOAT, float_of, "bitcast {i} {0} to {f}"),
    # Written as several instructions: see `llvm_ir`. An address is never known.
    "entry": Instruction(FLOAT, _read, ""),
}


class Body:
    """Arithmetic that is called several times, each time with other values of its
    parameters; what else it needs is the same at each call."""

    def __init__(self, parameters: list[Node], first: int):
        self.parameters = parameters
        self.first, self.last = first, first
        """What has a number from the one up to below the other is worked out at each
        call."""
        self.results: list[Value] = []

    def has(self, value: Value) -> bool:
        """Tell whether a value is worked out at each call."""
        return isinstance(value, Node) and self.first <= value.number < self.last


class Call(NamedTuple):
    """A call of a body."""

    body: Body
    arguments: list[Value]
    """Values of the parameters."""
    results: list[Node]
    """Nodes that stand for what the call gives."""


class Graph:
    """A graph of nodes: the same operation on the same arguments is the same node."""

    def __init__(self):
        self._known: dict[tuple, Node] = {}
        self.calls: list[Call] = []

    def _remember(self, key: tuple, kind: str, arguments: tuple, along: bool) -> Node:
        node = self._known.get(key)
        if node is None:
            node = Node(key[0], kind, arguments, len(self._known), along)
            self._known[key] = node
        return node

    def input(self, place: int, kind: str, along: bool = False) -> Node:
        """Return the node of the value, or of the derivative along a direction, in a
        row of the kernel's memory."""
        return self._remember((INPUT, place), kind, (place,), along)

    def begin_body(self, parameters: list[tuple[str, bool]]) -> Body:
        """Begin a body, to which all belongs that is made up to its end. Of each of its
        parameters the kind is given, and whether it is a derivative."""
        place = len(self._known)
        nodes = [
            self._remember((PARAMETER, place, k), kind, (k,), along)
            for k, (kind, along) in enumerate(parameters)
        ]
        return Body(nodes, len(self._known))

    def end_body(self, body: Body, results: list[Value]) -> None:
        """End a body, which gives some results."""
        body.last, body.results = len(self._known), results

    def call(self, body: Body, arguments: list[Value]) -> list[Value]:
        """Return what a body gives for values of its parameters."""
        number, nodes, results = len(self.calls), [], []
        for place, value in enumerate(body.results):
            if body.has(value) or value in body.parameters:
                key = RESULT, number, place
                value = self._remember(
                    key, kind_of(value), (number, place), is_along(value)
                )
                nodes.append(value)
            results.append(value)
        self.calls.append(Call(body, arguments, nodes))
        return results

    def apply(self, name: str, *arguments: Value) -> Value:
        """Apply an operation of `OPERATIONS`; numbers alone give a number."""
        operation = OPERATIONS[name]
        keys, known = [], True
        for value in arguments:
            if isinstance(value, Node):
                keys.append(value.number)
                known = False
            else:
                # 0.0 and -0.0 are equal, and NaN is not equal to itself.
                exact = value.hex() if isinstance(value, float) else value
                keys.append((type(value), exact))
        if known:
            return PYTHON[operation.kind](operation.fold(*arguments))
        same = _simplified(name, arguments)
        if same is not None:
            return same
        along = any(map(is_along, arguments))
        if operation.commutes:
            first, second = keys
            if isinstance(first, tuple) or (
                not isinstance(second, tuple) and second < first
            ):
                keys = [second, first]
        return self._remember((name, *keys), operation.kind, arguments, along)

    def choose(self, condition: Value, yes: Value, no: Value) -> Value:
        """Select `yes` where the condition is true, else `no`."""
        name = {FLOAT: "float", INTEGER: "integer", TRUTH: "truth"}[kind_of(yes)]
        return self.apply(f"choose_{name}", condition, yes, no)


def _is(value: Value, number: Number) -> bool:
    return type(value) is type(number) and value == number


NEUTRAL = {
    "add": 0.0,
    "subtract": 0.0,
    "multiply": 1.0,
    "divide": 1.0,
    "and": True,
    "or": False,
}
"""Second operand, of what commutes also the first, that leaves the other as it is."""


def _simplified(name: str, arguments: tuple) -> Value | None:
    """Return the argument, or truth, that the operation gives whatever the others are.

    Products with zero stay: they are not zero for infinity and NaN.
    """
    if name not in NEUTRAL:
        if not name.startswith("choose"):
            return None
        condition, yes, no = arguments
        if not isinstance(condition, Node):
            return yes if condition else no
        return yes if yes is no else None
    first, second = arguments
    if _is(second, NEUTRAL[name]):
        return first
    if OPERATIONS[name].commutes and _is(first, NEUTRAL[name]):
        return second
    if name in ("and", "or"):
        known = (x for x in arguments if not isinstance(x, Node))
        return next(known, first if first is second else None)
    return None

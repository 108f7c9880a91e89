"""Instructions in LLVM's language for the nodes of a graph.

A division takes the time of some ten products. So a quotient is written as a product
with the inverse of its divisor, which all quotients by it share; and the inverse of a
product, a quotient or a choice is put together from those of its parts. A sum takes the
product in it along.

How a value is written depends on what it is made of alone, and never on what else is
worked out beside it: code with derivatives, or with a ledger, gives the same values to
the last bit as code without.

What comes out differs from the rounded quotient by a few roundings. For finite operands
it is a number where that is, but where an inverse leaves the range of normal numbers:
there zero by next to nothing is NaN.
"""

import re
import struct
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

from .graph import (
    FLOAT,
    INPUT,
    INTEGER,
    OPERATIONS,
    PARAMETER,
    RESULT,
    TRUTH,
    Body,
    Call,
    Node,
    Value,
)

PACK = 8
"""Lanes side by side: the numbers of a row."""
NOWHERE = 65_535
"""Last address of those at which no system has memory. Columns without a lane, whose
memory is zeros, come to addresses below it, and read zeros."""
NAME = re.compile(r"%v\d+")


class Vectors:
    """Types of vectors of so many lanes, in LLVM's words; `packs_truths` where the
    processor has registers for single bits."""

    def __init__(self, lanes: int, packs_truths: bool):
        self.lanes, self.packs_truths = lanes, packs_truths
        self.floats, self.integers, self.truths, self.pointers = (
            f"<{lanes} x {kind}>" for kind in (FLOAT, INTEGER, TRUTH, "ptr")
        )
        self.of = {FLOAT: self.floats, INTEGER: self.integers, TRUTH: self.truths}
        self.align = f"align {8 * lanes}"
        self.gather = f"@llvm.masked.gather.v{lanes}f64.v{lanes}p0"
        self.in_templates: dict = {
            "f": self.floats,
            "i": self.integers,
            "t": self.truths,
            "n": lanes,
        }
        """Names that the templates of `OPERATIONS` have for them."""

    def in_memory(self, kind: str) -> str:
        """Return the type as which values of a type are kept between parts: truths are
        as long as numbers, unless they are packed."""
        is_long = kind == self.truths and not self.packs_truths
        return self.integers if is_long else kind

    @property
    def declarations(self) -> str:
        """What a module declares that has functions on them."""
        f, n = self.floats, self.lanes
        return f"""
declare {f} @llvm.fabs.v{n}f64({f})
declare {f} @llvm.sqrt.v{n}f64({f})
declare {f} @llvm.fma.v{n}f64({f}, {f}, {f})
declare {f} {self.gather}({self.pointers}, i32, {self.truths}, {f})
"""


HALF = PACK // 2
"""Lanes of a vector of half the lanes."""
DECLARATIONS = f"""{Vectors(PACK, True).declarations}{Vectors(HALF, True).declarations}
attributes #0 = {{ "prefer-vector-width"="512" "min-legal-vector-width"="512" }}
"""
"""What a module declares that has functions."""


def in_order(roots: Iterable[Value], calls: Sequence[Call] = ()) -> list[Node]:
    """List all nodes that the roots need but inputs and parameters, in the order of
    their making, each after its arguments. Those of a body stand before what the first
    call of it gives.

    LLVM keeps the order of what depends on nothing between, by and large. As made, a
    derivative stands by what it is the derivative of. Root by root instead, two
    thousand values wait for each other in a step with one derivative, and code takes a
    third longer to compile and to run.
    """
    return [
        node
        for node in _needed(roots, calls)
        if node.operation not in (INPUT, PARAMETER)
    ]


def rows_read(roots: Iterable[Value], calls: Sequence[Call]) -> set[int]:
    """List the rows of memory that the roots need."""
    return {n.arguments[0] for n in _needed(roots, calls) if n.operation == INPUT}


def _needed(roots: Iterable[Value], calls: Sequence[Call]) -> list[Node]:
    """List all nodes that the roots need, in the order of their making."""
    needed: dict[int, Node] = {}
    stack = [root for root in roots if isinstance(root, Node)]
    while stack:
        node = stack.pop()
        if node.number not in needed:
            needed[node.number] = node
            values: Iterable[Any] = node.arguments
            if node.operation == RESULT:
                call = calls[node.arguments[0]]
                # Where the first call stands, the body does.
                first = next(other for other in calls if other.body is call.body)
                values = [*call.arguments, *call.body.results, *first.results]
            stack.extend(value for value in values if isinstance(value, Node))
    return [needed[number] for number in sorted(needed)]


MAY_BE_PRODUCTS = {"multiply", "divide", "negate", "choose_float", "magnitude"}
"""Operations whose result may be a product as it stands."""


def is_quotient(node: Node) -> bool:
    """Tell whether a node is written as a product with an inverse. A value divided by
    itself is not: that is one exactly."""
    return node.operation == "divide" and node.arguments[0] is not node.arguments[1]


def parts_to_invert(value: Node) -> tuple[Value, ...]:
    """Choose values to invert for the inverse of a value; none if the value is no
    product, quotient or choice."""
    if value.operation == "multiply":
        return value.arguments
    if value.operation == "divide":
        return value.arguments[:1]
    if value.operation == "choose_float":
        return value.arguments[1:]
    return ()


def product_in(node: Node) -> int | None:
    """Find the index, among the operands of a sum or difference, of the product that is
    fused with it into one instruction, which rounds once; None if none is.

    Not where both operands of values may be products: what is zero by symmetry would
    become the rounding of one of them, and the first steps noise. Derivatives `along` a
    direction are sums of products, and control no step.
    """
    if node.operation not in ("add", "subtract"):
        return None
    if node.along:
        products = map(is_product, node.arguments)
        return next((place for place, is_one in enumerate(products) if is_one), None)
    may_be = [
        isinstance(operand, Node) and operand.operation in MAY_BE_PRODUCTS
        for operand in node.arguments
    ]
    if sum(may_be) != 1:
        return None
    place = may_be.index(True)
    return place if node.arguments[place].operation == "multiply" else None


def is_product(value: Value) -> bool:
    """Tell whether a value is written as a product."""
    return isinstance(value, Node) and (
        value.operation == "multiply" or is_quotient(value)
    )


def _constant(number: float | int | bool) -> str:
    if type(number) is bool:
        return f"splat (i1 {str(number).lower()})"
    if type(number) is int:
        return f"splat (i64 {number})"
    return f"splat (double 0x{struct.pack('>d', number).hex().upper()})"


ONE, ZERO = _constant(1.0), _constant(0.0)


class Line(NamedTuple):
    """An instruction."""

    text: str
    """Nothing for what a call gives, which is read where it left it."""
    made: str
    """Name of its result."""
    used: list[str]
    along: bool
    """True for what is worked out for each direction."""
    result: int = -1
    """Place of what a call gives."""


class Stretch:
    """Lines between two calls, or those of a body."""

    def __init__(self, body: Body | None = None, after: Body | None = None):
        self.body, self.after = body, after
        """The body that they are, and the one that is called before them."""
        self.call: Call | None = None
        """The call that follows."""
        self.lines: list[Line] = []
        self.breaks: list[int] = []
        """Lines before which a part of the function may begin."""


class Writer:
    """Lines of one function on the rows of `%work`."""

    def __init__(self, vectors: Vectors):
        self.vectors = vectors
        self.stretches = [Stretch()]
        """In the order of their running, but for bodies, which stand once."""
        self.names: dict[int, str] = {}
        self.inverses: dict[int, str] = {}
        self.types: dict[str, str] = {}
        """LLVM type of each value that one part may hand on to another."""
        self.inputs: dict[str, Node] = {}
        """Inputs and parameters by name: each part reads those that it needs."""
        self.is_along = False
        self.count = 0

    def name(self, value: Value) -> str:
        if not isinstance(value, Node):
            return _constant(value)
        if value.operation in (INPUT, PARAMETER) and id(value) not in self.names:
            name = self.names[id(value)] = self.new_name()
            self.inputs[name] = value
        return self.names[id(value)]

    def new_name(self) -> str:
        self.count += 1
        return f"%v{self.count}"

    def new(self, text: str) -> str:
        """Add an instruction; return the name of its result."""
        name = self.new_name()
        self.stretches[-1].lines.append(
            Line(f"  {name} = {text}", name, NAME.findall(text), self.is_along)
        )
        return name

    def write(self, nodes: list[Node], calls: Sequence[Call] = ()) -> None:
        """Write nodes, in the order of `in_order`. A stretch begins with each body, and
        with what each call gives."""
        bodies = {id(call.body): call.body for call in calls}.values()
        called = set()
        for node in nodes:
            body = next((body for body in bodies if body.has(node)), None)
            if body is not None and body is not self.stretches[-1].body:
                self.stretches.append(Stretch(body))
            if node.operation == RESULT and node.arguments[0] not in called:
                number = node.arguments[0]
                called.add(number)
                before = next(s for s in reversed(self.stretches) if s.body is None)
                before.call = calls[number]
                self.stretches.append(Stretch(after=calls[number].body))
            stretch = self.stretches[-1]
            stretch.breaks.append(len(stretch.lines))
            self.is_along = node.along
            name = self.names[id(node)] = self.written(node)
            self.types[name] = self.vectors.of[node.kind]

    def written(self, node: Node) -> str:
        """Write a node; return the name of its result."""
        operation, arguments = node.operation, node.arguments
        if operation == RESULT:
            line = Line("", self.new_name(), [], node.along, arguments[1])
            self.stretches[-1].lines.append(line)
            return line.made
        if operation == "entry":
            return self.entry(self.name(arguments[0]))
        if is_quotient(node):
            if arguments[0] == 1.0:
                return self.inverse(arguments[1])
            return self.operation("multiply", *self.factors(node))
        place = product_in(node)
        if place is None:
            return self.operation(operation, *map(self.name, arguments))
        one, other = self.factors(arguments[place])
        rest = self.name(arguments[1 - place])
        if operation == "subtract" and place == 0:
            rest = self.operation("negate", rest)
        if operation == "subtract" and place == 1:
            one = self.operation("negate", one)
        return self.operation("fused", one, other, rest)

    def factors(self, product: Node) -> tuple[str, str]:
        """Return the names of the factors of what is written as a product."""
        first, second = product.arguments
        if product.operation == "divide":
            return self.name(first), self.inverse(second)
        return self.name(first), self.name(second)

    def entry(self, address: str) -> str:
        """Read the numbers at some addresses."""
        to = self.vectors
        there = self.new(f"icmp sgt {to.integers} {address}, {_constant(NOWHERE)}")
        pointers = self.new(f"inttoptr {to.integers} {address} to {to.pointers}")
        return self.new(
            f"call {to.floats} {to.gather}({to.pointers} {pointers}, i32 8, "
            f"{to.truths} {there}, {to.floats} {ZERO})"
        )

    def operation(self, operation: str, *operands: str) -> str:
        template = OPERATIONS[operation].text
        return self.new(template.format(*operands, **self.vectors.in_templates))

    def inverse(self, value: Value) -> str:
        """Return the name of one over a value, computed once."""
        if not isinstance(value, Node):
            return _constant(OPERATIONS["divide"].fold(1.0, value))
        if id(value) not in self.inverses:
            asking, self.is_along = self.is_along, value.along
            name = self.inverses[id(value)] = self.new_inverse(value)
            self.types[name] = self.vectors.floats
            self.is_along = asking
        return self.inverses[id(value)]

    def new_inverse(self, value: Node) -> str:
        parts = parts_to_invert(value)
        if not parts:
            return self.operation("divide", ONE, self.name(value))
        inverses = map(self.inverse, parts)
        if value.operation == "multiply":
            return self.operation("multiply", *inverses)
        if value.operation == "divide":
            return self.operation("multiply", self.name(value.arguments[1]), *inverses)
        return self.operation("choose_float", self.name(value.arguments[0]), *inverses)

"""Writing of graphs in LLVM's language.

A division takes the time of some ten products. So a quotient is written as a product
with the inverse of its divisor, which all quotients by it share; and the inverse of a
product, a quotient or a choice is put together from those of its parts. A sum takes the
product in it along.

LLVM's time grows faster than the length of a function. So long functions are divided
into parts, which can be compiled side by side. What one part works out for another goes
through rows of the memory that all work on; it would have gone through the stack
anyway. A vector has all eight lanes of a row, or half of them: then a part runs for one
half, and for the other.

How a value is written depends on what it is made of alone, and never on what else is
worked out beside it: code with derivatives, or with a ledger, gives the same values to
the last bit as code without.

What comes out differs from the rounded quotient by a few roundings. For finite operands
it is a number where that is, but where an inverse leaves the range of normal numbers:
there zero by next to nothing is NaN.
"""

import re
import struct
from collections.abc import Iterable
from typing import NamedTuple

from .graph import FLOAT, INPUT, INTEGER, OPERATIONS, TRUTH, Node, Value, kind_of

PACK = 8
"""Lanes side by side: the numbers of a row."""
NOWHERE = 65_535
"""Last address of those at which no system has memory. Columns without a lane, whose
memory is zeros, come to addresses below it, and read zeros."""
NAME = re.compile(r"%v\d+")
WHOLE = 12_000
"""Lines of the longest function that is not divided. Values alone run slower divided:
their steps, of some 6 000 lines, by a tenth."""
PART = 300
"""Lines of a part of a function: its machine code fits twice into the 32 KB in which a
processor holds instructions at hand. Derivatives run a tenth slower by parts of 1 500
lines, and two tenths by parts of 6 000; by those of 120 they run no faster."""


class Vectors:
    """Types of vectors of so many lanes, in LLVM's words."""

    def __init__(self, lanes: int):
        self.lanes = lanes
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

    @property
    def declarations(self) -> str:
        """What a module declares that has functions on them."""
        f, n = self.floats, self.lanes
        return f"""
declare {f} @llvm.fabs.v{n}f64({f})
declare {f} @llvm.sqrt.v{n}f64({f})
declare {f} @llvm.fma.v{n}f64({f}, {f}, {f})
declare {f} {self.gather}({self.pointers}, i32, {self.truths}, {f})
attributes #0 = {{ "prefer-vector-width"="512" "min-legal-vector-width"="512" }}
"""


class Output(NamedTuple):
    """A value that a function stores in a row."""

    row: int
    value: Value


class Function(NamedTuple):
    """A function in LLVM's language."""

    parts: list[str]
    """Definitions, each on vectors."""
    head: str = ""
    """Definition of what calls them one after the other; none of a single part for all
    lanes."""
    declarations: str = ""
    """Those of the parts, for a module that has the head alone."""


def in_order(roots: Iterable[Value]) -> list[Node]:
    """List all nodes that the roots need, each after its arguments: inputs where they
    are first needed, the others as they were made.

    LLVM keeps the order of what depends on nothing between, by and large. As made, a
    derivative stands by what it is the derivative of. Root by root instead, two
    thousand values wait for each other in a step with one derivative, and code takes a
    third longer to compile and to run.
    """
    needed: dict[int, Node] = {}
    stack = [root for root in roots if isinstance(root, Node)]
    while stack:
        node = stack.pop()
        if node.number not in needed:
            needed[node.number] = node
            stack.extend(a for a in node.arguments if isinstance(a, Node))
    ordered: dict[int, Node] = {}
    for number in sorted(needed):
        node = needed[number]
        if node.operation != INPUT:
            ordered |= {a.number: a for a in node.arguments if isinstance(a, Node)}
            ordered[number] = node
    return list((ordered | needed).values())


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

    Not where both operands may be products: what is zero by symmetry would become the
    rounding of one of them, and the first steps noise.
    """
    if node.operation not in ("add", "subtract"):
        return None
    may_be = [
        isinstance(operand, Node) and operand.operation in MAY_BE_PRODUCTS
        for operand in node.arguments
    ]
    if sum(may_be) != 1:
        return None
    place = may_be.index(True)
    return place if node.arguments[place].operation == "multiply" else None


def _constant(number: float | int | bool) -> str:
    if type(number) is bool:
        return f"splat (i1 {str(number).lower()})"
    if type(number) is int:
        return f"splat (i64 {number})"
    return f"splat (double 0x{struct.pack('>d', number).hex().upper()})"


ONE, ZERO = _constant(1.0), _constant(0.0)


class _Writer:
    """Lines of one function on the rows of `%work`."""

    def __init__(self, vectors: Vectors):
        self.vectors = vectors
        self.lines: list[str] = []
        self.names: dict[int, str] = {}
        self.inverses: dict[int, str] = {}
        self.breaks: list[int] = []
        """Lines before which a part of the function may begin."""
        self.types: dict[str, str] = {}
        """LLVM type of each value that one part may hand on to another."""

    def name(self, value: Value) -> str:
        return self.names[id(value)] if isinstance(value, Node) else _constant(value)

    def new(self, text: str) -> str:
        """Add an instruction; return the name of its result."""
        name = f"%v{len(self.lines)}"
        self.lines.append(f"  {name} = {text}")
        return name

    def row(self, row: int) -> str:
        return self.new(f"getelementptr double, ptr %work, i64 {row * PACK}")

    def read(self, row: int) -> str:
        vectors = self.vectors
        return self.new(f"load {vectors.floats}, ptr {self.row(row)}, {vectors.align}")

    def load(self, row: int, kind: str) -> str:
        read, vectors = self.read(row), self.vectors
        if kind == TRUTH:
            return self.new(f"fcmp une {vectors.floats} {read}, {ZERO}")
        if kind == INTEGER:
            return self.new(f"fptosi {vectors.floats} {read} to {vectors.integers}")
        return read

    def store(self, output: Output, mask: str | None) -> None:
        name, kind = self.name(output.value), kind_of(output.value)
        floats, truths = self.vectors.floats, self.vectors.truths
        if kind == TRUTH:
            name = self.new(f"select {truths} {name}, {floats} {ONE}, {floats} {ZERO}")
        if kind == INTEGER:
            name = self.new(f"sitofp {self.vectors.integers} {name} to {floats}")
        if mask:
            old = self.read(output.row)
            name = self.new(f"select {truths} {mask}, {floats} {name}, {floats} {old}")
        row = self.row(output.row)
        self.lines.append(f"  store {floats} {name}, ptr {row}, {self.vectors.align}")

    def write(self, nodes: list[Node]) -> None:
        for node in nodes:
            self.breaks.append(len(self.lines))
            name = self.names[id(node)] = self.written(node)
            self.types[name] = self.vectors.of[node.kind]

    def written(self, node: Node) -> str:
        """Write a node; return the name of its result."""
        operation, arguments = node.operation, node.arguments
        if operation == INPUT:
            return self.load(arguments[0], node.kind)
        if operation == "entry":
            return self.entry(self.name(arguments[0]))
        if is_quotient(node):
            numerator, divisor = arguments
            inverse = self.inverse(divisor)
            if numerator == 1.0:
                return inverse
            return self.operation("multiply", self.name(numerator), inverse)
        place = product_in(node)
        if place is None:
            return self.operation(operation, *map(self.name, arguments))
        one, other = map(self.name, arguments[place].arguments)
        rest = self.name(arguments[1 - place])
        if operation == "subtract" and place == 0:
            rest = self.operation("negate", rest)
        if operation == "subtract" and place == 1:
            one = self.operation("negate", one)
        return self.operation("fused", one, other, rest)

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
            name = self.inverses[id(value)] = self.new_inverse(value)
            self.types[name] = self.vectors.floats
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


def write_function(
    name: str,
    outputs: list[Output],
    truth: Value,
    masked: bool = False,
    free_row: int = 0,
    lanes: int = PACK,
) -> tuple[Function, int]:
    """Write a function on the rows of the memory that it is called with, of which it
    may use those from `free_row` on; also return how many of these it uses.

    Its second argument names columns by their bits. It stores the outputs in these, but
    in others too unless `masked`, and returns the bits of a truth.

    Args:
        lanes: of a vector.
    """
    writer = _Writer(Vectors(lanes))
    writer.write(in_order([*(output.value for output in outputs), truth]))
    writer.breaks.append(len(writer.lines))
    truths = writer.vectors.truths
    mask = writer.new(f"bitcast i{lanes} %columns to {truths}") if masked else None
    for output in outputs:
        writer.store(output, mask)
    bits = writer.new(f"bitcast {truths} {writer.name(truth)} to i{lanes}")
    parts, used = _in_parts(writer, free_row)
    if len(parts) == 1 and lanes == PACK:
        return Function([_definition(name, lanes, parts[0], bits)]), used
    names = [f"{name}_{place}" for place in range(len(parts))]
    results = [*["0"] * (len(parts) - 1), bits]
    definitions = [
        _definition(part_name, lanes, part, result)
        for part_name, part, result in zip(names, parts, results, strict=True)
    ]
    declarations = (f"declare i{lanes} @{part}(ptr, i{lanes})\n" for part in names)
    return Function(definitions, _head(name, names, lanes), "".join(declarations)), used


def _definition(name: str, lanes: int, lines: list[str], result: str) -> str:
    first = f"define i{lanes} @{name}(ptr %work, i{lanes} %columns) #0 {{"
    return "\n".join([first, *lines, f"  ret i{lanes} {result}", "}\n"])


def _head(name: str, parts: list[str], lanes: int) -> str:
    """Write the function that calls the parts one after the other, each for every
    vector in which a column is wanted: its instructions are at hand then. The last one
    gives the bits.

    It takes their addresses from a table: a call by relative address, from one object
    file to another, might not reach. Calls are written out, since a processor foresees
    where each leads; in a loop derivatives take a sixth longer.
    """
    table, starts = f"@{name}_parts", [*range(0, PACK, lanes)]
    addresses = ", ".join(f"ptr @{part}" for part in parts)
    lines = [
        f"{table} = global [{len(parts)} x ptr] [{addresses}]",
        f"define i{PACK} @{name}(ptr %work, i{PACK} %columns) {{",
    ]
    for start in starts:
        lines += [
            f"  %work{start} = getelementptr double, ptr %work, i64 {start}",
            f"  %shifted{start} = lshr i{PACK} %columns, {start}",
            f"  %columns{start} = {_resized(f'%shifted{start}', PACK, lanes)}",
            f"  %empty{start} = icmp eq i{lanes} %columns{start}, 0",
        ]
    if len(starts) == 2:
        for start, other in (starts, starts[::-1]):
            lines += [
                f"  br i1 %empty{other}, label %only{start}, label %not{start}",
                f"only{start}:",
                *_calls(table, len(parts), [start], lanes, f"_only{start}"),
                f"not{start}:",
            ]
    return "\n".join([*lines, *_calls(table, len(parts), starts, lanes, ""), "}\n"])


def _calls(
    table: str, parts: int, starts: list[int], lanes: int, suffix: str
) -> list[str]:
    """Write the calls of the parts for vectors that start at some columns, and the
    return of their bits; the suffix tells names from those of other calls."""
    lines = []
    for place in range(parts):
        lines += [
            f"  %at{place}{suffix} = getelementptr ptr, ptr {table}, i64 {place}",
            f"  %part{place}{suffix} = load ptr, ptr %at{place}{suffix}",
        ]
        lines += [
            f"  %bits{place}_{start}{suffix} = call i{lanes} %part{place}{suffix}"
            f"(ptr %work{start}, i{lanes} %columns{start})"
            for start in starts
        ]
    bits = "0"
    for start in starts:
        of_part = f"%bits{parts - 1}_{start}{suffix}"
        lines += [
            f"  %wide{start}{suffix} = {_resized(of_part, lanes, PACK)}",
            f"  %placed{start}{suffix} = shl i{PACK} %wide{start}{suffix}, {start}",
            f"  %all{start}{suffix} = or i{PACK} {bits}, %placed{start}{suffix}",
        ]
        bits = f"%all{start}{suffix}"
    return [*lines, f"  ret i{PACK} {bits}"]


def _resized(value: str, before: int, after: int) -> str:
    """Write the conversion between integers of so many bits."""
    if before == after:
        return f"or i{before} {value}, 0"
    return f"{'zext' if after > before else 'trunc'} i{before} {value} to i{after}"


def _in_parts(writer: _Writer, free_row: int) -> tuple[list[list[str]], int]:
    """Divide a long function, and add lines that hand on what later parts need, in rows
    from `free_row` on. Returns the lines by part, and how many rows they take."""
    if len(writer.lines) <= WHOLE:
        return [writer.lines], 0
    align = writer.vectors.align
    ends, begin = [], 0
    for place in writer.breaks:
        if place - begin >= PART and len(writer.lines) - place >= PART // 2:
            ends.append(place)
            begin = place
    bounds = list(zip([0, *ends], [*ends, len(writer.lines)], strict=True))
    made_in: dict[str, int] = {}
    last_use: dict[str, int] = {}
    for part, (begin, end) in enumerate(bounds):
        for line in writer.lines[begin:end]:
            made, *used = NAME.findall(line)
            if " = " in line:
                made_in[made] = part
            else:
                used.append(made)
            last_use |= dict.fromkeys(used, part)
    handed_on = {n for n, part in last_use.items() if part > made_in[n]}
    rows: dict[str, int] = {}
    free: list[int] = []
    most = 0
    written = []

    def address(name: str, lines: list[str]) -> str:
        at, row = f"%at{len(lines)}", free_row + rows[name]
        lines.append(f"  {at} = getelementptr double, ptr %work, i64 {row * PACK}")
        return f"ptr {at}, {align}"

    for part, (begin, end) in enumerate(bounds):
        lines, here = [], set()
        for line in writer.lines[begin:end]:
            names = NAME.findall(line)
            gives = " = " in line
            for name in names[gives:]:
                if made_in[name] < part and name not in here:
                    here.add(name)
                    at = address(name, lines)
                    lines.append(f"  {name} = load {writer.types[name]}, {at}")
            lines.append(line)
            if gives and names[0] in handed_on:
                if not free:
                    free.append(most)
                    most += 1
                name = names[0]
                rows[name] = free.pop()
                at = address(name, lines)
                lines.append(f"  store {writer.types[name]} {name}, {at}")
        # What no later part reads makes room for what the next one gives.
        free += [rows.pop(name) for name in list(rows) if last_use[name] == part]
        written.append(lines)
    return written, most

"""Writing of graphs in LLVM's language, and compilation to machine code.

A division takes the time of some ten products. So a quotient is written as a product
with the inverse of its divisor, which all quotients by it share; and the inverse of a
product, a quotient or a choice is put together from those of its parts. A sum takes the
product in it along.

LLVM's time grows faster than the length of a function: a step with three derivatives,
of 50 000 lines, takes twice as long in one piece as in four. So long functions are
divided into parts. What one part works out for another goes through rows of the memory
that all work on; it would have gone through the stack anyway.

How a value is written depends on what it is made of alone, and never on what else is
worked out beside it: code with derivatives, or with a ledger, gives the same values to
the last bit as code without.

What comes out differs from the rounded quotient by a few roundings. For finite operands
it is a number where that is, but where an inverse leaves the range of normal numbers:
there zero by next to nothing is NaN.
"""

import re
import struct
from collections.abc import Callable, Iterable
from importlib.metadata import version
from typing import NamedTuple

import llvmlite.binding as llvm

from .graph import FLOAT, INPUT, INTEGER, OPERATIONS, TRUTH, Node, Value, kind_of
from .target import this_target

PACK = 8
"""Lanes in a vector: one register of AVX-512, two of AVX2, four of Neon."""
FLOATS, INTEGERS, TRUTHS = (f"<{PACK} x {kind}>" for kind in (FLOAT, INTEGER, TRUTH))
POINTERS = f"<{PACK} x ptr>"
GATHER = f"@llvm.masked.gather.v{PACK}f64.v{PACK}p0"
NOWHERE = 65_535
"""Last address of those at which no system has memory. Columns without a lane, whose
memory is zeros, come to addresses below it, and read zeros."""
VECTORS = {"f": FLOATS, "i": INTEGERS, "t": TRUTHS}
TYPES = {FLOAT: FLOATS, INTEGER: INTEGERS, TRUTH: TRUTHS}
NAME = re.compile(r"%v\d+")
PART = 12_000
"""Lines of a part of a function."""
DECLARATIONS = f"""
declare {FLOATS} @llvm.fabs.v{PACK}f64({FLOATS})
declare {FLOATS} @llvm.sqrt.v{PACK}f64({FLOATS})
declare {FLOATS} @llvm.fma.v{PACK}f64({FLOATS}, {FLOATS}, {FLOATS})
declare {FLOATS} {GATHER}({POINTERS}, i32, {TRUTHS}, {FLOATS})
attributes #0 = {{ "prefer-vector-width"="512" "min-legal-vector-width"="512" }}
"""

Keep = Callable[[str, Callable[[], bytes]], bytes]
_keep: Keep = lambda _, make: make()  # noqa: E731


class Output(NamedTuple):
    """A value that a function stores in a row."""

    row: int
    value: Value


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

    def __init__(self):
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
        return self.new(f"load {FLOATS}, ptr {self.row(row)}, align 64")

    def load(self, row: int, kind: str) -> str:
        read = self.read(row)
        if kind == TRUTH:
            return self.new(f"fcmp une {FLOATS} {read}, {ZERO}")
        if kind == INTEGER:
            return self.new(f"fptosi {FLOATS} {read} to {INTEGERS}")
        return read

    def store(self, output: Output, mask: str | None) -> None:
        name, kind = self.name(output.value), kind_of(output.value)
        if kind == TRUTH:
            name = self.new(f"select {TRUTHS} {name}, {FLOATS} {ONE}, {FLOATS} {ZERO}")
        if kind == INTEGER:
            name = self.new(f"sitofp {INTEGERS} {name} to {FLOATS}")
        if mask:
            old = self.read(output.row)
            name = self.new(f"select {TRUTHS} {mask}, {FLOATS} {name}, {FLOATS} {old}")
        row = self.row(output.row)
        self.lines.append(f"  store {FLOATS} {name}, ptr {row}, align 64")

    def write(self, nodes: list[Node]) -> None:
        for node in nodes:
            self.breaks.append(len(self.lines))
            name = self.names[id(node)] = self.written(node)
            self.types[name] = TYPES[node.kind]

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
        there = self.new(f"icmp sgt {INTEGERS} {address}, {_constant(NOWHERE)}")
        pointers = self.new(f"inttoptr {INTEGERS} {address} to {POINTERS}")
        return self.new(
            f"call {FLOATS} {GATHER}({POINTERS} {pointers}, i32 8, "
            f"{TRUTHS} {there}, {FLOATS} {ZERO})"
        )

    def operation(self, operation: str, *operands: str) -> str:
        return self.new(OPERATIONS[operation].text.format(*operands, **VECTORS))

    def inverse(self, value: Value) -> str:
        """Return the name of one over a value, computed once."""
        if not isinstance(value, Node):
            return _constant(OPERATIONS["divide"].fold(1.0, value))
        if id(value) not in self.inverses:
            name = self.inverses[id(value)] = self.new_inverse(value)
            self.types[name] = FLOATS
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
) -> tuple[str, int]:
    """Write a function on the rows of the memory that it is called with, of which it
    may use those from `free_row` on; also return how many of these it uses.

    It stores the outputs, if `masked` in the columns named by the bits of its second
    argument alone, and returns the bits of a truth.
    """
    writer = _Writer()
    writer.write(in_order([*(output.value for output in outputs), truth]))
    writer.breaks.append(len(writer.lines))
    mask = writer.new(f"bitcast i{PACK} %columns to {TRUTHS}") if masked else None
    for output in outputs:
        writer.store(output, mask)
    bits = writer.new(f"bitcast {TRUTHS} {writer.name(truth)} to i{PACK}")
    parts, used = _in_parts(writer, free_row)
    arguments, lines = f"(ptr %work, i{PACK} %columns)", []
    for place, part in enumerate(parts[:-1]):
        lines += [f"define internal void @{name}_{place}{arguments} #0 {{", *part]
        lines += ["  ret void", "}"]
    lines.append(f"define i{PACK} @{name}{arguments} #0 {{")
    lines += [f"  call void @{name}_{k}{arguments}" for k in range(len(parts) - 1)]
    lines += [*parts[-1], f"  ret i{PACK} {bits}", "}\n"]
    return "\n".join(lines), used


def _in_parts(writer: _Writer, free_row: int) -> tuple[list[list[str]], int]:
    """Divide a function, and add lines that hand on what later parts need, in rows from
    `free_row` on. Returns the lines by part, and how many rows they take."""
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
        return f"ptr {at}, align 64"

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


def keep_objects(keep: Keep) -> None:
    """Have object files kept, since LLVM takes seconds: `keep` gives what is kept under
    a key, or what a function makes and it keeps."""
    global _keep
    _keep = keep


def compile_text(text: str, external_calls: bool = False) -> bytes:
    """Return the machine code for this computer, as an object file, compiled or kept.

    The key is the text itself, with every constant in it: whatever a user's law refers
    to, other numbers are other code. External calls are those of functions of
    libraries.

    Raises NoMachineCode where this computer can run none.
    """
    target = this_target()
    how = external_calls, target, version("llvmlite")
    return _keep(
        repr(("object", *how, text)), lambda: target.object_file(text, external_calls)
    )


def load(object_file: bytes, external_calls: bool = False):
    """Make an engine of LLVM with machine code put to where it can run; the code is
    there as long as the engine lives."""
    target = this_target()
    small = target.has_small_code_model(external_calls)
    # Relative addresses reach 2 GB. llvmlite's memory manager keeps constants beside
    # the code, but aborts the process where code has external calls.
    engine = llvm.create_mcjit_compiler(
        llvm.parse_assembly(""), target.machine(external_calls), use_lmm=small or None
    )
    engine.add_object_file(llvm.ObjectFileRef.from_data(object_file))
    engine.finalize_object()
    return engine

"""Functions in LLVM's language, whole or in parts (`parts`)."""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from .graph import INTEGER, PARAMETER, TRUTH, Call, Node, Value, kind_of
from .llvm_ir import HALF, ONE, PACK, ZERO, Vectors, Writer, in_order
from .parts import HandedOn, Output, Part, Rows, divided, parameters_of, results_of


class Function(NamedTuple):
    """A function in LLVM's language."""

    parts: list[str]
    """Definitions, each on vectors."""
    head: str = ""
    """Definition of what calls them one after the other; none of a single part for all
    lanes."""
    declarations: str = ""
    """Those of the parts, for a module that has the head alone."""


def write_function(
    name: str,
    outputs: Sequence[Output],
    truth: Value,
    rows: Rows,
    vectors: Vectors,
    masked: bool = False,
    calls: Sequence[Call] = (),
) -> tuple[Function, int]:
    """Write a function on rows of the memory that it is called with; also return how
    many of the free ones it uses.

    Its second argument names columns by their bits, its third one is the number of
    directions that are wanted, of those for which there are rows. It stores the outputs
    in these columns, but in others too unless `masked`, and returns the bits of a
    truth.

    Args:
        calls: those of bodies in the graph.
    """
    writer, lanes = Writer(vectors), vectors.lanes
    roots = [*(output.value for output in outputs), truth]
    writer.write(in_order(roots, calls), calls)
    sequence = divided(writer, outputs, rows)
    sequence[-1].says = writer.name(truth)
    handed_on = HandedOn(writer, sequence)
    names: dict[Part, str] = {}
    for place, part in enumerate(sequence):
        if part not in names:
            names[part] = f"{name}_{len(names)}"
            _Text(part, writer, rows, handed_on).write(masked)
        handed_on.make_room(place)
    spare = handed_on.common + rows.directions * handed_on.along
    if len(sequence) == 1 and lanes == PACK:
        return Function([_definition(name, sequence[0], lanes, rows, handed_on)]), spare
    function = Function(
        [_definition(own, part, lanes, rows, handed_on) for part, own in names.items()],
        _head(name, names, sequence, lanes),
        "".join(
            f"declare i{lanes} @{own}(ptr, i{lanes}, i64)\n" for own in names.values()
        ),
    )
    return function, spare


def write_choice(name: str, ways: Mapping[str, Function]) -> Function:
    """Write a function that calls one of two, by their names: on vectors of all lanes,
    or on vectors of half of them where all columns wanted are in one half."""
    arguments = f"(ptr %work, i{PACK} %columns, i64 %directions)"
    addresses = ", ".join(f"ptr @{own}" for own in ways)
    head = f"""
@{name}_ways = global [{len(ways)} x ptr] [{addresses}]
define i{PACK} @{name}{arguments} {{
  %lower = and i{PACK} %columns, {2**HALF - 1}
  %upper = and i{PACK} %columns, {2**PACK - 2**HALF}
  %not_lower = icmp eq i{PACK} %lower, 0
  %not_upper = icmp eq i{PACK} %upper, 0
  %of_half = or i1 %not_lower, %not_upper
  %way = zext i1 %of_half to i64
  %at = getelementptr ptr, ptr @{name}_ways, i64 %way
  %function = load ptr, ptr %at
  %bits = call i{PACK} %function{arguments}
  ret i{PACK} %bits
}}
"""
    whole = [own for own, function in ways.items() if not function.head]
    return Function(
        [part for function in ways.values() for part in function.parts],
        "\n".join([*(function.head for function in ways.values()), head]),
        "".join(function.declarations for function in ways.values())
        + "".join(f"declare i{PACK} @{own}(ptr, i{PACK}, i64)\n" for own in whole),
    )


class _Text:
    """The lines of a part, as they are written."""

    def __init__(self, part: Part, writer: Writer, rows: Rows, handed_on: HandedOn):
        self.part, self.writer, self.rows = part, writer, rows
        self.handed_on, self.vectors = handed_on, writer.vectors
        self.lines: list[str] = []
        self.strides: dict[int, str] = {}
        self.here: set[str] = set()
        self.count = 0

    def write(self, masked: bool) -> None:
        part, handed_on = self.part, self.handed_on
        for line in part.made:
            for name in line.used:
                self.bring(name)
            if line.text:
                self.lines.append(line.text)
            else:
                assert part.after is not None, "a call before"
                self.take(line.made, results_of(part.after)[line.result][0])
            self.here.add(line.made)
            if handed_on.is_needed(line.made):
                self.hand_on(line.made, line.made)
        mask = None
        if masked and part.outputs:
            columns = f"bitcast i{self.vectors.lanes} %columns to {self.vectors.truths}"
            mask = self.new(columns)
        for output in part.outputs:
            self.store(output, mask)
        for to, value in part.passed:
            name = self.bring(self.writer.name(value))
            self.hand_on(name, to, self.vectors.of[kind_of(value)])
        if part.says is not None:
            said = self.bring(part.says)
            bits = f"bitcast {self.vectors.truths} {said} to i{self.vectors.lanes}"
            part.says = self.new(bits)
        part.lines = [*self.bases(), *self.lines]

    def new(self, text: str) -> str:
        """Add an instruction; return the name of its result."""
        self.count += 1
        self.lines.append(f"  %a{self.count} = {text}")
        return f"%a{self.count}"

    def at(self, row: int, base: str) -> str:
        at = self.new(f"getelementptr double, ptr {base}, i64 {row * PACK}")
        return f"ptr {at}, {self.vectors.align}"

    def row(self, row: int) -> str:
        """Return the address of a row; of those of a direction that of the direction
        for which the part is called."""
        stride = self.rows.strides.get(row, 0)
        base = self.strides.setdefault(stride, f"%by{stride}") if stride else "%work"
        return self.at(row, base)

    def type_of(self, name: str) -> str:
        node = self.writer.inputs.get(name)
        return self.writer.types[name] if node is None else self.vectors.of[node.kind]

    def handed_on_at(self, name: str) -> str:
        row = self.handed_on.row(name)
        if self.handed_on.is_along[name]:
            return self.at(row, "%spare")
        return self.at(self.rows.free + row, "%work")

    def bases(self) -> Iterator[str]:
        """Write where the rows of the direction begin."""
        for stride, base in self.strides.items():
            yield f"  {base}_more = mul i64 %direction, {stride * PACK}"
            yield f"  {base} = getelementptr double, ptr %work, i64 {base}_more"

    def bring(self, name: str) -> str:
        """Read a value that is an input, or comes from another part, once."""
        if name not in self.here and name.startswith("%"):
            self.here.add(name)
            node = self.writer.inputs.get(name)
            if node is None:
                self.take(name, name)
            elif node.operation == PARAMETER:
                assert self.part.body is not None, "a body has parameters"
                (place,) = node.arguments
                self.take(name, parameters_of(self.part.body)[place][0])
            else:
                self.read(name, node)
        return name

    def hand_on(self, name: str, to: str, kind: str | None = None) -> None:
        """Store a value for other parts, in the row of a name."""
        at = self.handed_on_at(to)
        kind = kind or self.writer.types[name]
        kept = self.vectors.in_memory(kind)
        if kept != kind:
            name = self.new(f"sext {kind} {name} to {kept}")
        self.lines.append(f"  store {kept} {name}, {at}")

    def take(self, name: str, where: str) -> None:
        """Read a value that comes from another part, in the row of a name."""
        kind = self.type_of(name)
        kept = self.vectors.in_memory(kind)
        read = f"load {kept}, {self.handed_on_at(where)}"
        if kept != kind:
            read = f"icmp slt {kept} {self.new(read)}, zeroinitializer"
        self.lines.append(f"  {name} = {read}")

    def read(self, name: str, node: Node) -> None:
        """Read an input, whose row holds a float."""
        floats, (row,) = self.vectors.floats, node.arguments
        read = f"load {floats}, {self.row(row)}"
        if node.kind == TRUTH:
            read = f"fcmp une {floats} {self.new(read)}, {ZERO}"
        if node.kind == INTEGER:
            read = f"fptosi {floats} {self.new(read)} to {self.vectors.integers}"
        self.lines.append(f"  {name} = {read}")

    def store(self, output: Output, mask: str | None) -> None:
        name, kind = self.bring(self.writer.name(output.value)), kind_of(output.value)
        floats, truths = self.vectors.floats, self.vectors.truths
        if kind == TRUTH:
            name = self.new(f"select {truths} {name}, {floats} {ONE}, {floats} {ZERO}")
        if kind == INTEGER:
            name = self.new(f"sitofp {self.vectors.integers} {name} to {floats}")
        if mask:
            old = self.new(f"load {floats}, {self.row(output.row)}")
            name = self.new(f"select {truths} {mask}, {floats} {name}, {floats} {old}")
        self.lines.append(f"  store {floats} {name}, {self.row(output.row)}")


def _definition(
    name: str, part: Part, lanes: int, rows: Rows, handed_on: HandedOn
) -> str:
    """Write a part as a function."""
    arguments = f"ptr %work, i{lanes} %columns, i64 %direction"
    lines = [f"define i{lanes} @{name}({arguments}) #0 {{"]
    if part.along:
        start = (rows.free + handed_on.common) * PACK
        lines += [
            f"  %first = getelementptr double, ptr %work, i64 {start}",
            f"  %more = mul i64 %direction, {handed_on.along * PACK}",
            "  %spare = getelementptr double, ptr %first, i64 %more",
        ]
    said = "0" if part.says is None else part.says
    return "\n".join([*lines, *part.lines, f"  ret i{lanes} {said}", "}\n"])


def _head(
    name: str, names: Mapping[Part, str], sequence: Sequence[Part], lanes: int
) -> str:
    """Write the function that calls the parts in their sequence, each for every
    vector in which a column is wanted, and if need be for every direction: its
    instructions are at hand then. The last one gives the bits.

    It takes their addresses from a table: a call by relative address, from one object
    file to another, might not reach. Calls of parts are written out, since a processor
    foresees where each leads; in a loop derivatives take a sixth longer.
    """
    table, starts = f"@{name}_parts", [*range(0, PACK, lanes)]
    addresses = ", ".join(f"ptr @{own}" for own in names.values())
    places = {part: place for place, part in enumerate(names)}
    parts = [(places[part], part.along) for part in sequence]
    lines = [
        f"{table} = global [{len(names)} x ptr] [{addresses}]",
        f"define i{PACK} @{name}(ptr %work, i{PACK} %columns, i64 %directions) {{",
        "begin:",
    ]
    for start in starts:
        lines += [
            f"  %work{start} = getelementptr double, ptr %work, i64 {start}",
            f"  %shifted{start} = lshr i{PACK} %columns, {start}",
            f"  %columns{start} = {_resized(f'%shifted{start}', PACK, lanes)}",
            f"  %empty{start} = icmp eq i{lanes} %columns{start}, 0",
        ]
    label = "begin"
    if len(starts) == 2:
        for start, other in (starts, starts[::-1]):
            lines += [
                f"  br i1 %empty{other}, label %only{start}, label %not{start}",
                f"only{start}:",
                *_calls(table, parts, [start], lanes, f"only{start}"),
                f"not{start}:",
            ]
            label = f"not{start}"
    return "\n".join([*lines, *_calls(table, parts, starts, lanes, label), "}\n"])


def _calls(
    table: str,
    parts: Sequence[tuple[int, bool]],
    starts: list[int],
    lanes: int,
    label: str,
) -> list[str]:
    """Write the calls of the parts for vectors that start at some columns, and the
    return of their bits.

    Args:
        parts: place of each in the table, and whether it is called for each direction.
        label: that of the block that the calls begin in; other names end with it.
    """
    lines, block = [], label
    for place, (entry, of_directions) in enumerate(parts):
        own = f"{place}_{label}"
        lines += [
            f"  %at{own} = getelementptr ptr, ptr {table}, i64 {entry}",
            f"  %part{own} = load ptr, ptr %at{own}",
        ]
        direction = "0"
        if of_directions:
            direction = f"%direction{own}"
            lines += [
                f"  br label %loop{own}",
                f"loop{own}:",
                f"  {direction} = phi i64 [ 0, %{block} ], [ %next{own}, %loop{own} ]",
            ]
        lines += [
            f"  %bits{start}_{own} = call i{lanes} %part{own}"
            f"(ptr %work{start}, i{lanes} %columns{start}, i64 {direction})"
            for start in starts
        ]
        if of_directions:
            block = f"end{own}"
            lines += [
                f"  %next{own} = add i64 {direction}, 1",
                f"  %more{own} = icmp ult i64 %next{own}, %directions",
                f"  br i1 %more{own}, label %loop{own}, label %{block}",
                f"{block}:",
            ]
    bits = "0"
    for start in starts:
        of_part = f"%bits{start}_{len(parts) - 1}_{label}"
        lines += [
            f"  %wide{start}_{label} = {_resized(of_part, lanes, PACK)}",
            f"  %placed{start}_{label} = shl i{PACK} %wide{start}_{label}, {start}",
            f"  %all{start}_{label} = or i{PACK} {bits}, %placed{start}_{label}",
        ]
        bits = f"%all{start}_{label}"
    return [*lines, f"  ret i{PACK} {bits}"]


def _resized(value: str, before: int, after: int) -> str:
    """Write the conversion between integers of so many bits."""
    if before == after:
        return f"or i{before} {value}, 0"
    return f"{'zext' if after > before else 'trunc'} i{before} {value} to i{after}"

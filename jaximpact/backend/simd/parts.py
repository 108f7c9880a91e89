"""Parts of a function, and the rows of memory in which they hand on values.

LLVM's time grows faster than the length of a function. So long functions are divided
into parts, which can be compiled side by side. What one part works out for another goes
through rows of the memory that all work on; it would have gone through the stack
anyway. A vector has all eight lanes of a row, or half of them: then a part runs for one
half, and for the other.

What is called several times, a body, is in parts of its own, which are compiled once
and run at each call.

What depends on a direction is in parts of its own, which run once for each direction,
on its rows: they are compiled once, and are in the processor's caches when they run
again. Values never depend on derivatives.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from .graph import Body, Value, is_along
from .llvm_ir import Line, Stretch, Writer

WHOLE = 12_000
"""Lines of the longest stretch of values alone that is not divided further than by its
calls. Steps run slower divided, by a tenth."""
PART = 300
"""Lines of a part of values and derivatives together: the machine code of either fits
into the 32 KB in which a processor holds instructions at hand. Derivatives run as fast
by parts of 100 to 500 lines, a tenth slower by those of 1 000, two tenths by 2 000."""


class Output(NamedTuple):
    """A value that a function stores in a row."""

    row: int
    value: Value


class Rows(NamedTuple):
    """Rows that a function works on."""

    free: int
    """First of those that it may use for itself."""
    directions: int = 0
    strides: Mapping[int, int] = {}
    """Row of a derivative along the first direction -> how many rows further that along
    the next one is."""


class Part:
    """A part of a function under way."""

    def __init__(self, made: list[Line], along: bool, outputs: Sequence[Output] = ()):
        self.made, self.along, self.outputs = made, along, outputs
        """Instructions; whether they are carried out for each direction; and what it
        stores at its end."""
        self.body: Body | None = None
        self.after: Body | None = None
        """The body whose part it is, and the one whose results it reads."""
        self.passed: list[tuple[str, Value]] = []
        """What it stores at its end for a call, or as what a call gives."""
        self.says: str | None = None
        """Name of the truth that it returns."""
        self.lines: list[str] = []

    def used(self, writer: Writer) -> Iterator[str]:
        """List the names of the values that it reads or makes."""
        for line in self.made:
            yield from line.used
        for output in self.outputs:
            yield writer.name(output.value)
        for _, value in self.passed:
            yield writer.name(value)
        if self.says is not None:
            yield self.says


def divided(writer: Writer, outputs: Sequence[Output], rows: Rows) -> list[Part]:
    """Divide a function into parts, in the order of their running: those of a body
    stand there at each call. Outputs are stored where nothing that they overwrite is
    read any more."""
    along = [output for output in outputs if output.row in rows.strides]
    others = [output for output in outputs if output.row not in rows.strides]
    whole = not along and all(len(s.lines) <= WHOLE for s in writer.stretches)
    of_body: dict[int, list[Part]] = {}
    for stretch in writer.stretches:
        if stretch.body is not None:
            parts = _parts_of(stretch, whole)
            _pass(parts, results_of(stretch.body), stretch.body.results)
            of_body[id(stretch.body)] = parts
    sequence = []
    for stretch in writer.stretches:
        if stretch.body is not None:
            continue
        parts = _parts_of(stretch, whole)
        if stretch.call is not None:
            body = stretch.call.body
            _pass(parts, parameters_of(body), stretch.call.arguments)
            parts += of_body[id(body)]
        sequence += parts
    if along:
        sequence.append(Part([], True, along))
    if along or not whole or sequence[-1].along:
        sequence.append(Part([], False))
    sequence[-1].outputs = others
    return sequence


def _parts_of(stretch: Stretch, whole: bool) -> list[Part]:
    """Divide a stretch, if it is not to be `whole`."""
    lines, ends, begin = stretch.lines, [], 0
    for place in () if whole else stretch.breaks:
        if place - begin >= PART and len(lines) - place >= PART // 2:
            ends.append(place)
            begin = place
    parts = []
    for first, last in zip([0, *ends], [*ends, len(lines)], strict=True):
        for of_directions in (False, True):
            made = [line for line in lines[first:last] if line.along == of_directions]
            if made or (whole and not of_directions):
                parts.append(Part(made, of_directions))
    for part in parts:
        part.body, part.after = stretch.body, stretch.after
    return parts


def _pass(parts: list[Part], names: list[tuple[str, bool]], values: list[Value]):
    """Have parts store values in the rows of some names, each told whether it is of a
    derivative: at the end of the last part of its kind."""
    body = parts[0].body if parts else None
    for of_directions in (False, True):
        passed = [
            (name, value)
            for (name, along), value in zip(names, values, strict=True)
            if along == of_directions
        ]
        if not passed:
            continue
        last = next((p for p in reversed(parts) if p.along == of_directions), None)
        if last is None:
            last = Part([], of_directions)
            last.body = body
            parts.append(last)
        last.passed = passed


def parameters_of(body: Body) -> list[tuple[str, bool]]:
    """Name the rows in which a body finds its parameters."""
    return [
        (f"parameter {k} of {id(body)}", node.along)
        for k, node in enumerate(body.parameters)
    ]


def results_of(body: Body) -> list[tuple[str, bool]]:
    """Name the rows in which a body leaves what it gives."""
    return [
        (f"result {k} of {id(body)}", is_along(value))
        for k, value in enumerate(body.results)
    ]


class HandedOn:
    """Rows in which parts hand on values to later ones.

    What a body works out for itself has rows of its own, which keep nothing from one
    call to the next.
    """

    def __init__(self, writer: Writer, sequence: Sequence[Part]):
        self.common, self.along = 0, 0
        """How many there are, for values and for what each direction has."""
        self.is_along: dict[str, bool] = {}
        made_in: dict[str, Part] = {}
        readers: dict[str, set[Part]] = {}
        first: dict[Part, int] = {}
        last: dict[Part, int] = {}
        for place, part in enumerate(sequence):
            last[part] = place
            if part in first:
                continue
            first[part] = place
            for name in part.used(writer):
                readers.setdefault(name, set()).add(part)
            made_in |= dict.fromkeys((line.made for line in part.made), part)
            self.is_along |= {line.made: line.along for line in part.made}
        for body in {part.body for part in sequence if part.body is not None}:
            self.is_along |= dict([*parameters_of(body), *results_of(body)])
        self.last_use: dict[str, int] = {}
        self.room: dict[str, Body | None] = {}
        """The body for which alone a value is."""
        for name, part in made_in.items():
            others = readers.get(name, set()) - {part}
            if not others:
                continue
            alone = part.body is not None and all(p.body is part.body for p in others)
            self.room[name] = part.body if alone else None
            # A body makes its values anew at each call.
            ends = [first[p] for p in others] if alone else [last[p] for p in others]
            self.last_use[name] = max(*ends, ends[0] if alone else last[part])
        self._rows: dict[str, int] = {}
        self._free: dict[tuple[bool, Body | None], list[int]] = {}

    def is_needed(self, name: str) -> bool:
        """Tell whether another part reads a value."""
        return name in self.last_use

    def row(self, name: str) -> int:
        """Return the row of a value, among those of its kind."""
        if name not in self._rows:
            along = self.is_along[name]
            free = self._free.setdefault((along, self.room.get(name)), [])
            if not free:
                free.append(self.along if along else self.common)
                self.along, self.common = self.along + along, self.common + (not along)
            self._rows[name] = free.pop()
        return self._rows[name]

    def make_room(self, place: int) -> None:
        """Forget what no part after this one reads."""
        for name in [n for n in self._rows if self.last_use.get(n) == place]:
            free = self._free[self.is_along[name], self.room[name]]
            free.append(self._rows.pop(name))

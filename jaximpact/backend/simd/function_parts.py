"""Division of long functions into parts.

LLVM's time grows faster than the length of a function: a step with three derivatives,
of 50 000 lines, takes twice as long in one piece as in four. What one part works out
for another goes through rows of the memory that all work on; it would have gone through
the stack anyway.
"""

import re
from typing import NamedTuple

NAME = re.compile(r"%v\d+")
PART = 12_000
"""Lines of a part."""


class Body(NamedTuple):
    """Lines of a function, places to divide it, and types of its values."""

    lines: list[str]
    breaks: list[int]
    """Lines before which a part may begin."""
    types: dict[str, str]
    """LLVM type of each value that may be handed on."""


def in_parts(body: Body) -> list[tuple[int, int]]:
    """First line of each part, and of what follows it."""
    ends, begin = [], 0
    for place in body.breaks:
        if place - begin >= PART and len(body.lines) - place >= PART // 2:
            ends.append(place)
            begin = place
    return list(zip([0, *ends], [*ends, len(body.lines)], strict=True))


def hand_on(body: Body, first_row: int, pack: int) -> tuple[list[list[str]], int]:
    """Divide a function, and add lines that hand on what later parts need.

    Args:
        first_row: first free row of the memory.
        pack: numbers in a row.

    Returns:
        Lines by part, and how many rows they take.
    """
    parts = in_parts(body)
    made_in: dict[str, int] = {}
    last_use: dict[str, int] = {}
    for part, (begin, end) in enumerate(parts):
        for line in body.lines[begin:end]:
            made, *used = NAME.findall(line)
            if " = " in line:
                made_in[made] = part
            else:
                used.append(made)
            for name in used:
                last_use[name] = part
    handed_on = {n for n, part in last_use.items() if part > made_in[n]}
    rows: dict[str, int] = {}
    free: list[int] = []
    most = 0
    written = []
    for part, (begin, end) in enumerate(parts):
        lines, here = [], set()
        for line in body.lines[begin:end]:
            names = NAME.findall(line)
            gives = " = " in line
            for name in names[gives:]:
                if made_in[name] < part and name not in here:
                    here.add(name)
                    at = f"%at{len(lines)}"
                    lines += [
                        _row(at, first_row + rows[name], pack),
                        f"  {name} = load {body.types[name]}, ptr {at}, align 64",
                    ]
            lines.append(line)
            if gives and names[0] in handed_on:
                if not free:
                    free.append(most)
                    most += 1
                rows[names[0]] = free.pop()
                at = f"%at{len(lines)}"
                lines += [
                    _row(at, first_row + rows[names[0]], pack),
                    f"  store {body.types[names[0]]} {names[0]}, ptr {at}, align 64",
                ]
        # What no later part reads makes room for what the next one gives.
        free += [row for name, row in rows.items() if last_use[name] == part]
        rows = {name: row for name, row in rows.items() if last_use[name] > part}
        written.append(lines)
    return written, most


def _row(name: str, row: int, pack: int) -> str:
    return f"  {name} = getelementptr double, ptr %work, i64 {row * pack}"

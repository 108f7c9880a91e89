r"""Tree of covers over the segments of a profile, for searches that look only near.

A cover is a line over some segments that follow each other: their chord, lifted until
no point of the ground between lies above it. What does not touch the column under a
cover touches none of its segments. Covers of `FAN` segments have covers again, up to
one over the whole profile, so that a search begins there and goes on into those covers
alone that it meets.

A search goes through the tree without a stack: each node names its first child, and
the node that follows once it and all below it are done with, both for searches from
left to right and from right to left.
"""

from typing import NamedTuple

import numpy as np

from ..backend.simd.tables import entries
from .lane_programs import Values

FAN = 4  # nodes under a cover
END = 0  # row of the table at which a search ends
ROOT = 1  # row of the cover over the whole profile


class Cover(NamedTuple):
    """Node of the tree: a segment, or a cover of some; of many, arrays `(nodes,)`."""

    left_x: Values  # ends of the line [m]
    left_y: Values
    right_x: Values
    right_y: Values
    segment: Values  # number of the segment; -1 for a cover
    child_to_right: Values  # row of the first child, for a search to the right
    child_to_left: Values
    next_to_right: Values
    """Row of the node after this one and all below it, for a search to the right."""
    next_to_left: Values


def cover_table(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Build the tree over the points of a profile [m]: its nodes, level by level from
    the top, `(nodes, fields of Cover)`. The first row stands for the end of a search.
    """
    span = 1
    lines = [_lines(x, y, span)]
    while lines[-1].shape[1] > 1:
        span *= FAN
        lines.append(_lines(x, y, span))
    lines.reverse()
    counts = [level.shape[1] for level in lines]
    starts = ROOT + np.concatenate([[0], np.cumsum(counts)])
    no_child = np.full(counts[-1], END)
    next_to_right = next_to_left = np.array([END])
    tables = [np.full((1, len(Cover._fields)), float(END))]
    for depth, level in enumerate(lines):
        number = np.arange(counts[depth])
        if depth > 0:
            # Beside each other under one cover, or else where the cover goes on.
            row, above = starts[depth] + number, number // FAN
            is_last = (number % FAN == FAN - 1) | (number == number[-1])
            next_to_right = np.where(is_last, next_to_right[above], row + 1)
            next_to_left = np.where(number % FAN == 0, next_to_left[above], row - 1)
        if depth + 1 < len(lines):
            leftmost = starts[depth + 1] + FAN * number
            rightmost = np.minimum(leftmost + FAN, starts[depth + 2]) - 1
            segment = np.full(len(number), -1)
        else:
            leftmost = rightmost = no_child
            segment = number
        rows = segment, leftmost, rightmost, next_to_right, next_to_left
        tables.append(np.stack([*level, *rows], axis=1))
    return np.concatenate(tables)


def _lines(x: np.ndarray, y: np.ndarray, span: int) -> np.ndarray:
    """Compute the ends of lines over so many segments each, `(4, lines)`."""
    last = len(x) - 1
    start = np.arange(0, last, span)
    end = np.minimum(start + span, last)
    line = np.repeat(np.arange(len(start)), end - start)
    slope = (y[end] - y[start]) / (x[end] - x[start])
    over = y[:-1] - y[start][line] - slope[line] * (x[:-1] - x[start][line])
    lift = np.maximum.reduceat(over, start)
    return np.stack([x[start], y[start] + lift, x[end], y[end] + lift])


def node(table: Values, row: Values) -> Cover:
    """Read a node of the table at an address, inside a program."""
    return Cover(*entries(table, row, len(Cover._fields)))

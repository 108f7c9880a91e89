"""Slope profiles from DXF drawings, read by the optional ezdxf."""

import collections
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..errors import InputError, did_you_mean
from ..io.checks import warn_unusual
from ..io.files import read_input
from .coordinates import LARGEST

KINDS = ("LINE", "LWPOLYLINE", "POLYLINE", "ARC", "ELLIPSE", "SPLINE")
"""Entities that a profile is read from."""
SILENT = (
    *("TEXT", "MTEXT", "ATTDEF", "DIMENSION", "ARC_DIMENSION", "LEADER", "MULTILEADER"),
    *("TOLERANCE", "HATCH", "MPOLYGON", "POINT", "CIRCLE", "SOLID", "IMAGE", "WIPEOUT"),
    *("XLINE", "RAY", "VIEWPORT", "ACAD_TABLE", "LIGHT", "SUN", "SECTION"),
)
"""Entities that no ground is drawn with: writing, measures, fillings, pictures."""
SURVEY_FOOT = 1200.0 / 3937.0
UNITS = {
    **{1: ("inches", 0.0254), 2: ("feet", 0.3048), 3: ("miles", 1609.344)},
    **{4: ("millimetres", 1e-3), 5: ("centimetres", 1e-2), 6: ("metres", 1.0)},
    **{7: ("kilometres", 1e3), 10: ("yards", 0.9144), 14: ("decimetres", 0.1)},
    **{15: ("decametres", 10.0), 16: ("hectometres", 100.0)},
    **{21: ("US survey feet", SURVEY_FOOT), 22: ("US survey inches", SURVEY_FOOT / 12)},
    **{23: ("US survey yards", 3 * SURVEY_FOOT)},
    24: ("US survey miles", 5280 * SURVEY_FOOT),
}
"""Units of lengths on the ground by their $INSUNITS: names and sizes [m]."""
GAP = 0.002
"""Largest distance between ends of lines that are joined [m]: coordinates rounded to a
millimetre are as much apart."""
SAME_DIGITS = 6
"""Decimals of metres up to which two lines agree that are one, drawn twice: a line that
was moved there and back differs by a rounding."""


class Line(NamedTuple):
    """Line of a drawing."""

    points: np.ndarray  # x and y [m], `(points, 2)`
    layer: str
    block: str  # name of the block that it is drawn in, "" for none


def read_dxf_points(
    path: Path, layer: str | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Read the points of a profile from a DXF drawing of any version.

    A profile is a polyline (LWPOLYLINE, POLYLINE) or several lines (LINE, ARC, ELLIPSE,
    SPLINE, or polylines again) that join end to end, in either direction, also within
    blocks; arcs are cut to chords. Where the line is closed, as around a section that
    is drawn as an area, the profile is its upper part. The drawing's unit ($INSUNITS)
    is converted to metres; a drawing without a unit is in metres. The layer is needed
    if lines on several do not join. A line that is drawn twice is taken once. What is
    hidden is passed over: entities that are invisible, or on a layer that is off or
    frozen and is not the one that `layer` names.

    Warns of a converted unit, of a closed line, of gaps that are closed, and of hidden
    lines and entities that are not read.

    Returns:
        x and y of the points [m], `(points,)` each, from left to right.

    Raises InputError, naming the file, for whatever makes no single line.
    """
    path = Path(path)
    lines = _each_once(_read_lines(path, layer))
    chains = _chains(lines)
    if len(chains) > 1:
        raise InputError(_not_joined(lines, chains), file=path)
    points = _joined(path, lines, chains[0])
    if len(points) > 2 and _distance(points[0], points[-1]) <= GAP:
        _warn(path, "has a closed line; its upper part is taken as the profile")
        points = _upper_part(points)
    if points[0, 0] > points[-1, 0]:
        points = points[::-1]
    return points[:, 0].copy(), points[:, 1].copy()


def _read_lines(path: Path, layer: str | None) -> list[Line]:
    """Read the lines of the model space, or of one layer, in the order of the file."""
    read_input(path, once=False)
    try:
        from ezdxf.filemanagement import (  # pyright: ignore[reportMissingImports]
            readfile,
        )
    except ImportError:
        problem = "needs the package ezdxf to be read: pip install ezdxf"
        raise InputError(problem, file=path) from None
    lines: list[Line] = []
    layers: set[str] = set()
    hidden: collections.Counter[str] = collections.Counter()
    passed_over: collections.Counter[str] = collections.Counter()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            drawing = readfile(path)
            number = drawing.header.get("$INSUNITS", 0) or 6  # without a unit: metres
            if number not in UNITS:
                raise InputError(
                    f"has $INSUNITS {number}, which is no unit of slopes; set its "
                    "units to metres",
                    file=path,
                )
            unit, metre = UNITS[number]
            unseen = _unseen_layers(drawing, layer)
            for entity, on, block, is_hidden in _entities(drawing.modelspace(), unseen):
                kind = _kind(entity)
                if kind in KINDS:
                    layers.add(on)
                # CAD programs compare names of layers without regard to case.
                if layer is not None and layer.casefold() != on.casefold():
                    continue
                if is_hidden and kind in KINDS:
                    hidden[on] += 1
                elif kind in KINDS:
                    points = _chords(path, entity, metre)
                    if len(points) and np.any(points != points[0]):
                        lines.append(Line(_flat(path, on, points), on, block))
                elif kind not in SILENT and not is_hidden:
                    passed_over[kind] += 1
        except InputError:
            raise
        except Exception as error:  # of many kinds, for damaged files
            reason = str(error) or type(error).__name__
            raise InputError(
                f"is no DXF drawing that can be read: {reason}", file=path
            ) from None
    others = ", ".join(f"{count} {kind}" for kind, count in passed_over.items())
    if not lines and hidden:
        raise InputError(f"has no line to be read: {_told(hidden, layer)}", file=path)
    if not lines and layers and layer is not None:
        hint = did_you_mean(layer, layers, repr)
        raise InputError(f"has no line on a layer {layer!r}; {hint}", file=path)
    if not lines:
        besides = f"; it has {others}, which must be exploded into lines"
        raise InputError(
            f"has no {', '.join(KINDS[:-1])} or {KINDS[-1]} in its model space, which "
            f"a profile is read from{besides if others else ''}",
            file=path,
        )
    if metre != 1.0:
        _warn(
            path,
            f"is in {unit} by its $INSUNITS: coordinates are taken times {metre:g} as "
            "metres; if they are metres already, set its units to metres",
        )
    if hidden:
        _warn(path, _told(hidden, layer))
    if others:
        _warn(
            path,
            f"holds {others}, which no profile is read from; explode what is ground "
            "into lines",
        )
    return lines


class Unseen(NamedTuple):
    """Layers that a drawing does not show, by their names in small letters."""

    off: set[str]
    frozen: set[str]


def _unseen_layers(drawing, wanted: str | None) -> Unseen:
    """Find the layers that are not shown, without the one that is wanted."""
    layers = {
        layer.dxf.name.casefold(): layer
        for layer in drawing.layers
        if wanted is None or layer.dxf.name.casefold() != wanted.casefold()
    }
    return Unseen(
        off={name for name, layer in layers.items() if layer.is_off()},
        frozen={name for name, layer in layers.items() if layer.is_frozen()},
    )


def _entities(
    entities,
    unseen: Unseen,
    inherited: str = "0",
    blocks: tuple[str, ...] = (),
    in_hidden: bool = False,
) -> Iterator[tuple[Any, str, str, bool]]:
    """List entities, those of blocks at the places where they are inserted, with their
    layers, the name of the outermost block, and whether they are hidden.

    What a block has on layer 0 inherits the layer of its insertion; `blocks` are those
    that the entities are in, the outermost first. An insertion on a frozen layer hides
    all of its block, one on a layer that is off only what the block has on that layer.
    """
    for entity in entities:
        layer = entity.dxf.get("layer", "0")
        on = inherited if layer == "0" else layer
        hidden = in_hidden or bool(entity.dxf.get("invisible", 0))
        hidden |= on.casefold() in unseen.frozen
        if _kind(entity) != "INSERT":
            hidden |= on.casefold() in unseen.off
            yield entity, on, blocks[0] if blocks else "", hidden
            continue
        name = entity.dxf.name
        if name in blocks:
            raise ValueError(f"the block {name!r} contains itself")
        for insert in entity.multi_insert() if entity.mcount > 1 else (entity,):
            content = _content(insert)
            yield from _entities(content, unseen, on, (*blocks, name), hidden)


def _content(insert) -> list:
    """List what a block has, at the place where it is inserted; what cannot be moved
    there, as no line of a profile, as it is."""
    unmoved: list = []
    moved = insert.virtual_entities(
        skipped_entity_callback=lambda entity, _: unmoved.append(entity)
    )
    return [*moved, *unmoved]


def _kind(entity) -> str:
    """Name the kind of an entity, and apart what has the name of another one."""
    kind = entity.dxftype()
    if kind == "POLYLINE" and not (entity.is_2d_polyline or entity.is_3d_polyline):
        return "mesh"
    if kind == "INSERT":
        block = entity.block()
        if block is None or block.block.is_xref or block.block.is_xref_overlay:
            return "INSERT whose block is in no or in another file"
    return kind


def _warn(path: Path, text: str) -> None:
    warn_unusual(text, f"{path}: {text}", file=path)


def _chords(path: Path, entity, metre: float) -> np.ndarray:
    """Cut an entity to chords, points `(points, 3)` [m]; metre is the drawing's unit in
    metres."""
    from ezdxf.path import make_path  # pyright: ignore[reportMissingImports]

    if entity.dxftype() == "POLYLINE":
        # Points that only control the curve, by flag 16, lie beside it.
        vertices = entity.vertices
        vertices[:] = [v for v in vertices if not v.dxf.flags & 16]
    curve = make_path(entity)
    # A bulge without bound makes an arc of any size, and without end of chords.
    corners = metre * np.array([tuple(v) for v in curve.control_vertices()], float)
    if not np.all(np.abs(corners) <= LARGEST):
        raise InputError(
            f"has a {'curve' if curve.has_curves else 'line'} that goes beyond "
            f"{LARGEST:g} m from the origin; draw it nearer to the origin, and bulges "
            "of arcs smaller",
            file=path,
        )
    size = np.max(np.ptp(corners, axis=0), initial=0.0) if len(corners) else 0.0
    # Within a centimetre of the arc, which ezdxf takes for cubic curves within 3e-4 of
    # its radius; of large arcs no more than some thousand chords.
    vertices = curve.flattening(max(0.01, 1e-6 * size) / metre)
    return metre * np.array([tuple(v) for v in vertices], float)


def _flat(path: Path, layer: str, points: np.ndarray) -> np.ndarray:
    """Drop z, which must be the same everywhere, and points that stand twice."""
    if np.ptp(points[:, 2]) > GAP:
        raise InputError(
            f"has a line on the layer {layer!r} whose z changes; a profile is drawn in "
            "x, to the right, and y, up",
            file=path,
        )
    moved = np.any(np.diff(points[:, :2], axis=0) != 0.0, axis=1)
    return points[np.append(True, moved), :2]


def _each_once(lines: list[Line]) -> list[Line]:
    """Leave out lines that have the points of an earlier one, in either direction."""
    first: dict[bytes, Line] = {}
    for line in lines:
        points = np.round(line.points, SAME_DIGITS) + 0.0  # as -0.0 has other bits
        bits = min(points.tobytes(), points[::-1].tobytes())
        first.setdefault(bits, line)
    return [*first.values()]


def _chains(lines: list[Line]) -> list[list[int]]:
    """Find lines that follow each other, until none do.

    Returns:
        Chains of lines, each line by the end at which the chain comes to it: end 2 i is
        the first point of line i, and 2 i + 1 its last.
    """
    from scipy.spatial import KDTree  # which takes a while to load

    ends = _ends(lines)
    within = np.nextafter(GAP, np.inf)
    # Where a profile goes on two ends meet; of more, eight are enough to tell.
    apart, near = KDTree(ends).query(ends, 8, p=np.inf, distance_upper_bound=within)
    # The nearest first, then in the order of the file; `len(ends)` stands for none.
    order = np.lexsort((near, apart), axis=1)
    touching = np.take_along_axis(near, order, axis=1).tolist()
    waiting = dict.fromkeys(range(len(lines)))

    def follow(end: int) -> list[int]:
        """Take from the lines that wait those that follow an end, one after another."""
        chain = []
        while True:
            other = next((e for e in touching[end] if e // 2 in waiting), None)
            if other is None:
                return chain
            del waiting[other // 2]
            chain.append(other)
            end = other ^ 1

    chains = []
    while waiting:
        first = next(iter(waiting))
        del waiting[first]
        after, before = follow(2 * first + 1), follow(2 * first)
        chains.append([*(end ^ 1 for end in reversed(before)), 2 * first, *after])
    return chains


def _ends(lines: list[Line]) -> np.ndarray:
    """List the first and the last point of each line, `(2 lines, 2)`."""
    return np.concatenate([line.points[[0, -1]] for line in lines])


def _distance(one: np.ndarray, other: np.ndarray) -> float:
    return float(np.max(np.abs(one - other)))


def _joined(path: Path, lines: list[Line], chain: list[int]) -> np.ndarray:
    """Join the lines of a chain, points `(points, 2)`; warn of gaps.

    A joint has the last point of the line before it.
    """
    pieces = [lines[end // 2].points[:: -1 if end % 2 else 1] for end in chain]
    joints = zip(pieces, [*pieces[1:], pieces[0]], strict=True)
    apart = [_distance(before[-1], after[0]) for before, after in joints]
    # Less is rounding; and a line that is not closed ends far from its begin.
    gaps = [gap if 1e-6 < gap <= GAP else 0.0 for gap in apart]
    if any(gaps):
        largest = int(np.argmax(gaps))
        _warn(
            path,
            f"has gaps between ends of lines, which are closed: "
            f"{np.count_nonzero(gaps)}, the largest {1e3 * gaps[largest]:.2g} mm at "
            f"{_in_words(pieces[largest][-1])}",
        )
    return np.concatenate([pieces[0], *(piece[1:] for piece in pieces[1:])])


def _in_words(point: np.ndarray) -> str:
    return f"({point[0]:.10g}, {point[1]:.10g}) m"


def _told(hidden: collections.Counter[str], layer: str | None) -> str:
    """Say that hidden lines are passed over, by the numbers on their layers."""
    told = (
        "lines that are invisible, or on a layer that is off or frozen, are passed "
        f"over ({_counted(hidden)}); show what is ground"
    )
    if layer is not None:
        return told
    return f"{told}, or let layer name the layer that is off or frozen"


def _counted(lines: collections.Counter[str]) -> str:
    """List layers with their numbers of lines."""
    return ", ".join(f"{name!r}: {count}" for name, count in lines.items())


def _not_joined(lines: list[Line], chains: list[list[int]]) -> str:
    """Say what lines do not join, and where they come nearest to each other."""
    counts = collections.Counter(line.layer for line in lines)
    blocks = sorted({line.block for line in lines} - {""})
    inside = f", some of them in the blocks {', '.join(blocks)}" if blocks else ""
    gap, one, other = _nearest_ends(_ends(lines), chains)
    where = f"the nearest ends are {gap:.3g} m apart, at {_in_words(one)} and "
    where += f"{_in_words(other)}; gaps of up to {1e3 * GAP:g} mm are closed"
    if gap <= GAP:
        where = f"more than two ends meet at {_in_words(one)}"
    if len(counts) > 1:
        return (
            f"has lines that do not join on {len(counts)} layers "
            f"({_counted(counts)}{inside}); "
            f"layer must say which is the profile, or if it is all of them: {where}"
        )
    return (
        f"has {len(chains)} lines on the layer {lines[0].layer!r} that do not "
        f"join{inside}: {where}; a profile is one line"
    )


def _nearest_ends(
    points: np.ndarray, chains: list[list[int]]
) -> tuple[float, np.ndarray, np.ndarray]:
    """Find distance and places of the end of a chain, and the end of another chain's
    line, that come nearest to each other, given the ends of all lines, `(ends, 2)`."""
    nearest = []
    for chain in chains:
        lines = np.array(chain) // 2
        for end in (chain[0], chain[-1] ^ 1):
            apart = np.max(np.abs(points - points[end]), axis=1)
            apart[[*(2 * lines), *(2 * lines + 1)]] = np.inf
            other = int(np.argmin(apart))
            nearest.append((float(apart[other]), end, other))
    gap, one, other = min(nearest)
    return gap, points[one], points[other]


def _upper_part(ring: np.ndarray) -> np.ndarray:
    """Take the upper part of a closed line, whose last point is its first, from its
    left side to its right one."""
    x, y = (ring[:-1] - ring[0]).T
    area = np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
    if area > 0.0:  # counterclockwise, so that its upper part goes to the left
        return _upper_part(ring[::-1])
    left = np.argmax(np.where(x <= np.min(x) + GAP, y, -np.inf))
    right = np.argmax(np.where(x >= np.max(x) - GAP, y, -np.inf))
    count = (right - left) % len(x) + 1
    return np.roll(ring[:-1], -left, axis=0)[:count]

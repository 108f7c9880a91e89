"""Slope profiles from DXF drawings, read by ezdxf, an optional package."""

import warnings
from pathlib import Path

import numpy as np

from ..errors import InputError, nearest
from ..io.files import read_input

KINDS = ("LINE", "LWPOLYLINE", "POLYLINE")
"""Entities that a profile is read from."""
SAGITTA = 0.01
"""Largest distance of the chords from an arc [m], which ezdxf takes for cubic curves
within 3e-4 of its radius."""
TOUCHING = 1e-6
"""Distance of ends of lines that are joined, as a fraction of the drawing's size."""


def read_dxf_points(
    path: Path, layer: str | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Read the points of a profile from a DXF drawing.

    A profile is a polyline (LWPOLYLINE, POLYLINE) or several lines (LINE, or polylines
    again) that join end to end, in either direction; arcs of polylines are cut to
    chords. x and y of the drawing are taken as metres.

    Args:
        path: the file, DXF of any version.
        layer: layer of the profile; needed if lines on several do not join.

    Returns:
        x and y of the points [m], `(points,)` each, from left to right.

    Raises InputError, naming the file, for whatever makes no single line.
    """
    by_layer = _lines_by_layer(Path(path))
    if not by_layer:
        raise InputError(
            "has no LINE, LWPOLYLINE or POLYLINE in its model space, which a profile "
            "is read from",
            file=path,
        )
    if layer is not None and layer not in by_layer:
        raise InputError(
            f"has no line on a layer {layer!r}; did you mean "
            f"{nearest(layer, by_layer)!r}?",
            file=path,
        )
    layers = [layer] if layer is not None else list(by_layer)
    chains = _joined([line for name in layers for line in by_layer[name]])
    if len(chains) > 1 and len(layers) > 1:
        counts = ", ".join(f"{name!r}: {len(by_layer[name])}" for name in layers)
        raise InputError(
            f"has lines that do not join on {len(layers)} layers ({counts}); layer "
            "must say which is the profile",
            file=path,
        )
    if len(chains) > 1:
        (x, y), (other, height) = chains[0][-1], chains[1][0]
        raise InputError(
            f"has {len(chains)} lines on the layer {layers[0]!r} that do not join: one "
            f"ends at ({x:g}, {y:g}), another begins at ({other:g}, {height:g}); a "
            "profile is one line",
            file=path,
        )
    points = chains[0]
    if points[0, 0] > points[-1, 0]:
        points = points[::-1]
    return points[:, 0].copy(), points[:, 1].copy()


def _lines_by_layer(path: Path) -> dict[str, list[np.ndarray]]:
    """Read the lines of the model space, points `(points, 2)` each."""
    read_input(path)
    try:
        from ezdxf.filemanagement import (  # pyright: ignore[reportMissingImports]
            readfile,
        )
        from ezdxf.path import make_path  # pyright: ignore[reportMissingImports]
    except ImportError:
        raise InputError(
            "needs the package ezdxf to be read: pip install ezdxf",
            file=path,
        ) from None
    found: dict[str, list[np.ndarray]] = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            entities = readfile(path).modelspace().query(" ".join(KINDS))
            for entity in entities:
                vertices = make_path(entity).flattening(SAGITTA)
                points = np.array([tuple(v) for v in vertices], float)
                if len(points) and np.any(points != points[0]):
                    found.setdefault(entity.dxf.layer, []).append(points)
        except Exception as error:  # of many kinds, for damaged files
            told = str(error) or type(error).__name__
            raise InputError(
                f"is no DXF drawing that can be read: {told}", file=path
            ) from None
    return {name: [_flat(path, name, p) for p in of] for name, of in found.items()}


def _flat(path: Path, layer: str, points: np.ndarray) -> np.ndarray:
    """Drop z, which must be the same everywhere, and points that stand twice."""
    if np.ptp(points[:, 2]) > 0.0:
        raise InputError(
            f"has a line on the layer {layer!r} whose z changes; a profile is drawn in "
            "x, to the right, and y, up",
            file=path,
        )
    moved = np.any(np.diff(points[:, :2], axis=0) != 0.0, axis=1)
    return points[np.append(True, moved), :2]


def _joined(lines: list[np.ndarray]) -> list[np.ndarray]:
    """Join lines whose ends touch, until none do."""
    size = np.max(np.ptp(np.concatenate(lines), axis=0))
    waiting = list(lines)
    chains = []
    while waiting:
        chain = waiting.pop(0)
        place = 0
        while place < len(waiting):
            longer = _join(chain, waiting[place], TOUCHING * size)
            if longer is None:
                place += 1
            else:
                chain = longer
                del waiting[place]
                place = 0
        chains.append(chain)
    return chains


def _join(first: np.ndarray, second: np.ndarray, within: float) -> np.ndarray | None:
    """Join two lines at ends that touch; None if there are none."""
    for one in (first, first[::-1]):
        for other in (second, second[::-1]):
            if np.max(np.abs(one[-1] - other[0])) <= within:
                return np.concatenate([one, other[1:]])
    return None

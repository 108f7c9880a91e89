"""Segments of a profile cut into shorter ones, where the ground changes within them."""

import jax
import numpy as np
from numpy.typing import ArrayLike

from .terrain import Profile

ROUNDING = 16.0 * float(np.finfo(float).eps)
"""Turn at a cut, as a fraction of the largest coordinate over the width of the pieces:
some units of the last digit of a short segment's slope."""


def subdivide(profile: Profile, places: ArrayLike) -> tuple[Profile, np.ndarray]:
    """Cut the segments of a profile at some places.

    The pieces have their segment's ground. A block that rolls over a break is sent
    into the air if the ground falls away there by whatever little, and rounding would
    make every other cut such a break. So the ground rises at each cut, by a turn just
    above rounding, which moves the ground by micrometres (by millimetres where
    coordinates are those of a map, of some 1e6 m).

    Args:
        places: x of the cuts [m], in any order; those at points of the profile, or
            beyond its ends, cut nothing.

    Returns:
        The profile, and for each of its segments the index of the one that it is a
        piece of, `(segments,)`. The profile itself where nothing is cut.
    """
    places = np.asarray(places, float)
    inside = (places > profile.x[0]) & (places < profile.x[-1])
    x = np.union1d(profile.x, places[inside])
    if len(x) == len(profile.x):
        return profile, np.arange(profile.segments)
    piece = np.searchsorted(profile.x, x[:-1], side="right") - 1
    y = profile.height(x)
    scale = max(np.max(np.abs(x)), np.max(np.abs(y)))
    for segment in np.unique(piece):
        own = np.flatnonzero(piece == segment)
        ends = np.append(own, own[-1] + 1)
        y[ends] += _rise(x[ends], ROUNDING * scale)
    soil = jax.tree.map(lambda leaf: leaf[piece], profile.soil)
    angles = profile.rolling_friction_angle[piece], profile.roughness[piece]
    return Profile(x, y, soil, *angles), piece


def _rise(x: np.ndarray, turn: float) -> np.ndarray:
    """Compute by how much points of a segment rise above it, 0 at its ends, below 0
    between them, so that it turns upwards at each [m].

    Args:
        turn: turn at a point times the width of the shorter piece beside it [m].
    """
    widths = np.diff(x)
    turns = turn / np.minimum(widths[:-1], widths[1:])
    rise = np.cumsum(np.cumsum(turns) * widths[1:])
    rise = np.concatenate([[0.0, 0.0], rise])
    return rise - rise[-1] * (x - x[0]) / (x[-1] - x[0])

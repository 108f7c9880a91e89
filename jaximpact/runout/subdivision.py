"""Segments of a profile cut into shorter ones, where the ground changes within them."""

import jax
import numpy as np
from numpy.typing import ArrayLike

from .terrain import Profile


def subdivide(profile: Profile, places: ArrayLike) -> tuple[Profile, np.ndarray]:
    """Cut the segments of a profile at some places.

    The pieces have their segment's ground, and go straight on but for rounding.

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
    soil = jax.tree.map(lambda leaf: leaf[piece], profile.soil)
    angles = profile.rolling_friction_angle[piece], profile.roughness[piece]
    return Profile(x, profile.height(x), soil, *angles), piece

"""Blocks on the ground, as a ride along the path of their centres needs them."""

from typing import NamedTuple

import numpy as np


class Riders(NamedTuple):
    """Blocks on the ground, arrays `(blocks,)`."""

    radius: np.ndarray
    """Height of the centre over the ground [m]."""
    ratio: np.ndarray
    """k = I/(m r^2); 0 for a block that slides."""
    rolls: np.ndarray
    """True for a block that rolls."""
    barrier: np.ndarray
    """Height by which its long axis lifts a block that rolls [m]; 0 for a block that
    slides."""
    turning_slope: np.ndarray
    """Tangent of the slope that tips a block over its long axis."""
    flat_curvature: np.ndarray
    """Radius of curvature with which a block that slides leaves an edge [m]."""
    hop: np.ndarray
    """Height of a flight that is not followed [m]."""
    closing: np.ndarray
    """Squared velocity across level ground that makes an impact [m2/s2]."""

    def at(self, blocks: np.ndarray) -> "Riders":
        """Select blocks."""
        return Riders(*(column[blocks] for column in self))

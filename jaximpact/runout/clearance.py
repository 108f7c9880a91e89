r"""How high a block must be to lie on the ground.

With an ellipse's extents $w$ across and $r$ upwards, $w^2 = H^2\sin^2\varphi +
R^2\cos^2\varphi$, and $c = (H^2 - R^2)\sin\varphi\cos\varphi$, its lower side is

$$ l(d) = \frac{c}{w^2} d - \frac{HR}{w}\sqrt{1 - d^2/w^2} $$

at a distance d from the centre. It lies on the ground where the centre's height is the
largest of ground less lower side; that difference is concave over each segment.

A block of another shape is let fall, without turning, from above all ground.
"""

import numpy as np

from ..scene import GRAVITY
from ..shapes import AbstractElliptic
from .flight import follow_flights
from .motion import Body, Outline
from .profile import Profile

LONGEST_FALL = 1e6
"""[s]"""


def lying_height(
    profile: Profile, outline: Outline, x: np.ndarray, orientation: np.ndarray
) -> np.ndarray:
    """Height y of the centre at which a block touches the ground from above [m].

    Args:
        outline, x, orientation: of the blocks, `(blocks,)`; x on the profile.
    """
    if isinstance(outline.shape, AbstractElliptic):
        return _of_ellipse(profile, outline, x, orientation)
    top = np.max(profile.y) + 2.0 * outline.largest
    still = np.zeros(len(x))
    body = Body(x, top, still, still, orientation, still)
    ends = follow_flights(body, outline, profile, np.full(len(x), LONGEST_FALL))
    return np.where(ends.touched, top - 0.5 * GRAVITY * ends.time**2, -np.inf)


def _of_ellipse(
    profile: Profile, outline: Outline, x: np.ndarray, orientation: np.ndarray
) -> np.ndarray:
    major, minor = (np.asarray(axis) for axis in outline.axes[:2])
    sin, cos = np.sin(orientation), np.cos(orientation)
    width = np.hypot(major * sin, minor * cos)
    tilt = (major**2 - minor**2) * sin * cos / width**2
    depth = major * minor / width
    height = np.full(np.shape(x), -np.inf)
    for i, slope in enumerate(np.diff(profile.y) / np.diff(profile.x)):
        left, right = (profile.x[i : i + 2, None] - x) / width
        steep = (slope - tilt) * width / depth
        place = np.clip(
            steep / np.sqrt(1.0 + steep**2), np.maximum(left, -1), np.minimum(right, 1)
        )
        ground = profile.y[i] + slope * (place - left) * width
        lower = tilt * place * width - depth * np.sqrt(np.maximum(1.0 - place**2, 0.0))
        over = (left <= 1.0) & (right >= -1.0)
        height = np.where(over, np.maximum(height, ground - lower), height)
    return height

r"""How high a block must be to lie on the ground.

With the ellipse's extents $w$ across and $r$ upwards, $w^2 = H^2\sin^2\varphi +
R^2\cos^2\varphi$, and $c = (H^2 - R^2)\sin\varphi\cos\varphi$, its lower side is

$$ l(d) = \frac{c}{w^2} d - \frac{HR}{w}\sqrt{1 - d^2/w^2} $$

at a distance d from the centre. It lies on the ground where the centre's height is the
largest of ground less lower side; that difference is concave over each segment.
"""

import numpy as np

from .motion import Outline
from .profile import Profile


def lying_height(
    profile: Profile, outline: Outline, x: np.ndarray, orientation: np.ndarray
) -> np.ndarray:
    """Height y of the centre at which a block touches the ground from above [m].

    Args:
        outline, x, orientation: of the blocks, `(blocks,)`; x on the profile.
    """
    major, minor = (np.asarray(axis) for axis in outline)
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

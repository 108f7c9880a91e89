r"""Footprint: the plane that a block strikes on ground finer than itself.

A block that lands on a facet of centimetres lies on more than the facet. Where all
straight lines in its footprint, of a width of `FOOTPRINT` times its smaller semi-axis
about the point that touches, are shorter than that width, the plane of the impact is
the chord of the ground over the footprint. Else it is the plane by which the block
touches: edges and feet of longer lines stay as sharp as they are.

A block that does not close on the chord fast enough for an impact strikes the facet.

The width is our reading: a sphere of radius r that sinks in by r/30, as blocks do,
touches the ground over about half its radius.
"""

import numpy as np

from ..blocks import BlockOutline, support_of
from ..state import BlockConstants, BlockState
from ..terrain import Profile
from .plane_contact import touch

FOOTPRINT = 0.5
"""Width of the footprint, as a fraction of the smaller semi-axis."""


def on_footprint(
    profile: Profile, block: BlockState, constants: BlockConstants
) -> BlockState:
    """Give blocks the planes that they strike.

    Args:
        block: blocks that touch the ground, with the planes of what they touch.
    """
    outline = constants.outline
    half = 0.5 * FOOTPRINT * outline.smallest
    segment = block.segment.astype(int)
    lines = profile.straight_length
    small = np.flatnonzero(lines[segment] < 2.0 * half)
    if not len(small):
        return block
    x = _touching_x(block, outline)[small]
    one = np.maximum(x - half[small], profile.x[0])
    two = np.minimum(x + half[small], profile.x[-1])
    fine = _longest(profile, lines, one, two) < 2.0 * half[small]
    small, one, two = small[fine], one[fine], two[fine]
    d_x, d_y = two - one, profile.height(two) - profile.height(one)
    length = np.sqrt(d_x**2 + d_y**2)
    normal_x, normal_y = block.normal_x.copy(), block.normal_y.copy()
    normal_x[small], normal_y[small] = -d_y / length, d_x / length
    struck = block._replace(normal_x=normal_x, normal_y=normal_y)
    seen = touch(struck, constants)
    closes = seen.contact.closing >= seen.slow
    return block._replace(
        normal_x=np.where(closes, normal_x, block.normal_x),
        normal_y=np.where(closes, normal_y, block.normal_y),
    )


def _longest(
    profile: Profile, lines: np.ndarray, one: np.ndarray, two: np.ndarray
) -> np.ndarray:
    """Find the longest of the lines between some x and others [m]."""
    first = np.searchsorted(profile.x, one, side="right") - 1
    last = np.searchsorted(profile.x, two, side="left")
    ranges = np.stack([first, last], axis=1).ravel()
    return np.maximum.reduceat(np.append(lines, 0.0), ranges)[::2]


def _touching_x(block: BlockState, outline: BlockOutline) -> np.ndarray:
    """Compute x of the point at which blocks touch [m]."""
    n_x, n_y = block.normal_x, block.normal_y
    theta = block.body.orientation - np.arctan2(n_x, n_y)
    radius, arm = support_of(outline, theta)
    return block.body.x - radius * n_x + arm * n_y

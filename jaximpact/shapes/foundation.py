r"""Geometry of the equivalent foundation: the block's section at ground level.

Everything is in closed form. With $s, c = \sin\Theta, \cos\Theta$ of the orientation
$\Theta = \theta_0 + \theta$ and $d$ the height of the block's centre above the ground,
for the ellipsoid:

| quantity | formula | paper |
|---|---|---|
| support radius | $r_y = \sqrt{H^2 c^2 + R^2 s^2}$ | eq. 22 |
| sinking | $u_D = r_y - d$ | eqs. 38-42 |
| section | $q = \sqrt{1 - (d/r_y)^2}$, $a_t = H R q/r_y$, $a_w = W q$ | eqs. 18-21 |
| its centre | $t_{mid} = -d\,s\,c\,(H^2 - R^2)/r_y^2$ | eq. 19 |
| extreme points | $t = \pm\tau$, $\tau = \sqrt{H^2 s^2 + R^2 c^2}$ | eqs. 24-29 |
| sizes | $B_t = t_2 - t_1$, $B_w = 2 a_w$ or $2 W$ | eqs. 30-35 |
| arms | $r_n = d$, $r_t = (t_1 + t_2)/2$ | eqs. 36-37 |

Misprints of the paper mended here, each shown by a test: eq. 13 divides $w^2$ by $H^2$;
$b_1$ of eq. 22 has $R^2 + H^2$ for $H^2 - R^2$; $C_w$ of eq. 26 does not lie at the
level of the block's centre, $n = u_n - r_{y0}$; eq. 33 repeats $C_{w1}$; eq. 40 swaps
tangent and cosine.
"""

from typing import NamedTuple

import jax.numpy as jnp

from .._types import Flag, Scalar
from .base import AbstractShape, SemiAxes, on_side


class Foundation(NamedTuple):
    """The equivalent foundation at one moment; lengths in metres."""

    length: Scalar
    """Size B_t along the slope."""
    width: Scalar
    """Size B_w out of the plane of motion."""
    sinking: Scalar
    """Sinking u_D: depth of the block's deepest point."""
    normal_arm: Scalar
    """Height r_n of the block's centre above the ground."""
    tangential_arm: Scalar
    """Centre r_t of the foundation from the block's centre, down-slope positive."""
    tangency_arm: Scalar
    """Deepest point T_low of the block from its centre, down-slope positive."""
    most_slender: float | None = None
    """Largest ratio of the sizes in the laws [-]; see `AbstractShape`."""


def foundation(
    shape: AbstractShape,
    axes: SemiAxes,
    sin: Scalar,
    cos: Scalar,
    sinking: Scalar,
    *,
    side: Flag | None = None,
) -> Foundation:
    """Sizes and arms of the equivalent foundation of a sunk block.

    Args:
        shape: shape of the block. axes: its half sizes [m].
        sin, cos: sine and cosine of the orientation $\\Theta$.
        sinking: $u_D$ [m], depth of the deepest point. At or below zero there is no
            section: both sizes are 0, and their gradients are 0.
        side: on which the shape is to stay; see `AbstractShape.side_of`.

    As smooth as the shape's section.

    Source: Dattola et al. (2023), appendix D, mended as told in this module's head.
    """
    sides = on_side(side)
    height = shape.support(axes, sin, cos, **sides) - sinking
    section = shape.section(axes, sin, cos, height, sinking, **sides)
    # Without a section there is no foundation to extend to the extreme points.
    touching = sinking > 0.0
    return Foundation(
        length=jnp.where(touching, section.right - section.left, 0.0),
        width=jnp.where(touching, section.width, 0.0),
        sinking=sinking,
        normal_arm=height,
        tangential_arm=0.5 * (section.left + section.right),
        tangency_arm=shape.tangency_arm(axes, sin, cos, **sides),
    )

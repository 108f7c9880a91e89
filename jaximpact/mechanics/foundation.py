r"""Geometry of the equivalent foundation: the block's section at ground level.

Everything is in closed form. With $s, c = \sin\Theta, \cos\Theta$ of the orientation
$\Theta = \theta_0 + \theta$ and $d$ the height of the block's centre above the ground:

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
from jaxtyping import Array, Float

from ..block import SemiAxes
from ..safe import safe_sqrt

Scalar = Float[Array, ""]


class Foundation(NamedTuple):
    """The equivalent foundation at one moment; lengths in metres."""

    length: Scalar
    """B_t, size along the slope."""
    width: Scalar
    """B_w, size out of the plane of motion."""
    sinking: Scalar
    """u_D, depth of the block's deepest point."""
    normal_arm: Scalar
    """r_n, height of the block's centre above the ground."""
    tangential_arm: Scalar
    """r_t, centre of the foundation from the block's centre, down-slope positive."""
    tangency_arm: Scalar
    """T_low, the block's deepest point from its centre, down-slope positive."""


def support_radius(axes: SemiAxes, sin: Scalar, cos: Scalar) -> Scalar:
    r"""Height of the centre over a tangent ground, $r_y = \sqrt{H^2 c^2 + R^2 s^2}$
    [m].

    Args:
        axes: semi-axes of the block [m].
        sin, cos: of the orientation from the ground's normal to the major axis.

    Smooth everywhere. Source: Dattola et al. (2023), eq. 22, first line.
    """
    return jnp.sqrt((axes.major * cos) ** 2 + (axes.minor * sin) ** 2)


def tangency_arm(axes: SemiAxes, sin: Scalar, cos: Scalar) -> Scalar:
    r"""The deepest point from the centre, $T_{low} = dr_y/d\Theta$ [m].

    $$ T_{low} = -(H^2 - R^2)\, s\, c / r_y $$

    Smooth everywhere; zero for a sphere and at 0 and 90 degrees.
    """
    return -(axes.major**2 - axes.minor**2) * sin * cos / support_radius(axes, sin, cos)


def foundation(axes: SemiAxes, sin: Scalar, cos: Scalar, sinking: Scalar) -> Foundation:
    """Sizes and arms of the equivalent foundation of a sunk ellipsoid.

    Args:
        axes: semi-axes of the block [m].
        sin, cos: of the orientation $\\Theta$.
        sinking: $u_D$ [m], depth of the deepest point. At or below zero there is no
            section: both sizes are 0, and their gradients are 0.

    Returns:
        `Foundation`. Continuous, with continuous first derivatives, where an extreme
        point of the block passes ground level and where the centre does (the section is
        widest there); of square-root type in `sinking` at the onset, where the gradient
        grows without bound as the sinking goes to zero from above.

    Source: Dattola et al. (2023), appendix D, mended as told in this module's head.
    """
    major, minor, out_of_plane = axes
    support = support_radius(axes, sin, cos)
    height = support - sinking
    # 1 - (d/r_y)^2 without the cancellation that d = r_y - u_D would bring at the onset
    relative_sinking = sinking / support
    q = safe_sqrt(relative_sinking * (2.0 - relative_sinking))

    difference = (major**2 - minor**2) * sin * cos
    half_section = major * minor * q / support
    section_centre = -height * difference / support**2
    extreme = jnp.sqrt((major * sin) ** 2 + (minor * cos) ** 2)
    right_is_above = -height - difference / extreme < 0.0
    left_is_above = -height + difference / extreme < 0.0
    right = jnp.where(right_is_above, section_centre + half_section, extreme)
    left = jnp.where(left_is_above, section_centre - half_section, -extreme)
    # Without a section there is no foundation to extend to the extreme points.
    touching = sinking > 0.0
    return Foundation(
        length=jnp.where(touching, right - left, 0.0),
        width=jnp.where(height > 0.0, 2.0 * out_of_plane * q, 2.0 * out_of_plane),
        sinking=sinking,
        normal_arm=height,
        tangential_arm=0.5 * (left + right),
        tangency_arm=-difference / support,
    )

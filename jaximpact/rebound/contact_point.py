"""The point at which a rigid ellipse touches the ground, and what impulses there do."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from ..block import Block
from ..scene import Impact
from .velocities import Rebound

Scalar = Float[Array, ""]


class ContactPoint(NamedTuple):
    """The deepest point of a rigid ellipse as it touches the ground."""

    normal_arm: Scalar
    """r_n [m], how far it lies below the block's centre."""
    tangential_arm: Scalar
    """r_t [m], from the block's centre, down-slope positive."""
    normal_velocity: Scalar
    """v_n + r_t Omega [m/s], of the block there; not positive: it moves away."""
    tangential_velocity: Scalar
    """v_t - r_n Omega [m/s], of the block there: the slip."""


def contact_point(block: Block, impact: Impact) -> ContactPoint:
    """The contact point as the block arrives."""
    axes = block.semi_axes
    sin, cos = jnp.sin(impact.orientation), jnp.cos(impact.orientation)
    normal_arm = block.shape.support(axes, sin, cos)
    spin = impact.angular_velocity
    tangential_arm = block.shape.arm_at_touch(axes, sin, cos, spin)
    return ContactPoint(
        normal_arm,
        tangential_arm,
        impact.normal_velocity + tangential_arm * spin,
        impact.tangential_velocity - normal_arm * spin,
    )


def rebound_of_impulse(
    block: Block, impact: Impact, point: ContactPoint, normal: Scalar, tangential=0.0
) -> Rebound:
    r"""Velocities after impulses $N$ and $T$ of the ground at the contact point.

    $$ v_n' = v_n - \frac{N}{m}, \qquad v_t' = v_t - \frac{T}{m}, \qquad
       \Omega' = \Omega + \frac{T r_n - N r_t}{I} $$

    Args:
        normal, tangential: impulses [N s], positive out of the ground and up-slope.
    """
    turning = tangential * point.normal_arm - normal * point.tangential_arm
    return Rebound(
        impact.normal_velocity - normal / block.mass,
        impact.tangential_velocity - tangential / block.mass,
        impact.angular_velocity + turning / block.inertia,
    )

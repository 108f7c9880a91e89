"""A rigid ellipse that turns about the point at which it touches."""

from typing import ClassVar

import jax.numpy as jnp

from ..scene import Block, Impact
from .base import AbstractRebound, Rebound, contact_point


class BozzoloPamini(AbstractRebound):
    r"""Rotation about the contact point, after Bozzolo and Pamini (1986).

    The contact point sticks; the block turns rigidly about it, with the angular
    momentum that it had about it:

    $$ \Omega' = \frac{I\Omega + m (r_n v_t - r_t v_n)}{I + m (r_n^2 + r_t^2)}, \qquad
       v_n' = -r_t\Omega', \qquad v_t' = r_n\Omega' $$

    with $r_n$, $r_t$ the arms of the ellipse's deepest point. No parameters; $e^* = 0$.
    Energy is never made. A contact point that moves away changes nothing, with a jump
    between the two. Elsewhere smooth.

    Nothing asks for a ground that pushes: the impulse $m (v_n - v_n')$ may be negative,
    when a block is held back that would roll over its contact point. And the centre may
    move into the ground afterwards, $r_t\Omega' < 0$.

    Source: Bozzolo and Pamini (1986), Acta Mechanica 63, 113-130, as told by Dattola et
    al. (2023), section 4.2; the equations follow from its two conditions. Losses at the
    contact, which later programs put on top, are not in it.
    """

    words: ClassVar[str] = "Bozzolo and Pamini"

    def __call__(self, block: Block, impact: Impact) -> Rebound:
        """Velocities after the impact."""
        point = contact_point(block, impact)
        mass, inertia = block.mass, block.inertia
        normal_arm, tangential_arm = point.normal_arm, point.tangential_arm
        momentum = inertia * impact.angular_velocity + mass * (
            normal_arm * impact.tangential_velocity
            - tangential_arm * impact.normal_velocity
        )
        spin = momentum / (inertia + mass * (normal_arm**2 + tangential_arm**2))
        closing = point.normal_velocity > 0.0
        return Rebound(
            jnp.where(closing, -tangential_arm * spin, impact.normal_velocity),
            jnp.where(closing, normal_arm * spin, impact.tangential_velocity),
            jnp.where(closing, spin, impact.angular_velocity),
        )

"""A rigid ellipse and an impulse along the normal."""

from typing import ClassVar

import jax.numpy as jnp

from .._types import Scalar
from ..parameters import parameter
from ..scene import Block, Impact
from .base import AbstractRebound, Rebound, contact_point, rebound_of_impulse


class RigidEllipsoid(AbstractRebound):
    r"""Rebound of a rigid ellipse by an instantaneous impulse along the normal.

    The impulse acts at the deepest point, after Vijayakumar et al. (2012).

    $$ N = (1 + e^\ast)\,\frac{m I}{I + m r_t^2}\,(v_n + r_t\Omega), \qquad
       v_n' = v_n - \frac{N}{m}, \qquad \Omega' = \Omega - \frac{N r_t}{I} $$

    with $r_t$ the arm of the deepest point; $v_t$ stays as it is: no friction. The
    velocity of approach at the contact is turned round and multiplied by $e^\ast$. A
    contact point that moves away gets no impulse; a kink between the two.
    """

    words: ClassVar[str] = "rigid ellipsoid"

    e_contact: Scalar = parameter(
        None, "-", "[0, 1]", "normal restitution at the contact"
    )
    """$e^*$ [-]"""

    def __call__(self, block: Block, impact: Impact) -> Rebound:
        """Velocities after the impact."""
        point = contact_point(block, impact)
        arm, mass, inertia = point.tangential_arm, block.mass, block.inertia
        normal = (
            (1.0 + self.e_contact)
            * (mass * inertia / (inertia + mass * arm**2))
            * jnp.maximum(point.normal_velocity, 0.0)
        )
        return rebound_of_impulse(block, impact, point, normal)

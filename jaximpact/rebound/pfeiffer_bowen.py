"""Rebound by coefficients that fall with speed, for spheres."""

from typing import ClassVar

import jax.numpy as jnp

from .._safe import safe_sqrt
from .._types import Scalar
from ..parameters import parameter
from ..scene import Block, Impact
from .base import AbstractRebound, Rebound

FOOT = 0.3048
"""Length of a foot [m]."""


class PfeifferBowen(AbstractRebound):
    r"""Rebound by coefficients that fall with speed, after Pfeiffer and Bowen (1989).

    $$ v_n' = -\frac{R_n v_n}{1 + (v_n/9.144)^2}, \qquad
       v_t'^2 = \frac{R^2 (I\Omega^2 + m v_t^2)\, f\, s}{I + m R^2} $$

    $$ f = R_t + \frac{1 - R_t}{1.2 + ((v_t - \Omega R)/6.096)^2}, \qquad
       s = \frac{R_t}{1 + (v_n/(76.2\,R_n))^2} $$

    and the block rolls away without slip, $\Omega' = v_t'/R$, in the direction in which
    it came (its direction of rotation if it came along the normal). The speeds are 30,
    20 and 250 feet a second, in m/s. $R$ is the semi-axis of the block's minor axis:
    the law is one of spheres. Continuous; a kink where $v_t$ and $\Omega$ are zero.

    Source: Pfeiffer and Bowen (1989), Bull. Assoc. Eng. Geol. 26(1), 135-146, in which
    speeds are in feet a second.
    """

    words: ClassVar[str] = "Pfeiffer and Bowen"

    normal_coefficient: Scalar = parameter(
        None, "-", "[1e-6, 1]", "normal restitution at low speed"
    )
    """Normal coefficient R_n at low speed [-]."""
    tangential_coefficient: Scalar = parameter(
        None, "-", "[0, 1]", "tangential restitution"
    )
    """Tangential coefficient R_t [-]."""

    def __call__(self, block: Block, impact: Impact) -> Rebound:
        """Velocities after the impact."""
        r_n, r_t = self.normal_coefficient, self.tangential_coefficient
        v_n, v_t = impact.normal_velocity, impact.tangential_velocity
        radius, inertia = block.semi_axes.minor, block.inertia
        spin = impact.angular_velocity
        slip = (v_t - spin * radius) / (20.0 * FOOT)
        friction = r_t + (1.0 - r_t) / (1.2 + slip**2)
        scaling = r_t / (1.0 + (v_n / (250.0 * FOOT * r_n)) ** 2)
        energy = inertia * spin**2 + block.mass * v_t**2
        speed = safe_sqrt(
            radius**2 * energy * friction * scaling / (inertia + block.mass * radius**2)
        )
        forward = jnp.where(v_t == 0.0, spin, v_t) >= 0.0
        tangential = jnp.where(forward, speed, -speed)
        normal = -r_n * v_n / (1.0 + (v_n / (30.0 * FOOT)) ** 2)
        return Rebound(normal, tangential, tangential / radius)

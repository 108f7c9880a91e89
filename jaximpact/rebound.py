r"""Rebound by laws in closed form, which know no time and no soil.

The first rung of the ladder, and what today's rockfall programs use.

Each is a module whose parameters are its leaves; called with a block and an impact it
gives the velocities after. Pure `jnp`, differentiable, for scalars or arrays that
broadcast. n into the ground, t down-slope, rotation clockwise: a block that rolls
down-slope without slip has $v_t = \Omega R$.
"""

from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .block import Block
from .foundation import tangency_arm
from .precision import float64_leaf
from .restitution import defined_ratio
from .safe import safe_sqrt
from .scene import Impact

Scalar = Float[Array, ""]

FOOT = 0.3048
"""[m]"""


class Rebound(NamedTuple):
    """Velocities after an impact: of the centre of mass [m/s], of rotation [rad/s]."""

    normal_velocity: Scalar
    tangential_velocity: Scalar
    angular_velocity: Scalar

    def e_n(self, impact: Impact) -> Scalar:
        """Apparent normal coefficient of restitution; NaN without normal velocity."""
        return -defined_ratio(self.normal_velocity, impact.normal_velocity)

    def e_t(self, impact: Impact) -> Scalar:
        """Apparent tangential coefficient; NaN without tangential velocity."""
        return defined_ratio(self.tangential_velocity, impact.tangential_velocity)


class ConstantCoefficients(eqx.Module):
    r"""$v_n' = -e_n v_n$, $v_t' = e_t v_t$; the rotation stays as it is."""

    e_n: Scalar = eqx.field(converter=float64_leaf)
    e_t: Scalar = eqx.field(converter=float64_leaf)

    def __call__(self, block: Block, impact: Impact) -> Rebound:
        """Velocities after."""
        return Rebound(
            -self.e_n * impact.normal_velocity,
            self.e_t * impact.tangential_velocity,
            impact.angular_velocity,
        )


class PfeifferBowen(eqx.Module):
    r"""Coefficients that fall with speed, after Pfeiffer and Bowen (1989).

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

    normal_coefficient: Scalar = eqx.field(converter=float64_leaf)
    """R_n [-]"""
    tangential_coefficient: Scalar = eqx.field(converter=float64_leaf)
    """R_t [-]"""

    def __call__(self, block: Block, impact: Impact) -> Rebound:
        """Velocities after."""
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


class RigidEllipsoid(eqx.Module):
    r"""An instantaneous impulse along the normal, at the deepest point of a rigid
    ellipse, after Vijayakumar et al. (2012).

    $$ J = (1 + e^\ast)\,\frac{m I}{I + m r_t^2}\,(v_n + r_t\Omega), \qquad
       v_n' = v_n - \frac{J}{m}, \qquad \Omega' = \Omega - \frac{J r_t}{I} $$

    with $r_t$ the arm of the deepest point; $v_t$ stays as it is: no friction. The
    velocity of approach at the contact is turned round and multiplied by $e^\ast$. A
    contact point that moves away gets no impulse; a kink between the two.
    """

    e_contact: Scalar = eqx.field(converter=float64_leaf)
    """$e^*$ [-]"""

    def __call__(self, block: Block, impact: Impact) -> Rebound:
        """Velocities after."""
        arm = tangency_arm(
            block.semi_axes, jnp.sin(impact.orientation), jnp.cos(impact.orientation)
        )
        mass, inertia = block.mass, block.inertia
        closing = impact.normal_velocity + arm * impact.angular_velocity
        impulse = (
            (1.0 + self.e_contact)
            * (mass * inertia / (inertia + mass * arm**2))
            * jnp.maximum(closing, 0.0)
        )
        return Rebound(
            impact.normal_velocity - impulse / mass,
            impact.tangential_velocity,
            impact.angular_velocity - impulse * arm / inertia,
        )

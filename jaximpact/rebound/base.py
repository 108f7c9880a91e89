"""Laws of rebound: what one has to define, and impulses at the contact point."""

import abc
from typing import ClassVar, NamedTuple

import jax.numpy as jnp

from .._types import Scalar
from ..parameters import Part
from ..restitution import defined_ratio
from ..scene import Block, Impact


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


class AbstractRebound(Part):
    r"""A law of rebound in closed form.

    A law of one's own derives from this class, declares its parameters and defines
    `__call__` in `jax.numpy`, for scalars:

        class Sticky(AbstractRebound):
            e_n: Scalar = parameter(0.3, "-", "[0, 1]", "normal restitution")

            def __call__(self, block, impact):
                return Rebound(-self.e_n * impact.normal_velocity, 0.0, 0.0)

    n into the ground, t down-slope, rotation clockwise: a block that rolls down-slope
    without slip has $v_t = \Omega R$.
    """

    words: ClassVar[str] = ""
    """Name of the law in files, where that is not the name of the class."""

    @abc.abstractmethod
    def __call__(self, block: Block, impact: Impact) -> Rebound:
        """Velocities after an impact.

        Args:
            block: mass, inertia, `semi_axes` and shape. impact: velocities, spin and
                orientation before.
        """


class ContactPoint(NamedTuple):
    """The deepest point of a rigid ellipse as it touches the ground."""

    normal_arm: Scalar
    """Depth r_n below the block's centre [m]."""
    tangential_arm: Scalar
    """Arm r_t from the block's centre [m], down-slope positive."""
    normal_velocity: Scalar
    """Normal velocity v_n + r_t Omega of the block there [m/s]; not positive where it
    moves away."""
    tangential_velocity: Scalar
    """Slip velocity v_t - r_n Omega of the block there [m/s]."""


def contact_point(block: Block, impact: Impact) -> ContactPoint:
    """Find the contact point as the block arrives."""
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
    block: Block,
    impact: Impact,
    point: ContactPoint,
    normal: Scalar,
    tangential: Scalar | float = 0.0,
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

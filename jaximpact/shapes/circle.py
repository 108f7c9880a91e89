"""Circular section: what is left of a block's geometry where its orientation changes
nothing."""

from collections.abc import Callable

import equinox as eqx
import jax.numpy as jnp

from .._types import Scalar
from .base import Section


class CentralSection(Section):
    """Section whose middle lies below the block's centre."""

    __slots__ = ()

    @property
    def middle(self) -> Scalar:
        return jnp.zeros_like(self.right)


class Circle(eqx.Module):
    r"""Geometry of a block whose section in the plane of motion is a circle of radius
    R, in place of its shape:

    $$ r_y = R, \qquad T_{low} = r_t = 0, \qquad a_t = R q, \qquad
       q = \sqrt{1 - (d/R)^2} $$

    and $a_t = R$ once the centre is below the ground. Methods are those of
    `AbstractShape`.
    """

    width: Callable = eqx.field(static=True)
    """Size B_w out of the plane of motion, of half sizes, height and q."""
    most_slender: float | None = eqx.field(static=True)

    def support(self, axes, sin, cos):
        return axes.minor

    def tangency_arm(self, axes, sin, cos):
        return jnp.zeros_like(axes.minor)

    def arm_at_touch(self, axes, sin, cos, spin):
        return self.tangency_arm(axes, sin, cos)

    def support_change(self, axes, start, now, sin_turn):
        return jnp.zeros_like(axes.minor)

    def section(self, axes, sin, cos, height, sinking) -> Section:
        q = root_of_section(sinking / axes.minor)
        half = jnp.where(height > 0.0, axes.minor * q, axes.minor)
        return CentralSection(-half, half, self.width(axes, height, q))

    def side_of(self, sin, cos) -> None:
        return None


def root_of_section(relative_sinking: Scalar) -> Scalar:
    """Compute q = sqrt(1 - (d/r_y)^2) from u_D / r_y [-], without the cancellation that
    d = r_y - u_D would bring; value 0 and gradient 0 below 0 and from 2 on."""
    cuts = (relative_sinking > 0.0) & (relative_sinking < 2.0)
    square = relative_sinking * (2.0 - relative_sinking)
    return jnp.where(cuts, jnp.sqrt(jnp.where(cuts, square, 1.0)), 0.0)

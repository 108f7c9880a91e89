"""Rebound by a normal coefficient that is a power of the impact angle."""

from typing import ClassVar

import jax.numpy as jnp

from .._types import Scalar
from ..parameters import parameter
from ..scene import Block, Impact
from ..units import DEGREE
from .base import AbstractRebound, Rebound

HALFWAY = 45.0 * DEGREE
"""Angle from the surface at which the coefficient is the law's own parameter [rad]."""
LEAST = 1.0 * DEGREE
"""Angle from the surface below which the coefficient no longer grows [rad]."""


class AnglePowerLaw(AbstractRebound):
    r"""Rebound by a power law in the impact angle, as fits to field tests have it.

    $$ v_n' = -e_{45} \left(\frac{\theta}{45^\circ}\right)^{-k} v_n, \qquad
       v_t' = e_t v_t, \qquad \theta = \max(90^\circ - |\theta^{in}|, 1^\circ) $$

    with $\theta$ the angle between velocity and surface. The rotation stays as it is.
    At grazing angles $e_n$ may exceed 1, as measured, so that energy may be made.
    Continuous; a kink at $\theta = 1^\circ$, below which $e_n$ is constant.

    Source: $e_n = 19.5\,\theta^{-1.03}$ with $\theta$ in degrees, a fit to field tests
    attributed to Wyllie (2014), is $e_{45} = 0.387$ and $k = 1.03$.
    """

    words: ClassVar[str] = "power law in the angle"

    e_45: Scalar = parameter(None, "-", "[0, 2]", "normal restitution at 45 degrees")
    """Normal coefficient at 45 degrees [-]."""
    angle_exponent: Scalar = parameter(
        None, "-", "[-1, 3]", "exponent by which e_n falls with the angle"
    )
    """Exponent k [-]."""
    e_t: Scalar = parameter(None, "-", "[0, 1]", "tangential restitution")
    """Tangential coefficient [-]."""

    def __call__(self, block: Block, impact: Impact) -> Rebound:
        """Velocities after the impact."""
        steepness = jnp.maximum(0.5 * jnp.pi - jnp.abs(impact.angle), LEAST)
        e_n = self.e_45 * (steepness / HALFWAY) ** -self.angle_exponent
        return Rebound(
            -e_n * impact.normal_velocity,
            self.e_t * impact.tangential_velocity,
            impact.angular_velocity,
        )

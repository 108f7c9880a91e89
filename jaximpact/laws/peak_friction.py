"""Peak friction angle of the ground."""

import abc
import math

import jax.numpy as jnp

from .._types import Scalar
from ..parameters import Part, parameter

DILATANCY_PER_INDEX = math.radians(3.0)
"""Bolton's 3 degrees of friction per unit of relative dilatancy index (triaxial)."""


class AbstractPeakFriction(Part):
    """Peak friction angle from the geotechnical description of the ground."""

    @abc.abstractmethod
    def __call__(self, friction_angle: Scalar, relative_density: Scalar) -> Scalar:
        r"""Peak friction angle $\varphi_p$ [rad].

        Args:
            friction_angle: $\varphi'$ [rad]. relative_density: $D_{r0}$, 0 to 1.
        """


class Bolton(AbstractPeakFriction):
    r"""Friction that rises with the density.

    $$ \varphi_p = \varphi' + 3^\circ\,
       \mathrm{clip}(\Delta_1 D_{r0} - \Delta_2,\ 0,\ 4) $$

    With $\Delta_1 = 5$, $\Delta_2 = 1$ this is Bolton's index $I_R = 5 D_r - 1$.
    Kinked where the clip begins and ends (Table 1 lies inside, at 3.5).

    Source: a reading of $\Delta_1$, $\Delta_2$; Bolton (1986, 1987).
    """

    delta_1: Scalar = parameter(5.0, "-", "(-inf, inf)", "peak friction slope")
    delta_2: Scalar = parameter(1.0, "-", "(-inf, inf)", "peak friction offset")

    def __call__(self, friction_angle, relative_density) -> Scalar:
        index = jnp.clip(self.delta_1 * relative_density - self.delta_2, 0.0, 4.0)
        return friction_angle + DILATANCY_PER_INDEX * index

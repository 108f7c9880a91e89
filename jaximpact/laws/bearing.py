"""Strength of the ground: peak friction, and the limit load of the foundation."""

import abc
import math
from typing import Any, NamedTuple

import jax.numpy as jnp

from .._types import Scalar
from ..parameters import Part, parameter
from ..shapes import Foundation
from .branch import Branch

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


class AbstractBearing(Part):
    """Limit load of the foundation."""

    def factors(self, friction: Scalar) -> Any:
        """Quantities of the limit load that depend on the peak friction angle [rad]
        alone, computed once an impact: any tuple of scalars; by default its tangent."""
        return jnp.tan(friction)

    @abc.abstractmethod
    def __call__(
        self,
        foundation: Foundation,
        unit_weight_normal: Scalar,
        factors: Any,
        *,
        branch: Branch | None = None,
    ) -> Scalar:
        r"""Vertical limit load $V_M$ [N], positive.

        Args:
            foundation: its sizes are positive; the sinking may be negative within a
                step.
            unit_weight_normal: $\gamma_n = \gamma\cos\omega$ [N/m3].
            factors: of the peak friction angle, from `factors`.
            branch: the sides taken at switches, if not those where the state is.
        """

    def at_velocity(
        self,
        foundation: Foundation,
        unit_weight_normal: Scalar,
        factors: Any,
        velocity: Scalar,
        density: Scalar,
        *,
        branch: Branch | None = None,
    ) -> Scalar:
        """Vertical limit load at a velocity of sinking [N]; by default that at rest.

        Args:
            velocity: of sinking [m/s], negative where the block rises.
            density: of the ground [kg/m3].
        """
        return self(foundation, unit_weight_normal, factors, branch=branch)


class BearingFactors(NamedTuple):
    """Quantities of the limit load that depend on the friction angle alone [-]."""

    friction_slope: Scalar  # mu = tan(phi_p)
    surcharge: Scalar  # N_q
    weight: Scalar  # N_gamma
    depth: Scalar  # 2 tan(phi_p) (1 - sin(phi_p))^2
    cohesion: Scalar  # N_c
    cohesion_shape: Scalar  # N_q, of the shape factor of N_c
    cohesion_depth: Scalar  # depth + 2 (1 - sin(phi_p))^2 / N_c


def bearing_factors(friction: Scalar) -> BearingFactors:
    r"""Vesic's factors at a peak friction angle [rad].

    $$ N_q = e^{\pi\tan\varphi} \tan^2(\pi/4 + \varphi/2), \quad
       N_\gamma = 2 (N_q + 1) \tan\varphi, \quad N_c = (N_q - 1)/\tan\varphi $$

    Smooth from 0, where $N_c = 2 + \pi$, to 90 degrees. Source: a reading; Vesic
    (1973).
    """
    slope = jnp.tan(friction)
    surcharge = jnp.exp(jnp.pi * slope) * jnp.tan(0.25 * jnp.pi + 0.5 * friction) ** 2
    cohesion = _cohesion_factor(slope)
    of_depth = 2.0 * (1.0 - jnp.sin(friction)) ** 2
    return BearingFactors(
        friction_slope=slope,
        surcharge=surcharge,
        weight=2.0 * (surcharge + 1.0) * slope,
        depth=2.0 * slope * (1.0 - jnp.sin(friction)) ** 2,
        cohesion=cohesion,
        cohesion_shape=surcharge,
        cohesion_depth=of_depth * (slope + 1.0 / cohesion),
    )


SMALL_SLOPE = 1e-4
"""Tangent below which N_c is its series, whose terms leave less than a rounding."""


def _cohesion_factor(slope: Scalar) -> Scalar:
    r"""Compute $N_c$ from $\tan\varphi$, by $N_q = e^z$ with
    $z = \pi\tan\varphi + 2\,\mathrm{arsinh}\tan\varphi$."""
    small = slope < SMALL_SLOPE
    exact = jnp.where(small, 1.0, slope)
    exact = jnp.expm1(jnp.pi * exact + 2.0 * jnp.arcsinh(exact)) / exact
    near = jnp.where(small, slope, 0.0)
    growth = jnp.pi + 2.0 - near**2 / 3.0  # z / tan(phi)
    z = growth * near
    series = 1.0 + z * (0.5 + z * (1.0 + z * (0.25 + z * 0.05)) / 6.0)
    return jnp.where(small, growth * series, exact)


class Vesic(AbstractBearing):
    r"""Vertical limit load of a footing sunk into the ground.

    With $B, L$ the smaller and larger of $B_t, B_w$, $A = \pi B_t B_w/4$,
    $u = \max(u_D, 0)$ and the cohesion $c$:

    $$ V_M = A\left(c N_c s_c d_c + \gamma_n u N_q s_q d_q + \tfrac12 \gamma_n B
    N_\gamma s_\gamma\right) $$
    $$ s_q = 1 + \tfrac{B}{L}\tan\varphi, \quad s_\gamma = 1 - 0.4 \tfrac{B}{L}, \quad
       d_q = 1 + 2\tan\varphi\,(1 - \sin\varphi)^2 \arctan(u/B) $$
    $$ s_c = 1 + \tfrac{B}{L}\tfrac{N_q}{N_c}, \quad
       d_c = d_q + \tfrac{d_q - 1}{N_c\tan\varphi} $$

    The paper's sand has no cohesion, and the default is 0. With it the strength has a
    part that grows neither with depth nor with size. Kinked at $B_t = B_w$ and at zero
    sinking.

    Source: a reading; Vesic (1973) with Hansen's depth factor. $d_c$ is that of $d_q$
    by the theorem of corresponding states.
    """

    cohesion: Scalar = parameter(
        0.0, "kPa", "[0, inf)", "cohesion of the ground", usual=(0.0, 1e4)
    )

    def factors(self, friction) -> BearingFactors:
        return bearing_factors(friction)

    def __call__(self, foundation, unit_weight_normal, factors, *, branch=None):
        length, width, sinking = (
            foundation.length,
            foundation.width,
            foundation.sinking,
        )
        oblong = length > width if branch is None else branch.oblong
        smaller = jnp.where(oblong, width, length)
        ratio = smaller / jnp.where(oblong, length, width)
        depth = jnp.maximum(sinking, 0.0)
        surcharge_shape = 1.0 + ratio * factors.friction_slope
        weight_shape = 1.0 - 0.4 * ratio
        sunk = jnp.arctan(depth / smaller)
        depth_factor = 1.0 + factors.depth * sunk
        area = 0.25 * jnp.pi * length * width
        cohesive = factors.cohesion + ratio * factors.cohesion_shape
        cohesive *= 1.0 + factors.cohesion_depth * sunk
        # As a height of ground, behind the other terms: without cohesion they keep
        # every bit.
        return (
            area
            * unit_weight_normal
            * (
                depth * factors.surcharge * surcharge_shape * depth_factor
                + 0.5 * smaller * factors.weight * weight_shape
                + self.cohesion / unit_weight_normal * cohesive
            )
        )


class VesicWithInertia(Vesic):
    r"""Vesic's limit load, and the inertia of the ground that has to move aside.

    $$ V_M = V_M^{Vesic} + k_\rho\, \rho A \max(v, 0)^2 $$

    with the density $\rho = \gamma/g$ of the ground, the area $A$ of the foundation and
    the velocity $v$ of sinking. It is a strength: it resists flow and never gives
    energy. Smooth at $v = 0$ to first order.

    Source: Poncelet's law of penetration. Katsuragi and Durian (2007) measured
    $m v^2/d_1$ with $d_1$ = 8.7 cm for a steel sphere in glass beads, which is
    $k_\rho$ = 1.03 on its whole section.
    """

    ground_inertia: Scalar = parameter(
        1.0, "-", "[0, inf)", "inertial resistance over density, area and velocity^2"
    )

    def at_velocity(
        self,
        foundation,
        unit_weight_normal,
        factors,
        velocity,
        density,
        *,
        branch=None,
    ):
        area = 0.25 * jnp.pi * foundation.length * foundation.width
        sinking = jnp.maximum(velocity, 0.0)
        at_rest = self(foundation, unit_weight_normal, factors, branch=branch)
        return at_rest + self.ground_inertia * density * area * sinking**2


class VesicWithoutDepthFactor(Vesic):
    """Vesic's limit load without $d_q$ and $d_c$; a reading to compare with.

    Of the paper's claims C01 to C33, 17 hold, 13 hold partly and 3 fail with it, as
    many as with the default: C23 is won, C10 lost.
    """

    def factors(self, friction) -> BearingFactors:
        zero = jnp.zeros_like(friction)
        return bearing_factors(friction)._replace(depth=zero, cohesion_depth=zero)


class VesicWithoutSurcharge(Vesic):
    """Vesic's limit load without the term of depth, $N_q$; a reading to compare with.

    Of the paper's claims C01 to C33, 13 hold, 15 hold partly and 5 fail with it
    (default: 17, 13, 3).
    """

    def factors(self, friction) -> BearingFactors:
        factors = bearing_factors(friction)
        return factors._replace(surcharge=jnp.zeros_like(friction))

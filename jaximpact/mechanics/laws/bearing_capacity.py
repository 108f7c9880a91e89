"""Limit load of the equivalent foundation under a central vertical load."""

import math
from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from ...soil import Soil
from .branch import Branch

Scalar = Float[Array, ""]

DILATANCY_PER_INDEX = math.radians(3.0)
"""Bolton's 3 degrees of friction per unit of relative dilatancy index (triaxial)."""


def peak_friction_angle(soil: Soil) -> Scalar:
    r"""Peak friction angle of the ground [rad].

    $$ \varphi_p = \varphi' + 3^\circ\,
       \mathrm{clip}(\Delta_1 D_{r0} - \Delta_2,\ 0,\ 4) $$

    With $\Delta_1 = 5$, $\Delta_2 = 1$ this is Bolton's index $I_R = 5 D_r - 1$.
    Kinked where the clip begins and ends (Table 1 lies inside, at 3.5).

    Source: a reading of $\Delta_1$, $\Delta_2$; Bolton (1986, 1987).
    """
    index = jnp.clip(soil.delta_1 * soil.relative_density - soil.delta_2, 0.0, 4.0)
    return soil.friction_angle + DILATANCY_PER_INDEX * index


class BearingFactors(NamedTuple):
    """What the limit load takes from the friction angle alone; all dimensionless."""

    friction_slope: Scalar  # mu = tan(phi_p)
    surcharge: Scalar  # N_q
    weight: Scalar  # N_gamma
    depth: Scalar  # 2 tan(phi_p) (1 - sin(phi_p))^2


def bearing_factors(friction: Scalar) -> BearingFactors:
    r"""Vesic's factors at a peak friction angle [rad].

    $$ N_q = e^{\pi\tan\varphi} \tan^2(\pi/4 + \varphi/2), \quad
       N_\gamma = 2 (N_q + 1) \tan\varphi $$

    Smooth below 90 degrees. Source: a reading; Vesic (1973).
    """
    slope = jnp.tan(friction)
    surcharge = jnp.exp(jnp.pi * slope) * jnp.tan(0.25 * jnp.pi + 0.5 * friction) ** 2
    return BearingFactors(
        friction_slope=slope,
        surcharge=surcharge,
        weight=2.0 * (surcharge + 1.0) * slope,
        depth=2.0 * slope * (1.0 - jnp.sin(friction)) ** 2,
    )


def bearing_capacity(
    length: Scalar,
    width: Scalar,
    sinking: Scalar,
    unit_weight_normal: Scalar,
    factors: BearingFactors,
    *,
    branch: Branch | None = None,
) -> Scalar:
    r"""Vertical limit load $V_M$ [N] of a footing sunk into the ground.

    With $B, L$ the smaller and larger of $B_t, B_w$, $A = \pi B_t B_w/4$ and
    $u = \max(u_D, 0)$:

    $$ V_M = A\left(\gamma_n u N_q s_q d_q + \tfrac12 \gamma_n B N_\gamma
    s_\gamma\right) $$
    $$ s_q = 1 + \tfrac{B}{L}\tan\varphi, \quad s_\gamma = 1 - 0.4 \tfrac{B}{L}, \quad
       d_q = 1 + 2\tan\varphi\,(1 - \sin\varphi)^2 \arctan(u/B) $$

    Args:
        length, width: $B_t$, $B_w$ [m], positive.
        sinking: $u_D$ [m].
        unit_weight_normal: $\gamma_n = \gamma\cos\omega$ [N/m3].
        factors: of the peak friction angle.
        branch: the side taken at $B_t = B_w$, if not the one where the sizes are.

    Kinked at $B_t = B_w$ and at zero sinking.

    Source: a reading; Vesic (1973) with Hansen's depth factor.
    """
    oblong = length > width if branch is None else branch.oblong
    smaller = jnp.where(oblong, width, length)
    ratio = smaller / jnp.where(oblong, length, width)
    depth = jnp.maximum(sinking, 0.0)
    surcharge_shape = 1.0 + ratio * factors.friction_slope
    weight_shape = 1.0 - 0.4 * ratio
    depth_factor = 1.0 + factors.depth * jnp.arctan(depth / smaller)
    area = 0.25 * jnp.pi * length * width
    return (
        area
        * unit_weight_normal
        * (
            depth * factors.surcharge * surcharge_shape * depth_factor
            + 0.5 * smaller * factors.weight * weight_shape
        )
    )

"""Elastic stiffness of the ground under the equivalent foundation."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from ...safe import safe_power
from ...soil import Soil
from .branch import Branch

Scalar = Float[Array, ""]

ATMOSPHERIC_PRESSURE = 100e3
"""p_a [Pa], the reference pressure of Duncan and Chang."""


class Stiffness(NamedTuple):
    """Stiffness of the foundation on the half-space."""

    normal: Scalar  # k_n [N/m]
    tangential: Scalar  # k_t [N/m]
    rotational: Scalar  # k_r [N m/rad]


def shape_factor(shape_ratio: Scalar) -> Scalar:
    r"""Correction of the normal stiffness for an oblong foundation.

    $$ J_s = 0.957 \exp(0.0394 R_s), \qquad R_s = \max(B_t, B_w)/\min(B_t, B_w) $$

    Source: Dattola et al. (2023), appendix C, from values of Gazetas (1983). At
    $R_s = 1$ it is 0.9955, not 1: the paper's interpolation, kept.
    """
    return 0.957 * jnp.exp(0.0394 * shape_ratio)


def elastic_stiffness(
    length: Scalar,
    width: Scalar,
    unit_weight_normal: Scalar,
    soil: Soil,
    *,
    branch: Branch | None = None,
) -> Stiffness:
    r"""Stiffness of a circular footing of equal area, modulus taken at one radius'
    depth.

    $$ r_0 = \tfrac12\sqrt{B_t B_w}, \quad
       E = k_E\, p_a (\gamma_n r_0/p_a)^{n_E}, \quad
       G = S_{ef} \frac{E}{2 (1 + \nu)}, $$
    $$ k_n = J_s \frac{4 G r_0}{1 - \nu}, \quad k_t = \frac{8 G r_0}{2 - \nu}, \quad
       k_r = \frac{8 G r_0^3}{3 (1 - \nu)} $$

    Args:
        length, width: $B_t$, $B_w$ [m], positive.
        unit_weight_normal: $\gamma_n = \gamma \cos\omega$ [N/m3].
        soil: `k_E`, `n_E`, `S_ef`, `poisson`.
        branch: the side taken at the kink, if not the one where the sizes are.

    Smooth except at $B_t = B_w$, where the shape ratio has a kink; the derivative there
    is that of $B_t < B_w$.

    Source: a reading. Stiffness: Gazetas (1983); modulus: Duncan and Chang (1970).
    Dattola et al. (2023) print only $J_s$ and name the parameters.
    """
    radius = 0.5 * jnp.sqrt(length * width)
    ratio = length / width
    oblong = ratio > 1.0 if branch is None else branch.oblong
    shape_ratio = jnp.where(oblong, ratio, 1.0 / ratio)
    modulus = (
        soil.k_E
        * ATMOSPHERIC_PRESSURE
        * safe_power(unit_weight_normal * radius / ATMOSPHERIC_PRESSURE, soil.n_E)
    )
    shear_modulus = soil.S_ef * modulus / (2.0 * (1.0 + soil.poisson))
    return Stiffness(
        normal=shape_factor(shape_ratio)
        * (4.0 * shear_modulus * radius / (1.0 - soil.poisson)),
        tangential=8.0 * shear_modulus * radius / (2.0 - soil.poisson),
        rotational=8.0 * shear_modulus * radius**3 / (3.0 * (1.0 - soil.poisson)),
    )

"""Dashpots beside the elastic springs."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from ...soil import Soil
from .elasticity import Stiffness

Scalar = Float[Array, ""]


class Damping(NamedTuple):
    """Dashpot coefficients."""

    normal: Scalar  # c_n [N s/m]
    tangential: Scalar  # c_t [N s/m]
    rotational: Scalar  # c_r [N m s/rad]


def dashpots(
    stiffness: Stiffness, mass: Scalar, inertia: Scalar, soil: Soil
) -> Damping:
    r"""Dashpot coefficients from damping ratios.

    $$ c_n = 2 \eta_N \sqrt{k_n m}, \quad c_t = 2 \eta_T \sqrt{k_t m}, \quad
       c_r = 2 \eta_R \sqrt{k_r I} $$

    Args:
        stiffness: of the foundation at this moment.
        mass: $m$ [kg]. inertia: $I$ [kg m2].
        soil: `eta_N`, `eta_T`, `eta_R`; 0 switches a dashpot off.

    Source: a reading; the paper gives the three ratios, all zero in Table 1.
    """
    return Damping(
        normal=2.0 * soil.eta_N * jnp.sqrt(stiffness.normal * mass),
        tangential=2.0 * soil.eta_T * jnp.sqrt(stiffness.tangential * mass),
        rotational=2.0 * soil.eta_R * jnp.sqrt(stiffness.rotational * inertia),
    )

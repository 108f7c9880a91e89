"""Hardening of the visco-plastic element."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from ..soil import Soil
from .flow import FlowRate

Scalar = Float[Array, ""]


def hardening_rate(
    hardening: Scalar, flow: FlowRate, length: Scalar, width: Scalar, soil: Soil
) -> Scalar:
    r"""Rate of the hardening variable [1/s].

    $$ \dot\rho_c = c_v (1 - \rho_c)\,
       \frac{\max(\dot u_n, 0) + \alpha_{vT}|\dot u_t| + \alpha_{vR} B_t |\dot\theta|}
            {\sqrt{B_t B_w}} $$

    Args:
        hardening: $\rho_c$ [-]; it grows towards 1 and never passes it.
        flow: visco-plastic rates.
        length, width: $B_t$, $B_w$ [m], positive.
        soil: `c_v`, `alpha_vT`, `alpha_vR`.

    Kinked where a rate changes sign (slope 0 is taken at zero).

    Source: a reading; di Prisco and Vecchiotti (2006).
    """
    path = (
        jnp.maximum(flow.normal, 0.0)
        + soil.alpha_vT * jnp.abs(flow.tangential)
        + soil.alpha_vR * length * jnp.abs(flow.rotational)
    )
    return soil.c_v * (1.0 - hardening) * path / jnp.sqrt(length * width)

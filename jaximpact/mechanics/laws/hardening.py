"""Hardening of the visco-plastic element."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from ...soil import Soil
from .branch import Branch
from .flow import FlowRate

Scalar = Float[Array, ""]


def hardening_rate(
    hardening: Scalar,
    flow: FlowRate,
    length: Scalar,
    width: Scalar,
    soil: Soil,
    *,
    branch: Branch | None = None,
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
        branch: the signs of the rates, if not those that they have.

    Kinked where a rate changes sign; the derivative there is that of a positive rate.

    Source: a reading; di Prisco and Vecchiotti (2006).
    """
    if branch is None:
        heaves, shears_up, rocks_back = (rate < 0.0 for rate in flow)
    else:
        heaves, shears_up, rocks_back = (
            branch.heaves,
            branch.shears_up,
            branch.rocks_back,
        )
    path = (
        jnp.where(heaves, 0.0, flow.normal)
        + soil.alpha_vT * jnp.where(shears_up, -flow.tangential, flow.tangential)
        + soil.alpha_vR
        * length
        * jnp.where(rocks_back, -flow.rotational, flow.rotational)
    )
    return soil.c_v * (1.0 - hardening) * path / jnp.sqrt(length * width)

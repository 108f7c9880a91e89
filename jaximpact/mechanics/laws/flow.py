"""Visco-plastic flow: how fast, and in which direction."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from ...safe import TINY
from .branch import Branch
from .loading_surface import Load

Scalar = Float[Array, ""]


class FlowRate(NamedTuple):
    """Rate of visco-plastic displacement."""

    normal: Scalar  # du_n^vp/dt [m/s]
    tangential: Scalar  # du_t^vp/dt [m/s]
    rotational: Scalar  # dtheta^vp/dt [rad/s]


def overstress(
    load_size: Scalar, hardening: Scalar, *, branch: Branch | None = None
) -> Scalar:
    r"""Viscous nucleus $\Phi = \max(\rho^*/\rho_c - 1, 0)$ [-].

    Kinked at yield. Source: a reading; Perzyna (1963).
    """
    excess = load_size / hardening - 1.0
    yields = excess > 0.0 if branch is None else branch.yields
    return jnp.where(yields, excess, 0.0)


def flow_direction(
    load: Load, dilatancy: Scalar, *, branch: Branch | None = None
) -> FlowRate:
    r"""Unit vector of flow in the dimensionless space.

    The gradient of the loading surface, with the part that would heave the block up
    reduced: $g_\xi \leftarrow \max(g_\xi, 0) + \mathrm{dilatancy}\,\min(g_\xi, 0)$.

    Kinked where $g_\xi = 0$ unless dilatancy is 1. Source: a reading; associated flow
    of Nova and Montrasio (1991) at dilatancy 1, none of the heave at 0.
    """
    heaves = load.normal < 0.0 if branch is None else branch.heaves
    normal = jnp.where(heaves, dilatancy, 1.0) * load.normal
    norm = jnp.sqrt(normal**2 + load.tangential**2 + load.rotational**2 + TINY)
    return FlowRate(normal / norm, load.tangential / norm, load.rotational / norm)


def flow_rate(
    load: Load,
    hardening: Scalar,
    length: Scalar,
    friction_slope: Scalar,
    soil,
    *,
    branch: Branch | None = None,
    nucleus=overstress,
) -> FlowRate:
    r"""Visco-plastic displacement rates.

    $$ \dot u_n = \gamma_v \Phi g_\xi, \quad \dot u_t = \gamma_v \Phi g_h/\mu, \quad
       \dot\theta = \gamma_v \Phi g_m/(\psi B_t) $$

    Args:
        load: size and gradient of the loading surface.
        hardening: $\rho_c$ [-], positive.
        length: $B_t$ [m]. friction_slope: $\mu = \tan\varphi_p$ [-].
        soil: `gamma_v` [m/s], `psi`, `dilatancy`.
        branch: the sides taken at yield and at the onset of heave, if not those where
            the load is.
        nucleus: the viscous nucleus, replaceable.

    The dissipation $N\dot u_n + T\dot u_t + M\dot\theta$ is never negative.

    Source: a reading; Perzyna (1963).
    """
    rate = soil.gamma_v * nucleus(load.size, hardening, branch=branch)
    direction = flow_direction(load, soil.dilatancy, branch=branch)
    return FlowRate(
        normal=rate * direction.normal,
        tangential=rate * direction.tangential / friction_slope,
        rotational=rate * direction.rotational / (soil.psi * length),
    )

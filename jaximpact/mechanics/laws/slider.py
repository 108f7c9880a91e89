"""Plastic slider: Coulomb friction between block and ground."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from ...soil import Soil
from .branch import Branch

Scalar = Float[Array, ""]

RELAXATION_TIME = 1e-6
"""tau_s [s], of the Duvaut-Lions regularisation; contacts last 1e-4 s and more."""


def slider_friction(soil: Soil) -> Scalar:
    r"""Friction coefficient between block and ground.

    $$ \tan\varphi_b = \alpha_s \tan\varphi' $$

    Source: a reading of $\alpha_s$, which Table 1 leaves blank.
    """
    return soil.alpha_s * jnp.tan(soil.friction_angle)


def slip_rate(
    tangential_force: Scalar,
    normal_force: Scalar,
    tangential_stiffness: Scalar,
    friction: Scalar,
    *,
    branch: Branch | None = None,
) -> Scalar:
    r"""Rate of slip $\dot u_t^{ps}$ [m/s], Duvaut-Lions regularisation of Coulomb.

    $$ \dot u_t^{ps} = \mathrm{sign}(T)
       \frac{\max(|T| - N\tan\varphi_b, 0)}{k_t \tau_s} $$

    Args:
        tangential_force: $T$ [N]. normal_force: $N \ge 0$ [N].
        tangential_stiffness: $k_t$ [N/m], positive.
        friction: $\tan\varphi_b$ [-].
        branch: whether it slips, if not as the forces have it.

    Kinked at the onset of slip, smooth at T = 0 (for N > 0).

    Source: a reading of the paper's slider, whose consistency conditions
    ($f \le 0$, $\lambda \ge 0$, $f\lambda = 0$) hold as tau_s goes to 0.
    """
    limit = normal_force * friction
    down, up = tangential_force - limit, tangential_force + limit
    slips_down = down > 0.0 if branch is None else branch.slips_down
    slips_up = up < 0.0 if branch is None else branch.slips_up
    excess = jnp.where(slips_down, down, jnp.where(slips_up, up, 0.0))
    return excess / (tangential_stiffness * RELAXATION_TIME)

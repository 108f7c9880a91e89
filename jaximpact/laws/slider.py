"""Plastic slider: Coulomb friction between block and ground."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from ..soil import Soil

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
) -> Scalar:
    r"""Rate of slip $\dot u_t^{ps}$ [m/s], Duvaut-Lions regularisation of Coulomb.

    $$ \dot u_t^{ps} = \mathrm{sign}(T)
       \frac{\max(|T| - N\tan\varphi_b, 0)}{k_t \tau_s} $$

    Args:
        tangential_force: $T$ [N]. normal_force: $N \ge 0$ [N].
        tangential_stiffness: $k_t$ [N/m], positive.
        friction: $\tan\varphi_b$ [-].

    Kinked at the onset of slip, smooth at T = 0 (for N > 0).

    Source: a reading of the paper's slider, whose consistency conditions
    ($f \le 0$, $\lambda \ge 0$, $f\lambda = 0$) hold as tau_s goes to 0.
    """
    limit = normal_force * friction
    excess = tangential_force - jnp.clip(tangential_force, -limit, limit)
    return excess / (tangential_stiffness * RELAXATION_TIME)

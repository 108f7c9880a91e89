"""Restitution coefficients, from velocities before and after an impact."""

import jax.numpy as jnp

from ._safe import safe_sqrt
from ._types import Scalar
from .scene import Block


def defined_ratio(numerator: Scalar, denominator: Scalar) -> Scalar:
    """`numerator / denominator`; NaN, with gradient 0, where the denominator is 0."""
    defined = denominator != 0.0
    ratio = numerator / jnp.where(defined, denominator, 1.0)
    return jnp.where(defined, ratio, jnp.nan)


def defined_root(x: Scalar) -> Scalar:
    """Square root of `max(x, 0)`, with gradient 0 where x <= 0; NaN of NaN."""
    return jnp.where(jnp.isnan(x), x, safe_sqrt(x))


def energetic_coefficient(
    e_n: Scalar,
    e_t: Scalar,
    angle: Scalar,
    rotational_ratio_before: Scalar,
    rotational_ratio_after: Scalar,
) -> Scalar:
    r"""Energetic coefficient from the apparent ones.

    $$ \bar e = \sqrt{\frac{1 - R_{r0}}{1 - R_r}
       (e_n^2\cos^2\theta^{in} + e_t^2\sin^2\theta^{in})} $$

    Args:
        e_n, e_t: apparent coefficients [-]. angle: impact angle [rad].
        rotational_ratio_before, rotational_ratio_after: rotational over total kinetic
            energy.

    Equal to $\sqrt{E_k/E_{k0}}$ identically; NaN of a failed impact. At vertical
    incidence, where e_t is NaN, it does not count.

    Source: Dattola et al. (2023), eq. 5, which prints $R_t$ for $R_r$.
    """
    sin = jnp.sin(angle)
    along = jnp.where(sin == 0.0, 0.0, e_t) * sin
    translational = (e_n * jnp.cos(angle)) ** 2 + along**2
    return defined_root(
        (1.0 - rotational_ratio_before) / (1.0 - rotational_ratio_after) * translational
    )


def vijayakumar_coefficient(
    block: Block,
    orientation: Scalar,
    e_contact: Scalar,
    normal_velocity: Scalar,
    angular_velocity: Scalar,
) -> Scalar:
    r"""Apparent normal coefficient of an instantaneous rigid-body impact.

    $$ e_n = \frac{I e^* - m r_t^2}{I + m r_t^2}
       + (1 + e^*)\frac{r_t I}{I + m r_t^2}\frac{\dot\theta_0}{v_{n0}} $$

    Args:
        block: mass, inertia and shape.
        orientation: $\theta_0$ [rad]; gives the arm $r_t$ of the tangency point
            (on a level face, of the end that the spin drives down; see
            `AbstractShape.arm_at_touch`).
        e_contact: coefficient $e^*$ at the contact [-].
        normal_velocity, angular_velocity: before the impact [m/s, rad/s].

    Source: Vijayakumar et al. (2012), as eq. 6 of Dattola et al. (2023), whose last
    term has $r_t^2$ where the dimensions need $r_t$.
    """
    arm = block.shape.arm_at_touch(
        block.semi_axes, jnp.sin(orientation), jnp.cos(orientation), angular_velocity
    )
    turning = block.mass * arm**2
    inertia = block.inertia
    return (inertia * e_contact - turning) / (inertia + turning) + (
        (1.0 + e_contact)
        * (arm * inertia / (inertia + turning))
        * defined_ratio(angular_velocity, normal_velocity)
    )

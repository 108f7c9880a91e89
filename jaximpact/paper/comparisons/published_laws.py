"""Laws that others fitted to measured impacts, in the units of their authors.

Fits, not theory: each holds for what its authors measured. Pure `jnp`, differentiable,
for scalars or arrays that broadcast.
"""

import math
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array

from ...scene import GRAVITY

Numbers = float | np.ndarray | Array


def labiouse_max_force_kN(
    modulus_kPa: Numbers, radius_m: Numbers, weight_kN: Numbers, height_m: Numbers
) -> Numbers:
    r"""Largest force of a block dropped on a cushion of soil [kN].

    $$ F = 1.765\, M_E^{2/5} R^{1/5} (W H)^{3/5} $$

    Args:
        modulus_kPa: $M_E$ [kN/m2], modulus of the cushion from a plate loading test.
        radius_m: R [m], of the block where it strikes.
        weight_kN: W [kN]. height_m: H [m], of the drop.

    Vertical drops. Source: Labiouse, Descoeudres and Montani (1996), Experimental study
    of rock sheds impacted by rock blocks, Structural Engineering International 6(3).
    """
    return 1.765 * modulus_kPa**0.4 * radius_m**0.2 * (weight_kN * height_m) ** 0.6


def gerber_penetration_m(
    mass_kg: Numbers, modulus_kPa: Numbers, speed_mps: Numbers
) -> Numbers:
    r"""Penetration of a block dropped on soil [m].

    $$ d = 0.1\, m^{1/3} M_E^{-2/5} v^{4/5} $$

    Args:
        mass_kg: m [kg]. modulus_kPa: $M_E$ [kN/m2]. speed_mps: v [m/s].

    Vertical drops. Source: Gerber (2019), as eq. 11 of Lu et al. (2019), Landslides 16,
    2353-2367, doi 10.1007/s10346-019-01238-z.
    """
    return 0.1 * jnp.cbrt(mass_kg) * modulus_kPa**-0.4 * speed_mps**0.8


def wyllie_normal_restitution(angle_from_slope_deg: Numbers) -> Numbers:
    r"""Apparent normal coefficient of restitution against the impact angle [-].

    $$ e_n = 19.5\, \theta^{-1.03} $$

    Args:
        angle_from_slope_deg: $\theta$ [deg], between the block's path and the ground's
            surface (90 is vertical incidence), from 10 to 90.

    Fitted to field tests; below 18 degrees it is above 1. Source: attributed to Wyllie
    (2014).
    """
    return 19.5 * angle_from_slope_deg**-1.03


class KatsuragiDurian(NamedTuple):
    r"""A sphere that falls into glass beads: friction with depth and inertial drag.

    $$ F = k z + \frac{m v^2}{d_1}, \qquad \frac{dv}{dt} = g - \frac{F}{m} $$

    Over depth this is linear in $v^2$, so that, with $\kappa = k/m$,

    $$ v^2(z) = a - \kappa d_1 z + (v_0^2 - a)\, e^{-2z/d_1}, \qquad
       a = g d_1 + \tfrac12\kappa d_1^2 $$

    The defaults are of a steel sphere of 25.4 mm and 69.2 g that strikes, at 0 to 4
    m/s, beads of 250 to 350 micrometres with a bulk density of 1.52 g/cm3.

    Source: Katsuragi and Durian (2007), Nature Physics 3, 420-423.
    """

    mass: float = 0.0692
    """m [kg]"""
    drag_length: float = 0.087
    r"""$d_1$ [m], measured as 8.7 +- 0.7 cm"""
    stiffness_over_mass: float = 1040.0
    r"""$\kappa = k/m$ [1/s2], measured as 1040 +- 10"""

    def force(self, depth: Numbers, speed: Numbers) -> Numbers:
        """Force of the beads on the sphere [N], at a depth [m] and a speed [m/s]."""
        return self.mass * (
            self.stiffness_over_mass * depth + speed**2 / self.drag_length
        )

    def squared_speed(self, depth: Numbers, impact_speed: Numbers) -> Numbers:
        """v^2 [m2/s2] at a depth [m]; negative beyond the depth where it stops."""
        level = self._level()
        return (
            level
            - self.stiffness_over_mass * self.drag_length * depth
            + (impact_speed**2 - level) * jnp.exp(-2.0 * depth / self.drag_length)
        )

    def stopping_depth(self, impact_speed: Numbers) -> Numbers:
        r"""Depth at which the sphere stops [m].

        $$ z = z_0 + \frac{d_1}{2} W\!\left(
           \frac{2 (v_0^2 - a)}{\kappa d_1^2} e^{-2 z_0/d_1}\right), \qquad
           z_0 = \frac{a}{\kappa d_1} $$

        with the principal branch W of Lambert's function. At a speed of zero the sphere
        sinks by its weight.
        """
        scale = self.stiffness_over_mass * self.drag_length
        level = self._level()
        last, half = level / scale, 0.5 * self.drag_length
        argument = (impact_speed**2 - level) / (scale * half) * jnp.exp(-last / half)
        return last + half * lambert_w(argument)

    def _level(self) -> float:
        return self.drag_length * (
            GRAVITY + 0.5 * self.stiffness_over_mass * self.drag_length
        )


HALLEY_STEPS = 5
"""The fifth changes nothing in double precision, between -0.36 and 1e6."""


def lambert_w(x: Numbers) -> Numbers:
    r"""Principal branch of Lambert's function, $W e^W = x$, for $x > -1/e$.

    Smooth; the slope grows without bound towards $-1/e$.
    """
    x = jnp.asarray(x, float)
    # First guesses: the series about the branch point, and the logarithm
    root = jnp.sqrt(2.0 * jnp.maximum(math.e * x + 1.0, 1e-12))
    near = -1.0 + root * (1.0 + root * (-1.0 / 3.0 + root * 11.0 / 72.0))
    w = jnp.where(x < 0.5, near, jnp.log1p(jnp.maximum(x, 0.0)))
    for _ in range(HALLEY_STEPS):
        power = jnp.exp(w)
        miss = w * power - x
        slope = power * (w + 1.0)
        w = w - miss / (slope - 0.5 * miss * (w + 2.0) / (w + 1.0))
    return w

"""The ground: the parameters of the macro-element as array leaves."""

import functools
import math

import equinox as eqx
import numpy as np
from jaxtyping import Array, Float

from .fields import Parameters
from .precision import float64_leaf


def _parameter(default: float) -> Float[Array, ""]:
    return eqx.field(default=default, converter=float64_leaf)


class Soil(Parameters):
    """Parameters of the ground; the defaults are Table 1, a very dense sand.

    Any field can be swept, batched and differentiated. Angles in radians, unit weight
    in N/m3; the rest is dimensionless but for `gamma_v`, which is a velocity.

    Source: Dattola, Crosta and di Prisco (2023), Table 1. The paper does not print the
    functions in which these parameters stand; the module named beside each group holds
    our reading of its sources. `alpha_s` is blank in Table 1 and is 1 here; `dilatancy`
    is ours.
    """

    # Geotechnical description
    unit_weight: Float[Array, ""] = _parameter(18e3)  # gamma [N/m3]
    friction_angle: Float[Array, ""] = _parameter(math.radians(30.0))  # phi' [rad]
    relative_density: Float[Array, ""] = _parameter(0.90)  # D_r0 [-], 0 to 1
    # Elasto-damping element (mechanics/laws/: elasticity, damping)
    k_E: Float[Array, ""] = _parameter(900.0)  # modulus number [-]
    n_E: Float[Array, ""] = _parameter(0.40)  # modulus exponent [-]
    poisson: Float[Array, ""] = _parameter(0.30)  # nu [-]
    S_ef: Float[Array, ""] = _parameter(1.0)  # factor on the modulus [-]
    eta_N: Float[Array, ""] = _parameter(0.0)  # damping ratio, normal [-]
    eta_T: Float[Array, ""] = _parameter(0.0)  # damping ratio, tangential [-]
    eta_R: Float[Array, ""] = _parameter(0.0)  # damping ratio, rotational [-]
    # Visco-plastic element (mechanics/laws/: bearing_capacity, loading_surface, flow)
    beta: Float[Array, ""] = _parameter(0.90)  # exponent of the loading surface [-]
    c_v: Float[Array, ""] = _parameter(1.0)  # hardening per foundation size [-]
    gamma_v: Float[Array, ""] = _parameter(8.7)  # fluidity [m/s]
    delta_1: Float[Array, ""] = _parameter(5.0)  # peak friction: slope in D_r0 [-]
    delta_2: Float[Array, ""] = _parameter(1.0)  # peak friction: offset [-]
    alpha_vT: Float[Array, ""] = _parameter(2.53)  # hardening by sliding [-]
    alpha_vR: Float[Array, ""] = _parameter(0.0)  # hardening by rocking [-]
    psi: Float[Array, ""] = _parameter(0.33)  # moment intercept of the surface [-]
    # Plastic slider (mechanics/laws/: slider) and flow rule
    alpha_s: Float[Array, ""] = _parameter(1.0)  # tan(phi_b) / tan(phi') [-]
    dilatancy: Float[Array, ""] = _parameter(0.0)  # heave admitted, 0 to 1 [-]


DAMPING_RATIOS = ("eta_N", "eta_T", "eta_R")


def is_above_zero(ratio) -> np.ndarray:
    """Where a damping ratio is above zero, or NaN: not known."""
    return ~(np.asarray(ratio) <= 0.0)


def has_dashpots(soil: Soil) -> np.ndarray:
    """Where any damping ratio is above zero, or not known."""
    ratios = [is_above_zero(getattr(soil, name)) for name in DAMPING_RATIOS]
    return functools.reduce(np.logical_or, ratios)

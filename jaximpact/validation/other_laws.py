"""Constitutive functions read otherwise, to measure what hangs on a reading.

Each takes the place of one function of `Laws`. They differ from the package's readings
in one thing, which the docstring names.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float

from ..mechanics.dynamics import INITIAL_HARDENING
from ..mechanics.laws import (
    BearingFactors,
    FlowRate,
    Load,
    bearing_factors,
    flow_rate,
    hardening_rate,
    loading_surface,
)

Scalar = Float[Array, ""]


def without_depth_factor(friction: Scalar) -> BearingFactors:
    """The limit load without $d_q$."""
    return bearing_factors(friction)._replace(depth=jnp.zeros_like(friction))


def without_surcharge(friction: Scalar) -> BearingFactors:
    """The limit load without what grows with depth, $N_q$."""
    factors = bearing_factors(friction)
    return factors._replace(surcharge=jnp.zeros_like(friction))


def sharper_vertex(xi: Scalar, h: Scalar, m: Scalar, beta: Scalar) -> Load:
    """The loading surface with its vertex rounded by 0.001."""
    return loading_surface(xi, h, m, beta, rounding=1e-3)


def blunter_vertex(xi: Scalar, h: Scalar, m: Scalar, beta: Scalar) -> Load:
    """The loading surface with its vertex rounded by 0.1."""
    return loading_surface(xi, h, m, beta, rounding=0.1)


def _absolute(load_size, hardening, *, branch=None):
    return hardening * _relative(load_size, hardening, branch)


def _squared(load_size, hardening, *, branch=None):
    return _relative(load_size, hardening, branch) ** 2


def _relative(load_size, hardening, branch):
    excess = load_size / hardening - 1.0
    yields = excess > 0.0 if branch is None else branch.yields
    return jnp.where(yields, excess, 0.0)


def absolute_overstress(*arguments, branch=None) -> FlowRate:
    r"""Flow with the nucleus $\rho^* - \rho_c$."""
    return flow_rate(*arguments, branch=branch, nucleus=_absolute)


def squared_overstress(*arguments, branch=None) -> FlowRate:
    r"""Flow with the nucleus $(\rho^*/\rho_c - 1)^2$."""
    return flow_rate(*arguments, branch=branch, nucleus=_squared)


def fluidity_by_size(
    load, hardening, length, friction_slope, soil, *, branch=None
) -> FlowRate:
    r"""Flow at $\gamma_v B_t$: the fluidity a rate [1/s], not a velocity."""
    rates = flow_rate(load, hardening, length, friction_slope, soil, branch=branch)
    return FlowRate(*(length * rate for rate in rates))


def _flow_from(initial: float):
    """Flow with another hardening at the start.

    The rate of hardening is linear in $1 - \rho_c$; so a larger $1 - \rho_c$ by a
    constant factor, as flow sees it, is another start and nothing else.
    """
    factor = (1.0 - initial) / (1.0 - INITIAL_HARDENING)

    def nucleus(load_size, hardening, *, branch=None):
        # The switch that the branch knows lies at another hardening.
        del branch
        seen = 1.0 - factor * (1.0 - hardening)
        return jnp.maximum(load_size / seen - 1.0, 0.0)

    def flow_from(*arguments, branch=None) -> FlowRate:
        return flow_rate(*arguments, branch=branch, nucleus=nucleus)

    return flow_from


flow_from_softer = _flow_from(0.001)
"""Flow with a tenth of the hardening at the start."""
flow_from_harder = _flow_from(0.1)
"""Flow with ten times the hardening at the start."""


def hardening_per_metre(hardening, flow, length, width, soil, *, branch=None) -> Scalar:
    r"""Hardening by the path in metres, not by its part of the foundation's size."""
    rate = hardening_rate(hardening, flow, length, width, soil, branch=branch)
    return rate * jnp.sqrt(length * width)

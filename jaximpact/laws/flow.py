"""Visco-plastic flow: its rate and its direction."""

import abc
from typing import ClassVar, NamedTuple

import jax.numpy as jnp

from .._safe import TINY, safe_power
from .._types import Scalar
from ..parameters import Part, parameter
from ..shapes import Foundation
from .branch import Branch
from .loading_surface import Load


class FlowRate(NamedTuple):
    """Rate of visco-plastic displacement."""

    normal: Scalar  # du_n^vp/dt [m/s]
    tangential: Scalar  # du_t^vp/dt [m/s]
    rotational: Scalar  # dtheta^vp/dt [rad/s]


class AbstractFlow(Part):
    """Visco-plastic flow of the ground."""

    @abc.abstractmethod
    def __call__(
        self,
        load: Load,
        hardening: Scalar,
        foundation: Foundation,
        *,
        branch: Branch | None = None,
    ) -> FlowRate:
        r"""Visco-plastic displacement rates.

        Args:
            load: size $\rho^*$ and gradient of the loading surface.
            hardening: $\rho_c$ [-], positive.
            foundation: its sizes are positive.
            branch: the sides taken at yield and at the onset of heave, if not those
                where the load is.

        For the dissipation $N\dot u_n + T\dot u_t + M\dot\theta$ to be never negative,
        flow goes along the gradient, as `displacement_rates` gives it.
        """

    statements: ClassVar = {"flows_below_yield": ("__call__", "flow_size")}
    flows_below_yield: ClassVar[bool] = True
    """Whether there may be flow below yield. Steps of the integration then end there
    too where the flow begins to heave and where hardening has kinks, and an impact
    begins with a load that the flow can follow."""


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
    normal, inverse = _reduced(load, dilatancy, branch)
    return FlowRate(
        normal * inverse, load.tangential * inverse, load.rotational * inverse
    )


def _reduced(
    load: Load, dilatancy: Scalar, branch: Branch | None
) -> tuple[Scalar, Scalar]:
    """Return the normal part of the gradient, reduced where it would heave the block
    up, and one over the gradient's magnitude."""
    heaves = load.normal < 0.0 if branch is None else branch.heaves
    normal = jnp.where(heaves, dilatancy, 1.0) * load.normal
    # The normal part is known last. Root and division, which take long, go side by
    # side.
    square = load.tangential**2 + load.rotational**2 + TINY + normal**2
    return normal, jnp.sqrt(square) / square


def displacement_rates(
    rate: Scalar, load: Load, dilatancy: Scalar, *, branch: Branch | None = None
) -> FlowRate:
    r"""Displacement rates of flow of a given size along `flow_direction` $g$.

    $$ \dot u_n = \dot\lambda g_\xi, \quad \dot u_t = \dot\lambda g_h/\mu, \quad
       \dot\theta = \dot\lambda g_m/(\psi B_t) $$

    Args:
        rate: $\dot\lambda$ [m/s], not negative.
        load, branch: as for a law. dilatancy: 0 to 1 [-].
    """
    normal, inverse = _reduced(load, dilatancy, branch)
    # Of the factors the magnitude's inverse is known last.
    factor = rate * inverse
    return FlowRate(
        normal=factor * normal,
        tangential=factor * (load.tangential / load.tangential_scale),
        rotational=factor * (load.rotational / load.rotational_scale),
    )


class AbstractFluidityFlow(AbstractFlow):
    r"""Flow of a size $\dot\lambda$ along `flow_direction`, with a fluidity."""

    gamma_v: Scalar = parameter(8.7, "m/s", "[0, inf)", "fluidity", usual=(0.0, 1e4))
    dilatancy: Scalar = parameter(
        0.0,
        "-",
        "[0, 1]",
        "dilatancy: fraction of the uplift of an associated flow rule",
    )

    @abc.abstractmethod
    def flow_size(self, load, hardening, foundation, branch) -> Scalar:
        r"""Size of flow $\dot\lambda$ [m/s], not negative."""

    def __call__(self, load, hardening, foundation, *, branch=None) -> FlowRate:
        rate = self.flow_size(load, hardening, foundation, branch)
        return displacement_rates(rate, load, self.dilatancy, branch=branch)


class Perzyna(AbstractFluidityFlow):
    r"""Flow in proportion to the overstress.

    $$ \dot\lambda = \gamma_v \Phi, \qquad \Phi = \max(\rho^*/\rho_c - 1, 0) $$

    and rates along the direction of flow (`displacement_rates`). The fluidity
    $\gamma_v$ is a velocity. Kinked at yield and at the onset of heave.

    Source: a reading; Perzyna (1963).
    """

    flows_below_yield = False

    def flow_size(self, load, hardening, foundation, branch) -> Scalar:
        return self.gamma_v * overstress(load.size, hardening, branch=branch)


class FluidityRate(AbstractFluidityFlow):
    r"""Perzyna's flow with a fluidity that is a rate [1/s], not a velocity.

    $$ \dot\lambda = \gamma_v B_t \Phi $$

    A named alternative. Of the paper's claims C01 to C33, 16 hold, 14 hold partly and 3
    fail with it (default: 17, 13, 3): C23 is won, C09 and C26 come nearer, C07 and C08
    are lost. With hardening per the root of the area (`HardeningPerRootArea`) 17, 14
    and 2.
    """

    flows_below_yield = False
    gamma_v: Scalar = parameter(8.7, "1/s", "[0, inf)", "fluidity", usual=(0.0, 1e4))

    def flow_size(self, load, hardening, foundation, branch) -> Scalar:
        rate = self.gamma_v * overstress(load.size, hardening, branch=branch)
        return foundation.length * rate


class PowerNucleus(AbstractFluidityFlow):
    r"""Flow at every load, by a power: a viscous nucleus without a threshold.

    $$ \dot\lambda = \gamma_v \left(\frac{\rho^*}{\rho_c}\right)^n $$

    A named alternative. Of the paper's claims C01 to C33, with n = 2, 15 hold, 15 hold
    partly and 3 fail (default: 17, 13, 3). Measured coefficients over the impact speed
    reject it: e_n rises with it where it falls (best fit to golf balls on turf, after
    Penner: rms 0.15, against 0.06 with the default).
    """

    nucleus_exponent: Scalar = parameter(2.0, "-", "[1, 20]", "n of the nucleus")

    def flow_size(self, load, hardening, foundation, branch) -> Scalar:
        nucleus = safe_power(load.size / hardening, self.nucleus_exponent)
        return self.gamma_v * nucleus


class PowerNucleusRate(AbstractFluidityFlow):
    r"""`PowerNucleus` with a fluidity that is a rate [1/s].

    $$ \dot\lambda = \gamma_v B_t \left(\frac{\rho^*}{\rho_c}\right)^n $$

    A named alternative. Of the paper's claims C01 to C33, with n = 2, 17 hold, 12 hold
    partly and 4 fail at `reference` (default: 17, 13, 3); with hardening per the root
    of the area (`HardeningPerRootArea`) 18, 13 and 2. Measured coefficients reject it
    as they do `PowerNucleus`.
    """

    gamma_v: Scalar = parameter(8.7, "1/s", "[0, inf)", "fluidity", usual=(0.0, 1e4))
    nucleus_exponent: Scalar = parameter(2.0, "-", "[1, 20]", "n of the nucleus")

    def flow_size(self, load, hardening, foundation, branch) -> Scalar:
        nucleus = safe_power(load.size / hardening, self.nucleus_exponent)
        return self.gamma_v * foundation.length * nucleus


class AbsoluteOverstress(AbstractFluidityFlow):
    r"""Perzyna's flow with an overstress that is not relative; to compare with.

    The nucleus is $\max(\rho^* - \rho_c, 0)$, not divided by $\rho_c$.

    Of the paper's claims C01 to C33, 14 hold, 13 hold partly and 6 fail with it
    (default: 17, 13, 3).
    """

    flows_below_yield = False

    def flow_size(self, load, hardening, foundation, branch) -> Scalar:
        nucleus = hardening * overstress(load.size, hardening, branch=branch)
        return self.gamma_v * nucleus


class SquaredOverstress(AbstractFluidityFlow):
    r"""Perzyna's flow with the overstress squared; a reading to compare with.

    The nucleus is $\max(\rho^*/\rho_c - 1, 0)^2$. All verdicts on the paper's claims
    C01 to C33 are the default's.
    """

    flows_below_yield = False

    def flow_size(self, load, hardening, foundation, branch) -> Scalar:
        nucleus = overstress(load.size, hardening, branch=branch) ** 2
        return self.gamma_v * nucleus

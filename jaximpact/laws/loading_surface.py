"""Loading surface of the macro-element: the size of a load, and the outward
gradient."""

import abc
from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp

from .._safe import TINY, positive_power
from .._types import Scalar
from ..parameters import Part, parameter
from ..shapes import Foundation

VERTEX_ROUNDING = 0.01
"""Rounding e of the vertex of the surface on the axis of pure normal load [-]."""
LARGEST_RATIO = 1e6
"""Tangential and moment loads count as at most so many times the normal load; at the
edge of toppling or slip they are of its order. Keeps powers of the ratio finite."""
TANGENT_FROM = 0.95
"""Value of w beyond which F is continued by its tangent [-]."""


class Forces(NamedTuple):
    """Forces of the ground on the block, as they enter the balance with minus signs."""

    normal: Scalar  # N [N], not negative (within a step, as its branch has it)
    tangential: Scalar  # T [N]
    moment: Scalar  # M [N m]


class Load(NamedTuple):
    r"""A dimensionless load $(\xi, h, m)$ and the outward gradient there.

    $\xi = N/V_M$; $h$ and $m$ are $T/V_M$ and $M/V_M$ over the two scales, by which the
    flow rule divides again: so $N \dot u_n + T \dot u_t + M \dot\theta$ is $V_M$ times
    load times direction.
    """

    size: Scalar
    """Size rho* of the surface through the load [-]."""
    normal: Scalar
    """Derivative of rho* with respect to xi [-]."""
    tangential: Scalar
    """Derivative of rho* with respect to h [-]."""
    rotational: Scalar
    """Derivative of rho* with respect to m [-]."""
    tangential_scale: Scalar
    r"""Scale mu of $h = T/(\mu V_M)$ [-]."""
    rotational_scale: Scalar
    r"""Scale psi B_t of $m = M/(\psi B_t V_M)$ [m]."""


class AbstractLoadingSurface(Part):
    """Size of a load, and the outward gradient there."""

    @abc.abstractmethod
    def __call__(
        self,
        forces: Forces,
        capacity: Scalar,
        foundation: Foundation,
        friction_slope: Scalar,
    ) -> Load:
        r"""Size of the surface through a load, and its gradient.

        Args:
            forces: of the ground; the normal one is not negative.
            capacity: $V_M$ [N], positive.
            foundation: its sizes are positive.
            friction_slope: $\tan\varphi_p$ [-].

        The size must be homogeneous of degree one in the forces, so that no flow gives
        energy.
        """

    def needs_ratios_alone(self) -> bool:
        """Tell whether forces and capacity may be given in any common unit: for the
        package's own surfaces. A class derived from one of them may depend on the
        forces otherwise."""
        return type(self) in OF_RATIOS


class NovaMontrasio(AbstractLoadingSurface):
    r"""The loading surface of Nova and Montrasio, its vertex rounded.

    $$ \xi = \frac{N}{V_M}, \quad h = \frac{T}{\mu V_M}, \quad
       m = \frac{M}{\psi B_t V_M}, \quad \mu = \tan\varphi_p $$
    $$ \eta = \sqrt{(h^2 + m^2)/\xi^2 + e^2} - e, \quad w = \eta^{1/\beta}, \quad
       \rho^* = \xi F(w), \quad F(w) = \frac{1}{1 - w}, $$

    so that $\rho^* = \rho_c$ is the surface
    $h^2 + m^2 = \xi^2 (1 - \xi/\rho_c)^{2\beta}$ with its vertex rounded. F goes on
    along its tangent beyond $w = 0.95$. $\rho^*$ is homogeneous of degree one, so that
    load times gradient is $\rho^* \ge 0$. $\xi$ below a millionth of the other two
    together counts as that.

    Continuous also as xi goes to zero and below. Smooth for `xi > 0` but for a jump of
    the second derivative at $w = 0.95$; at h = m = 0 the gradient is continuous for
    beta below 2.

    Source: a reading; Nova and Montrasio (1991), radial size measure after
    di Prisco and Vecchiotti (2006).
    """

    beta: Scalar = parameter(
        0.90, "-", "(0, 2)", "loading surface exponent", usual=(0.1, 1.2)
    )
    psi: Scalar = parameter(
        0.33, "-", "(0, inf)", "moment intercept", usual=(1e-2, 1e2)
    )
    rounding: float = eqx.field(default=VERTEX_ROUNDING, static=True)
    """Rounding e [-], positive; a choice of the method, no parameter."""

    def __call__(self, forces, capacity, foundation, friction_slope) -> Load:
        lever = self.psi * foundation.length
        # h / xi and m / xi do not depend on V_M.
        tangential = forces.tangential / friction_slope
        rotational = forces.moment / lever
        least = (jnp.abs(tangential) + jnp.abs(rotational)) / LARGEST_RATIO
        # The normal force is known last.
        divisor = jnp.maximum(forces.normal, jnp.maximum(least, TINY))
        h_ratio, m_ratio = tangential / divisor, rotational / divisor
        square = h_ratio**2 + m_ratio**2
        root = jnp.sqrt(square + self.rounding**2)
        # eta = root - e, without cancellation; TINY keeps the power's gradient finite
        # at 0
        eta = (square + TINY) / (root + self.rounding)
        w = positive_power(eta, 1.0 / self.beta)
        inside = jnp.minimum(w, TANGENT_FROM)
        inverse = 1.0 / (1.0 - inside)
        slope = inverse**2
        beyond = w - inside
        steepness = w / (self.beta * eta * root)  # w'(eta) / root
        # dF/d(ratio) / ratio
        common = slope * steepness
        return Load(
            size=divisor / capacity * (inverse + slope * beyond),
            normal=inverse + slope * (beyond - steepness * square),
            tangential=common * h_ratio,
            rotational=common * m_ratio,
            tangential_scale=friction_slope,
            rotational_scale=lever,
        )


class SharperVertex(NovaMontrasio):
    """The default surface with its vertex rounded by 0.001; a reading to compare with.

    All verdicts on the paper's claims C01 to C33 are the default's.
    """

    rounding: float = eqx.field(default=1e-3, static=True)


class BlunterVertex(NovaMontrasio):
    """The default surface with its vertex rounded by 0.1; a reading to compare with.

    Of the paper's claims C01 to C33, 16 hold, 14 hold partly and 3 fail with it
    (default: 17, 13, 3): C12 is lost.
    """

    rounding: float = eqx.field(default=0.1, static=True)


OF_RATIOS = (NovaMontrasio, SharperVertex, BlunterVertex)
"""Surfaces that depend on forces over capacity alone."""

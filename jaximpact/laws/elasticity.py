"""Springs of the ground under the equivalent foundation, and dashpots beside them."""

import abc
import functools
import operator
from typing import Any, ClassVar, NamedTuple

import jax.numpy as jnp
import numpy as np

from .._jax_internals import namespace_of
from .._safe import safe_power
from .._types import Scalar
from ..parameters import Part, parameter
from ..shapes import Foundation
from .branch import Branch

ATMOSPHERIC_PRESSURE = 100e3
"""Reference pressure p_a of Duncan and Chang [Pa]."""
LEAST_PRESSED = 1e-6
"""Elastic displacement over r_0 below which a modulus does not fall with it."""


class Stiffness(NamedTuple):
    """Stiffness of the foundation on the half-space."""

    normal: Scalar  # k_n [N/m]
    tangential: Scalar  # k_t [N/m]
    rotational: Scalar  # k_r [N m/rad]


class FactoredStiffness(Stiffness):
    """Stiffness that is a modulus times what the shape of the foundation gives.

    Ratios of the forces do not depend on the modulus, a power, and need not wait for
    it. A law that changes the stiffness, by `_replace` or `jax.tree.map`, leaves the
    two factors behind.
    """

    modulus: Any = None
    """The modulus E, or its product with a factor [Pa]."""
    at_one: Any = None
    """The stiffness over the modulus."""

    @classmethod
    def of(cls, modulus: Scalar, at_one: Stiffness) -> "FactoredStiffness":
        stiffness = cls(*(modulus * value for value in at_one))
        stiffness.modulus, stiffness.at_one = modulus, at_one
        return stiffness


def shape_factor(shape_ratio: Scalar) -> Scalar:
    r"""Correction of the normal stiffness for an oblong foundation.

    $$ J_s = 0.957 \exp(0.0394 R_s), \qquad R_s = \max(B_t, B_w)/\min(B_t, B_w) $$

    Source: Dattola et al. (2023), appendix C, from values of Gazetas (1983). At
    $R_s = 1$ it is 0.9955, not 1: the paper's interpolation, kept.
    """
    return 0.957 * jnp.exp(0.0394 * shape_ratio)


class AbstractElasticity(Part):
    """Elastic springs between block and ground."""

    @abc.abstractmethod
    def __call__(
        self,
        foundation: Foundation,
        unit_weight_normal: Scalar,
        elastic_normal: Scalar,
        *,
        branch: Branch | None = None,
    ) -> Stiffness:
        r"""Secant stiffness: force over elastic displacement.

        Args:
            foundation: its sizes are positive.
            unit_weight_normal: $\gamma_n = \gamma \cos\omega$ [N/m3].
            elastic_normal: $u^{ed}_n$ [m]; may be negative within a step.
            branch: the sides taken at switches, if not those where the state is.
        """


def footing_stiffness(
    modulus: Scalar,
    S_ef: Scalar,
    poisson: Scalar,
    foundation: Foundation,
    branch: Branch | None,
) -> FactoredStiffness:
    r"""Stiffness of a circular footing of equal area on a half-space.

    $$ r_0 = \tfrac12\sqrt{B_t B_w}, \quad G = S_{ef} \frac{E}{2 (1 + \nu)}, \quad
       k_n = J_s \frac{4 G r_0}{1 - \nu}, \quad k_t = \frac{8 G r_0}{2 - \nu}, \quad
       k_r = \frac{8 G r_0^3}{3 (1 - \nu)} $$

    Args:
        modulus: $E$ [Pa].
        S_ef, poisson: $S_{ef}$ and $\nu$ [-].
        foundation, branch: as for a law.

    $R_s$ counts no further than the foundation's `most_slender`: a block straight out
    of the plane of motion touches along a line, where the exponential of $R_s$ has lost
    its meaning, and overflows.

    Smooth except there and at $B_t = B_w$, where the shape ratio has a kink; the
    derivative there is that of $B_t < B_w$. Source: a reading; Gazetas (1983).
    """
    length, width = foundation.length, foundation.width
    radius = equal_area_radius(foundation)
    ratio = length / width
    oblong = ratio > 1.0 if branch is None else branch.oblong
    shape_ratio = jnp.where(oblong, ratio, 1.0 / ratio)
    if foundation.most_slender is not None:
        shape_ratio = jnp.minimum(shape_ratio, foundation.most_slender)
    shear = S_ef / (2.0 * (1.0 + poisson))  # G / E
    at_one = Stiffness(
        normal=4.0 * shear / (1.0 - poisson) * radius * shape_factor(shape_ratio),
        tangential=8.0 * shear / (2.0 - poisson) * radius,
        rotational=8.0 * shear / (3.0 * (1.0 - poisson)) * radius**3,
    )
    return FactoredStiffness.of(modulus, at_one)


def equal_area_radius(foundation: Foundation) -> Scalar:
    """Radius r_0 of a circle of the foundation's area [m]."""
    return 0.5 * jnp.sqrt(foundation.length * foundation.width)


class AbstractFootingSprings(AbstractElasticity):
    """Springs of `footing_stiffness`, with a modulus by number and exponent."""

    k_E: Scalar = parameter(900.0, "-", "(0, inf)", "modulus number", usual=(1.0, 1e6))
    n_E: Scalar = parameter(0.40, "-", "[0, 2]", "modulus exponent")
    poisson: Scalar = parameter(0.30, "-", "[0, 0.5]", "Poisson's ratio")
    S_ef: Scalar = parameter(
        1.0, "-", "(0, inf)", "factor on the modulus", usual=(1e-3, 1e3)
    )


class DuncanChang(AbstractFootingSprings):
    r"""Modulus taken at one radius' depth.

    $$ E = k_E\, p_a (\gamma_n r_0/p_a)^{n_E} $$

    and the springs of `footing_stiffness`.

    Source: a reading. Stiffness: Gazetas (1983); modulus: Duncan and Chang (1970).
    Dattola et al. (2023) print only $J_s$ and name the parameters.
    """

    def __call__(self, foundation, unit_weight_normal, elastic_normal, *, branch=None):
        # The power of the square, which needs no root.
        per_radius = unit_weight_normal / ATMOSPHERIC_PRESSURE
        square = 0.25 * per_radius**2 * (foundation.length * foundation.width)
        modulus = self.k_E * ATMOSPHERIC_PRESSURE
        modulus *= safe_power(square, 0.5 * self.n_E)
        return footing_stiffness(modulus, self.S_ef, self.poisson, foundation, branch)


class ContactPressureModulus(AbstractFootingSprings):
    r"""Modulus taken at the contact pressure $N/A$ in place of the depth $r_0$.

    $$ E = k_E\, p_a \left(\frac{N}{A\,p_a}\right)^{n_E}, \qquad
       A = \tfrac{\pi}{4} B_t B_w $$

    With $N = k_n u^{ed}_n$ this is an equation for $N$:
    $k_n = K (N/(A p_a))^{n_E}$ with $K$ the stiffness at $E = k_E p_a$, so that

    $$ \frac{N}{A p_a} = \left(\frac{K |u^{ed}_n|}{A p_a}\right)^{1/(1 - n_E)} . $$

    Springs that stiffen as they are pressed; the exponent is below 1. Not smooth at
    $u^{ed}_n = 0$, where the stiffness is taken as that at a millionth of $r_0$.

    A named alternative. Of the paper's claims C01 to C33, 16 hold, 14 hold partly and 3
    fail with it (default: 17, 13, 3): C23 is won, C10 and C16 are lost. The only one
    with which e_n falls with the impact speed about as measured (best fit to golf balls
    on turf, after Penner: rms 0.039, against 0.062 with the default).
    """

    n_E: Scalar = parameter(0.40, "-", "[0, 0.9]", "modulus exponent")

    def __call__(self, foundation, unit_weight_normal, elastic_normal, *, branch=None):
        radius = equal_area_radius(foundation)
        modulus = self.k_E * ATMOSPHERIC_PRESSURE
        first = footing_stiffness(modulus, self.S_ef, self.poisson, foundation, branch)
        area = 0.25 * jnp.pi * foundation.length * foundation.width
        pressed = jnp.maximum(jnp.abs(elastic_normal), LEAST_PRESSED * radius)
        relative = first.normal * pressed / (area * ATMOSPHERIC_PRESSURE)
        factor = safe_power(relative, self.n_E / (1.0 - self.n_E))
        return FactoredStiffness.of(modulus * factor, first.at_one)


class Damping(NamedTuple):
    """Dashpot coefficients."""

    normal: Scalar  # c_n [N s/m]
    tangential: Scalar  # c_t [N s/m]
    rotational: Scalar  # c_r [N m s/rad]


class AbstractDamping(Part):
    """Dashpots beside the springs."""

    @abc.abstractmethod
    def __call__(self, stiffness: Stiffness, mass: Scalar, inertia: Scalar) -> Damping:
        """Dashpot coefficients.

        Args:
            stiffness: of the foundation at this moment.
            mass: $m$ [kg]. inertia: $I$ [kg m2].
        """

    statements: ClassVar = {"acts": ("__call__",)}

    def acts(self) -> tuple[Any, Any]:
        """Tell whether the normal dashpot may act, and whether any may: where none
        does, forces follow from the springs alone, which costs less. For arrays of
        NumPy, and of JAX while it traces; NaN, which stands for a value that is not
        known, counts as one that acts."""
        return np.asarray(True), np.asarray(True)


class DampingRatios(AbstractDamping):
    r"""Dashpot coefficients from damping ratios; 0 switches a dashpot off.

    $$ c_n = 2 \eta_N \sqrt{k_n m}, \quad c_t = 2 \eta_T \sqrt{k_t m}, \quad
       c_r = 2 \eta_R \sqrt{k_r I} $$

    Source: a reading; the paper gives the three ratios, all zero in Table 1.
    """

    eta_N: Scalar = parameter(
        0.0, "-", "[0, inf)", "damping ratio, normal", usual=(0.0, 10.0)
    )
    eta_T: Scalar = parameter(
        0.0, "-", "[0, inf)", "damping ratio, tangential", usual=(0.0, 10.0)
    )
    eta_R: Scalar = parameter(
        0.0, "-", "[0, inf)", "damping ratio, rotational", usual=(0.0, 10.0)
    )

    def __call__(self, stiffness, mass, inertia) -> Damping:
        return Damping(
            normal=2.0 * self.eta_N * jnp.sqrt(stiffness.normal * mass),
            tangential=2.0 * self.eta_T * jnp.sqrt(stiffness.tangential * mass),
            rotational=2.0 * self.eta_R * jnp.sqrt(stiffness.rotational * inertia),
        )

    def acts(self) -> tuple[Any, Any]:
        normal, *others = (
            ~(namespace_of(ratio).asarray(ratio) <= 0.0)
            for ratio in (self.eta_N, self.eta_T, self.eta_R)
        )
        return normal, functools.reduce(operator.or_, others, normal)

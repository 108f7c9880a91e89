"""Dashpots beside the elastic springs."""

import abc
import functools
import operator
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np

from .._jax_internals import namespace_of
from .._types import Scalar
from ..parameters import Part, parameter
from .elasticity import Stiffness


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

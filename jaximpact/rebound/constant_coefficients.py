"""Coefficients of restitution that nothing changes."""

import equinox as eqx
from jaxtyping import Array, Float

from ..block import Block
from ..parameters import Parameters
from ..precision import float64_leaf
from ..scene import Impact
from .velocities import Rebound

Scalar = Float[Array, ""]


class ConstantCoefficients(Parameters):
    r"""$v_n' = -e_n v_n$, $v_t' = e_t v_t$; the rotation stays as it is."""

    e_n: Scalar = eqx.field(converter=float64_leaf)
    e_t: Scalar = eqx.field(converter=float64_leaf)

    def __call__(self, block: Block, impact: Impact) -> Rebound:
        """Velocities after."""
        return Rebound(
            -self.e_n * impact.normal_velocity,
            self.e_t * impact.tangential_velocity,
            impact.angular_velocity,
        )

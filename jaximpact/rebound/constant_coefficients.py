"""Coefficients of restitution that nothing changes."""

from typing import ClassVar

from jaxtyping import Array, Float

from ..block import Block
from ..parameters import parameter
from ..scene import Impact
from .base import AbstractRebound
from .velocities import Rebound

Scalar = Float[Array, ""]


class ConstantCoefficients(AbstractRebound):
    r"""$v_n' = -e_n v_n$, $v_t' = e_t v_t$; the rotation stays as it is."""

    words: ClassVar[str] = "constant coefficients"

    e_n: Scalar = parameter(None, "-", "[0, 1]", "normal restitution")
    e_t: Scalar = parameter(None, "-", "[0, 1]", "tangential restitution")

    def __call__(self, block: Block, impact: Impact) -> Rebound:
        """Velocities after."""
        return Rebound(
            -self.e_n * impact.normal_velocity,
            self.e_t * impact.tangential_velocity,
            impact.angular_velocity,
        )

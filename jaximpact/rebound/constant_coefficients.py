"""Rebound by constant coefficients of restitution."""

from typing import ClassVar

from .._types import Scalar
from ..parameters import parameter
from ..scene import Block, Impact
from .base import AbstractRebound, Rebound


class ConstantCoefficients(AbstractRebound):
    r"""Rebound by constant coefficients, in which the rotation stays as it is.

    $$ v_n' = -e_n v_n, \qquad v_t' = e_t v_t $$

    Smooth. Source: the common practice of rockfall programs.
    """

    words: ClassVar[str] = "constant coefficients"

    e_n: Scalar = parameter(None, "-", "[0, 1]", "normal restitution")
    e_t: Scalar = parameter(None, "-", "[0, 1]", "tangential restitution")

    def __call__(self, block: Block, impact: Impact) -> Rebound:
        """Velocities after the impact."""
        return Rebound(
            -self.e_n * impact.normal_velocity,
            self.e_t * impact.tangential_velocity,
            impact.angular_velocity,
        )

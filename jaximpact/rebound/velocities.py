"""What a rebound law gives."""

from typing import NamedTuple

from jaxtyping import Array, Float

from ..restitution import defined_ratio
from ..scene import Impact

Scalar = Float[Array, ""]


class Rebound(NamedTuple):
    """Velocities after an impact: of the centre of mass [m/s], of rotation [rad/s]."""

    normal_velocity: Scalar
    tangential_velocity: Scalar
    angular_velocity: Scalar

    def e_n(self, impact: Impact) -> Scalar:
        """Apparent normal coefficient of restitution; NaN without normal velocity."""
        return -defined_ratio(self.normal_velocity, impact.normal_velocity)

    def e_t(self, impact: Impact) -> Scalar:
        """Apparent tangential coefficient; NaN without tangential velocity."""
        return defined_ratio(self.tangential_velocity, impact.tangential_velocity)

"""Plastic slider: friction between block and ground."""

import abc

import equinox as eqx
import jax.numpy as jnp

from .._types import Scalar
from ..parameters import Part, parameter
from .branch import Branch

RELAXATION_TIME = 1e-6
"""Time tau_s of the Duvaut-Lions regularisation [s]; contacts last 1e-4 s and more."""


class AbstractSlider(Part):
    """Slip between block and ground."""

    @abc.abstractmethod
    def friction(self, friction_angle: Scalar) -> Scalar:
        r"""Friction coefficient $\tan\varphi_b$ between block and ground [-], at which
        slip sets in.

        Args:
            friction_angle: $\varphi'$ of the ground [rad].
        """

    @abc.abstractmethod
    def __call__(
        self,
        tangential_force: Scalar,
        normal_force: Scalar,
        tangential_stiffness: Scalar,
        friction: Scalar,
        *,
        branch: Branch | None = None,
    ) -> Scalar:
        r"""Rate of slip $\dot u_t^{ps}$ [m/s], of the sign of T.

        Args:
            tangential_force: $T$ [N]. normal_force: $N \ge 0$ [N].
            tangential_stiffness: $k_t$ [N/m], positive.
            friction: $\tan\varphi_b$ [-], from `friction`.
            branch: whether it slips, if not as the forces have it.
        """


class Coulomb(AbstractSlider):
    r"""Coulomb's friction, in the regularisation of Duvaut and Lions.

    $$ \dot u_t^{ps} = \mathrm{sign}(T)
       \frac{\max(|T| - N\tan\varphi_b, 0)}{k_t \tau_s}, \qquad
       \tan\varphi_b = \alpha_s \tan\varphi' $$

    Kinked at the onset of slip, smooth at T = 0 (for N > 0).

    Source: a reading of the paper's slider, whose consistency conditions
    ($f \le 0$, $\lambda \ge 0$, $f\lambda = 0$) hold as tau_s goes to 0, and of
    $\alpha_s$, which Table 1 leaves blank.
    """

    alpha_s: Scalar = parameter(
        1.0, "-", "[0, inf)", "block-soil over soil friction", usual=(0.0, 10.0)
    )
    relaxation_time: float = eqx.field(default=RELAXATION_TIME, static=True)
    """Relaxation time tau_s [s]; a choice of the method, no parameter."""

    def friction(self, friction_angle) -> Scalar:
        return self.alpha_s * jnp.tan(friction_angle)

    def __call__(
        self,
        tangential_force,
        normal_force,
        tangential_stiffness,
        friction,
        *,
        branch=None,
    ) -> Scalar:
        limit = normal_force * friction
        down, up = tangential_force - limit, tangential_force + limit
        slips_down = down > 0.0 if branch is None else branch.slips_down
        slips_up = up < 0.0 if branch is None else branch.slips_up
        excess = jnp.where(slips_down, down, jnp.where(slips_up, up, 0.0))
        return excess / (tangential_stiffness * self.relaxation_time)

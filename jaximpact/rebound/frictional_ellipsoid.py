"""A rigid ellipse and an impulse with Coulomb friction."""

from typing import ClassVar

import jax.numpy as jnp

from .._types import Scalar
from ..parameters import parameter
from ..scene import Block, Impact
from .base import AbstractRebound, Rebound, contact_point, rebound_of_impulse


class FrictionalEllipsoid(AbstractRebound):
    r"""An impulse with Coulomb friction at the deepest point of a rigid ellipse.

    As the normal impulse $N$ grows, the velocities of approach $\dot n$ and of slip
    $\dot t$ of the contact point change with the impulses (Routh's method):

    $$ d\dot n = -A\,dN + C\,dT, \qquad d\dot t = C\,dN - B\,dT $$

    $$ A = \frac1m + \frac{r_t^2}{I}, \qquad B = \frac1m + \frac{r_n^2}{I}, \qquad
       C = \frac{r_n r_t}{I} $$

    While the point slips, $dT = \mu\,\mathrm{sign}(\dot t)\,dN$. If the slip dies, at

    $$ N_s = \frac{\lvert\dot t_0\rvert}{\mu B - C\,\mathrm{sign}(\dot t_0)}, $$

    it goes on with $dT = \mathrm{clip}(C/B, -\mu, \mu)\,dN$: the point sticks where
    friction can hold it and slips the other way where it cannot. Compression ends at
    $N_c$, where $\dot n = 0$, and by Poisson's hypothesis the impact ends at
    $N = (1 + e^*) N_c$.

    Energy is never made for $e^*$ in [0, 1] and $\mu \ge 0$, which with Newton's
    hypothesis would not be so. For $\mu = 0$ this is `RigidEllipsoid`, and both
    hypotheses are one; for $e^* = 0$ and ever larger $\mu$ it tends to `BozzoloPamini`
    wherever the normal impulse of that law is not negative. With friction $e^*$ is a
    ratio of impulses, and not of the velocities at the contact.

    Continuous; kinks where the kind of contact changes. A contact point that moves away
    gets no impulse. $\mu$ must be finite.

    Source: Routh, Dynamics of a System of Rigid Bodies; Wang and Mason (1992), J. Appl.
    Mech. 59(3), 635-642, who show that Poisson's hypothesis makes no energy.
    """

    words: ClassVar[str] = "frictional ellipsoid"

    e_contact: Scalar = parameter(
        None, "-", "[0, 1]", "normal restitution at the contact"
    )
    """Impulse of restitution over that of compression, $e^*$ [-]."""
    friction_coefficient: Scalar = parameter(
        None, "-", "[0, 100]", "coefficient of friction"
    )
    r"""Coefficient of friction $\mu$ [-]."""

    def __call__(self, block: Block, impact: Impact) -> Rebound:
        """Velocities after the impact."""
        point = contact_point(block, impact)
        friction, inertia = self.friction_coefficient, block.inertia
        normal = 1.0 / block.mass + point.tangential_arm**2 / inertia
        tangential = 1.0 / block.mass + point.normal_arm**2 / inertia
        coupling = point.normal_arm * point.tangential_arm / inertia
        approach = jnp.maximum(point.normal_velocity, 0.0)
        slip = point.tangential_velocity
        forward = jnp.sign(slip)

        # Two ratios dT/dN: while the first slip lasts, and after it. A slip that never
        # dies has one ratio: the first phase may as well be of no length.
        slipping = friction * forward
        after_slip = jnp.clip(coupling / tangential, -friction, friction)
        braking = friction * tangential - coupling * forward
        dies = braking > 0.0
        slip_end = jnp.where(dies, jnp.abs(slip) / jnp.where(dies, braking, 1.0), 0.0)

        compressing = normal - coupling * slipping
        left = approach - compressing * slip_end
        # Then `compressing` is positive. `compressing_after` always is: A B > C^2.
        while_slipping = left < 0.0
        compressing_after = normal - coupling * after_slip
        compression = jnp.where(
            while_slipping,
            approach / jnp.where(while_slipping, compressing, 1.0),
            slip_end + left / compressing_after,
        )
        # Without approach there is no impulse, whatever the slip.
        compression = jnp.where(approach > 0.0, compression, 0.0)

        normal_impulse = (1.0 + self.e_contact) * compression
        slipped = jnp.minimum(normal_impulse, slip_end)
        tangential_impulse = slipping * slipped + after_slip * (
            normal_impulse - slipped
        )
        return rebound_of_impulse(
            block, impact, point, normal_impulse, tangential_impulse
        )

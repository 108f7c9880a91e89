"""The laws of rebound: by coefficients, and by impulses on a rigid ellipse."""

from typing import ClassVar

import jax.numpy as jnp

from .._types import Scalar
from ..parameters import parameter
from ..restitution import defined_root
from ..scene import Block, Impact
from ..units import DEGREE
from .base import AbstractRebound, Rebound, contact_point, rebound_of_impulse

HALFWAY = 45.0 * DEGREE
"""Angle from the surface at which the coefficient is the law's own parameter [rad]."""
LEAST = 1.0 * DEGREE
"""Angle from the surface below which the coefficient no longer grows [rad]."""


class AnglePowerLaw(AbstractRebound):
    r"""Rebound by a power law in the impact angle, as fits to field tests have it.

    $$ v_n' = -e_{45} \left(\frac{\theta}{45^\circ}\right)^{-k} v_n, \qquad
       v_t' = e_t v_t, \qquad \theta = \max(90^\circ - |\theta^{in}|, 1^\circ) $$

    with $\theta$ the angle between velocity and surface. The rotation stays as it is.
    At grazing angles $e_n$ may exceed 1, as measured, so that energy may be made.
    Continuous; a kink at $\theta = 1^\circ$, below which $e_n$ is constant.

    Source: $e_n = 19.5\,\theta^{-1.03}$ with $\theta$ in degrees, a fit to field tests
    attributed to Wyllie (2014), is $e_{45} = 0.387$ and $k = 1.03$.
    """

    words: ClassVar[str] = "power law in the angle"

    e_45: Scalar = parameter(None, "-", "[0, 2]", "normal restitution at 45 degrees")
    angle_exponent: Scalar = parameter(
        None, "-", "[-1, 3]", "exponent by which e_n falls with the angle"
    )
    e_t: Scalar = parameter(None, "-", "[0, 1]", "tangential restitution")

    def __call__(self, block: Block, impact: Impact) -> Rebound:
        """Velocities after the impact."""
        steepness = jnp.maximum(0.5 * jnp.pi - jnp.abs(impact.angle), LEAST)
        e_n = self.e_45 * (steepness / HALFWAY) ** -self.angle_exponent
        return Rebound(
            -e_n * impact.normal_velocity,
            self.e_t * impact.tangential_velocity,
            impact.angular_velocity,
        )


class BozzoloPamini(AbstractRebound):
    r"""Rotation about the contact point, after Bozzolo and Pamini (1986).

    The contact point sticks; the block turns rigidly about it, with the angular
    momentum that it had about it:

    $$ \Omega' = \frac{I\Omega + m (r_n v_t - r_t v_n)}{I + m (r_n^2 + r_t^2)}, \qquad
       v_n' = -r_t\Omega', \qquad v_t' = r_n\Omega' $$

    with $r_n$, $r_t$ the arms of the ellipse's deepest point. No parameters; $e^* = 0$.
    Energy is never made. A contact point that moves away changes nothing, with a jump
    between the two. Elsewhere smooth.

    Nothing asks for a ground that pushes: the impulse $m (v_n - v_n')$ may be negative,
    when a block is held back that would roll over its contact point. And the centre may
    move into the ground afterwards, $r_t\Omega' < 0$.

    Source: Bozzolo and Pamini (1986), Acta Mechanica 63, 113-130, as described by
    Dattola et al. (2023), section 4.2; the equations follow from its two conditions.
    Losses at the contact, which later programs put on top, are not in it.
    """

    words: ClassVar[str] = "Bozzolo and Pamini"

    def __call__(self, block: Block, impact: Impact) -> Rebound:
        """Velocities after the impact."""
        point = contact_point(block, impact)
        mass, inertia = block.mass, block.inertia
        normal_arm, tangential_arm = point.normal_arm, point.tangential_arm
        momentum = inertia * impact.angular_velocity + mass * (
            normal_arm * impact.tangential_velocity
            - tangential_arm * impact.normal_velocity
        )
        spin = momentum / (inertia + mass * (normal_arm**2 + tangential_arm**2))
        away = point.normal_velocity <= 0.0  # not where it is NaN
        return Rebound(
            jnp.where(away, impact.normal_velocity, -tangential_arm * spin),
            jnp.where(away, impact.tangential_velocity, normal_arm * spin),
            jnp.where(away, impact.angular_velocity, spin),
        )


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
    friction_coefficient: Scalar = parameter(
        None, "-", "[0, 100]", "coefficient of friction"
    )

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
        compression = jnp.where(approach <= 0.0, 0.0, compression)

        normal_impulse = (1.0 + self.e_contact) * compression
        slipped = jnp.minimum(normal_impulse, slip_end)
        tangential_impulse = slipping * slipped + after_slip * (
            normal_impulse - slipped
        )
        return rebound_of_impulse(
            block, impact, point, normal_impulse, tangential_impulse
        )


FOOT = 0.3048
"""Length of a foot [m]."""


class PfeifferBowen(AbstractRebound):
    r"""Rebound by coefficients that fall with speed, after Pfeiffer and Bowen (1989).

    $$ v_n' = -\frac{R_n v_n}{1 + (v_n/9.144)^2}, \qquad
       v_t'^2 = \frac{R^2 (I\Omega^2 + m v_t^2)\, f\, s}{I + m R^2} $$

    $$ f = R_t + \frac{1 - R_t}{1.2 + ((v_t - \Omega R)/6.096)^2}, \qquad
       s = \frac{R_t}{1 + (v_n/(76.2\,R_n))^2} $$

    and the block rolls away without slip, $\Omega' = v_t'/R$, in the direction in which
    it came (its direction of rotation if it came along the normal). The speeds are 30,
    20 and 250 feet a second, in m/s. $R$ is the semi-axis of the block's minor axis:
    the law is one of spheres. It jumps where $v_t$ changes its sign while the block
    spins, as the block leaves the way it came; a kink where $\Omega$ is zero too.

    Source: Pfeiffer and Bowen (1989), Bull. Assoc. Eng. Geol. 26(1), 135-146, in which
    speeds are in feet a second.
    """

    words: ClassVar[str] = "Pfeiffer and Bowen"

    normal_coefficient: Scalar = parameter(
        None, "-", "[1e-6, 1]", "normal restitution at low speed"
    )
    tangential_coefficient: Scalar = parameter(
        None, "-", "[0, 1]", "tangential restitution"
    )

    def __call__(self, block: Block, impact: Impact) -> Rebound:
        """Velocities after the impact."""
        r_n, r_t = self.normal_coefficient, self.tangential_coefficient
        v_n, v_t = impact.normal_velocity, impact.tangential_velocity
        radius, inertia = block.semi_axes.minor, block.inertia
        spin = impact.angular_velocity
        slip = (v_t - spin * radius) / (20.0 * FOOT)
        friction = r_t + (1.0 - r_t) / (1.2 + slip**2)
        scaling = r_t / (1.0 + (v_n / (250.0 * FOOT * r_n)) ** 2)
        energy = inertia * spin**2 + block.mass * v_t**2
        speed = defined_root(
            radius**2 * energy * friction * scaling / (inertia + block.mass * radius**2)
        )
        forward = jnp.where(v_t == 0.0, spin, v_t) >= 0.0
        tangential = jnp.where(forward, speed, -speed)
        normal = -r_n * v_n / (1.0 + (v_n / (30.0 * FOOT)) ** 2)
        return Rebound(normal, tangential, tangential / radius)


class RigidEllipsoid(AbstractRebound):
    r"""Rebound of a rigid ellipse by an instantaneous impulse along the normal.

    The impulse acts at the deepest point, after Vijayakumar et al. (2012).

    $$ N = (1 + e^\ast)\,\frac{m I}{I + m r_t^2}\,(v_n + r_t\Omega), \qquad
       v_n' = v_n - \frac{N}{m}, \qquad \Omega' = \Omega - \frac{N r_t}{I} $$

    with $r_t$ the arm of the deepest point; $v_t$ stays as it is: no friction. The
    velocity of approach at the contact is turned round and multiplied by $e^\ast$. A
    contact point that moves away gets no impulse; a kink between the two.
    """

    words: ClassVar[str] = "rigid ellipsoid"

    e_contact: Scalar = parameter(
        None, "-", "[0, 1]", "normal restitution at the contact"
    )

    def __call__(self, block: Block, impact: Impact) -> Rebound:
        """Velocities after the impact."""
        point = contact_point(block, impact)
        arm, mass, inertia = point.tangential_arm, block.mass, block.inertia
        normal = (
            (1.0 + self.e_contact)
            * (mass * inertia / (inertia + mass * arm**2))
            * jnp.maximum(point.normal_velocity, 0.0)
        )
        return rebound_of_impulse(block, impact, point, normal)

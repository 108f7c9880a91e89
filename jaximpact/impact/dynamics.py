r"""Equations of motion: the one place where laws and forces come together.

The block obeys, with the foundation's forces N, T and moment M,

$$ m \dot v_n = m g \cos\omega - N, \quad m \dot v_t = m g \sin\omega - T, \quad
   I \dot\Omega = T r_n - N r_t - M . $$

Elastic, visco-plastic and slider displacements add up to the contact's:

$$ \dot u_n^{ed} = v_n + T_{low}\Omega - \dot u_n^{vp}, \quad
   \dot u_t^{ed} = v_t - r_n\Omega - \dot u_t^{vp} - \dot u_t^{ps}, \quad
   \dot\theta^{ed} = \Omega - \dot\theta^{vp} . $$

The elastic displacements are the unknowns, not the visco-plastic ones that the paper
integrates: the two differ by a geometric identity ($u_D - u^{ed}_n = u_n^{vp}$ and so
on), but forces follow from elastic displacements a hundred times smaller than the
sinking, and the error control should see them.

Source: Dattola et al. (2023), appendix B. Departures: the contact's tangential
displacement is in rate form, because the block may turn a lot; the paper prints
$u_t - r_n\theta$.
"""

from typing import Any, Literal, NamedTuple

import jax
import jax.numpy as jnp

from .._types import Flag, Scalar
from ..laws import Branch, FlowRate, Forces, Load, Stiffness
from ..laws.elasticity import FactoredStiffness
from ..scene import GRAVITY, Scene, Soil
from ..shapes import AbstractShape, Foundation, SemiAxes, foundation

INITIAL_SINKING = 1e-6
"""Penetration at the start of the integration, as a fraction of the semi-axis R."""
SMALLEST_FOUNDATION = 1e-6
"""Sizes of the foundation are not taken below this part of R, so that the laws stay
finite where the solver probes a state out of contact; at the least sinking of a
contact, 0.5e-6 R, the foundation is a thousand times larger."""


class Motion(NamedTuple):
    """State of the block and of the ground, the unknowns of the impact."""

    penetration: Scalar  # u_n [m]
    rotation: Scalar  # theta [rad], since impact
    normal_velocity: Scalar  # v_n [m/s]
    tangential_velocity: Scalar  # v_t [m/s]
    angular_velocity: Scalar  # Omega [rad/s]
    elastic_normal: Scalar  # u_ed,n [m]
    elastic_tangential: Scalar  # u_ed,t [m]
    elastic_rotation: Scalar  # theta_ed [rad]
    hardening: Scalar  # rho_c [-]


FORCE_RELAXATION = (1e-10, 1e-10, 1e-8)
"""Relaxation times of N, T and M with dashpots, as parts of the time in which the block
moves by its size. Smaller ones are lost in the rounding of time where forces jump;
larger ones are seen in the results. With a moment as quick as the other two, forces
oscillate more often, with no stable state to go to."""
STALLED_STEPS = 50
"""Steps without progress at the onset after which forces relax otherwise."""
STALLED_RELAXATION = ((1.0, 0.1), (1e1, 0.1), (1e2, 0.1), (1e3, 0.1), (1e4, 0.1))
"""Factors of all relaxation times, and further of that of the tangential force, after
one to five times `STALLED_STEPS`. At the onset, while the foundation is almost zero,
forces may oscillate for ever about a state that is not stable at other factors. Longer
times are not seen in the results there: the impulse of the forces is still almost
zero."""


class Work(NamedTuple):
    """Works that the energy ledger is made of (rates in W, or their integrals in J).

    `arm` is no dissipation: the printed equations imply it. The normal force acts at
    the foundation's centre, while sinking is measured at the tangency point.
    """

    gravity: Scalar
    viscoplastic: Scalar
    slider: Scalar
    dashpot: Scalar
    arm: Scalar
    springs: Scalar
    """Work on the springs. What they hold at the start, and what they gain as the
    foundation's size changes their stiffness, is not in it: the rate of that has a
    sharp peak where a foundation vanishes under load."""


ARM = "arm"
LedgerItems = bool | Literal["arm"]
"""Items of the ledger that an impact keeps: all, none, or the arm work alone, which
costs next to nothing."""


class ImpactConstants(NamedTuple):
    """Constants of the laws and the balance, worked out once an impact."""

    soil: Soil
    shape: AbstractShape
    axes: SemiAxes
    mass: Scalar
    inertia: Scalar
    sin_start: Scalar  # of theta_0
    cos_start: Scalar
    start_side: Flag | None  # of theta_0, for a shape with flat faces
    gravity_normal: Scalar  # g cos(omega) [m/s2]
    gravity_tangential: Scalar  # g sin(omega) [m/s2]
    unit_weight_normal: Scalar  # gamma cos(omega) [N/m3]
    friction_slope: Scalar  # mu = tan(phi_p) [-]
    bearing_factors: Any  # of the law of bearing
    slider_friction: Scalar  # tan(phi_b) [-]


def prepare(scene: Scene) -> ImpactConstants:
    """Work out the constants of one impact."""
    block, soil, impact = scene.block, scene.soil, scene.impact
    axes = block.semi_axes
    sin, cos = jnp.sin(impact.orientation), jnp.cos(impact.orientation)
    cos_slope = jnp.cos(impact.slope)
    friction = soil.peak_friction(soil.friction_angle, soil.relative_density)
    start_side = None
    if block.shape.side_of(sin, cos) is not None:
        # Without spin, friction turns the block.
        spin = impact.angular_velocity
        turning = jnp.where(spin == 0.0, impact.tangential_velocity, spin)
        start_side, _ = block.shape.side_towards(sin, cos, turning)
    return ImpactConstants(
        soil=soil,
        shape=block.shape,
        axes=axes,
        mass=block.mass,
        inertia=block.inertia,
        sin_start=sin,
        cos_start=cos,
        start_side=start_side,
        gravity_normal=GRAVITY * cos_slope,
        gravity_tangential=GRAVITY * jnp.sin(impact.slope),
        unit_weight_normal=soil.unit_weight * cos_slope,
        friction_slope=jnp.tan(friction),
        bearing_factors=soil.bearing.factors(friction),
        slider_friction=soil.slider.friction(soil.friction_angle),
    )


class Contact(NamedTuple):
    """Foundation, forces and flow at one moment."""

    foundation: Foundation
    stiffness: Stiffness
    forces: Forces
    normal_force_before_cut: Scalar
    """Normal force N before it is cut off at zero [N], for the end of contact."""
    elastic_forces: Forces
    """Forces that the springs carry; the normal one may be negative."""
    approach: tuple[Scalar, Scalar, Scalar]
    """Velocities at which the block presses on the ground: sinking, sliding,
    turning."""
    load: Load
    flow: FlowRate
    slip: Scalar
    hardening_rate: Scalar
    elastic_rates: tuple[Scalar, Scalar, Scalar]
    """Rates of the elastic displacements: normal, tangential, rotation."""


def turned(ground: ImpactConstants, rotation: Scalar) -> tuple[Scalar, Scalar]:
    """Sine and cosine of the orientation after a rotation theta [rad]."""
    sin_turn, cos_turn = jnp.sin(rotation), jnp.cos(rotation)
    return (
        ground.sin_start * cos_turn + ground.cos_start * sin_turn,
        ground.cos_start * cos_turn - ground.sin_start * sin_turn,
    )


def contact_geometry(
    ground: ImpactConstants,
    penetration: Scalar,
    rotation: Scalar,
    branch: Branch | None = None,
) -> Foundation:
    """Compute the equivalent foundation at a penetration u_n [m] and a rotation theta
    [rad]; the sinking is `u_D = u_n + r_y - r_y0`."""
    side = None if branch is None else branch.side
    sin, cos = turned(ground, rotation)
    start = ground.sin_start, ground.cos_start
    sides = {} if side is None else dict(start_side=ground.start_side, side=side)
    change = ground.shape.support_change(
        ground.axes, start, (sin, cos), jnp.sin(rotation), **sides
    )
    return foundation(
        ground.shape, ground.axes, sin, cos, penetration + change, side=side
    )


def jump_of_elastic_normal(
    ground: ImpactConstants, motion: Motion, before: Branch, after: Flag | None
) -> Scalar:
    r"""Change of $u^{ed}_n$ where the block has rolled over a level face [m].

    The arm $r$ of the sinking velocity $v_n + r\Omega$ jumps as the face is level. A
    step lands there but for a tiny angle $\delta$, and not at all where
    the block moves off the face in its first steps; with the other arm the block would
    have sunk by $\delta$ times the jump more. Its value is almost zero, its derivative
    is not: it carries how the moment moves at which the face is level.

    Args:
        before: branch on which the step was taken.
        after: side of the next step; None for a shape without sides.
    """

    def side_at(rotation):
        return ground.shape.side_of(*turned(ground, rotation))

    def arm_of(branch):
        base = contact_geometry(ground, motion.penetration, motion.rotation, branch)
        return ground.soil.kinematics.sinking_arm(base)

    value, rate = jax.jvp(
        side_at, (motion.rotation,), (jnp.ones_like(motion.rotation),)
    )
    turns = before.side != after
    past = value / jnp.where(turns, rate, 1.0)
    jump = arm_of(before._replace(side=after)) - arm_of(before)
    return jnp.where(turns, jump * past, 0.0)


def for_laws(ground: ImpactConstants, base: Foundation) -> Foundation:
    """Keep the sizes of a foundation positive, as the laws need them."""
    floor = SMALLEST_FOUNDATION * ground.axes.minor
    return base._replace(
        length=jnp.maximum(base.length, floor),
        width=jnp.maximum(base.width, floor),
        most_slender=ground.shape.most_slender,
    )


def _spread(result, motion: Motion):
    """Broadcast a law's result to the shape of the state: a law may return plain
    numbers where a rate is zero."""
    shape = jnp.shape(motion.penetration)

    def spread(value):
        if isinstance(value, jax.Array) and value.shape == shape:
            return value
        return jnp.broadcast_to(jnp.asarray(value, float), shape)

    return jax.tree.map(spread, result)


def _forces_of_springs(stiffness: Stiffness, motion: Motion) -> Forces:
    return Forces(
        stiffness.normal * motion.elastic_normal,
        stiffness.tangential * motion.elastic_tangential,
        stiffness.rotational * motion.elastic_rotation,
    )


def contact(
    ground: ImpactConstants,
    motion: Motion,
    forces: Forces | None = None,
    branch: Branch | None = None,
) -> Contact:
    """Foundation, forces and flow at one state.

    Args:
        ground: constants of the impact, and the laws.
        motion: the state.
        forces: what springs and dashpots carry together, the normal one not cut off;
            None without dashpots, where the springs carry all.
        branch: the side taken at each switch of the laws, if not the one where the
            state is.

    Finite for every finite input. Kinks: see the laws.
    """
    soil = ground.soil
    base = contact_geometry(ground, motion.penetration, motion.rotation, branch)
    footing = for_laws(ground, base)
    stiffness = soil.elasticity(
        footing, ground.unit_weight_normal, motion.elastic_normal, branch=branch
    )
    springs = _forces_of_springs(stiffness, motion)
    approach = (
        motion.normal_velocity
        + soil.kinematics.sinking_arm(base) * motion.angular_velocity,
        motion.tangential_velocity - base.normal_arm * motion.angular_velocity,
        motion.angular_velocity,
    )
    capacity = soil.bearing.at_velocity(
        footing,
        ground.unit_weight_normal,
        ground.bearing_factors,
        approach[0],
        soil.unit_weight / GRAVITY,
        branch=branch,
    )
    of_springs = forces is None
    if forces is None:
        forces = springs
    else:
        # A force without a dashpot is known. Were it to follow the springs, it would
        # chatter where they relax more quickly than that.
        dashpots = soil.damping(stiffness, ground.mass, ground.inertia)
        each = zip(dashpots, forces, springs, strict=True)
        forces = Forces(*(jnp.where(c > 0.0, force, known) for c, force, known in each))
    normal_before_cut = forces.normal
    # The step that lands on N = 0 has stages just beyond: cut off there, they would
    # leave its value as it is and spoil its derivative.
    presses = normal_before_cut > 0.0 if branch is None else branch.presses
    forces = forces._replace(normal=jnp.where(presses, forces.normal, 0.0))
    # Forces and capacity, both over the modulus, give the same load, and sooner: see
    # `FactoredStiffness`.
    on_surface, limit = forces, capacity
    if (
        of_springs
        and isinstance(stiffness, FactoredStiffness)
        and stiffness.at_one is not None
        and soil.loading_surface.needs_ratios_alone()
    ):
        pressed = motion._replace(
            elastic_normal=jnp.where(presses, motion.elastic_normal, 0.0)
        )
        on_surface = _forces_of_springs(stiffness.at_one, pressed)
        limit = capacity / stiffness.modulus
    load = soil.loading_surface(on_surface, limit, footing, ground.friction_slope)
    flow = _spread(soil.flow(load, motion.hardening, footing, branch=branch), motion)
    slip = soil.slider(
        forces.tangential,
        forces.normal,
        stiffness.tangential,
        ground.slider_friction,
        branch=branch,
    )
    return Contact(
        foundation=base,
        stiffness=_spread(stiffness, motion),
        forces=forces,
        normal_force_before_cut=normal_before_cut,
        elastic_forces=springs,
        approach=approach,
        load=_spread(load, motion),
        flow=flow,
        slip=_spread(slip, motion),
        hardening_rate=_spread(
            soil.hardening(motion.hardening, flow, footing, branch=branch), motion
        ),
        elastic_rates=(
            approach[0] - flow.normal,
            approach[1] - slip - flow.tangential,
            approach[2] - flow.rotational,
        ),
    )


def force_rate(
    ground: ImpactConstants, now: Contact, passing_time: Scalar, stalled: Scalar | float
) -> Forces:
    r"""Rates at which forces follow what springs and dashpots carry.

    $$ \tau \dot F = k u^{ed} + c \dot u^{ed} - F $$

    Flow and slip, and with them the rates of the springs and the dashpots' forces,
    depend on the forces themselves. As $\tau \to 0$ that is an equation for the forces
    which may have several solutions, and may lose the one the impact is on: flow is not
    associated. With $\tau > 0$ they go over to another one that is stable.

    Args:
        passing_time: time in which the block moves by its size [s]; the relaxation
            times are `FORCE_RELAXATION` of it.
        stalled: steps without progress at the onset.
    """
    relaxation = [part * passing_time for part in FORCE_RELAXATION]
    factors = jnp.ones(()), jnp.ones(())
    for times, others in enumerate(STALLED_RELAXATION, 1):
        factors = [
            jnp.where(stalled > times * STALLED_STEPS, other, factor)
            for factor, other in zip(factors, others, strict=True)
        ]
    relaxation = [factors[0] * time for time in relaxation]
    relaxation[1] = factors[1] * relaxation[1]
    dashpots = ground.soil.damping(now.stiffness, ground.mass, ground.inertia)
    forces = now.forces._replace(normal=now.normal_force_before_cut)
    return Forces(
        *(
            (spring + coefficient * rate - force) / time
            for spring, coefficient, rate, force, time in zip(
                now.elastic_forces,
                dashpots,
                now.elastic_rates,
                forces,
                relaxation,
                strict=True,
            )
        )
    )


def motion_rate(ground: ImpactConstants, motion: Motion, now: Contact) -> Motion:
    """Time derivative of the state: balance and kinematics."""
    forces, base = now.forces, now.foundation
    moment = (
        forces.tangential * base.normal_arm
        - forces.normal * base.tangential_arm
        - forces.moment
    )
    return Motion(
        motion.normal_velocity,
        motion.angular_velocity,
        ground.gravity_normal - forces.normal / ground.mass,
        ground.gravity_tangential - forces.tangential / ground.mass,
        moment / ground.inertia,
        *now.elastic_rates,
        now.hardening_rate,
    )


def work_rate(
    ground: ImpactConstants,
    motion: Motion,
    now: Contact,
    elastic_rates: tuple[Scalar, Scalar, Scalar],
) -> Work:
    """Power of every work [W].

    Args:
        ground, motion, now: as for `contact`, and what it gives.
        elastic_rates: rates of the elastic displacements as the integration has them.

    What the ground dissipates is its force times the part of the block's motion that
    the springs do not take up. The laws' own rates of flow and slip would not do: they
    relax in much less than a step, and multiply the error of a state between two steps
    by its width over their relaxation time.
    """
    forces = now.forces
    inelastic = [
        velocity - rate
        for velocity, rate in zip(now.approach, elastic_rates, strict=True)
    ]
    slip = jnp.where(now.slip == 0.0, 0.0, inelastic[1] - now.flow.tangential)
    return Work(
        gravity=ground.mass
        * (
            ground.gravity_normal * motion.normal_velocity
            + ground.gravity_tangential * motion.tangential_velocity
        ),
        viscoplastic=forces.normal * inelastic[0]
        + forces.tangential * (inelastic[1] - slip)
        + forces.moment * inelastic[2],
        slider=forces.tangential * slip,
        dashpot=_sum(
            (force - spring) * rate
            for force, spring, rate in zip(
                forces, now.elastic_forces, elastic_rates, strict=True
            )
        ),
        arm=arm_power(ground, motion, now),
        springs=_sum(
            spring * rate
            for spring, rate in zip(now.elastic_forces, elastic_rates, strict=True)
        ),
    )


def arm_power(ground: ImpactConstants, motion: Motion, now: Contact) -> Scalar:
    """Power of the arm work [W]: normal force times the velocity of the point at which
    sinking is taken against that of the foundation's centre, where the force acts."""
    base = now.foundation
    arm = ground.soil.kinematics.sinking_arm(base) - base.tangential_arm
    return now.forces.normal * motion.angular_velocity * arm


def _sum(items) -> Any:
    return sum(items)


def initial_motion(scene: Scene) -> Motion:
    """Return the state at the start: sunk by 1e-6 R, springs compressed by as much."""
    impact = scene.impact
    sinking = INITIAL_SINKING * scene.block.semi_axes.minor
    zero = jnp.zeros_like(sinking)
    return Motion(
        penetration=sinking,
        rotation=zero,
        normal_velocity=impact.normal_velocity,
        tangential_velocity=impact.tangential_velocity,
        angular_velocity=impact.angular_velocity,
        elastic_normal=sinking,
        elastic_tangential=zero,
        elastic_rotation=zero,
        hardening=zero + scene.soil.hardening.initial,
    )


def kinetic_energy(ground: ImpactConstants, motion: Motion) -> Scalar:
    """Translational and rotational kinetic energy [J]."""
    return 0.5 * (
        ground.mass * (motion.normal_velocity**2 + motion.tangential_velocity**2)
        + ground.inertia * motion.angular_velocity**2
    )


def elastic_energy(motion: Motion, stiffness: Stiffness) -> Scalar:
    """Compute the energy held in the springs [J]."""
    return 0.5 * (
        stiffness.normal * motion.elastic_normal**2
        + stiffness.tangential * motion.elastic_tangential**2
        + stiffness.rotational * motion.elastic_rotation**2
    )

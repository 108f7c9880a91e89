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

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .block import SemiAxes
from .foundation import Foundation, foundation, support_radius
from .laws import BearingFactors, FlowRate, Laws, Stiffness
from .rosenbrock import factorise, substitute
from .safe import TINY
from .scene import GRAVITY, Scene
from .soil import Soil

Scalar = Float[Array, ""]

INITIAL_SINKING = 1e-6
"""Penetration at the start of the integration, as a part of the semi-axis R."""
INITIAL_HARDENING = 0.01
"""rho_c at the start [-]."""
SMALLEST_FOUNDATION = 1e-6
"""Sizes of the foundation are not taken below this part of R, so that the laws stay
finite where the solver probes a state out of contact; at the least sinking of a
contact, 0.5e-6 R, the foundation is a thousand times larger."""
LOOP_TOLERANCE = 1e-12
"""Relative change at which the forces of springs and dashpots are settled."""


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


class Forces(NamedTuple):
    """Forces of the ground on the block, as they enter the balance with minus signs."""

    normal: Scalar  # N [N], never negative
    tangential: Scalar  # T [N]
    moment: Scalar  # M [N m]


class Work(NamedTuple):
    """Items of the energy ledger (rates in W, or their integrals in J).

    `arm` and `stiffness` are no dissipation: the printed equations imply them. The
    normal force acts at the foundation's centre, while sinking is measured at the
    tangency point; and the springs' stiffness changes with the foundation's size.
    """

    gravity: Scalar
    viscoplastic: Scalar
    slider: Scalar
    dashpot: Scalar
    arm: Scalar
    stiffness: Scalar


class Ground(NamedTuple):
    """What the laws and the balance take from the scene, worked out once an impact."""

    soil: Soil
    axes: SemiAxes
    mass: Scalar
    inertia: Scalar
    sin_start: Scalar  # of theta_0
    cos_start: Scalar
    support_at_start: Scalar  # r_y0 [m]
    gravity_normal: Scalar  # g cos(omega) [m/s2]
    gravity_tangential: Scalar  # g sin(omega) [m/s2]
    unit_weight_normal: Scalar  # gamma cos(omega) [N/m3]
    bearing: BearingFactors
    slider_friction: Scalar  # tan(phi_b) [-]


def prepare(scene: Scene, laws: Laws) -> Ground:
    """Constants of one impact."""
    block, soil, impact = scene.block, scene.soil, scene.impact
    axes = block.semi_axes
    sin, cos = jnp.sin(impact.orientation), jnp.cos(impact.orientation)
    cos_slope = jnp.cos(impact.slope)
    return Ground(
        soil=soil,
        axes=axes,
        mass=block.mass,
        inertia=block.inertia,
        sin_start=sin,
        cos_start=cos,
        support_at_start=support_radius(axes, sin, cos),
        gravity_normal=GRAVITY * cos_slope,
        gravity_tangential=GRAVITY * jnp.sin(impact.slope),
        unit_weight_normal=soil.unit_weight * cos_slope,
        bearing=laws.bearing_factors(laws.peak_friction_angle(soil)),
        slider_friction=laws.slider_friction(soil),
    )


class Contact(NamedTuple):
    """Everything that is known of the contact at one moment."""

    foundation: Foundation
    stiffness: Stiffness
    forces: Forces
    normal_force_before_cut: Scalar
    """N before it is cut off at zero, for the event that it ends."""
    elastic_forces: Forces
    """Part of the forces that the springs carry; the normal one may be negative."""
    flow: FlowRate
    slip: Scalar
    hardening_rate: Scalar
    elastic_rates: tuple[Scalar, Scalar, Scalar]
    """Rates of the elastic displacements: normal, tangential, rotation."""


def contact_geometry(
    ground: Ground, penetration: Scalar, rotation: Scalar
) -> Foundation:
    """The equivalent foundation at a penetration u_n [m] and a rotation theta [rad].

    The sinking `u_D = u_n + r_y - r_y0` is taken with the difference of radii as
    `(r_y^2 - r_y0^2) / (r_y + r_y0)` and
    `r_y^2 - r_y0^2 = -(H^2 - R^2) sin(2 theta_0 + theta) sin(theta)`, which keeps its
    digits at small rotations.
    """
    axes = ground.axes
    sin_turn, cos_turn = jnp.sin(rotation), jnp.cos(rotation)
    sin = ground.sin_start * cos_turn + ground.cos_start * sin_turn
    cos = ground.cos_start * cos_turn - ground.sin_start * sin_turn
    sin_sum = sin * ground.cos_start + cos * ground.sin_start
    difference = -(axes.major**2 - axes.minor**2) * sin_sum * sin_turn
    support = support_radius(axes, sin, cos)
    sinking = penetration + difference / (support + ground.support_at_start)
    return foundation(axes, sin, cos, sinking)


def floored_sizes(ground: Ground, base: Foundation) -> tuple[Scalar, Scalar]:
    """Length and width of the foundation [m], kept positive for the laws."""
    floor = SMALLEST_FOUNDATION * ground.axes.minor
    return jnp.maximum(base.length, floor), jnp.maximum(base.width, floor)


def contact(ground: Ground, laws: Laws, motion: Motion, *, damped: bool) -> Contact:
    """Foundation, forces and flow at one state.

    Args:
        ground: constants of the impact.
        laws: the constitutive functions.
        motion: the state.
        damped: whether there are dashpots; without them the springs give the forces
            outright, with them the forces solve an algebraic loop.

    Finite for every finite input. Kinks: see the laws.
    """
    soil = ground.soil
    base = contact_geometry(ground, motion.penetration, motion.rotation)
    length, width = floored_sizes(ground, base)
    stiffness = laws.elastic_stiffness(length, width, ground.unit_weight_normal, soil)
    springs = Forces(
        stiffness.normal * motion.elastic_normal,
        stiffness.tangential * motion.elastic_tangential,
        stiffness.rotational * motion.elastic_rotation,
    )
    capacity = laws.bearing_capacity(
        length, width, base.sinking, ground.unit_weight_normal, ground.bearing
    )
    friction_slope = ground.bearing.friction_slope

    def yielding(forces: Forces) -> tuple[FlowRate, Scalar]:
        normal = jnp.maximum(forces.normal, 0.0)
        load = laws.loading_surface(
            normal / capacity,
            forces.tangential / (friction_slope * capacity),
            forces.moment / (soil.psi * length * capacity),
            soil.beta,
        )
        flow = laws.flow_rate(load, motion.hardening, length, friction_slope, soil)
        slip = laws.slip_rate(
            forces.tangential, normal, stiffness.tangential, ground.slider_friction
        )
        return flow, slip

    approach = (
        motion.normal_velocity + base.tangency_arm * motion.angular_velocity,
        motion.tangential_velocity - base.normal_arm * motion.angular_velocity,
        motion.angular_velocity,
    )

    def elastic_rates(flow: FlowRate, slip: Scalar) -> tuple[Scalar, Scalar, Scalar]:
        return (
            approach[0] - flow.normal,
            approach[1] - flow.tangential - slip,
            approach[2] - flow.rotational,
        )

    forces = springs
    if damped:
        dashpots = laws.dashpots(stiffness, ground.mass, ground.inertia, soil)

        def springs_and_dashpots(forces: Forces) -> Forces:
            rates = elastic_rates(*yielding(forces))
            return Forces(
                *(s + c * r for s, c, r in zip(springs, dashpots, rates, strict=True))
            )

        unyielding = Forces(
            *(s + c * r for s, c, r in zip(springs, dashpots, approach, strict=True))
        )
        forces = solve_loop(springs_and_dashpots, springs, unyielding)
    flow, slip = yielding(forces)
    return Contact(
        foundation=base,
        stiffness=stiffness,
        forces=forces._replace(normal=jnp.maximum(forces.normal, 0.0)),
        normal_force_before_cut=forces.normal,
        elastic_forces=springs,
        flow=flow,
        slip=slip,
        hardening_rate=laws.hardening_rate(motion.hardening, flow, length, width, soil),
        elastic_rates=elastic_rates(flow, slip),
    )


def solve_loop(
    springs_and_dashpots: Callable[[Forces], Forces],
    springs: Forces,
    unyielding: Forces,
) -> Forces:
    """Forces that fulfil `forces = springs_and_dashpots(forces)`.

    The rate of flow depends on the forces, the rates of the springs on that of flow, and
    the dashpots' forces on these. Newton's method from the forces without any yielding:
    the residual is convex and steeper beyond the kinks of yield and slip, so steps from
    there seldom overshoot; two short ones in every eight end a cycle between the sides
    of a kink. Derivatives of every order are those of the implicit
    function.
    """
    size = [
        jnp.abs(a) + jnp.abs(b) + TINY for a, b in zip(springs, unyielding, strict=True)
    ]

    def residual(values):
        found = springs_and_dashpots(Forces(*values))
        return [f - v for f, v in zip(found, values, strict=True)]

    def linear_solve(linear_map, right_hand_side):
        columns = [
            linear_map([jnp.full_like(x, float(i == j)) for i, x in enumerate(size)])
            for j in range(3)
        ]
        rows = [{j: columns[j][i] for j in range(3)} for i in range(3)]
        return substitute(*factorise(rows), right_hand_side)

    def solve(residual, guess):
        def unsolved(carry):
            _, change, tries = carry
            return jnp.any(change > LOOP_TOLERANCE) & (tries < 48)

        def improve(carry):
            values, _, tries = carry
            factor = jnp.where(tries % 8 < 6, 1.0, jnp.where(tries % 8 == 6, 0.5, 0.2))
            errors, linear_map = jax.linearize(residual, list(values))
            steps = linear_solve(linear_map, errors)
            stepped = tuple(v - factor * c for v, c in zip(values, steps, strict=True))
            change = sum(
                jnp.abs(c) / (jnp.abs(v) + 1e-12 * s + TINY)
                for v, c, s in zip(stepped, steps, size, strict=True)
            )
            return stepped, change, tries + 1

        start = (tuple(guess), jnp.full_like(guess[0], jnp.inf), 0)
        return list(jax.lax.while_loop(unsolved, improve, start)[0])

    return Forces(*jax.lax.custom_root(residual, list(unyielding), solve, linear_solve))


def motion_rate(ground: Ground, motion: Motion, now: Contact) -> Motion:
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


def work_rate(ground: Ground, laws: Laws, motion: Motion, now: Contact) -> Work:
    """Power of every item of the ledger [W]."""
    base, forces = now.foundation, now.forces

    def stiffness_at(penetration, rotation):
        sizes = floored_sizes(ground, contact_geometry(ground, penetration, rotation))
        return laws.elastic_stiffness(*sizes, ground.unit_weight_normal, ground.soil)

    _, stiffness_rates = jax.jvp(
        stiffness_at,
        (motion.penetration, motion.rotation),
        (motion.normal_velocity, motion.angular_velocity),
    )
    elastic = (
        motion.elastic_normal,
        motion.elastic_tangential,
        motion.elastic_rotation,
    )
    return Work(
        gravity=ground.mass
        * (
            ground.gravity_normal * motion.normal_velocity
            + ground.gravity_tangential * motion.tangential_velocity
        ),
        viscoplastic=forces.normal * now.flow.normal
        + forces.tangential * now.flow.tangential
        + forces.moment * now.flow.rotational,
        slider=forces.tangential * now.slip,
        dashpot=sum(
            (force - spring) * rate
            for force, spring, rate in zip(
                forces, now.elastic_forces, now.elastic_rates, strict=True
            )
        ),
        arm=forces.normal
        * motion.angular_velocity
        * (base.tangency_arm - base.tangential_arm),
        stiffness=sum(
            0.5 * displacement**2 * rate
            for displacement, rate in zip(elastic, stiffness_rates, strict=True)
        ),
    )


def initial_motion(scene: Scene) -> Motion:
    """State at the start: touching by 1e-6 R, springs pressed by as much."""
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
        hardening=zero + INITIAL_HARDENING,
    )


def kinetic_energy(ground: Ground, motion: Motion) -> Scalar:
    """Translational and rotational kinetic energy [J]."""
    return 0.5 * (
        ground.mass * (motion.normal_velocity**2 + motion.tangential_velocity**2)
        + ground.inertia * motion.angular_velocity**2
    )


def elastic_energy(motion: Motion, stiffness: Stiffness) -> Scalar:
    """Energy held in the springs [J]."""
    return 0.5 * (
        stiffness.normal * motion.elastic_normal**2
        + stiffness.tangential * motion.elastic_tangential**2
        + stiffness.rotational * motion.elastic_rotation**2
    )

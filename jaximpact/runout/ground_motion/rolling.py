r"""Motion along the ground: rolling, sliding where a block cannot roll, slope breaks.

**Rolling.** The block is replaced by a round one of the same perimeter, mass and
inertia. Its radius r is the mean of r_y over a turn, since a turn takes the block on by
its perimeter. With $k = I/(m r^2)$ and the rolling-friction angle,

$$ a = g\,\frac{\sin w - \tan\varphi_r \cos w}{1 + k} $$

in its direction of motion, up to the end of the segment or to rest. Hops off the
block's corners are not followed.

**Where it cannot roll.** The block has to get over its long axis, higher by
$r_{max} - r$ than the mean. Where $\tan w > (H^2 - R^2)/(2 H R) + \tan\varphi_r$ it
tips over it by itself: $r_y'/r_y$ is nowhere larger than that fraction. Elsewhere a
block whose kinetic energy is less than $m g \cos w\,(r_{max} - r)$ lies down on its
flat side and slides, with the ground's friction, $\tan\varphi_b =
\alpha_s\tan\varphi'$.

**At a convex break** the round block turns about the edge, from one segment to the
next, as long as its weight holds it there: $v^2 \le g r\cos\alpha$ with $\alpha$ going
from one descent to the other. Where that ends it flies. To cross a crest it has to be
lifted by $r(\cos\alpha - \cos w)$; a block that is too slow goes back. A block that
slides flies if it does so at once, with the radius of curvature of its flat side. A
flight that would rise over the next segment by less than a hop,
$v^2\sin^2(w_2 - w_1)/(2 g \cos w_2)$, is not followed: the block goes on along the
ground.

**At a concave break** it runs into the next segment; in places narrower than itself
into whatever is in its way (`obstacles`).

**Slow blocks.** A block comes to roll, to slide or to rest where it lies
(`begin_on_ground`); below `small_speed` there is neither a hop nor an impact.
"""

from typing import NamedTuple

import jax.numpy as jnp

from ..._safe import safe_sqrt
from ...scene import GRAVITY
from ..blocks import support
from ..flight.narrow_phase import NEVER
from ..lane_programs import Values
from ..state import BlockConstants, BlockState
from ..trajectory import Ending

PAST_THE_EDGE = 1e-3
"""Turn beyond the one at which a block leaves the edge, at which its flight begins
[rad]; at the very one it would leave too slowly to be told from staying."""


def barrier(
    constants: BlockConstants, slope: Values, rolling_friction: Values
) -> Values:
    """Compute the least kinetic energy for rolling [J]; 0 on a slope that tips the
    block.

    Args:
        slope: angle w [rad], of either sign.
        rolling_friction: tangent of phi_r.
    """
    whole = constants.round
    steep = jnp.abs(jnp.tan(slope)) > whole.turning_slope + rolling_friction
    height = whole.tallest - whole.radius
    energy = constants.mass_properties.mass * GRAVITY * jnp.cos(slope) * height
    return jnp.where(steep, 0.0, energy)


class GroundMotion(NamedTuple):
    """Motion of a block along the ground."""

    rolls: Values
    """1 if it rolls, 0 if it slides."""
    direction: Values
    """1 along t, -1 against it."""
    speed_squared: Values
    """Squared speed [m2/s2]; negative where the slope tips a block over that lies so
    low that it has to go down first."""
    stays: Values
    """1 where the block lies too deep to come up."""


def begin_ground_motion(
    constants: BlockConstants,
    slope: Values,
    rolling_friction: Values,
    height: Values,
    tangential_velocity: Values,
    angular_velocity: Values,
) -> GroundMotion:
    """Begin motion along the ground: rolling, sliding or rest.

    The block is brought to rolling by an impulse at the ground, which leaves the
    angular momentum about the contact as it is and costs the energy of the slip; its
    centre comes to the height of the round block, which costs or gives energy. If the
    rest takes it over its long axis it rolls. Else it slides at the velocity that it
    has along the ground, and its rotation is lost.

    Args:
        height: height of the centre over the plane [m].
    """
    mass, inertia = constants.mass_properties
    radius = constants.round.radius
    whole = mass * radius**2 + inertia
    spin = (mass * radius * tangential_velocity + inertia * angular_velocity) / whole
    lift = mass * GRAVITY * jnp.cos(slope) * (radius - height)
    energy = 0.5 * whole * spin**2 - lift
    needed = barrier(constants, slope, rolling_friction)
    rolls = (needed <= 0.0) | (energy >= needed)
    turning_slope = constants.round.turning_slope
    steep = jnp.abs(jnp.tan(slope)) > turning_slope + rolling_friction
    rounding = 1e-9 * mass * GRAVITY * radius
    energy = jnp.where(jnp.abs(energy) < rounding, jnp.maximum(energy, 0.0), energy)
    # A block that lies down loses its height; any height that it gains costs energy.
    rise = jnp.maximum(constants.outline.smallest - height, 0.0)
    sliding = tangential_velocity**2 - 2.0 * GRAVITY * jnp.cos(slope) * rise
    along = jnp.where(rolls, spin, tangential_velocity)
    # A block at rest starts down-slope.
    direction = jnp.where(along == 0.0, slope, along)
    return GroundMotion(
        rolls=rolls.astype(float),
        direction=jnp.where(direction >= 0.0, 1.0, -1.0),
        speed_squared=jnp.where(
            rolls, 2.0 * radius**2 * energy / whole, jnp.maximum(sliding, 0.0)
        ),
        stays=jnp.where(
            rolls, (energy < 0.0) & ~steep, sliding < -1e-9 * GRAVITY * radius
        ).astype(float),
    )


class Leg(NamedTuple):
    """Motion along one segment, at constant acceleration."""

    time: Values
    """Duration [s]."""
    distance: Values
    """Distance [m], positive."""
    speed: Values
    """Speed at the end [m/s], positive."""
    acceleration: Values
    """Acceleration in the direction of motion [m/s2]."""
    arrives: Values
    """1 at the end of the segment, 0 where the block has become too slow for its kind
    of motion."""


def follow_segment(
    speed: Values,
    descent: Values,
    distance: Values,
    friction: Values,
    inertia_ratio: Values,
    least_speed: Values,
) -> Leg:
    """Move along one segment, at constant acceleration.

    Args:
        speed: speed at the start [m/s], not negative.
        descent: slope in the direction of motion [rad]; negative where it rises.
        distance: distance to the end of the segment [m].
        friction: tangent of the angle of rolling or sliding friction.
        inertia_ratio: k, 0 for a block that slides.
        least_speed: speed at which the block has become too slow [m/s].
    """
    drive = jnp.sin(descent) - friction * jnp.cos(descent)
    acceleration = GRAVITY * drive / (1.0 + inertia_ratio)
    distance = jnp.maximum(distance, 0.0)
    slows = acceleration < 0.0
    brake = jnp.where(slows, -acceleration, 1.0)
    to_slow = jnp.maximum(speed**2 - least_speed**2, 0.0) / (2.0 * brake)
    stands = ~slows & (speed <= 0.0) & (acceleration <= 0.0)
    arrives = (~slows | (to_slow > distance)) & ~stands
    end = safe_sqrt(speed**2 + 2.0 * acceleration * distance)
    time_to_end = 2.0 * distance / jnp.maximum(speed + end, 1.0 / NEVER)
    time_to_slow = jnp.maximum(speed - least_speed, 0.0) / brake
    return Leg(
        time=jnp.where(arrives, time_to_end, jnp.where(stands, 0.0, time_to_slow)),
        distance=jnp.where(arrives, distance, jnp.where(stands, 0.0, to_slow)),
        speed=jnp.where(arrives, end, jnp.minimum(speed, least_speed)),
        acceleration=acceleration,
        arrives=arrives.astype(float),
    )


class Crossing(NamedTuple):
    """Motion of a block over a break."""

    goes_back: Values
    """1 where it does not get over a crest."""
    stays: Values
    """1 where its energy does not suffice to move."""
    flies: Values
    """1 where it leaves the ground."""
    descent: Values
    """Angle of the velocity of a block that flies, downwards [rad]."""
    speed: Values
    """Speed at the start of the next segment, or as the block goes back [m/s]."""
    normal_velocity: Values
    """Velocity v_n of the centre of a block that flies [m/s]."""
    tangential_velocity: Values
    """Velocity of the centre of a block that flies, in the direction of motion
    [m/s]."""
    angular_velocity: Values
    """Angular velocity of a block that flies [rad/s], positive as it rolls."""


class TakeOff(NamedTuple):
    """Round block that leaves the edge of a break as it turns about it."""

    angle: Values
    """Descent at which the block leaves [rad]."""
    arm: Values
    """Distance from the centre to the edge along the plane [m]."""
    height: Values
    """Height of the centre over the edge, across the plane [m]."""
    spin: Values
    """Angular velocity about the edge [rad/s]."""
    loose: Values
    """True where the block is fast enough to fly."""


def _take_off(
    constants: BlockConstants,
    radius: Values,
    whole: Values,
    speed_squared: Values,
    before: Values,
    orientation: Values,
) -> TakeOff:
    """Find where a round block leaves an edge, and the motion of the ellipse in its
    place.

    Args:
        radius: radius of the round block [m].
        whole: total kinetic energy over that of translation, 1 + k.
        speed_squared, before, orientation: as for `cross_break`.
    """
    mass, inertia = constants.mass_properties
    gain = 2.0 * GRAVITY * radius / whole
    # v^2 / (g r) at the edge, as it was before the turn.
    froude = speed_squared / (GRAVITY * radius)
    at_once = froude > jnp.cos(before)
    cos = (froude + 2.0 / whole * jnp.cos(before)) / (1.0 + 2.0 / whole)
    cos = jnp.clip(cos, -1.0 + 1e-12, 1.0)
    angle = 2.0 * jnp.arctan(safe_sqrt((1.0 - cos) / (1.0 + cos))) + PAST_THE_EDGE
    angle = jnp.where(at_once, before, angle)
    at_angle = safe_sqrt(speed_squared + gain * (jnp.cos(before) - jnp.cos(angle)))
    # The ellipse in the round block's place.
    theta = orientation - angle
    height, arm = support(constants.outline, jnp.sin(theta), jnp.cos(theta))
    lift = (height - radius) * jnp.cos(angle) + arm * jnp.sin(angle)
    kinetic = 0.5 * mass * whole * at_angle**2 - mass * GRAVITY * lift
    about_edge = mass * (height**2 + arm**2) + inertia
    spin = safe_sqrt(2.0 * kinetic / about_edge)
    loose = (kinetic > 0.0) & (height * spin**2 > GRAVITY * jnp.cos(angle))
    return TakeOff(angle, arm, height, spin, loose)


def cross_break(
    constants: BlockConstants,
    speed_squared: Values,
    before: Values,
    after: Values,
    orientation: Values,
    rolls: Values,
    hop: Values,
) -> Crossing:
    """Move a block over a convex break.

    A block that flies has its ellipse over the edge, turning about it without slip, and
    the energy of the round block as it left. At a concave break, where a block may rest
    that was in the ground, it continues without an impact. Angles descend in the
    direction of motion.

    Args:
        speed_squared: squared speed with the centre over the edge [m2/s2]; negative
            if its energy does not suffice for that place.
        before, after: descents of the plane on which the block rests and of the next
            segment [rad].
        orientation: angle from the vertical to the major axis, positive towards the
            direction of motion [rad].
        rolls: 1 if it rolls, 0 if it slides.
        hop: height up to which a flight is not followed [m].
    """
    outline, rolling = constants.outline, rolls > 0.0
    radius = constants.centre_height(rolls)
    whole = 1.0 + constants.inertia_ratio(rolls)
    least, most = jnp.minimum(before, after), jnp.maximum(before, after)
    top = jnp.clip(0.0, least, most)
    gain = 2.0 * GRAVITY * radius / whole
    crest = gain * (jnp.cos(top) - jnp.cos(before))
    end_squared = speed_squared + gain * (jnp.cos(before) - jnp.cos(after))
    short = (crest > 0.0) & (speed_squared < crest)
    goes_back = short & (speed_squared >= 0.0)
    stays = (short & (speed_squared < 0.0)) | (end_squared < 0.0)
    leaving = _take_off(constants, radius, whole, speed_squared, before, orientation)
    curvature = outline.largest**2 / outline.smallest
    slips = speed_squared > GRAVITY * curvature * jnp.cos(before)
    slips &= before + PAST_THE_EDGE < after
    flies = jnp.where(rolling, (leaving.angle < after) & leaving.loose, slips)
    # Also keeps rounding of a straight slope's points from throwing blocks up.
    rise = speed_squared * jnp.sin(after - before) ** 2
    is_hop = rise < 2.0 * GRAVITY * jnp.cos(after) * hop
    flies = flies & ~short & ~stays & ~is_hop
    speed = safe_sqrt(speed_squared)
    return Crossing(
        goes_back=goes_back.astype(float),
        stays=stays.astype(float),
        flies=flies.astype(float),
        descent=jnp.where(rolling, leaving.angle, before),
        speed=jnp.where(goes_back, speed, safe_sqrt(end_squared)),
        normal_velocity=jnp.where(rolling, -leaving.arm * leaving.spin, 0.0),
        tangential_velocity=jnp.where(rolling, leaving.height * leaving.spin, speed),
        angular_velocity=jnp.where(rolling, leaving.spin, 0.0),
    )


SMALL_RISE = 1e-2
"""Fraction of the smaller semi-axis; energies that would lift a block by less count as
none: hops so low are not followed, and touches so slow are no impacts. They take less
time than a contact does; with a tenth of it a sphere that has come to rolling continues
in hundreds of hops of 0.2 mm."""


def small_speed(smallest: Values, slope: Values) -> Values:
    """Compute the speed across a plane below which there is no hop or impact [m/s].

    Args:
        smallest: height of the centre of the block lying on its flat side [m].
    """
    return jnp.sqrt(2.0 * GRAVITY * jnp.cos(slope) * SMALL_RISE * smallest)


def begin_on_ground(
    block: BlockState,
    constants: BlockConstants,
    plane: Values,
    rolling_friction: Values,
    height: Values,
    tangential_velocity: Values,
    angular_velocity: Values,
) -> BlockState:
    """Begin motion along the ground: decide whether a block rolls, where to, how fast.

    The block lies on `block.segment`, or on an edge if that is set.

    Args:
        plane: angle of the plane on which it rests [rad].
        rolling_friction: that of the segment.
        height: height of its centre over the plane [m].
        tangential_velocity, angular_velocity: velocities along it [m/s], and of
            rotation [rad/s].
    """
    motion = begin_ground_motion(
        *(constants, plane, rolling_friction),
        *(height, tangential_velocity, angular_velocity),
    )
    stays, body = motion.stays > 0.0, block.body
    over = jnp.where(stays, 0.0, constants.centre_height(motion.rolls) - height)
    lying = lying_orientation(body.orientation, constants, plane)
    begun = block._replace(
        rolls=motion.rolls,
        direction=motion.direction,
        speed_squared=motion.speed_squared,
        plane=plane,
    ).moved(
        x=body.x + over * jnp.sin(plane),
        y=body.y + over * jnp.cos(plane),
        orientation=jnp.where(motion.rolls > 0.0, body.orientation, lying),
    )
    return begun.ended(Ending.stopped, stays)


def lying_orientation(
    orientation: Values, constants: BlockConstants, plane: Values
) -> Values:
    """Turn the nearest flat side of a block to the ground [rad]."""
    axes = constants.outline.axes
    quarter = jnp.where(axes.major >= axes.minor, 0.5 * jnp.pi, 0.0)
    turns = jnp.floor((orientation - plane - quarter) / jnp.pi + 0.5)
    return plane + turns * jnp.pi + quarter

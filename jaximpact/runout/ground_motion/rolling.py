r"""Rolling and sliding: how a block that stays on the ground begins to move along it,
and how it leaves it, off an edge or against a corner.

**Rolling.** The block is replaced by a round one of the same perimeter, mass and
inertia. Its radius r is the mean of r_y over a turn, since a turn takes the block on by
its perimeter. With $k = I/(m r^2)$ and the rolling-friction angle,

$$ a = g\,\frac{\sin w - \tan\varphi_r \cos w}{1 + k} $$

in its direction of motion. Hops off the block's corners are not followed.

**Where it cannot roll.** The block has to get over its long axis, higher by
$r_{max} - r$ than the mean. Where $\tan w > (H^2 - R^2)/(2 H R) + \tan\varphi_r$ it
tips over it by itself: $r_y'/r_y$ is nowhere larger than that fraction. Elsewhere a
block whose kinetic energy is less than $m g \cos w\,(r_{max} - r)$ lies down on its
flat side and slides, with the ground's friction, $\tan\varphi_b =
\alpha_s\tan\varphi'$.

**Slow blocks.** A block comes to roll, to slide or to rest where it lies
(`begin_on_ground`); below `small_speed` there is neither a hop nor an impact. How it
goes on from there is the matter of `ride`. A round block leaves the ground as the
section that it stands for (`take_off`, `strike_corner`).
"""

import jax.numpy as jnp

from ...scene import GRAVITY
from ..blocks import support
from ..lane_programs import Values, closed_form
from ..state import NONE, BlockConstants, BlockState, Phase
from ..trajectory import Ending

SMALL_RISE = 1e-2
"""Fraction of the smaller semi-axis; energies that would lift a block by less count as
none: hops so low are not followed, and touches so slow are no impacts. They take less
time than a contact does; with a tenth of it a sphere that has come to rolling continues
in hundreds of hops of 0.2 mm."""


def small_speed(smallest: Values, slope: Values) -> Values:
    """Compute the speed across a plane below which there is no hop or impact [m/s], of
    blocks by the height of their centres as they lie on their flat sides [m]."""
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
    """Begin motion along the ground: rolling, sliding or rest.

    The block is brought to rolling by an impulse at the ground, which leaves the
    angular momentum about the contact as it is and costs the energy of the slip; its
    centre comes to the height of the round block, which costs or gives energy. If the
    rest takes it over its long axis it rolls. Else it slides at the velocity that it
    has along the ground, and its rotation is lost. One that lies so low that the slope
    tips it over before it has the height to roll goes down-slope for it.

    Args:
        plane: angle of the plane on which it rests [rad].
        height: height of its centre over the plane [m].
    """
    (mass, inertia), whole = constants.mass_properties, constants.round
    radius, weight = whole.radius, mass * GRAVITY * jnp.cos(plane)
    turning = mass * radius**2 + inertia
    spin = (mass * radius * tangential_velocity + inertia * angular_velocity) / turning
    energy = 0.5 * turning * spin**2 - weight * (radius - height)
    steep = jnp.abs(jnp.tan(plane)) > whole.turning_slope + rolling_friction
    # Least energy for rolling: none on a slope that tips the block.
    needed = jnp.where(steep, 0.0, weight * (whole.tallest - radius))
    can_roll = (needed <= 0.0) | (energy >= needed)
    rolls = can_roll.astype(float)
    rounding = 1e-9 * mass * GRAVITY * radius
    energy = jnp.where(jnp.abs(energy) < rounding, jnp.maximum(energy, 0.0), energy)
    # A block that lies down loses its height; any height that it gains costs energy.
    rise = jnp.maximum(constants.outline.smallest - height, 0.0)
    sliding = tangential_velocity**2 - 2.0 * GRAVITY * jnp.cos(plane) * rise
    squared = jnp.where(
        can_roll, 2.0 * radius**2 * energy / turning, jnp.maximum(sliding, 0.0)
    )
    # It stays where it lies too deep to come up.
    stays = jnp.where(
        can_roll, (energy < 0.0) & ~steep, sliding < -1e-9 * GRAVITY * radius
    )
    along = jnp.where(can_roll, spin, tangential_velocity)
    # A block at rest starts down-slope.
    direction = jnp.where(along == 0.0, plane, along)

    over = jnp.where(stays, 0.0, constants.centre_height(rolls) - height)
    sin, cos = jnp.sin(plane), jnp.cos(plane)
    short = can_roll & (squared < 0.0) & ~stays
    missing = jnp.where(short, -squared, 0.0) * (1.0 + constants.inertia_ratio(rolls))
    down = jnp.where(plane >= 0.0, 1.0, -1.0)
    way = down * missing / (2.0 * GRAVITY * jnp.where(short, jnp.abs(sin), 1.0))
    body = block.body
    lying = lying_orientation(body.orientation, constants, plane)
    begun = block._replace(
        phase=jnp.full_like(block.phase, float(Phase.grounded)),
        element=jnp.full_like(block.element, NONE),
        rolls=rolls,
        direction=jnp.where(short, down, jnp.where(direction >= 0.0, 1.0, -1.0)),
        speed_squared=jnp.where(short, 0.0, squared),
    ).moved(
        x=body.x + over * sin + way * cos,
        y=body.y + over * cos - way * sin,
        orientation=jnp.where(can_roll, body.orientation, lying),
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


@closed_form
def lie_down(block: BlockState, constants: BlockConstants, plane: Values) -> BlockState:
    """Lay a block down that is too slow to roll: it slides on its flat side, on a plane
    at an angle [rad]."""
    drop = constants.round.radius - constants.outline.smallest
    sin, cos = jnp.sin(plane), jnp.cos(plane)
    return block._replace(
        rolls=jnp.zeros_like(block.rolls),
        element=jnp.full_like(block.element, NONE),
        normal_x=sin,
        normal_y=cos,
    ).moved(
        x=block.body.x - drop * sin,
        y=block.body.y - drop * cos,
        orientation=lying_orientation(block.body.orientation, constants, plane),
    )


@closed_form
def take_off(
    block: BlockState, constants: BlockConstants, normal_x: Values, normal_y: Values
) -> tuple[BlockState, Values]:
    """Let blocks leave the ground, where the path has this normal.

    A block that rolled has its section over the point that it touched, turning about it
    without slip, with the energy of the round block. It flies if it is fast enough for
    that. A block that slid flies as it lies. Those that do not fly, by the second
    result, roll on.
    """
    mass, inertia = constants.mass_properties
    direction, body, rolls = block.direction, block.body, block.is_rolling
    radius = constants.centre_height(block.rolls)
    speed = block.speed
    theta = body.orientation - jnp.arctan2(normal_x, normal_y)
    height, arm = support(constants.outline, jnp.sin(theta), jnp.cos(theta))
    height = jnp.where(rolls, height, radius)
    arm = jnp.where(rolls, arm, 0.0)
    rise = (height - radius) * normal_y + arm * normal_x
    whole = mass * radius**2 + inertia
    kinetic = 0.5 * whole * (speed / radius) ** 2 - mass * GRAVITY * rise
    about_edge = mass * (height**2 + arm**2) + inertia
    spin = direction * jnp.sqrt(2.0 * jnp.maximum(kinetic, 0.0) / about_edge)
    loose = (kinetic > 0.0) & (height * spin**2 > GRAVITY * normal_y)
    v_n = jnp.where(rolls, -arm * spin, 0.0)
    v_t = jnp.where(rolls, height * spin, direction * speed)
    flying = block._replace(
        phase=jnp.full_like(block.phase, float(Phase.airborne))
    ).moved(
        x=body.x + (height - radius) * normal_x - arm * normal_y,
        y=body.y + rise,
        v_x=v_t * normal_y - v_n * normal_x,
        v_y=-v_t * normal_x - v_n * normal_y,
        angular_velocity=jnp.where(rolls, spin, 0.0),
    )
    return flying, loose | ~rolls


@closed_form
def strike_corner(
    block: BlockState,
    constants: BlockConstants,
    here: tuple[Values, Values],
    ahead: tuple[Values, Values],
    segment: Values,
) -> BlockState:
    """Let a block strike the ground ahead, with its velocity along the path; directions
    are normals, of the path along which it came and of the plane on the segment ahead.

    The round block strikes; where the ellipse in its place would turn away from the
    plane, it does so along its nearest axis.
    """
    direction, body = block.direction, block.body
    speed, (here_x, here_y), (sin, cos) = block.speed, here, ahead
    height = constants.centre_height(block.rolls)
    spin = jnp.where(block.is_rolling, direction * speed / height, 0.0)
    slope = jnp.arctan2(sin, cos)
    closing = speed * (direction * (here_x * cos - here_y * sin))
    theta = body.orientation - slope
    _, arm = support(constants.outline, jnp.sin(theta), jnp.cos(theta))
    small = small_speed(constants.outline.smallest, slope)
    upright = jnp.floor(theta / (0.5 * jnp.pi) + 0.5) * (0.5 * jnp.pi)
    theta = jnp.where(closing + arm * spin < small, upright, theta)
    reach, _ = support(constants.outline, jnp.sin(theta), jnp.cos(theta))
    return block._replace(
        segment=segment,
        phase=jnp.full_like(block.phase, float(Phase.touching)),
        normal_x=sin,
        normal_y=cos,
        gap=height - reach,
    ).moved(
        v_x=direction * speed * here_y,
        v_y=-direction * speed * here_x,
        angular_velocity=spin,
        orientation=theta + slope,
    )

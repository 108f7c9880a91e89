r"""Contact with a plane: from touch to impact, and from its end back onto the plane.

**Footprint.** A block that lands on a facet of centimetres lies on more than the facet.
Where all straight lines in its footprint, of a width of half its smaller semi-axis
about the point that touches, are shorter than that width, the plane of the impact is
the chord of the ground over the footprint. Else it is the plane by which the block
touches: edges and feet of longer lines stay as sharp as they are. A block that does not
close on the chord fast enough for an impact strikes the facet.

The width is our reading: a sphere of radius r that sinks in by r/30, as blocks do,
touches the ground over about half its radius.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from ..._safe import safe_sqrt
from ...impact_response import ImpactResponse
from ...scene import GRAVITY, Impact
from .. import libm
from ..blocks import BlockOutline, Body, support, support_of
from ..ground_motion.rolling import small_speed
from ..lane_programs import Values, closed_form
from ..state import BlockConstants, BlockState
from ..terrain import Profile


class PlaneContact(NamedTuple):
    """Block that touches a plane, in the frame of the plane."""

    slope: Values  # angle w of the plane [rad]
    orientation: Values  # angle Theta [rad]
    normal_velocity: Values  # v_n [m/s], into the ground
    tangential_velocity: Values  # v_t [m/s], to the right
    angular_velocity: Values  # angular velocity [rad/s], clockwise positive
    closing: Values  # velocity at which the lowest point goes into the ground [m/s]
    slow: Values  # least closing velocity of an impact [m/s]


def contact_with_plane(
    body: Body, outline: BlockOutline, normal_x: Values, normal_y: Values
) -> PlaneContact:
    """Transform a block to the frame of the plane that it touches, given the plane's
    normal N."""
    # A wall is taken to lean by 1e-4.
    slope = jnp.arctan(normal_x / jnp.maximum(normal_y, 1e-4))
    sin, cos = jnp.sin(slope), jnp.cos(slope)
    theta = body.orientation - slope
    if outline.shape.largest_bending(outline.axes) is None:
        # Of a level flat face the lowest point is the end that comes down, not its
        # middle: a turn of more than the rounding of orientations, that lowers no block
        # by more than the gap within which it touches.
        theta = theta + 1e-9 * jnp.sign(body.angular_velocity)
    _, arm = support(outline, jnp.sin(theta), jnp.cos(theta))
    v_n = -(body.v_x * sin + body.v_y * cos)
    v_t = body.v_x * cos - body.v_y * sin
    return PlaneContact(
        slope=slope,
        orientation=theta,
        normal_velocity=v_n,
        tangential_velocity=v_t,
        angular_velocity=body.angular_velocity,
        closing=v_n + arm * body.angular_velocity,
        slow=small_speed(outline.smallest, slope),
    )


@closed_form
def touch(block: BlockState, constants: BlockConstants) -> PlaneContact:
    """Transform a block that touches the ground to the frame of the plane there."""
    return contact_with_plane(
        block.body, constants.outline, block.normal_x, block.normal_y
    )


@closed_form
def touch_facet(
    block: BlockState, constants: BlockConstants, slope: Values, turn: Values
) -> PlaneContact:
    """Transform a block that touches the ground to the frame of a facet there, which is
    turned from its segment [rad]."""
    facet = slope + turn
    return contact_with_plane(
        block.body, constants.outline, jnp.sin(facet), jnp.cos(facet)
    )


@closed_form
def impact_of(contact: PlaneContact) -> Impact:
    """Describe a contact with a plane as an impact.

    The angle may pass 90 degrees: a turning block can strike while its centre rises.
    """
    v_n, v_t = contact.normal_velocity, contact.tangential_velocity
    speed = jnp.maximum(jnp.sqrt(v_n**2 + v_t**2), 1e-12)
    # Half the angle, from the side on which nothing cancels.
    steep = v_n >= 0.0
    towards = v_t / jnp.where(steep, speed + v_n, 1.0)
    away = (speed - v_n) / jnp.where(v_t == 0.0, 1e-300, v_t)
    return Impact(
        speed=speed,
        angle=2.0 * jnp.arctan(jnp.where(steep, towards, away)),
        orientation=contact.orientation,
        angular_velocity=contact.angular_velocity,
        slope=contact.slope,
    )


class PostImpact(NamedTuple):
    """Block after a contact, tangent to the plane again."""

    orientation: Values  # angle Theta [rad]
    rise: Values  # displacement of the centre along N since touch [m]
    travel: Values  # displacement of the centre along t since touch [m]
    normal_velocity: Values  # velocity v_n of the centre [m/s]
    tangential_velocity: Values  # velocity v_t of the centre [m/s]
    angular_velocity: Values  # angular velocity [rad/s]
    leaving: Values  # velocity at which the lowest point leaves the ground [m/s]
    climbs: Values  # 1 where the block's energy lifts it out of the ground

    def scaled(self, fraction: Values) -> "PostImpact":
        """Scale the velocities of the block, but not that of leaving."""
        return self._replace(
            normal_velocity=fraction * self.normal_velocity,
            tangential_velocity=fraction * self.tangential_velocity,
            angular_velocity=fraction * self.angular_velocity,
        )


class Settled(NamedTuple):
    """Block after a contact, before it travels along the plane."""

    after: PostImpact
    x: Values  # centre, without the travel [m]
    y: Values
    along_x: Values  # travel along the plane, x and y [m]
    along_y: Values


@closed_form
def settle(
    block: BlockState,
    constants: BlockConstants,
    contact: PlaneContact,
    response: ImpactResponse,
) -> Settled:
    """Set a block back on the plane after its contact.

    It ends its contact some depth in the ground and has to climb out: m g cos w times
    that depth is taken from its kinetic energy, from all velocities alike, and so is a
    depth, or height above the plane, at contact. The model does not follow the travel
    along the plane during contact: it is the duration times the mean of v_t before and
    after; up-slope it ends where it would add energy, see `impact.depart`.
    """
    outline, mass = constants.outline, constants.mass_properties.mass
    sin, cos = jnp.sin(contact.slope), jnp.cos(contact.slope)
    theta = contact.orientation + response.rotation
    before, _ = support(
        outline, jnp.sin(contact.orientation), jnp.cos(contact.orientation)
    )
    radius, arm = support(outline, jnp.sin(theta), jnp.cos(theta))
    v_n, v_t, spin = response[:3]
    kinetic = constants.mass_properties.kinetic_energy(v_n, v_t, spin)
    climb = mass * GRAVITY * cos * (response.sinking - block.gap)
    left = kinetic - climb
    fraction = safe_sqrt(left / jnp.where(kinetic > 0.0, kinetic, 1.0))
    v_n, v_t, spin = fraction * v_n, fraction * v_t, fraction * spin
    mean = 0.5 * (contact.tangential_velocity + response.tangential_velocity)
    after = PostImpact(
        orientation=theta,
        # A block that cannot climb stays as deep as it is.
        rise=radius - before - jnp.where(left > 0.0, block.gap, response.sinking),
        travel=mean * response.duration,
        normal_velocity=v_n,
        tangential_velocity=v_t,
        angular_velocity=spin,
        leaving=-(v_n + arm * spin),
        climbs=(left > 0.0).astype(float),
    )
    return Settled(
        after,
        x=block.body.x + after.rise * sin,
        y=block.body.y + after.rise * cos,
        along_x=after.travel * cos,
        along_y=-after.travel * sin,
    )


class Continuation(NamedTuple):
    """Motion of a block after its contact, seen from the segment that it touched."""

    x: Values  # centre [m]
    y: Values
    orientation: Values  # angle Theta from the segment [rad]
    tangential_velocity: Values  # velocity along the segment [m/s]
    over: Values  # height above the segment [m]; above 0 only after a facet
    rising: Values  # velocity of the centre out of the segment [m/s]
    leaves: Values  # true for a block whose lowest point leaves the ground
    stuck: Values  # true for a block that lacks the energy to climb out of the ground


def on_footprint(
    profile: Profile, block: BlockState, constants: BlockConstants
) -> BlockState:
    """Give blocks that touch the ground the planes that they strike."""
    outline = constants.outline
    half = 0.25 * outline.smallest
    lines = profile.straight_length
    small = np.flatnonzero(lines[block.segment.astype(int)] < 2.0 * half)
    if not len(small):
        return block
    n_x, n_y = block.normal_x, block.normal_y
    theta = block.body.orientation - libm.arctan2(n_x, n_y)
    radius, arm = support_of(outline, theta)
    x = (block.body.x - radius * n_x + arm * n_y)[small]  # of the point that touches
    one = np.maximum(x - half[small], profile.x[0])
    two = np.minimum(x + half[small], profile.x[-1])
    first = np.searchsorted(profile.x, one, side="right") - 1
    last = np.searchsorted(profile.x, two, side="left")
    ranges = np.stack([first, last], axis=1).ravel()
    longest = np.maximum.reduceat(np.append(lines, 0.0), ranges)[::2]
    fine = longest < 2.0 * half[small]
    small, one, two = small[fine], one[fine], two[fine]
    d_x, d_y = two - one, profile.height(two) - profile.height(one)
    length = np.sqrt(d_x**2 + d_y**2)
    normal_x, normal_y = n_x.copy(), n_y.copy()
    normal_x[small], normal_y[small] = -d_y / length, d_x / length
    struck = block._replace(normal_x=normal_x, normal_y=normal_y)
    touched = touch(struck, constants)
    closes = touched.closing >= touched.slow
    return block._replace(
        normal_x=np.where(closes, normal_x, n_x),
        normal_y=np.where(closes, normal_y, n_y),
    )

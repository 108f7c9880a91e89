r"""Ground that is narrower than a block: what a block on the ground runs into there.

A block on the ground is a circle of radius $h$ that touches its segment, or turns about
a point of the profile. In ditches, gaps and on steps smaller than itself it comes to
other segments than the next one, to their faces or to the points between them.

**Along a segment**, in the direction d from the centre c, it touches the line of a face
with the normal n through a point p, and a point p, after

$$ \frac{n\cdot(c - p) - h}{-n\cdot d}, \qquad
   b - \sqrt{b^2 - |p - c|^2 + h^2}, \quad b = d\cdot(p - c). $$

**About a point q**, with the centre at $q + h\,(\sin\alpha, \cos\alpha)$, it touches
the line of a face of slope w, and a point p, at an angle from w, and from the direction
$\beta$ of p from the upright,

$$ \arccos\left(1 - \frac{n\cdot(q - p)}{h}\right), \qquad
   -\arccos\frac{|p - q|}{2 h}. $$
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from ..blocks import Body
from ..lane_programs import Values
from ..narrow_places import NONE, ROUNDING
from ..terrain import Profile
from .running_into import Plane


class Obstacle(NamedTuple):
    """Ground that a block runs into, of many arrays `(lanes,)`."""

    is_point: Values
    """1 for a point of the profile, 0 for a face."""
    x: Values
    """The point, or one of the face [m]."""
    y: Values
    slope: Values
    """Angle of the face [rad]; for a point, of the segment at its left, if any."""
    segment: Values
    """Number of that segment."""
    right: Values
    """Number of the segment at a point's right, if any; else of that segment."""
    point: Values
    """Number of the point; -1 for a face."""


def distance_to(
    obstacle: Obstacle, body: Body, direction: tuple[Values, Values], height: Values
) -> Values:
    """Compute the way along a direction to the touch [m]; 0 for a block that is already
    in an obstacle to which it moves.

    Args:
        direction: unit vector of the motion.
        height: radius of the circle [m].
    """
    to_x, to_y = obstacle.x - body.x, obstacle.y - body.y
    sin, cos = jnp.sin(obstacle.slope), jnp.cos(obstacle.slope)
    towards = -(sin * direction[0] + cos * direction[1])
    to_face = -(sin * to_x + cos * to_y) - height
    to_face /= jnp.where(towards > 0.0, towards, 1.0)
    along = direction[0] * to_x + direction[1] * to_y
    left = along**2 - (to_x**2 + to_y**2 - height**2)
    to_point = along - jnp.sqrt(jnp.maximum(left, 0.0))
    return jnp.maximum(jnp.where(obstacle.is_point > 0.0, to_point, to_face), 0.0)


def turn_to(
    obstacle: Obstacle, pivot: tuple[Values, Values], direction: Values, height: Values
) -> Values:
    """Compute the angle of the plane on which a block that turns about a point touches
    an obstacle [rad], seen in its direction of motion.

    Args:
        pivot: the point [m].
        direction: 1 to the right, -1 to the left.
        height: radius of the circle [m].
    """
    from_x, from_y = obstacle.x - pivot[0], obstacle.y - pivot[1]
    sin, cos = jnp.sin(obstacle.slope), jnp.cos(obstacle.slope)
    over = -(sin * from_x + cos * from_y)
    to_face = direction * obstacle.slope + jnp.arccos(
        jnp.clip(1.0 - over / height, -1.0, 1.0)
    )
    apart = jnp.sqrt(from_x**2 + from_y**2)
    towards = direction * jnp.arctan2(from_x, from_y)
    to_point = towards - jnp.arccos(jnp.minimum(0.5 * apart / height, 1.0))
    return jnp.where(obstacle.is_point > 0.0, to_point, to_face)


def plane_at(
    obstacle: Obstacle, body: Body, here: Values, direction: Values, friction: Values
) -> Plane:
    """Describe the plane by which a block touches an obstacle.

    Args:
        here: angle of the plane along which it came [rad].
        direction: 1 to the right, -1 to the left.
        friction: tangent of the angle of rolling friction at the obstacle.
    """
    is_point = obstacle.is_point > 0.0
    leaning = jnp.arctan2(body.x - obstacle.x, body.y - obstacle.y)
    slope = jnp.where(is_point, leaning, obstacle.slope)
    # A plane at a point leans to the right of the segment at its left, and to the left
    # of the one at its right; one that is in the ground may lean out of both.
    other = is_point & (slope < obstacle.slope)
    return Plane(
        *(obstacle.x, obstacle.y, slope),
        segment=jnp.where(other, obstacle.right, obstacle.segment),
        point=obstacle.point,
        rolling_friction=friction,
        turn=direction * (here - slope),
    )


class _Others(NamedTuple):
    """Segments that blocks may touch, arrays `(lanes, most)`."""

    segment: np.ndarray
    exists: np.ndarray
    start: tuple[np.ndarray, np.ndarray]
    end: tuple[np.ndarray, np.ndarray]
    slope: np.ndarray
    length: np.ndarray


def _others(profile: Profile, segments: np.ndarray) -> _Others:
    j = np.maximum(segments, 0)
    x, y = profile.x, profile.y
    return _Others(
        *(j, segments != NONE),
        *((x[j], y[j]), (x[j + 1], y[j + 1])),
        *(profile.slope[j], profile.length[j]),
    )


def obstacles_along(
    profile: Profile,
    segments: np.ndarray,
    own: np.ndarray,
    centre: tuple[np.ndarray, np.ndarray],
    direction: np.ndarray,
    height: np.ndarray,
    room: np.ndarray,
) -> tuple[np.ndarray, Obstacle]:
    """Find what blocks that move along segments run into before the segments' ends.

    Args:
        segments: a row of `NarrowPlaces.along` for each block.
        own: the segments that they are on.
        centre: their centres [m].
        direction: 1 to the right, -1 to the left.
        height: radii of their circles [m].
        room: distances to the ends of the segments [m].

    Returns:
        True where they run into anything but the face of the next segment, and what.
    """
    ground, h = _others(profile, segments), height[:, None]
    slope = profile.slope[own]
    d_x, d_y = direction * np.cos(slope), -direction * np.sin(slope)
    x, y, d_x, d_y = (v[:, None] for v in (*centre, d_x, d_y))
    sin, cos = np.sin(ground.slope), np.cos(ground.slope)
    over = sin * (x - ground.start[0]) + cos * (y - ground.start[1])
    towards = -(sin * d_x + cos * d_y)
    nears = towards > ROUNDING
    way = np.maximum((over - h) / np.where(nears, towards, 1.0), 0.0)
    foot = cos * (x + d_x * way - ground.start[0])
    foot -= sin * (y + d_y * way - ground.start[1])
    touches = nears & (over > 0.0) & (foot >= 0.0) & (foot <= ground.length)
    ways = [np.where(touches & ground.exists, way, np.inf)]
    for point, number in ((ground.start, 0), (ground.end, 1)):
        to_x, to_y = point[0] - x, point[1] - y
        along = d_x * to_x + d_y * to_y
        left = along**2 - (to_x**2 + to_y**2 - h**2)
        way = np.maximum(along - np.sqrt(np.maximum(left, 0.0)), 0.0)
        place = ground.segment + number
        beside = (place == own[:, None]) | (place == own[:, None] + 1)
        touches = (left > 0.0) & (along > ROUNDING * h) & ~beside & ground.exists
        ways.append(np.where(touches, way, np.inf))
    first, obstacle = _first(profile, ground, ways)
    next_face = (obstacle.is_point == 0.0) & (obstacle.segment == own + direction)
    return (first < room) & ~next_face, obstacle


def obstacles_about(
    profile: Profile,
    segments: np.ndarray,
    point: np.ndarray,
    turn: tuple[np.ndarray, np.ndarray],
    direction: np.ndarray,
    height: np.ndarray,
) -> tuple[np.ndarray, Obstacle]:
    """Find what blocks run into that turn about points of the profile.

    Args:
        segments: a row of `NarrowPlaces.about` for each block.
        point: the points.
        turn: angles of the planes before and after, seen in the direction of motion
            [rad].
        direction: 1 to the right, -1 to the left.
        height: radii of their circles [m].

    Returns:
        True where they run into anything before the end of the turn, and what.
    """
    ground, h = _others(profile, segments), height[:, None]
    before = turn[0][:, None]
    x, y = profile.x[point][:, None], profile.y[point][:, None]
    way = direction[:, None]
    sin, cos = np.sin(ground.slope), np.cos(ground.slope)
    over = sin * (x - ground.start[0]) + cos * (y - ground.start[1])
    beside = (ground.segment == point[:, None]) | (ground.segment == point[:, None] - 1)
    face = way * ground.slope
    angle = face + np.arccos(np.clip(1.0 - over / h, -1.0, 1.0))
    # One that is in the ground already touches at once if it goes on into it.
    nears = (over >= 0.0) & (over < 2.0 * h) & (before < face + np.pi)
    angle = np.maximum(angle, before)
    c_x, c_y = x + h * way * np.sin(angle), y + h * np.cos(angle)
    foot = cos * (c_x - ground.start[0]) - sin * (c_y - ground.start[1])
    in_front = sin * (c_x - ground.start[0]) + cos * (c_y - ground.start[1]) > 0.0
    touches = nears & in_front & ~beside
    touches &= (foot >= 0.0) & (foot <= ground.length)
    angles = [np.where(touches & ground.exists, angle, np.inf)]
    for end, number in ((ground.start, 0), (ground.end, 1)):
        from_x, from_y = end[0] - x, end[1] - y
        apart = np.hypot(from_x, from_y)
        towards = way * np.arctan2(from_x, from_y)
        angle = towards - np.arccos(np.clip(0.5 * apart / h, 0.0, 1.0))
        touches = (apart < 2.0 * h) & (before < towards) & ground.exists
        touches &= ground.segment + number != point[:, None]
        angles.append(np.where(touches, np.maximum(angle, before), np.inf))
    first, obstacle = _first(profile, ground, angles)
    return first < turn[1], obstacle


def _first(
    profile: Profile, ground: _Others, ways: list[np.ndarray]
) -> tuple[np.ndarray, Obstacle]:
    """Choose what is touched first: a face, its start or its end."""
    most = ground.segment.shape[1]
    together = np.concatenate(ways, axis=1)
    place = np.argmin(together, axis=1)
    lanes = np.arange(len(place))
    kind, column = np.divmod(place, most)
    segment = ground.segment[lanes, column]
    is_point = kind > 0
    point = np.where(kind == 2, segment + 1, segment)
    segment = np.where(is_point, np.maximum(point - 1, 0), segment)
    right = np.where(is_point, np.minimum(point, profile.segments - 1), segment)
    return together[lanes, place], Obstacle(
        is_point.astype(float),
        *(profile.x[point], profile.y[point], profile.slope[segment]),
        *(segment.astype(float), right.astype(float)),
        np.where(is_point, point, -1).astype(float),
    )

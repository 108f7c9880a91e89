r"""Narrow phase: how long a block in flight is certain not to touch the ground.

The ground is the union of columns, one under each segment. A direction N that parts the
block from a column, with the column's corner p farthest along N, has a gap

$$ g(t) = N\cdot(c(t) - p) - r_y(\varphi(t) - w), \qquad
   \ddot g = -g_0 N_y - \Omega^2 r_y'' \ge -K, $$

where the shape bounds $r_y''$, as an ellipse does. So the gap stays open for as long as
$g + \dot g\tau - K\tau^2/2$ does: that much time is certain, and as it comes closer the
steps are Newton's and better, at any spin.

A flat face has no such bound: where the block comes to lie on it, the lowest point
jumps to the other end. But a convex body lies between the tangents at two orientations,

$$ r_y(\Theta + s) \le \frac{r_y(\Theta)\sin(\delta - s) +
   r_y(\Theta + \delta)\sin s}{\sin\delta}, \qquad 0 \le s \le \delta, $$

the support of the point in which these meet, whose $r_y''$ is not positive. So with its
arm, $(r_y(\Theta + \delta) - r_y\cos\delta)/\sin\delta$, in place of $r_y'$, and
$K = g_0 N_y$, the time is certain again until the block has turned by $\delta$. Of
several $\delta$ the one that gives the longest time counts. And the gap to an end of
the segment may be taken in a direction that turns with the block, until that points
beyond the segment's normal or the horizontal; then $r_y$ does not change at all, and

$$ \ddot g \ge -g_0 - 2 |\Omega| |v| - \Omega^2 |c - p| . $$

Directions tried: the segment's normal, and at each of its ends the shape's
`parting_direction`, or the horizontal if that points down. If the block does not touch
the column one of the three has an open gap. By default the direction is the one from
the end to the nearest point of the block: what is nearest to the block in the column
lies inside the segment, at an end of it, or on a wall below an end, and is parted from
it by the segment's normal, that direction, or the horizontal.
"""

import math
from typing import NamedTuple

import jax.numpy as jnp

from ...scene import GRAVITY
from ..blocks import BlockOutline, Body, choose, support
from ..lane_programs import Values

NEVER = 1e30
"""Time that does not come [s]."""
TURNS_AHEAD = tuple(1.5 / 8.0**k for k in range(7))
"""Delta [rad]: to less than a block turns by while it falls out of reach of a touch."""


class Piece(NamedTuple):
    """Segment of the ground, or many, by its ends [m]."""

    left_x: Values
    left_y: Values
    right_x: Values
    right_y: Values


class Gap(NamedTuple):
    """Gap between a block and a column, in a direction that may part them."""

    width: Values  # width g [m]; negative where the direction does not part them
    opening: Values  # rate dg/dt [m/s]
    normal_x: Values  # direction N from the column to the block
    normal_y: Values


def bending_or_size(outline: BlockOutline) -> Values:
    r"""Bound $r_y''$ [m]; a shape without a bound gives its size."""
    bending = outline.shape.largest_bending(outline.axes)
    return outline.largest if bending is None else bending


def gap_along(
    body: Body, outline: BlockOutline, axis, normal, point, touches=None
) -> Gap:
    """Compute the gap along a direction from a point of the ground.

    Args:
        axis: sine and cosine of the orientation.
        normal, point: x and y.
        touches: true where a shape that may have flat faces can touch the point itself,
            so that the gap is to the point and not to a plane through it.
    """
    sin_phi, cos_phi = axis
    n_x, n_y = normal
    sin, cos = sin_phi * n_y - cos_phi * n_x, cos_phi * n_y + sin_phi * n_x
    reach, arm = support(outline, sin, cos)
    if touches is not None:
        # A flat face turns on the point, and the direction turns with the face.
        of_point = n_y * (point[0] - body.x) - n_x * (point[1] - body.y)
        arm = jnp.where(touches, of_point, arm)
    height = n_x * (body.x - point[0]) + n_y * (body.y - point[1])
    speed = n_x * body.v_x + n_y * body.v_y
    return Gap(height - reach, speed - arm * body.angular_velocity, n_x, n_y)


def gaps(body: Body, outline: BlockOutline, axis, piece: Piece) -> list[Gap]:
    """Compute gaps in all directions tried; the width is -inf for an invalid one."""
    width, rise = piece.right_x - piece.left_x, piece.right_y - piece.left_y
    length = jnp.sqrt(width**2 + rise**2)
    t_x, t_y = width / length, rise / length
    left, right = (piece.left_x, piece.left_y), (piece.right_x, piece.right_y)
    has_no_faces = outline.shape.largest_bending(outline.axes) is not None
    candidates = [gap_along(body, outline, axis, (-t_y, t_x), left)]
    for side, point in ((-1.0, left), (1.0, right)):
        n_x, n_y = normal_through(body, outline, axis, point)
        down = n_y < 0.0
        n_x, n_y = jnp.where(down, side, n_x), jnp.where(down, 0.0, n_y)
        touches = None if has_no_faces else ~down
        gap = gap_along(body, outline, axis, (n_x, n_y), point, touches)
        holds = side * (n_x * t_x + n_y * t_y) >= 0.0
        candidates.append(gap._replace(width=jnp.where(holds, gap.width, -jnp.inf)))
    return candidates


def normal_through(body: Body, outline: BlockOutline, axis, point):
    """Compute the direction, from a point to the block, that parts the shape from
    it."""
    sin_phi, cos_phi = axis
    x, y = body.x - point[0], body.y - point[1]
    along, across = outline.shape.parting_direction(
        outline.axes, x * sin_phi + y * cos_phi, x * cos_phi - y * sin_phi
    )
    n_x = along * sin_phi + across * cos_phi
    n_y = along * cos_phi - across * sin_phi
    size = jnp.sqrt(n_x**2 + n_y**2)
    # A block centred on the point is far from parted from it.
    size = jnp.where(size > 0.0, size, 1.0)
    return n_x / size, n_y / size


def widest(candidates: list[Gap]) -> Gap:
    """Choose the widest gap."""
    best = candidates[0]
    for gap in candidates[1:]:
        best = choose(gap.width > best.width, gap, best)
    return best


def time_open(width: Values, opening: Values, closing_acceleration: Values) -> Values:
    r"""Compute the positive root of $g + \dot g\tau - K\tau^2/2$ without
    cancellation."""
    bound = jnp.maximum(closing_acceleration, 1e-12)
    root = jnp.sqrt(opening**2 + 2.0 * bound * width)
    return jnp.where(
        opening > 0.0,
        (opening + root) / bound,
        2.0 * width / jnp.maximum(root - opening, 1e-300),
    )


def _time_open_to_plane(
    body: Body, outline: BlockOutline, axis, gap: Gap, width: Values
) -> Values:
    """Bound the time for which a gap of this width stays open [s]."""
    shape, axes = outline.shape, outline.axes
    bending = shape.largest_bending(axes)
    if bending is not None:
        spin = body.angular_velocity**2 * bending
        return time_open(width, gap.opening, GRAVITY * gap.normal_y + spin)
    (sin_phi, cos_phi), n_x, n_y = axis, gap.normal_x, gap.normal_y
    sin, cos = sin_phi * n_y - cos_phi * n_x, cos_phi * n_y + sin_phi * n_x
    reach = shape.support(axes, sin, cos)
    speed = n_x * body.v_x + n_y * body.v_y
    spin = jnp.abs(body.angular_velocity)
    sense = jnp.where(body.angular_velocity < 0.0, -1.0, 1.0)
    longest = jnp.zeros_like(width)
    for turn in TURNS_AHEAD:
        sin_turn, cos_turn = sense * math.sin(turn), math.cos(turn)
        ahead = shape.support(
            axes, sin * cos_turn + cos * sin_turn, cos * cos_turn - sin * sin_turn
        )
        arm = (ahead - reach * cos_turn) / math.sin(turn)
        time = time_open(width, speed - arm * spin, GRAVITY * n_y)
        lasts = turn / jnp.maximum(spin, 1.0 / NEVER)
        longest = jnp.maximum(longest, jnp.minimum(time, lasts))
    return longest


def _time_open_to_point(
    body: Body,
    outline: BlockOutline,
    gap: Gap,
    width: Values,
    line: Gap,
    side: float,
    point: tuple[Values, Values],
) -> Values:
    """Bound the time for which the gap to an end of a segment stays open [s], in a
    direction that turns with the block: a flat face that turns on a point stays parted
    from it. It may turn up to the segment's normal, that of the gap `line`, or to the
    horizontal; the side is -1 for the left end, 1 for the right one."""
    spin = jnp.abs(body.angular_velocity)
    to_line = side * body.angular_velocity < 0.0
    end_x = jnp.where(to_line, line.normal_x, side)
    end_y = jnp.where(to_line, line.normal_y, 0.0)
    free = jnp.sqrt((gap.normal_x - end_x) ** 2 + (gap.normal_y - end_y) ** 2)
    speed = jnp.sqrt(body.v_x**2 + body.v_y**2)
    size = outline.largest
    lasts = jnp.minimum(
        free / jnp.maximum(spin, 1.0 / NEVER),
        size / (speed + jnp.sqrt(GRAVITY * size)),
    )
    fastest = speed + GRAVITY * lasts
    farthest = jnp.sqrt((body.x - point[0]) ** 2 + (body.y - point[1]) ** 2)
    farthest = farthest + fastest * lasts
    bound = GRAVITY + 2.0 * spin * fastest + spin**2 * farthest
    time = jnp.minimum(time_open(width, gap.opening, bound), lasts)
    return jnp.where(gap.normal_y > 0.0, time, 0.0)


def time_without_contact(
    body: Body,
    outline: BlockOutline,
    axis,
    piece: Piece,
    candidates: list[Gap],
    depth: Values,
    slack: Values,
) -> Values:
    """Bound the time for which the block does not touch a column [s].

    Args:
        axis: sine and cosine of the orientation.
        candidates: gaps of the block to this column.
        depth: depth by which the column is taken to lie lower than it does [m].
        slack: depth by which the block may sink in [m], so that it can start where it
            touches.
    """
    times = []
    ends = (-1.0, (piece.left_x, piece.left_y)), (1.0, (piece.right_x, piece.right_y))
    has_no_faces = outline.shape.largest_bending(outline.axes) is not None
    for number, gap in enumerate(candidates):
        width = gap.width + depth + slack
        is_apart = width > -slack  # but for rounding
        width = jnp.maximum(width, 0.01 * slack)
        time = _time_open_to_plane(body, outline, axis, gap, width)
        if number > 0 and not has_no_faces:
            side_and_point = ends[number - 1]
            off_point = _time_open_to_point(
                body, outline, gap, width, candidates[0], *side_and_point
            )
            time = jnp.maximum(time, off_point)
        times.append(jnp.where(is_apart, time, 0.0))
    # However it turns, the block stays inside its circumscribed circle.
    line, largest = candidates[0], outline.largest
    speed = line.normal_x * body.v_x + line.normal_y * body.v_y
    height = line.normal_x * (body.x - piece.left_x) + line.normal_y * (
        body.y - piece.left_y
    )
    clear = time_open(
        jnp.maximum(height - largest, 0.0), speed, GRAVITY * line.normal_y
    )
    times.append(jnp.where(height > largest, clear, 0.0))
    for distance, towards in (
        (piece.left_x - largest - body.x, body.v_x),
        (body.x - piece.right_x - largest, -body.v_x),
    ):
        arrival = jnp.where(
            towards > 0.0, distance / jnp.where(towards > 0.0, towards, 1.0), NEVER
        )
        times.append(jnp.where(distance > 0.0, arrival, 0.0))
    longest = times[0]
    for time in times[1:]:
        longest = jnp.maximum(longest, time)
    return longest

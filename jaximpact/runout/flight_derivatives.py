r"""Derivatives of the ends of flights.

A flight that is struck ends at the first zero of the gap $g(t, p)$ between block and
ground, so that its time changes with a parameter p by

$$ \frac{dt}{dp} = -\frac{\partial g/\partial p}{\partial g/\partial t}. $$

At a corner of the ground the gap is that along the block's normal there, which turns as
the block does.
"""

import jax.numpy as jnp
import numpy as np

from .dual import Dual, carrying, plain
from .flight import FlightEnds
from .motion import Body, Outline, fly, take
from .motion import support_of as support
from .profile import Profile
from .programs import closed_form
from .separation import normal_through

SAME_PLANE = 1e-9
"""Sine of an angle between planes within which they are the same."""
IN_THE_GROUND = 1e-8
"""Part of the larger semi-axis by which a block that is struck was in the ground
already."""


def differentiate_ends(
    ends: FlightEnds,
    body: Body,
    outline: Outline,
    profile: Profile,
    time_limit: np.ndarray,
    parameters: int,
) -> FlightEnds:
    """The ends of flights, with derivatives of their times, normals and gaps.

    Args:
        ends: found by `follow_flights`.
        body, outline, profile, time_limit: as there; some of them carry derivatives.
        parameters: by how many.

    A block that is struck as it starts, as in a corner after it was set back on one
    side of it, is struck at once for other parameters too: its gap changes, its time
    does not. Derivatives are NaN where a flight failed, and where a block that started
    in the ground is struck later: how far in is left to the search.
    """
    body = Body(*(carrying(value, parameters) for value in body))
    corner, point_x, point_y = _points(ends, profile)

    def normals(of: Body) -> Dual:
        """Of the planes that blocks touch."""
        normal = carrying(ends.normal, parameters)
        if len(corner):
            normal[:, corner] = normal_at(
                take(of, corner),
                take(outline, corner),
                point_x[corner],
                point_y[corner],
            )
        return normal

    at_end = fly(body, ends.time)
    n_x, n_y = normals(at_end)
    reach = support(outline, at_end.orientation - np.arctan2(n_x, n_y))
    width = n_x * (at_end.x - point_x) + n_y * (at_end.y - point_y) - reach.radius
    arm = plain(reach.arm)
    if plain(outline.shape).largest_bending(plain(outline.axes)) is None:
        # On a flat face the point that touches is that of the ground.
        d_x, d_y = point_x - plain(at_end.x), point_y - plain(at_end.y)
        of_point = plain(n_y) * d_x - plain(n_x) * d_y
        arm[corner] = of_point[corner]
    opening = n_x * at_end.v_x + n_y * at_end.v_y - arm * body.angular_velocity
    at_once = ends.touched & (ends.time == 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        of_touch = np.where(at_once, 0.0, -width.tangent / opening.value)
        border = np.where(body.v_x.value > 0.0, profile.x[-1], profile.x[0])
        of_leaving = np.maximum((border - body.x) / body.v_x, 0.0).tangent
    of_limit = carrying(time_limit, parameters).tangent
    tangent = np.where(ends.left, of_leaving, of_limit)
    tangent = np.where(ends.touched, of_touch, tangent)
    tangent = np.where(ends.failed, np.nan, tangent)
    time = Dual(ends.time, tangent)
    was_in = np.abs(ends.gap) > IN_THE_GROUND * plain(outline.largest)
    of_gap = np.where(was_in, np.nan, np.zeros_like(tangent))
    gap = Dual(ends.gap, np.where(at_once, width.tangent, of_gap))
    normal = normals(fly(body, time))
    return FlightEnds(
        time, ends.touched, ends.left, ends.failed, ends.segment, normal, gap
    )


def _points(ends: FlightEnds, profile: Profile):
    """Lanes that touch a point of the profile by a leaning plane; and for each lane a
    point of what it touches."""
    slope, (n_x, n_y) = profile.slope[ends.segment], ends.normal
    between = n_x * np.cos(slope) - n_y * np.sin(slope)
    leans = ends.touched & (np.abs(between) > SAME_PLANE) & (n_y > 0.0)
    # Planes at the left end of a segment lean to the left of it.
    point = np.where(leans & (between > 0.0), ends.segment + 1, ends.segment)
    return np.flatnonzero(leans), profile.x[point], profile.y[point]


def _normal_at(body: Body, outline: Outline, point_x, point_y):
    axis = jnp.sin(body.orientation), jnp.cos(body.orientation)
    return normal_through(body, outline, axis, (point_x, point_y))


normal_at = closed_form(_normal_at)
"""Inward normal of a block at a point of its outline, x and y."""

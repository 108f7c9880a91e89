"""Transition of blocks on the ground: along the path of the centre to the next event,
and what happens there."""

import concurrent.futures

import numpy as np

from ..._settings import numpy_settings
from ...backend.threads import thread_count
from ...scene import GRAVITY
from .. import libm
from ..blocks import put, select
from ..centre_path import LEFT_BEHIND
from ..state import NONE, BlockConstants, BlockState, Phase, RunState
from ..trajectory import Ending, Pieces
from .conditions import Riders, least_squared
from .ride import Event, Place, Ride, ride
from .rolling import SMALL_RISE, lie_down, strike_corner, take_off

SHORTEST_LOOKAHEAD, LONGEST_LOOKAHEAD = 4, 128
"""Numbers of elements ahead that a ride evaluates: few after an event, more while
nothing happens."""


def move_along(state: RunState, lanes: np.ndarray) -> None:
    """Move blocks along the ground to their next events."""
    blocks = state.blocks
    lanes = _placed(state, lanes)
    while len(lanes):
        lookaheads = state.lookahead[lanes]
        jobs = []
        for width in np.unique(lookaheads):
            alike = lanes[lookaheads == width]
            # As many elements at a time as the caches of a core have room for.
            parts = -(-len(alike) * int(width) // 30_000)
            jobs += [(part, int(width)) for part in np.array_split(alike, parts)]
        _ride_side_by_side(state, jobs)
        grounded = blocks.phase[lanes] == Phase.grounded
        known = blocks.element[lanes] != NONE
        lanes = lanes[grounded & known]


def _ride_side_by_side(state: RunState, jobs: list[tuple[np.ndarray, int]]) -> None:
    """Let parts of the blocks ride, on all cores; the first alone, so that what has to
    be compiled is compiled once."""

    def ride_on(job: tuple[np.ndarray, int]) -> None:
        with numpy_settings():  # which belong to a thread
            _ride(state, *job)

    first, *others = jobs
    _ride(state, *first)
    if len(others) < 2 or thread_count() == 1:
        for job in others:
            _ride(state, *job)
        return
    with concurrent.futures.ThreadPoolExecutor(thread_count()) as pool:
        list(pool.map(ride_on, others))


def _placed(state: RunState, lanes: np.ndarray) -> np.ndarray:
    """Put blocks onto the path of the centre, at the cost of the energy for it, and
    give those that move: one that cannot come up is wedged where it lies, and stops."""
    blocks = state.blocks
    new = lanes[blocks.element[lanes] == NONE]
    if not len(new):
        return lanes
    block, constants = select((blocks, state.constants), new)
    riders, body = _riders(state, block, constants), block.body
    first, last = state.profile.x[0], state.profile.x[-1]
    left = (body.x <= first) | (body.x >= last)
    element, y = state.path.locate(body.x, riders.radius, block.direction)
    lift = y - body.y
    squared = block.speed_squared - 2.0 * GRAVITY * lift / (1.0 + riders.ratio)
    rounding = np.abs(lift) <= LEFT_BEHIND * riders.radius
    squared = np.where(rounding, block.speed_squared, squared)
    wedged = (squared < 0.0) & ~left
    ends = left | wedged
    ending = np.where(left, float(Ending.left_profile), float(Ending.stopped))
    after = block._replace(
        element=element.astype(float),
        speed_squared=np.where(ends, block.speed_squared, squared),
        phase=np.where(ends, float(Phase.ended), block.phase),
        ending=np.where(ends, ending, block.ending),
    ).moved(y=np.where(ends, body.y, y))
    state.move(new, after)
    state.lookahead[new] = SHORTEST_LOOKAHEAD
    state.blocked[new] = False
    return lanes[blocks.phase[lanes] == Phase.grounded]


def _riders(state: RunState, block: BlockState, constants: BlockConstants) -> Riders:
    """Describe blocks as a ride needs them."""
    outline, whole = constants.outline, constants.round
    rolls = block.rolls > 0.0
    radius = np.where(rolls, whole.radius, outline.smallest)
    mass, inertia = constants.mass_properties
    small = 2.0 * GRAVITY * SMALL_RISE * outline.smallest
    return Riders(
        radius=radius,
        ratio=np.where(rolls, inertia / (mass * radius**2), 0.0),
        rolls=rolls,
        barrier=np.where(rolls, whole.tallest - whole.radius, 0.0),
        turning_slope=np.asarray(whole.turning_slope),
        flat_curvature=outline.largest**2 / outline.smallest,
        hop=np.maximum(
            state.limits.hop_threshold * outline.heave, SMALL_RISE * outline.smallest
        ),
        closing=small,
    )


def _ride(state: RunState, lanes: np.ndarray, width: int) -> None:
    """Move blocks along the path, and apply the events that end their rides."""
    block, constants = select((state.blocks, state.constants), lanes)
    riders, direction = _riders(state, block, constants), block.direction

    def friction_of(segments: np.ndarray) -> np.ndarray:
        row = lanes.reshape(-1, *(1,) * (segments.ndim - 1))
        return np.where(
            riders.rolls.reshape(row.shape),
            state.ground.rolling_friction[row, segments],
            state.ground.sliding_friction[row, segments],
        )

    begin = Place(
        element=block.element.astype(int),
        x=direction * block.body.x,
        y=block.body.y,
        speed_squared=block.speed_squared,
        time=block.time,
    )
    ridden, pieces = ride(
        path=state.path,
        friction_of=friction_of,
        riders=riders,
        begin=begin,
        stays_on=state.stays_on[lanes],
        passed=state.passed[lanes],
        time_limit=state.limits.time,
        width=width,
    )
    state.pieces.add(lanes[pieces.trajectory], _out_of_mirror(pieces, block))
    end = ridden.end
    after = block._replace(
        time=end.time,
        element=end.element.astype(float),
        speed_squared=end.speed_squared,
    ).moved(
        x=direction * end.x,
        y=end.y,
        orientation=block.body.orientation + direction * ridden.turned,
    )
    put(state.blocks, lanes, after)
    goes_on = ridden.event == Event.continues
    stands = goes_on & (end.element == begin.element)
    longer = np.where(stands, 2 * width, min(2 * width, max(width, LONGEST_LOOKAHEAD)))
    state.lookahead[lanes] = np.where(
        goes_on, longer, max(width // 2, SHORTEST_LOOKAHEAD)
    )
    state.stays_on[lanes[~goes_on]] = NONE
    state.passed[lanes] = np.where(goes_on, ridden.passed, -np.inf)
    for event, happens in HAPPENING.items():
        chosen = np.flatnonzero(ridden.event == event)
        if len(chosen):
            happens(state, lanes[chosen], select(ridden, chosen))
            _count(state, lanes[chosen])


def _out_of_mirror(pieces: Pieces, block: BlockState) -> Pieces:
    """Turn pieces of rides to x, and to the orientations at the begin."""
    rider = pieces.trajectory
    direction, orientation = block.direction[rider], block.body.orientation[rider]
    return pieces._replace(
        x=direction * pieces.x,
        v_x=direction * pieces.v_x,
        a_x=direction * pieces.a_x,
        orientation=orientation + direction * pieces.orientation,
        angular_velocity=direction * pieces.angular_velocity,
        angular_acceleration=direction * pieces.angular_acceleration,
    )


def _end(state: RunState, lanes: np.ndarray, ending: Ending) -> None:
    state.blocks.phase[lanes] = Phase.ended
    state.blocks.ending[lanes] = ending


def _count(state: RunState, lanes: np.ndarray) -> None:
    """Count an event of blocks; end those that have had too many."""
    blocks = state.blocks
    blocks.events[lanes] += 1.0
    many = blocks.events[lanes] >= state.limits.events
    _end(state, lanes[many & (blocks.phase[lanes] != Phase.ended)], Ending.event_limit)


def _strike(state: RunState, lanes: np.ndarray, there: Ride) -> None:
    """Let blocks strike what is ahead at a corner."""
    block, constants = select((state.blocks, state.constants), lanes)
    ground = select(state.path.elements, block.element.astype(int))
    touching_x = block.body.x - block.direction * (
        there.riders.radius * there.next_normal_x
    )
    number = np.searchsorted(state.profile.x, touching_x, side="right") - 1
    least = np.minimum(ground.behind, ground.ahead)
    most = np.maximum(ground.behind, ground.ahead)
    on_line = np.clip(number, least, most)
    segment = np.where(ground.is_segment, on_line, ground.behind)
    here = block.direction * there.normal_x, there.normal_y
    ahead = block.direction * there.next_normal_x, there.next_normal_y
    struck = strike_corner(block, constants, here, ahead, segment.astype(float))
    put(state.blocks, lanes, struck)


def _turn_slowly(state: RunState, lanes: np.ndarray, there: Ride) -> None:
    """Let blocks that are too slow for an impact go on behind a corner, or stop where
    they can: on ground that friction holds them on, or between two rises."""
    blocks, ratio = state.blocks, there.riders.ratio
    cos = there.normal_x * there.next_normal_x + there.normal_y * there.next_normal_y
    kept = np.maximum((cos + ratio) / (1.0 + ratio), 0.0)
    squared = kept**2 * blocks.speed_squared[lanes]
    slow = squared < there.riders.closing * there.next_normal_y
    rests = np.abs(there.next_normal_x) <= there.friction * there.next_normal_y
    rests |= (there.next_normal_x <= 0.0) & (there.normal_x >= 0.0)
    blocks.speed_squared[lanes] = squared
    _end(state, lanes[slow & rests], Ending.stopped)


def _fly_off(state: RunState, lanes: np.ndarray, there: Ride) -> None:
    """Let blocks leave the ground; those whose sections would not, roll on. None leaves
    the same element twice in a row."""
    block, constants = select((state.blocks, state.constants), lanes)
    normal = block.direction * there.normal_x, there.normal_y
    after, flies = take_off(block, constants, *normal)
    flies = flies > 0.0
    state.move(lanes[flies], select(after, flies))
    # A section that flies may touch again at once, wider than the circle on the path.
    state.stays_on[lanes] = block.element


def _slow_down(state: RunState, lanes: np.ndarray, there: Ride) -> None:
    """Let blocks that are too slow lie down if they roll and lack the energy to turn
    over, else start down-slope, or stop where friction holds them."""
    blocks, riders = state.blocks, there.riders
    normal = there.normal_x, there.normal_y
    lies = least_squared(riders, *normal, there.friction) > 0.0
    down = lanes[lies]
    if len(down):
        block, constants = select((blocks, state.constants), down)
        plane = libm.arctan2(
            block.direction * there.normal_x[lies], there.normal_y[lies]
        )
        state.move(down, lie_down(block, constants, plane))
    steep = np.abs(there.normal_x) > there.friction * there.normal_y
    back = there.normal_x < 0.0
    # A block at rest that cannot go one way is turned once, and then lies between.
    is_blocked = ~there.moved & state.blocked[lanes]
    starts = ~lies & steep & ~(back & is_blocked)
    _end(state, lanes[~lies & ~starts], Ending.stopped)
    state.blocked[lanes] = ~there.moved & back
    blocks.speed_squared[lanes[starts]] = 0.0
    turning = lanes[starts & back]
    mirrored = state.path.mirrored(blocks.element[turning].astype(int))
    blocks.element[turning] = mirrored
    blocks.direction[turning] *= -1.0


HAPPENING = {
    Event.strikes: _strike,
    Event.slow_corner: _turn_slowly,
    Event.flies: _fly_off,
    Event.slow: _slow_down,
    Event.leaves: lambda state, lanes, _: _end(state, lanes, Ending.left_profile),
    Event.time_limit: lambda state, lanes, _: _end(state, lanes, Ending.time_limit),
}
"""What happens at the events, given the ends of the rides."""

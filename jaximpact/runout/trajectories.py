"""Many trajectories, round by round.

In a round every block under way is taken on, through the air and along the ground, to
its next contact, and then the impacts of all are worked out together. A block that has
ended gives its place to the next. What becomes of a block does not depend on the
others.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from ..block import Block
from ..errors import InputError
from ..fields import expect, real_number, whole_number
from ..formats.checks import check_scene
from ..precision import require_float64
from ..scene import Impact, Scene, as_scene
from ..soil import Soil
from .airborne import fly_on
from .edges import cross_edges
from .ground import Ground
from .grounded import go_along
from .profile import Profile
from .rebounds import Contacts, FullModel
from .release import Release, check_release
from .runs import Ending, Runs
from .state import Phase, State
from .striking import strike
from .touching import touching

TIME_LIMIT = 600.0
"""Default [s]."""
EVENT_LIMIT = 10_000
"""Default."""
WIDTH = 8192
"""Blocks under way at once: enough for full cores, few enough for the caches."""


def simulate_runout(
    profile: Profile,
    release: Release | Scene | tuple[Block, Soil, Impact],
    contacts: Contacts | None = None,
    *,
    x: ArrayLike | None = None,
    ground: Ground | None = None,
    time_limit: float = TIME_LIMIT,
    event_limit: int = EVENT_LIMIT,
    width: int = WIDTH,
    progress: Callable[[int, int], None] | None = None,
) -> Runs:
    """Trajectories of blocks on a slope.

    A block flies, with constant spin; strikes, and is set back on the ground at the
    cost of the energy that it takes to climb out of it; flies again if its lowest point
    leaves the ground, and else rolls, or slides where it cannot roll; and so on to its
    end. See `flight`, `contact`, `roughness`, `rolling` and `breaks`.

    Args:
        profile: the slope.
        release: the blocks; or a scene, or its block, soil and impact in a tuple: they
            then begin as its impact strikes the profile at `x`, and its soil is the
            ground of the whole slope; see `touching`.
        contacts: how they rebound: `FullModel()`, the default, or `ClosedForm(law)`.
        x: where the blocks of a scene touch the profile [m].
        ground: as each block finds it; the profile's, or the scene's soil, if not
            given.
        time_limit: longest trajectory [s].
        event_limit: most contacts and legs along the ground of a trajectory.
        width: blocks under way at once; no result depends on it.
        progress: called as `progress(ended, blocks)`.

    Returns:
        `Runs`; every trajectory has an ending.

    Raises ValueError for a block that is released in the ground or off the profile, and
    for a ground of other blocks or segments.
    """
    require_float64()
    if not isinstance(release, Release):
        scene = as_scene(release)
        expect("profile", profile, Profile)
        if x is None:
            raise InputError("a scene needs x, where its blocks touch the profile [m]")
        check_scene(scene, batched=True, warn=True)
        release, its_ground = touching(scene, profile, x)
        ground = ground or its_ground
    elif x is not None:
        raise InputError("x is for a scene; a release says where its blocks are")
    check_release(release, profile)
    if contacts is not None and not callable(contacts):
        raise InputError(f"contacts must be a law of contacts, but is {contacts!r}")
    if ground is not None:
        expect("ground", ground, Ground)
    if real_number("time_limit", time_limit) <= 0.0:
        raise InputError(f"time_limit must be above 0 s, but is {time_limit!r}")
    whole_number("event_limit", event_limit, 1)
    whole_number("width", width, 1)
    scenes = Scene(
        release.block,
        (ground or profile).soil,
        Impact(
            orientation=release.orientation,
            angular_velocity=release.angular_velocity,
        ),
    )
    check_scene(scenes, batched=True, warn=True, of="entry")
    state = State.at_release(profile, release, ground)
    return follow(
        state, contacts or FullModel(), time_limit, event_limit, width, progress
    )


def follow(
    state: State,
    contacts: Contacts,
    time_limit: float,
    event_limit: int,
    width: int,
    progress: Callable[[int, int], None] | None,
) -> Runs:
    """Blocks at their release, followed to their ends; see `simulate_runout`."""
    active, waiting, blocks = np.zeros(0, int), 0, state.release.count
    while True:
        active = active[state.phase[active] != Phase.ended]
        count = min(width - len(active), blocks - waiting)
        active = np.concatenate([active, np.arange(waiting, waiting + count)])
        waiting += count
        if progress is not None:
            progress(waiting - len(active), blocks)
        if not len(active):
            break
        _to_contacts(state, active, time_limit, event_limit)
        touching = active[state.phase[active] == Phase.touching]
        if len(touching):
            strike(state, touching, contacts)
            _count(state, touching, event_limit)
    return Runs(
        profile=state.profile,
        release=state.release,
        ending=state.ending,
        x=state.body.x,
        y=state.body.y,
        time=state.time,
        events=state.events,
        contacts=state.contacts.whole(),
        pieces=state.pieces.whole(),
    )


def _to_contacts(
    state: State, active: np.ndarray, time_limit: float, event_limit: int
) -> None:
    """Take blocks on until each touches the ground or has ended."""
    while True:
        phase = state.phase[active]
        airborne = active[phase == Phase.airborne]
        grounded = active[phase == Phase.grounded]
        at_edge = active[phase == Phase.at_edge]
        if not (len(airborne) or len(grounded) or len(at_edge)):
            return
        if len(airborne):
            fly_on(state, airborne, time_limit)
        if len(grounded):
            go_along(state, grounded, time_limit)
        if len(at_edge):
            cross_edges(state, at_edge)
        _count(state, np.concatenate([grounded, at_edge]), event_limit)


def _count(state: State, lanes: np.ndarray, event_limit: int) -> None:
    """Count an event of each block; end those that have had too many."""
    state.events[lanes] += 1
    many = (state.events[lanes] >= event_limit) & (state.phase[lanes] != Phase.ended)
    state.end(lanes[many], Ending.event_limit)

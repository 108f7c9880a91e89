"""Scheduler of many trajectories, round by round.

In a round every block under way is moved, through the air and along the ground, to its
next contact, and then the impacts of all are computed together. A block that has ended
gives its place to the next. The trajectory of a block does not depend on the others.
"""

from collections.abc import Iterator

import jax
import numpy as np
from numpy.typing import ArrayLike

from .._checks import expect, real_number, whole_number
from .._precision import require_float64
from .._settings import numpy_settings
from ..errors import InputError
from ..io.checks import check_scene
from ..progress import SILENT, Progress, ProgressFunction, as_progress
from ..rebound import AbstractRebound
from ..scene import Block, Impact, Scene, Soil, as_scene
from ..shapes import each_shape
from .blocks import Release
from .contacts.contact_models import ClosedForm, Contacts, FullModel
from .contacts.impact import strike
from .flight.flights import fly_on
from .flight.placement import check_release, release_at_touch
from .ground_motion.moving import move_along
from .state import EVENT_LIMIT, HOP_THRESHOLD, TIME_LIMIT, Limits, Phase, RunState
from .terrain import Ground, Profile
from .trajectory import Ending, Runs, joined

WIDTH = 8192
"""Number of blocks under way at once: enough for full cores, few enough for the
caches."""


def simulate_runout(
    profile: Profile,
    release: Release | Scene | tuple[Block, Soil, Impact],
    contacts: Contacts | None = None,
    *,
    x: ArrayLike | None = None,
    ground: Ground | None = None,
    time_limit: float = TIME_LIMIT,
    event_limit: int = EVENT_LIMIT,
    hop_threshold: float = HOP_THRESHOLD,
    width: int = WIDTH,
    progress: Progress | ProgressFunction | None = None,
) -> Runs:
    """Simulate the trajectories of blocks on a slope.

    A block flies, with constant spin; strikes, and is set back on the ground at the
    cost of the energy that it takes to climb out; flies again if its lowest point
    leaves the ground, and else rolls, or slides where it cannot roll; and so on to its
    end. See `flight`, `contacts` and `ground_motion`.

    Args:
        profile: the slope.
        release: the blocks; or a scene, or its block, soil and impact in a tuple: the
            blocks then begin as its impact strikes the profile at `x`, and its soil is
            the ground of the whole slope; see `flight.placement`.
        contacts: contact model: `FullModel()`, the default, `ClosedForm(law)`, or
            `jaximpact.lookup.Tabulated(tables)`.
        x: places where the blocks of a scene touch the profile [m].
        ground: ground as each block finds it; that of the profile, or the scene's soil,
            if not given.
        time_limit: longest trajectory [s], above 0.
        event_limit: most contacts and legs along the ground of a trajectory, from 1.
        hop_threshold: height of a flight after a contact or at a break of the slope, as
            a fraction of the heave of the block's centre as it rolls, below which the
            block rolls instead of flying, from 0; see `contacts.impact`. Spheres do not
            heave: it is not for them.
        width: number of blocks under way at once, from 1; no result depends on it.
        progress: called as `progress(ended, blocks)`.

    Returns:
        `Runs`; every trajectory has an ending.

    Raises ValueError for a block that is released in the ground or off the profile, and
    for a ground or a law of other blocks or segments.
    """
    require_float64()
    if not isinstance(release, Release):
        scene = as_scene(release)
        expect("profile", profile, Profile)
        if x is None:
            raise InputError("a scene needs x, where its blocks touch the profile [m]")
        check_scene(scene, batched=True, warn=True)
        release, scene_ground = release_at_touch(scene, profile, x)
        ground = ground or scene_ground
    elif x is not None:
        raise InputError("x is for a scene; a release says where its blocks are")
    check_release(release, profile)
    if contacts is not None and not callable(contacts):
        raise InputError(f"contacts must be a law of contacts, but is {contacts!r}")
    if isinstance(contacts, AbstractRebound):
        name = type(contacts).__name__
        raise InputError(
            f"contacts must be a law of contacts, but {name} is a law of rebound; "
            f"write ClosedForm({name}(...))"
        )
    if ground is not None:
        expect("ground", ground, Ground)
        if ground.numbers is not None and len(ground.numbers) != release.count:
            raise InputError(
                f"a ground's numbers must be one for each of {release.count} blocks, "
                f"but are {len(ground.numbers)}"
            )
    limits = checked_limits(time_limit, event_limit, hop_threshold)
    width = whole_number("width", width, 1)
    if isinstance(contacts, ClosedForm):
        contacts.check_count(release.count)
    scenes = Scene(
        release.block,
        (ground or profile).soil,
        Impact(
            orientation=release.orientation,
            angular_velocity=release.angular_velocity,
        ),
    )
    check_scene(scenes, batched=True, warn=True, of="entry")
    return follow(
        profile=profile,
        release=release,
        ground=ground,
        limits=limits,
        contacts=contacts or FullModel(),
        width=width,
        progress=as_progress(progress),
    )


def checked_limits(time_limit: float, event_limit: int, hop_threshold: float) -> Limits:
    """Check the limits of trajectories. Raises InputError for values out of range."""
    limits = Limits(
        real_number("time_limit", time_limit),
        whole_number("event_limit", event_limit, 1),
        real_number("hop_threshold", hop_threshold),
    )
    if limits.time <= 0.0:
        raise InputError(f"time_limit must be above 0 s, but is {time_limit!r}")
    if limits.hop_threshold < 0.0:
        raise InputError(f"hop_threshold must be at least 0, but is {hop_threshold!r}")
    return limits


@numpy_settings()
def follow(
    profile: Profile,
    release: Release,
    ground: Ground | None,
    limits: Limits,
    *,
    contacts: Contacts,
    width: int = WIDTH,
    progress: Progress = SILENT,
) -> Runs:
    """Follow blocks from their release to their ends, those of one shape at a time; see
    `simulate_runout`."""
    states, indices, done = [], [], 0
    # The coordinates of national grids are coarser than the distances of contacts.
    origin, near = profile.origin, profile.from_origin
    for (block, body), places in each_shape((release.block, release.body)):
        alone = Release(block, *body._replace(x=body.x - origin))
        lanes = np.arange(release.count)[places]
        of_shape, laws = ground, contacts
        if len(lanes) < release.count:
            of_shape = (ground or Ground.of_profile(profile)).of_blocks(lanes)
            laws = contacts.at(lanes) if isinstance(contacts, ClosedForm) else contacts
        state = RunState.at_release(near, alone, of_shape, limits)
        for ended in _advance(state, laws, width):
            progress("blocks", done + ended, release.count)
        done += len(lanes)
        states.append(state)
        indices.append(lanes)
    order = np.argsort(np.concatenate(indices))
    blocks = jax.tree.map(
        lambda *parts: np.concatenate(parts)[order], *(s.blocks for s in states)
    )
    struck = joined([s.contacts for s in states], indices)
    pieces = joined([s.pieces for s in states], indices)
    # Where a block failed nothing is known of where it would have ended.
    failed = blocks.ending == Ending.failed
    return Runs(
        profile=profile,
        release=release,
        ending=blocks.ending.astype(int),
        x=np.where(failed, np.nan, blocks.body.x + origin),
        y=np.where(failed, np.nan, blocks.body.y),
        time=blocks.time,
        events=blocks.events.astype(int),
        contacts=struck._replace(x=struck.x + origin, x_after=struck.x_after + origin),
        pieces=pieces._replace(x=pieces.x + origin),
    )


def _advance(state: RunState, contacts: Contacts, width: int) -> Iterator[int]:
    """Advance all blocks to the ends of their trajectories; see `simulate_runout`.
    Yields in each round how many have ended."""
    phase = state.blocks.phase
    active, waiting, blocks = np.zeros(0, int), 0, state.release.count
    while True:
        active = active[phase[active] != Phase.ended]
        count = min(width - len(active), blocks - waiting)
        active = np.concatenate([active, np.arange(waiting, waiting + count)])
        waiting += count
        yield waiting - len(active)
        if not len(active):
            break
        _move_to_contacts(state, active)
        touching = active[phase[active] == Phase.touching]
        if len(touching):
            strike(state, touching, contacts)


def _move_to_contacts(state: RunState, active: np.ndarray) -> None:
    """Move blocks until each touches the ground or has ended."""
    transitions = {
        Phase.airborne: fly_on,
        Phase.grounded: move_along,
    }
    while True:
        phase = state.blocks.phase[active]
        lanes = {of: active[phase == of] for of in transitions}
        if not any(map(len, lanes.values())):
            return
        for of, transition in transitions.items():
            if len(lanes[of]):
                transition(state, lanes[of])

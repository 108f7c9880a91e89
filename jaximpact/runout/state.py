"""State of blocks under way."""

import dataclasses
import enum
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..scene import GRAVITY, Block, Soil
from ..shapes import RoundBlock
from .blocks import (
    BlockOutline,
    Body,
    MassProperties,
    Release,
    outline_of,
    put,
    select,
)
from .centre_path import CentrePath
from .lane_programs import Values, closed_form
from .terrain import Ground, Profile, spread
from .trajectory import (
    ContactRecord,
    Ending,
    MotionMode,
    Pieces,
    Recorder,
    state_after,
)

TIME_LIMIT = 600.0
"""Default of the longest trajectory [s]."""
EVENT_LIMIT = 10_000
"""Default of the most contacts and legs of a trajectory."""
HOP_THRESHOLD = 1.0
"""Default of the height of a flight, as a fraction of the block's heave, below which
it rolls."""
NONE = -1.0
"""Code of the ending, and place of the segment and the element, that a block does not
have, or not yet."""


class Phase(enum.IntEnum):
    """Next transition of a block."""

    airborne = 0
    """Flight to the next contact."""
    grounded = 1
    """Motion along the ground."""
    touching = 2
    """Contact with the ground."""
    ended = 3


class Limits(NamedTuple):
    """Limits of a trajectory, and of the flights that are followed."""

    time: float = TIME_LIMIT  # longest trajectory [s]
    events: int = EVENT_LIMIT  # most contacts and legs
    hop_threshold: float = HOP_THRESHOLD
    """Height of a flight after a contact or at a break, as a fraction of the block's
    heave, below which it rolls instead."""


class BlockState(NamedTuple):
    """State of one block, or of many, arrays `(blocks,)`; codes and numbers are
    floats."""

    time: Values  # time since release [s]
    body: Body
    """Position and motion at `time`; on the ground the velocities are those of the
    last flight."""
    phase: Values  # code of `Phase`
    ending: Values  # code of `Ending`; -1 for a block under way
    events: Values  # number of contacts and legs so far
    impacts: Values  # number of impacts so far
    segment: Values  # segment that the block touches, or touched last; -1 for none
    element: Values
    """Place of what a block on the ground touches in `CentrePath.elements`; -1 where it
    is not known yet."""
    rolls: Values  # 1 for a block that rolls, 0 for one that slides
    direction: Values  # of motion along the ground: 1 to the right, -1 to the left
    speed_squared: Values  # squared speed along the ground [m2/s2]
    normal_x: Values  # normal of the plane that the block touches
    normal_y: Values
    gap: Values  # distance to that plane [m]; negative in the ground

    @property
    def is_rolling(self) -> Values:
        """True for a block that rolls."""
        return self.rolls > 0.0

    @property
    def speed(self) -> Values:
        """Speed along the ground [m/s]; 0 where its square is negative."""
        return jnp.sqrt(jnp.maximum(self.speed_squared, 0.0))

    def moved(self, **fields: Values) -> "BlockState":
        """Copy the state with other fields of the body."""
        return self._replace(body=self.body._replace(**fields))

    def ended(self, ending: Ending, where: Values = True) -> "BlockState":
        """End the trajectory, where a condition holds."""
        return self._replace(
            phase=jnp.where(where, float(Phase.ended), self.phase),
            ending=jnp.where(where, float(ending), self.ending),
        )

    def counted(self, limits: Limits) -> "BlockState":
        """Count an event; end a block that has had too many."""
        events = self.events + 1.0
        many = (events >= limits.events) & (self.phase != Phase.ended)
        return self._replace(events=events).ended(Ending.event_limit, many)


class BlockConstants(NamedTuple):
    """Constants of a block, or of many, arrays `(blocks,)`."""

    outline: BlockOutline
    mass_properties: MassProperties
    round: RoundBlock  # round block that rolls in its place

    def centre_height(self, rolls: Values) -> Values:
        """Give the height of the centre over the ground [m]: the round block's radius
        for a block that rolls, that of its flat side for one that slides."""
        return jnp.where(rolls > 0.0, self.round.radius, self.outline.smallest)

    def inertia_ratio(self, rolls: Values) -> Values:
        """Give k = I / (m r^2) of a block that rolls; 0 for one that slides."""
        mass, inertia = self.mass_properties
        return jnp.where(rolls > 0.0, inertia / (mass * self.round.radius**2), 0.0)


class GroundOfBlocks(NamedTuple):
    """Ground of each block and segment, arrays `(blocks, segments)`."""

    soil: Soil
    rolling_friction: Values  # tangents of the angles of rolling friction
    sliding_friction: Values  # tangents, between block and ground


@closed_form
def _constants_of(block: Block) -> BlockConstants:
    outline = outline_of(block)
    return BlockConstants(
        outline,
        MassProperties(block.mass, block.inertia),
        outline.shape.round_block(outline.axes),
    )


@closed_form
def _sliding_friction(slider, friction_angle: Values) -> Values:
    return slider.friction(friction_angle)


@closed_form
def _tangent(angle: Values) -> Values:
    return jnp.tan(angle)


@dataclasses.dataclass
class RunState:
    """State of all blocks of a run, which changes as it goes on."""

    profile: Profile
    release: Release
    path: CentrePath  # paths of the centres of blocks on the ground
    limits: Limits
    seed: int  # seed of the facets
    numbers: np.ndarray  # block numbers that select the random facets
    roughness: np.ndarray  # of facets [rad], `(blocks, segments)`
    blocks: BlockState
    constants: BlockConstants
    ground: GroundOfBlocks
    contacts: Recorder
    pieces: Recorder
    lookahead: np.ndarray  # number of elements that the next ride evaluates
    stays_on: np.ndarray  # element that a block does not leave; -1 for none
    passed: np.ndarray
    """x, in the mirror of a block that moves to the left, up to which a block on the
    ground passes over corners in a hop [m]."""
    blocked: np.ndarray  # at rest on the ground, and could not go the other way

    @classmethod
    def at_release(
        cls,
        profile: Profile,
        release: Release,
        ground: Ground | None,
        limits: Limits,
    ) -> "RunState":
        """Start all blocks; on the profile's own ground if no other is given."""
        n, surface = release.count, ground or profile
        numbers = None if ground is None else ground.numbers
        constants = _constants_of(release.block)
        # First, as it tells what does not fit the blocks or the segments.
        of_blocks = _ground_of_blocks(surface, n, profile.segments)
        radius = constants.round.radius, constants.outline.largest
        return cls(
            profile=profile,
            release=release,
            path=CentrePath.of(profile, float(np.max(radius)), _changes(surface)),
            limits=limits,
            seed=0 if ground is None else ground.seed,
            numbers=np.arange(n) if numbers is None else numbers,
            roughness=spread(surface.roughness, n, profile.segments),
            blocks=_at_release(release.body),
            constants=constants,
            ground=of_blocks,
            contacts=Recorder(ContactRecord),
            pieces=Recorder(Pieces),
            lookahead=np.zeros(n, int),
            stays_on=np.full(n, NONE),
            passed=np.full(n, -np.inf),
            blocked=np.zeros(n, bool),
        )

    def move(
        self,
        lanes: np.ndarray,
        after: BlockState,
        piece: Pieces | None = None,
        sinks: bool = False,
    ) -> None:
        """Move blocks on by a transition, and record the piece of the motion where it
        takes time.

        A block whose centre would come into the ground is wedged in a place narrower
        than itself: it does not move, and has stopped; but for one that sinks, and may
        end in its crater. What the piece leaves out of the way, as where a round block
        takes the place of an ellipse, becomes a piece of its own that takes time: no
        block is anywhere at once.
        """
        x, y = after.body.x, after.body.y
        on_profile = (x > self.profile.x[0]) & (x < self.profile.x[-1])
        wedged = on_profile & (y < self.profile.height(x))
        if sinks:
            wedged &= after.phase != Phase.ended
        before = select(self.blocks, lanes)
        put(self.blocks, lanes, after)
        if np.any(wedged):
            stopped = select(before, wedged)
            stopped.phase[:] = Phase.ended
            stopped.ending[:] = Ending.stopped
            put(self.blocks, lanes[wedged], stopped)
            free = ~wedged
            lanes, before, after = lanes[free], *select((before, after), free)
            piece = select(piece, free)
        x, y = before.body.x, before.body.y
        if piece is not None:
            lasts = piece.duration > 0.0
            self.pieces.add(lanes[lasts], select(piece, lasts))
            end = state_after(piece, piece.duration)
            x, y = np.where(lasts, end.x, x), np.where(lasts, end.y, y)
        self._shift(lanes, after, x, y)

    def _shift(
        self, lanes: np.ndarray, after: BlockState, x: np.ndarray, y: np.ndarray
    ) -> None:
        """Record the way of blocks from where a piece left them to where they go on.

        They move straight there, and come to the velocities with which they go on;
        what gravity gives or takes on the way they begin with less or more of. Blocks
        at rest take the time of a fall.
        """
        d_x, d_y = after.body.x - x, after.body.y - y
        way = np.sqrt(d_x**2 + d_y**2)
        apart = way > 1e-8 * self.constants.outline.smallest[lanes]
        if not np.any(apart):
            return
        lanes, after = lanes[apart], select(after, apart)
        d_x, d_y, way, x, y = (v[apart] for v in (d_x, d_y, way, x, y))
        constants = select(self.constants, lanes)
        speed, spin = velocities(after, constants)
        mass, inertia = constants.mass_properties
        kinetic = 0.5 * (speed**2 + inertia / mass * spin**2)
        falls = np.minimum(kinetic, np.maximum(-GRAVITY * d_y, 0.0))
        share = np.sqrt(1.0 - falls / np.where(kinetic > 0.0, kinetic, 1.0))
        start = np.sqrt((share * speed) ** 2 + 2.0 * GRAVITY * np.maximum(d_y, 0.0))
        time = 2.0 * way / np.maximum(start + speed, np.sqrt(GRAVITY * way))
        v_x, v_y = start * d_x / way, start * d_y / way
        zero = np.zeros(len(lanes))
        self.pieces.add(
            lanes,
            Pieces(
                trajectory=zero,
                motion=zero + MotionMode.contact,
                time=after.time,
                duration=time,
                x=x,
                y=y,
                v_x=v_x,
                v_y=v_y,
                a_x=2.0 * (d_x - v_x * time) / time**2,
                a_y=2.0 * (d_y - v_y * time) / time**2,
                orientation=after.body.orientation - 0.5 * (share + 1.0) * spin * time,
                angular_velocity=share * spin,
                angular_acceleration=(1.0 - share) * spin / time,
            ),
        )
        self.blocks.time[lanes] = after.time + time


def velocities(
    block: BlockState, constants: BlockConstants
) -> tuple[np.ndarray, np.ndarray]:
    """Compute speeds [m/s] and angular velocities [rad/s] of blocks, in the air or on
    the ground; 0 for those that have ended."""
    body, flies = block.body, block.phase == Phase.airborne
    along = np.sqrt(np.maximum(block.speed_squared, 0.0))
    along = np.where(block.phase == Phase.ended, 0.0, along)
    rolls = block.rolls > 0.0
    turn = np.where(rolls, along / constants.round.radius, 0.0)
    return (
        np.where(flies, np.sqrt(body.v_x**2 + body.v_y**2), along),
        np.where(flies, body.angular_velocity, block.direction * turn),
    )


def _at_release(body: Body) -> BlockState:
    zero = np.zeros(np.shape(body.x))
    state = BlockState(
        time=zero,
        body=body,
        phase=zero + Phase.airborne,
        ending=zero + NONE,
        events=zero,
        impacts=zero,
        segment=zero + NONE,
        element=zero + NONE,
        rolls=zero,
        direction=zero + 1.0,
        speed_squared=zero,
        normal_x=zero,
        normal_y=zero,
        gap=zero,
    )
    # Each field is written to.
    return jax.tree.map(lambda leaf: np.array(leaf, float), state)


def _changes(surface: Ground | Profile) -> np.ndarray:
    """Tell where the ground of any block changes from a segment to the next."""
    leaves = jax.tree.leaves((surface.soil, surface.rolling_friction_angle))
    changes = np.zeros(1, bool)
    for leaf in map(np.atleast_2d, leaves):
        if leaf.shape[1] > 1:
            changes = changes | np.any(leaf[:, 1:] != leaf[:, :-1], axis=0)
    return changes


def _ground_of_blocks(
    surface: Ground | Profile, blocks: int, segments: int
) -> GroundOfBlocks:
    soil, angle = jax.tree.map(
        np.atleast_2d, (surface.soil, surface.rolling_friction_angle)
    )
    # Two programs: what only one of them varies by, blocks or segments, stays so small.
    frictions = _tangent(angle), _sliding_friction(soil.slider, soil.friction_angle)
    return jax.tree.map(
        lambda values: spread(values, blocks, segments),
        GroundOfBlocks(soil, *frictions),
    )

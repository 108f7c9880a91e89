"""State of blocks under way."""

import dataclasses
import enum
from typing import NamedTuple

import jax
import numpy as np

from ..laws import Coulomb
from ..soil import Soil
from .blocks import BlockOutline, Body, MassProperties, Release, mean_radius_of
from .dual import Values
from .lane_programs import closed_form
from .terrain import Ground, Profile, spread
from .trajectory import ContactRecord, Pieces, Recorder

TIME_LIMIT = 600.0
"""Default of the longest trajectory [s]."""
EVENT_LIMIT = 10_000
"""Default of the most contacts and legs of a trajectory."""
HOP_THRESHOLD = 1.0
"""Default of the height of a flight, as a fraction of the block's heave, below which
it rolls."""
_friction_of = closed_form(lambda slider, angle: slider.friction(angle))


class Phase(enum.IntEnum):
    """Next transition of a block."""

    airborne = 0
    """Flight to the next contact."""
    grounded = 1
    """Motion along a segment."""
    at_edge = 2
    """Crossing of a convex break, or of an end of the profile."""
    touching = 3
    """Contact with the ground."""
    ended = 4


class Limits(NamedTuple):
    """Limits of a trajectory, and of the flights that are followed."""

    time: float = TIME_LIMIT
    """Longest trajectory [s]."""
    events: int = EVENT_LIMIT
    """Most contacts and legs."""
    hop_threshold: float = HOP_THRESHOLD
    """Height of a flight after a contact or at a break, as a fraction of the block's
    heave, below which it rolls instead."""


@dataclasses.dataclass
class State:
    """State of all blocks of a run; arrays `(blocks,)` that change as it goes on."""

    profile: Profile
    release: Release
    outline: BlockOutline
    mass_properties: MassProperties
    radius: np.ndarray
    """Radius of the round block that rolls [m]."""
    smallest: np.ndarray
    """Height of the centre of a block lying on its flat side [m]."""
    slope: np.ndarray
    """Slope angles of the segments [rad], `(segments,)`."""
    length: np.ndarray
    """Lengths of the segments [m], `(segments,)`."""
    soil: Soil
    """Soil of each block and segment, fields `(blocks, segments)`."""
    rolling_friction: Values
    """Tangents of the angles of rolling friction, `(blocks, segments)`."""
    sliding_friction: Values
    """Tangents of the angles of friction between block and ground, `(blocks,
    segments)`."""
    roughness: Values
    """Standard deviations of the angles of facets [rad], `(blocks, segments)`."""
    seed: int
    """Seed of the facets."""
    limits: Limits
    numbers: np.ndarray
    """Block numbers that select the random facets."""
    impacts: np.ndarray
    """Number of impacts so far."""
    phase: np.ndarray
    """Codes of `Phase`."""
    ending: np.ndarray
    """Codes of `Ending`; -1 for a block under way."""
    time: Values
    """Time since release [s]."""
    events: np.ndarray
    """Number of contacts and legs so far."""
    body: Body
    """Position and motion at `time`; on the ground the velocities are those of the
    last flight."""
    segment: np.ndarray
    """Segment that the block is on, or touches; -1 in the air."""
    rolls: np.ndarray
    """True for a block that rolls, False for one that slides."""
    direction: Values
    """Direction of motion along the ground: 1 to the right, -1 to the left."""
    speed_squared: Values
    """Squared speed along the ground [m2/s2]."""
    edge: np.ndarray
    """Profile point that the block is about to cross."""
    plane: Values
    """Angle of the plane on which the block rests at the edge [rad]."""
    normal: Values
    """Normal of the plane that the block touches, x and y, `(2, blocks)`."""
    gap: Values
    """Distance to that plane [m]; negative in the ground."""
    contacts: Recorder
    pieces: Recorder

    @classmethod
    def at_release(
        cls,
        profile: Profile,
        release: Release,
        ground: Ground | None = None,
        limits: Limits = Limits(),  # noqa: B008, which is immutable
    ) -> "State":
        """Start all blocks; on the profile's own ground if no other is given."""
        n, surface = release.count, ground or profile
        soil = surface.soil

        def of_all(values):
            return spread(values, n, profile.segments)

        outline = release.outline
        return cls(
            profile=profile,
            release=release,
            outline=outline,
            mass_properties=release.mass_properties,
            radius=mean_radius_of(outline),
            smallest=outline.smallest,
            slope=profile.slope,
            length=profile.length,
            soil=jax.tree.map(of_all, soil),
            rolling_friction=of_all(np.tan(surface.rolling_friction_angle)),
            sliding_friction=of_all(_sliding_friction(soil)),
            roughness=of_all(surface.roughness),
            seed=0 if ground is None else ground.seed,
            limits=limits,
            numbers=np.arange(n)
            if ground is None or ground.numbers is None
            else ground.numbers,
            impacts=np.zeros(n, int),
            phase=np.full(n, Phase.airborne),
            ending=np.full(n, -1),
            time=np.zeros(n),
            events=np.zeros(n, int),
            body=Body(*(value.copy() for value in release.body)),
            segment=np.full(n, -1),
            rolls=np.zeros(n, bool),
            direction=np.ones(n),
            speed_squared=np.zeros(n),
            edge=np.full(n, -1),
            plane=np.zeros(n),
            normal=np.zeros((2, n)),
            gap=np.zeros(n),
            contacts=Recorder(ContactRecord),
            pieces=Recorder(Pieces),
        )

    def end(self, lanes: np.ndarray, ending: int) -> None:
        """End trajectories, for the reason given."""
        self.phase[lanes] = Phase.ended
        self.ending[lanes] = ending

    def set_body(self, lanes: np.ndarray, **values) -> None:
        """Set fields of the body."""
        for name, value in values.items():
            getattr(self.body, name)[lanes] = value


def _sliding_friction(soil: Soil):
    """Compute tan phi_b between block and ground, of the shape of the soil's fields."""
    if type(soil.slider) is Coulomb:
        return soil.alpha_s * np.tan(soil.friction_angle)
    return _friction_of(soil.slider, soil.friction_angle)

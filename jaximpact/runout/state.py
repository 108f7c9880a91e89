"""Blocks under way."""

import dataclasses
import enum

import jax
import numpy as np

from ..laws import Coulomb
from ..soil import Soil
from .contact import Matter
from .ground import Ground, spread
from .motion import Body, Outline
from .profile import Profile
from .programs import closed_form
from .record import ContactRecord, Growing, Pieces
from .release import Release
from .rolling import mean_radius_of


class Phase(enum.IntEnum):
    """What a block is about to do."""

    airborne = 0
    grounded = 1
    """To go along a segment."""
    at_edge = 2
    """To cross a convex break, or an end of the profile."""
    touching = 3
    """To be struck."""
    ended = 4


@dataclasses.dataclass
class State:
    """All blocks of a run; arrays `(blocks,)` that change as it goes on."""

    profile: Profile
    release: Release
    outline: Outline
    matter: Matter
    radius: np.ndarray
    """Of the round block that rolls [m]."""
    smallest: np.ndarray
    """Height of its centre as it lies on its flat side [m]."""
    slope: np.ndarray
    """Of the profile's segments [rad]."""
    length: np.ndarray
    """Of the profile's segments [m]."""
    soil: Soil
    """Of each block and segment, fields `(blocks, segments)`."""
    rolling_friction: np.ndarray
    """Tangents of the angles of rolling friction, likewise."""
    sliding_friction: np.ndarray
    """And of the ground's friction on the block."""
    roughness: np.ndarray
    """Standard deviations of the angles of facets [rad], likewise."""
    seed: int
    """Of the facets."""
    numbers: np.ndarray
    """Of the blocks, by which their facets are drawn."""
    impacts: np.ndarray
    """So far."""
    phase: np.ndarray
    ending: np.ndarray
    time: np.ndarray
    events: np.ndarray
    body: Body
    """At `time`; on the ground its velocities are those of the last flight."""
    segment: np.ndarray
    """On which the block goes, or which it touches."""
    rolls: np.ndarray
    """True if it rolls, False if it slides."""
    way: np.ndarray
    """1 to the right, -1 to the left."""
    speed_squared: np.ndarray
    """Along the ground [m2/s2]."""
    edge: np.ndarray
    """The point of the profile that it is about to cross."""
    plane: np.ndarray
    """Angle of the plane on which it stands at the edge [rad]."""
    normal: np.ndarray
    """Of the plane that it touches, `(2, blocks)`."""
    gap: np.ndarray
    """To that plane [m]."""
    contacts: Growing
    pieces: Growing

    @classmethod
    def at_release(
        cls, profile: Profile, release: Release, ground: Ground | None = None
    ) -> "State":
        """With the profile's own ground if no other is given."""
        n, found = release.count, ground or profile
        soil = found.soil

        def of_all(values):
            return spread(values, n, profile.segments)

        outline = release.outline
        return cls(
            profile=profile,
            release=release,
            outline=outline,
            matter=release.matter,
            radius=mean_radius_of(outline),
            smallest=outline.smallest,
            slope=profile.slope,
            length=profile.length,
            soil=jax.tree.map(of_all, soil),
            rolling_friction=of_all(np.tan(found.rolling_friction_angle)),
            sliding_friction=of_all(_sliding_friction(soil)),
            roughness=of_all(found.roughness),
            seed=0 if ground is None else ground.seed,
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
            way=np.ones(n),
            speed_squared=np.zeros(n),
            edge=np.full(n, -1),
            plane=np.zeros(n),
            normal=np.zeros((2, n)),
            gap=np.zeros(n),
            contacts=Growing(ContactRecord),
            pieces=Growing(Pieces),
        )

    def of(self, lanes: np.ndarray, tree):
        """Some lanes of a tree of arrays."""
        return jax.tree.map(lambda leaf: leaf[lanes], tree)

    def end(self, lanes: np.ndarray, ending: int) -> None:
        """Trajectories end."""
        self.phase[lanes] = Phase.ended
        self.ending[lanes] = ending

    def place(self, lanes: np.ndarray, **values) -> None:
        """Set numbers of the body."""
        for name, value in values.items():
            getattr(self.body, name)[lanes] = value


def _sliding_friction(soil: Soil):
    """tan phi_b of the ground on the block, of the shape of the soil's fields."""
    if type(soil.slider) is Coulomb:
        return soil.alpha_s * np.tan(soil.friction_angle)
    return _friction_of(soil.slider, soil.friction_angle)


_friction_of = closed_form(lambda slider, angle: slider.friction(angle))

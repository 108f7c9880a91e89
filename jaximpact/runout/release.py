"""Blocks let go."""

import dataclasses

import jax
import numpy as np

from ..block import Block
from ..fields import expect, real_numbers
from ..formats.checks import check_scene
from ..scene import Scene
from .contact import Matter
from .contact_search import begin
from .motion import Body, Outline, outline_of, take
from .profile import Profile
from .programs import closed_form
from .reach import earliest, pieces_needed, reach

NUMBERS = ("x", "y", "v_x", "v_y", "orientation", "angular_velocity")
BURIED = 1e-6
"""How far a block may start in the ground, by its smaller semi-axis: rounding."""


@dataclasses.dataclass(frozen=True)
class Release:
    """How blocks are let go, in flight; fields that broadcast to `(blocks,)`.

    Args:
        block: the blocks.
        x, y: centres [m].
        v_x, v_y: velocities of the centres [m/s], to the right and up.
        orientation: from the vertical, clockwise, to the major axis [rad].
        angular_velocity: clockwise positive [rad/s].

    Raises ValueError, in one sentence, for values out of range.
    """

    block: Block
    x: np.ndarray
    y: np.ndarray
    v_x: np.ndarray = 0.0
    v_y: np.ndarray = 0.0
    orientation: np.ndarray = 0.0
    angular_velocity: np.ndarray = 0.0

    def __post_init__(self):
        expect("a release's block", self.block, Block)
        for name in NUMBERS:
            values = real_numbers(f"a release's {name}", getattr(self, name))
            object.__setattr__(self, name, values)
        leaves = [*jax.tree.leaves(self.block), *(getattr(self, n) for n in NUMBERS)]
        shapes = [np.shape(leaf) for leaf in leaves]
        try:
            shape = np.broadcast_shapes(*shapes, (1,))
        except ValueError:
            raise ValueError(
                f"fields of a release must broadcast to one axis, but have shapes "
                f"{sorted(set(shapes))}"
            ) from None
        if len(shape) > 1 or 0 in shape:
            raise ValueError(
                f"a release needs blocks along one axis, but got shape {shape}"
            )

        def spread(value):
            return np.array(np.broadcast_to(np.asarray(value, float), shape))

        for name in NUMBERS:
            values = spread(getattr(self, name))
            if not np.all(np.isfinite(values)):
                raise ValueError(
                    f"a release's {name} must be finite, but is not for block "
                    f"{int(np.argmin(np.isfinite(values)))}"
                )
            object.__setattr__(self, name, values)
        check_scene(Scene(self.block), batched=True)
        object.__setattr__(self, "block", jax.tree.map(spread, self.block))

    @property
    def count(self) -> int:
        """How many blocks."""
        return len(self.x)

    @property
    def body(self) -> Body:
        """Their state."""
        return Body(*(getattr(self, name) for name in NUMBERS))

    @property
    def outline(self) -> Outline:
        """Their sections."""
        return _outline(self.block)

    @property
    def matter(self) -> Matter:
        """Their mass and inertia."""
        return _matter(self.block)


_outline = closed_form(outline_of)


@closed_form
def _matter(block: Block) -> Matter:
    return Matter(block.mass, block.inertia)


@closed_form
def _depths(*inputs):
    return list(begin(*inputs).depths)


def check_release(release: Release, profile: Profile) -> None:
    """Raise ValueError, in one sentence, for a block that does not start on or above
    the ground of the profile."""
    expect("profile", profile, Profile)
    expect("release", release, Release)
    outside = ~((release.x >= profile.x[0]) & (release.x <= profile.x[-1]))
    if np.any(outside):
        i = int(np.argmax(outside))
        raise ValueError(
            f"block {i} is released at x = {release.x[i]:g}, but the profile goes from "
            f"{profile.x[0]:g} to {profile.x[-1]:g}"
        )
    body, outline = release.body, release.outline
    largest = outline.largest
    times = earliest(body, largest, profile)
    depth = np.zeros(release.count)
    needed = pieces_needed(body, largest, times)
    for count in np.unique(needed):
        chosen = needed == count
        watched = reach(times[chosen], count, profile)
        found = _depths(
            take(body, chosen),
            take(outline, chosen),
            watched.pieces,
            0.0,
            0.0,
        )
        depth[chosen] = np.max(found, axis=0)
    buried = depth > BURIED * outline.smallest
    if np.any(buried):
        i = int(np.argmax(buried))
        raise ValueError(
            f"block {i} is released {depth[i]:.3g} m in the ground; its centre at "
            f"x = {release.x[i]:g} must lie higher than y = {release.y[i]:g}"
        )

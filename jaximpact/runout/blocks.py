"""Blocks as the run-out sees them: outline, mass, motion in the plane, release.

x to the right, y up, rotation clockwise. A plane that descends at an angle w has
t = (cos w, -sin w) along it and N = (sin w, cos w) out of it; the impact's n is -N.
The orientation phi of a block is the angle from the vertical, clockwise, to its major
axis; seen from the plane it is Theta = phi - w.
"""

import dataclasses
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import ArrayLike

from .._checks import expect, real_numbers
from ..errors import InputError
from ..io.checks import check_scene
from ..io.display import Rows, ShownAsTable, range_of
from ..reports.tables import place_text
from ..scene import GRAVITY, Block, Scene
from ..shapes import AbstractShape, SemiAxes, shape_by_shape
from ..units import DEGREE
from .coordinates import LARGEST
from .lane_programs import Values, closed_form


class Body(NamedTuple):
    """Position and motion of blocks; arrays `(lanes,)`."""

    x: Values  # centre [m]
    y: Values
    v_x: Values  # velocity of the centre [m/s]
    v_y: Values
    orientation: Values  # angle phi [rad]
    angular_velocity: Values  # Omega [rad/s], clockwise positive


class MassProperties(NamedTuple):
    """Mass and moment of inertia of blocks."""

    mass: Values  # mass [kg]
    inertia: Values  # about the out-of-plane axis through the centre [kg m2]

    def kinetic_energy(self, v_x: Values, v_y: Values, spin: Values) -> Values:
        """Compute the kinetic energy [J] of velocities along two axes."""
        return 0.5 * (self.mass * (v_x**2 + v_y**2) + self.inertia * spin**2)


class BlockOutline(NamedTuple):
    """Section of the block in the plane of motion."""

    shape: AbstractShape
    axes: SemiAxes
    largest: Values  # radius of the circumscribed circle [m]
    smallest: Values  # height of the centre above the flat side [m]

    @property
    def heave(self) -> Values:
        """Difference between the greatest and the least height of the centre as the
        block rolls [m]; 0 for a sphere."""
        return self.largest - self.smallest


def outline_of(block: Block) -> BlockOutline:
    """Compute the outline of a block."""
    axes = block.semi_axes
    return BlockOutline(
        block.shape,
        axes,
        block.shape.bound * axes.minor,
        jnp.minimum(axes.major, axes.minor),
    )


def select(tree, chosen):
    """Select lanes of every array in a tree."""
    return jax.tree.map(lambda leaf: leaf[chosen], tree)


def common_shape(what: str, tree) -> tuple[int, ...]:
    """Return the shape, of one axis at least, that the fields of a tree broadcast to.
    Raises InputError, which says what they are, where they do not."""
    shapes = [np.shape(leaf) for leaf in jax.tree.leaves(tree)]
    try:
        return np.broadcast_shapes(*shapes, (1,))
    except ValueError:
        raise InputError(
            f"{what} must broadcast to one axis, but have shapes {sorted(set(shapes))}"
        ) from None


def put(tree, chosen, new) -> None:
    """Set lanes of every array in a tree to those of another tree."""
    pairs = zip(jax.tree.leaves(tree), jax.tree.leaves(new), strict=True)
    for leaf, values in pairs:
        leaf[chosen] = values


def choose(condition: Values, yes: Any, no: Any) -> Any:
    """Choose between two trees of one structure; what they have in common is left as it
    is."""
    return jax.tree.map(
        lambda a, b: a if a is b else jnp.where(condition, a, b), yes, no
    )


def fly(body: Body, time) -> Body:
    """Move blocks by a time of free flight [s], with constant spin: exact."""
    return Body(
        x=body.x + body.v_x * time,
        y=body.y + (body.v_y - 0.5 * GRAVITY * time) * time,
        v_x=body.v_x,
        v_y=body.v_y - GRAVITY * time,
        orientation=body.orientation + body.angular_velocity * time,
        angular_velocity=body.angular_velocity,
    )


def support(outline: BlockOutline, sin: Values, cos: Values) -> tuple[Values, Values]:
    """Compute the extent of a block against a direction N, from sine and cosine of
    Theta.

    Returns:
        Distances from the centre to the lowest point [m]: r_y against N, and along t
        the arm, T = dr_y/dTheta.
    """
    shape, axes = outline.shape, outline.axes
    return shape.support(axes, sin, cos), shape.tangency_arm(axes, sin, cos)


@closed_form
def support_of(outline: BlockOutline, theta: Values) -> tuple[Values, Values]:
    """Compute `support` from the angle Theta itself, for arrays."""
    return support(outline, jnp.sin(theta), jnp.cos(theta))


@closed_form
def _mass_properties(block: Block) -> MassProperties:
    return MassProperties(block.mass, block.inertia)


@closed_form
def _sizes(block: Block) -> tuple[SemiAxes, Values, Values]:
    outline = outline_of(block)
    return outline.axes, outline.largest, outline.smallest


def _check_size(outline: BlockOutline) -> None:
    """Raise ValueError for a block whose powers leave the floating-point numbers."""
    for size in (outline.smallest, outline.largest):
        allowed = (size >= 1.0 / LARGEST) & (size <= LARGEST)
        if not np.all(allowed):
            i = int(np.argmin(allowed))
            raise ValueError(
                f"semi-axes of blocks must be from {1.0 / LARGEST:g} to {LARGEST:g} m, "
                f"but one of block {i} is {size[i]:g} m, by its mass, density and shape"
            )


@dataclasses.dataclass(frozen=True, init=False, repr=False)
class Release(ShownAsTable):
    """Blocks at the start of their trajectories, in free flight.

    Args:
        block: the blocks; fields that broadcast to `(blocks,)`.
        x, y: centres [m], broadcast likewise, as all that follows.
        v_x, v_y: velocities of the centres [m/s], to the right and up.
        orientation: angle from the vertical, clockwise, to the major axis [rad].
        angular_velocity: spin [rad/s], clockwise positive.

    Raises ValueError, in one sentence, for values out of range.
    """

    block: Block
    x: np.ndarray
    y: np.ndarray
    v_x: np.ndarray
    v_y: np.ndarray
    orientation: np.ndarray
    angular_velocity: np.ndarray

    def __init__(
        self,
        block: Block,
        x: ArrayLike,
        y: ArrayLike,
        v_x: ArrayLike = 0.0,
        v_y: ArrayLike = 0.0,
        orientation: ArrayLike = 0.0,
        angular_velocity: ArrayLike = 0.0,
    ):
        expect("a release's block", block, Block)
        motion = Body(x, y, v_x, v_y, orientation, angular_velocity)._asdict()
        body = {n: real_numbers(f"a release's {n}", v) for n, v in motion.items()}
        shape = common_shape("fields of a release", (block, body))
        if len(shape) > 1 or 0 in shape:
            raise ValueError(
                f"a release needs blocks along one axis, but got shape {shape}"
            )

        def spread(value):
            return np.array(np.broadcast_to(np.asarray(value, float), shape))

        for name, value in body.items():
            values = spread(value)
            if not np.all(np.isfinite(values)):
                raise ValueError(
                    f"a release's {name} must be finite, but is not for block "
                    f"{int(np.argmin(np.isfinite(values)))}"
                )
            allowed = np.abs(values) <= LARGEST
            if not np.all(allowed):
                i = int(np.argmin(allowed))
                raise ValueError(
                    f"a release's {name} must be within {LARGEST:g} of 0, in SI units, "
                    f"but is {values[i]:g} for block {i}"
                )
            object.__setattr__(self, name, values)
        check_scene(Scene(block), batched=True)
        object.__setattr__(self, "block", jax.tree.map(spread, block))
        _check_size(self.outline)

    @property
    def count(self) -> int:
        """Number of blocks."""
        return len(self.x)

    def of_blocks(self, chosen: np.ndarray) -> "Release":
        """Select some blocks."""
        return Release(select(self.block, chosen), *select(self.body, chosen))

    @property
    def body(self) -> Body:
        """Position and motion at release, arrays `(blocks,)`."""
        return Body(*(getattr(self, name) for name in Body._fields))

    @property
    def outline(self) -> BlockOutline:
        """Sections of the blocks in the plane of motion."""
        return BlockOutline(self.block.shape, *shape_by_shape(_sizes, self.block))

    @property
    def mass_properties(self) -> MassProperties:
        """Mass [kg] and moment of inertia [kg m2], arrays `(blocks,)`."""
        return shape_by_shape(_mass_properties, self.block)

    def display_rows(self) -> tuple[str, Rows]:
        """Give the number of blocks and the ranges of their quantities."""
        body = self.body
        speed = np.hypot(body.v_x, body.v_y)
        rows = [
            ("mass", range_of(self.block.mass), "kg"),
            ("x", range_of(body.x, place_text), "m"),
            ("y", range_of(body.y, place_text), "m"),
            ("speed", range_of(speed), "m/s"),
            ("orientation", range_of(body.orientation / DEGREE), "deg"),
            ("angular velocity", range_of(body.angular_velocity / DEGREE), "deg/s"),
        ]
        kind = type(self.block.shape).__name__
        return f"Release: {self.count} blocks ({kind})", rows

"""A block in flight, and the frame of a plane that it may touch.

x to the right, y up, rotation clockwise. A plane that descends at an angle w has
t = (cos w, -sin w) along it and N = (sin w, cos w) out of it; the impact's n is -N.
The orientation phi of a block is the angle from the vertical, clockwise, to its major
axis; seen from the plane it is Theta = phi - w.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..block import Block
from ..scene import GRAVITY
from ..shapes import AbstractShape, SemiAxes
from .programs import closed_form

Scalar = Float[Array, " lanes"]

LITTLE_LATER = 1e-9
"""Turn by which faces count as level [rad]: more than the rounding of orientations, and
less than would lower a block by more than it touches within."""


class Body(NamedTuple):
    """Where a block is and how it moves."""

    x: Scalar
    """Of the centre [m]."""
    y: Scalar
    v_x: Scalar
    """Of the centre [m/s]."""
    v_y: Scalar
    orientation: Scalar
    """phi [rad]."""
    angular_velocity: Scalar
    """Omega [rad/s]."""


class Outline(NamedTuple):
    """The block's section in the plane of motion."""

    shape: AbstractShape
    axes: SemiAxes
    largest: Scalar
    """Radius of the circle about it [m]; for an ellipse the larger semi-axis."""
    smallest: Scalar
    """Height of its centre as it lies on its flat side [m]: the smaller semi-axis."""


def outline_of(block: Block) -> Outline:
    """The outline of a block."""
    axes = block.semi_axes
    return Outline(
        block.shape,
        axes,
        block.shape.bound * axes.minor,
        jnp.minimum(axes.major, axes.minor),
    )


def fly(body: Body, time: Scalar) -> Body:
    """The block after a time of free flight [s], with constant spin: exact."""
    return Body(
        x=body.x + body.v_x * time,
        y=body.y + (body.v_y - 0.5 * GRAVITY * time) * time,
        v_x=body.v_x,
        v_y=body.v_y - GRAVITY * time,
        orientation=body.orientation + body.angular_velocity * time,
        angular_velocity=body.angular_velocity,
    )


class Support(NamedTuple):
    """The block from a direction N."""

    radius: Scalar
    """r_y [m], how far it reaches against N."""
    arm: Scalar
    """T = dr_y/dTheta [m], where it reaches farthest, along t from the centre."""


def support(outline: Outline, sin: Scalar, cos: Scalar) -> Support:
    """How far the block reaches, by sine and cosine of Theta."""
    shape, axes = outline.shape, outline.axes
    return Support(shape.support(axes, sin, cos), shape.tangency_arm(axes, sin, cos))


def turned_on(outline: Outline, theta: Scalar, spin: Scalar) -> Scalar:
    """The orientation a little later, for a shape that may have flat faces: of a face
    that is level the end that comes down is the lowest point, not its middle. That of
    another shape as it is."""
    if outline.shape.largest_bending(outline.axes) is not None:
        return theta
    return theta + LITTLE_LATER * jnp.sign(spin)


def _support_of(outline: Outline, theta: Scalar) -> Support:
    return support(outline, jnp.sin(theta), jnp.cos(theta))


support_of = closed_form(_support_of)
"""`support` by the angle Theta itself, for arrays."""


def take(tree, chosen: np.ndarray):
    """Some lanes of a tree of arrays."""
    return jax.tree.map(lambda leaf: leaf[chosen], tree)

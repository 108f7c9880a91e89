"""How a block arrives, and the scene: block, soil and impact together."""

import dataclasses

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .block import Block
from .errors import InputError
from .fields import expect, real_numbers
from .parameters import Composite, parameter
from .soil import Soil
from .units import DEGREE

GRAVITY = 9.81
"""Acceleration of gravity [m/s2]."""


class Impact(Composite):
    """State of the block as it touches the ground.

    Positive: n into the ground, t down-slope, rotation clockwise when down-slope is to
    the right.
    """

    speed: Float[Array, ""] = parameter(
        14.0, "m/s", "(0, inf)", "impact speed", column="speed_mps", usual=(0.0, 300.0)
    )
    """Speed of the centre of mass [m/s], positive."""
    angle: Float[Array, ""] = parameter(
        0.0,
        "deg",
        "(-90, 90)",
        "impact angle from the ground's normal; negative up-slope",
    )
    """Impact angle [rad] from the ground's normal, in (-pi/2, pi/2); negative means
    that the block travels up-slope."""
    orientation: Float[Array, ""] = parameter(
        0.0,
        "deg",
        "(-inf, inf)",
        "angle from the ground's normal to the major axis",
        usual=(-360.0, 360.0),
    )
    """theta_0 [rad], angle from the ground's normal to the block's major axis."""
    angular_velocity: Float[Array, ""] = parameter(
        0.0,
        "deg/s",
        "(-inf, inf)",
        "spin at impact, clockwise positive",
        usual=(-3e4, 3e4),
    )
    """Omega_0 [rad/s], clockwise positive."""
    slope: Float[Array, ""] = parameter(0.0, "deg", "(-90, 90)", "slope angle")
    """Slope angle omega [rad], in (-pi/2, pi/2)."""

    @classmethod
    def from_degrees(
        cls, speed=14.0, angle=0.0, orientation=0.0, angular_velocity=0.0, slope=0.0
    ) -> "Impact":
        """An impact with its angles in degrees, and its spin in degrees a second."""
        angles = (angle, orientation, angular_velocity, slope)
        names = ("angle", "orientation", "angular_velocity", "slope")
        angles = {
            name: value * DEGREE
            if isinstance(value, jax.Array)
            else DEGREE * real_numbers(f"Impact.{name}", value)
            for name, value in zip(names, angles, strict=True)
        }
        return cls(speed=speed, **angles)

    @property
    def normal_velocity(self) -> Float[Array, ""]:
        """v_n at impact [m/s], positive into the ground."""
        return self.speed * jnp.cos(self.angle)

    @property
    def tangential_velocity(self) -> Float[Array, ""]:
        """v_t at impact [m/s], positive down-slope."""
        return self.speed * jnp.sin(self.angle)


class Scene(eqx.Module):
    """One impact to compute: which block, on which soil, arriving how; or many, if
    fields are arrays. What is not given has its default."""

    block: Block = eqx.field(default_factory=Block)
    soil: Soil = eqx.field(default_factory=Soil)
    impact: Impact = eqx.field(default_factory=Impact)


def as_scene(
    scene: "Scene | Block | tuple[Block, Soil, Impact]",
    soil: Soil | None = None,
    impact: "Impact | None" = None,
) -> "Scene":
    """What functions take as a scene: one, or its block, soil and impact, side by side
    or in a tuple; what is left out has its default.

    Raises InputError for anything else.
    """
    if isinstance(scene, Scene):
        if soil is not None or impact is not None:
            raise InputError(
                "a scene holds its soil and its impact already; give the scene alone, "
                "or block, soil and impact"
            )
        return scene
    if isinstance(scene, tuple | list):
        return as_scene(*scene)
    parts = {"block": scene, "soil": soil, "impact": impact}
    given = {part: value for part, value in parts.items() if value is not None}
    for part, value in given.items():
        expect(part, value, {"block": Block, "soil": Soil, "impact": Impact}[part])
    return Scene(**given)


def shape_of(scene: Scene) -> tuple[int, ...]:
    """The shape that the fields of a scene broadcast to.

    Raises InputError if they do not.
    """
    shapes = [np.shape(leaf) for leaf in jax.tree.leaves(scene)]
    try:
        return np.broadcast_shapes(*shapes)
    except ValueError:
        told = ", ".join(sorted({str(shape) for shape in shapes if shape}))
        raise InputError(
            "fields of a scene must be scalars or arrays that broadcast, but have "
            f"shapes {told}"
        ) from None


def with_axes(scene: Scene, count: int) -> Scene:
    """The scene with so many axes in every field, the missing ones of length one in
    front.

    Fields broadcast as before, and also after `jax.vmap` has put an axis in front of
    each, where those with fewer axes would no longer match.
    """

    def field(leaf):
        missing = count - jnp.ndim(leaf)
        return jnp.reshape(leaf, (1,) * missing + jnp.shape(leaf)) if missing else leaf

    return jax.tree.map(field, scene)


PARTS = tuple(field.name for field in dataclasses.fields(Scene))

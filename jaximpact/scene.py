"""How a block arrives, and the scene: block, soil and impact together."""

import dataclasses

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .block import Block
from .fields import Parameters
from .precision import float64_leaf
from .soil import Soil

GRAVITY = 9.81
"""Acceleration of gravity [m/s2]."""


class Impact(Parameters):
    """State of the block as it touches the ground.

    Positive: n into the ground, t down-slope, rotation clockwise when down-slope is to
    the right.
    """

    speed: Float[Array, ""] = eqx.field(default=14.0, converter=float64_leaf)
    """Speed of the centre of mass [m/s], positive."""
    angle: Float[Array, ""] = eqx.field(default=0.0, converter=float64_leaf)
    """Impact angle [rad] from the ground's normal, in (-pi/2, pi/2); negative means
    that the block travels up-slope."""
    orientation: Float[Array, ""] = eqx.field(default=0.0, converter=float64_leaf)
    """theta_0 [rad], angle from the ground's normal to the block's major axis."""
    angular_velocity: Float[Array, ""] = eqx.field(default=0.0, converter=float64_leaf)
    """Omega_0 [rad/s], clockwise positive."""
    slope: Float[Array, ""] = eqx.field(default=0.0, converter=float64_leaf)
    """Slope angle omega [rad], in (-pi/2, pi/2)."""

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


PARTS = tuple(field.name for field in dataclasses.fields(Scene))

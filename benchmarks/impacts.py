"""Impacts that methods are measured on, the paper's parametric sets, and what a method
answers."""

import dataclasses
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaximpact.scene import Block, Impact, Scene, Soil

PARAMETERS = ("k_E", "gamma_v", "c_v")
"""Parameters of the soil with respect to whose logarithms e_n is differentiated."""
SETS = ("I", "II", "III", "IV")
"""Table 2 of the paper: I upright and vertical, II lying and vertical, III upright or
lying and oblique, IV turned and vertical."""


def parametric_scenes(sets: np.ndarray, seed: int) -> Scene:
    """Random scenes of the sets given by their places in `SETS`, `(n,)`.

    A_r 1 to 4; angle 10 to 80 degrees in III, orientation 0 to 170 in IV; gamma_v
    0.85 to 8.7 m/s and c_v 0.5 to 1, which are the supplement's; the rest is Table 1.
    """
    sets = np.asarray(sets)
    count = len(sets)
    draw = np.random.default_rng(seed).uniform
    aspect_ratio = draw(1.0, 4.0, count)
    gamma_v = np.exp(draw(np.log(0.85), np.log(8.7), count))
    c_v = draw(0.5, 1.0, count)
    angle = np.where(sets == 2, draw(10.0, 80.0, count), 0.0)
    lies = draw(0.0, 1.0, count) < 0.5
    turned = draw(0.0, 170.0, count)
    orientation = np.choose(
        sets, [np.zeros(count), np.full(count, 90.0), np.where(lies, 90.0, 0.0), turned]
    )
    return spread(
        Scene(
            Block(aspect_ratio=aspect_ratio),
            Soil(gamma_v=gamma_v, c_v=c_v),
            Impact(angle=np.radians(angle), orientation=np.radians(orientation)),
        ),
        count,
    )


def mixed_scenes(count: int, seed: int) -> Scene:
    """Random scenes of all four sets, in random order."""
    return parametric_scenes(np.random.default_rng(seed).integers(0, 4, count), seed)


def spread(scene: Scene, count: int) -> Scene:
    """The scene with every field as an array `(count,)`."""
    return jax.tree.map(lambda x: np.broadcast_to(np.asarray(x), (count,)), scene)


def choose(scene: Scene, places) -> Scene:
    """Some of the scenes."""
    return jax.tree.map(lambda x: np.asarray(x)[places], scene)


def shifted(scenes: Scene, shift) -> Scene:
    """The scenes with the logarithms of `PARAMETERS` changed by `(3,)`."""
    values = {
        name: getattr(scenes.soil, name) * factor
        for name, factor in zip(PARAMETERS, jnp.exp(shift), strict=True)
    }
    soil = dataclasses.replace(scenes.soil, **values)
    return Scene(scenes.block, soil, scenes.impact)


class Answer(NamedTuple):
    """Impacts solved by a method."""

    e_n: np.ndarray
    """NaN where it did not finish, or says so."""
    seconds: float
    """Time of all of them, without preparing the scenes and without compiling."""

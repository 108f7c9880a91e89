"""Scenes of many impacts that tests share."""

import numpy as np

from jaximpact import Block, Impact, Scene, Soil


def mixed_scenes(count, seed=0):
    """Short and long contacts, some that are none, in no order."""
    draw = np.random.default_rng(seed).uniform
    return Scene(
        Block(mass=draw(1.0, 500.0, count), aspect_ratio=draw(0.6, 3.0, count)),
        Soil(gamma_v=draw(1.0, 10.0, count)),
        Impact(
            speed=draw(2.0, 30.0, count),
            angle=draw(-1.2, 1.2, count),
            orientation=draw(0.0, np.pi, count),
            angular_velocity=draw(-100.0, 100.0, count),
        ),
    )

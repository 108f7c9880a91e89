"""What impacts do to blocks, and many impacts side by side by the full model."""

from typing import TYPE_CHECKING, Any, NamedTuple

import jax
import numpy as np
from jaxtyping import Array

from .accuracy import Accuracy
from .batch import compute_scenes
from .scene import Scene

if TYPE_CHECKING:
    # `Array`, `np.ndarray`, or the dual numbers of the run-out; no union says so.
    Values = Any
else:
    Values = Array | np.ndarray


class ImpactResponse(NamedTuple):
    """What an impact does to a block; arrays `(lanes,)`."""

    normal_velocity: Values
    """Velocity v_n of the centre after the impact [m/s], positive into the ground."""
    tangential_velocity: Values
    """Velocity v_t of the centre after the impact [m/s], along the ground."""
    angular_velocity: Values
    """Angular velocity after the impact [rad/s]."""
    duration: Values
    """Duration of the contact [s]."""
    rotation: Values
    """Rotation during the contact [rad]."""
    sinking: Values
    """Penetration of the lowest point at the end of the contact [m]."""


class ImpactResponses(NamedTuple):
    """Responses of blocks to impacts, and how these ended."""

    response: ImpactResponse
    """Arrays `(lanes,)`; NaN where an impact failed."""
    outcome: np.ndarray
    """Codes of `Outcome`, `(lanes,)`."""


def respond(scene: Scene, accuracy: Accuracy) -> ImpactResponses:
    """Integrate impacts by the full model; every field an array `(lanes,)`."""
    scene = jax.tree.map(np.asarray, scene)
    lanes = len(scene.impact.speed)
    columns = np.full((len(ImpactResponse._fields) + 1, lanes), np.nan)

    def keep(lanes, summary) -> None:
        columns[:, lanes] = [
            summary.normal_velocity,
            summary.tangential_velocity,
            summary.angular_velocity,
            summary.duration,
            summary.rotation,
            summary.final_sinking,
            summary.outcome_code,
        ]

    compute_scenes(scene, accuracy, keep)
    return ImpactResponses(ImpactResponse(*columns[:-1]), columns[-1].astype(int))

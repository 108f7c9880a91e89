"""Effects of impacts on blocks, and many impacts side by side by the full model."""

from typing import TYPE_CHECKING, Any, NamedTuple

import jax
import numpy as np
from jaxtyping import Array

from .accuracy import Accuracy
from .backend.rows import in_parts
from .batch import Collector, compute_part, summary_of
from .impact.dynamics import ARM
from .io.journal import Journal
from .scene import Scene

if TYPE_CHECKING:
    # Arrays of NumPy or of JAX: the same formulas run on both, and no union says so.
    Values = Any
else:
    Values = Array | np.ndarray


class ImpactResponse(NamedTuple):
    """Effects of impacts on blocks; arrays `(lanes,)`."""

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


FIELDS = (
    *("normal_velocity", "tangential_velocity", "angular_velocity"),
    *("duration", "rotation", "final_sinking", "outcome_code"),
)
"""Fields of an impact's summary, in the order of `ImpactResponse`, and its outcome."""
COLUMNS = (*ImpactResponse._fields, "outcome", "arm_work")
"""Names of the numbers of an impact that `respond` keeps."""


class ImpactResponses(NamedTuple):
    """Responses of blocks to impacts, and how these ended."""

    response: ImpactResponse
    """Arrays `(lanes,)`; NaN where an impact failed."""
    outcome: np.ndarray
    """Codes of `Outcome`, `(lanes,)`."""
    arm_work: np.ndarray | float = 0.0
    """Work of the normal force through its lever arm [J], `(lanes,)`, as in
    `EnergyLedger`; 0 where a contact model knows of none."""


def respond(
    scene: Scene, accuracy: Accuracy, journal: Journal | None = None
) -> ImpactResponses:
    """Integrate impacts by the full model; every field an array `(lanes,)`. A journal
    keeps the columns `COLUMNS` by the index of the impact."""
    scene = jax.tree.map(np.asarray, scene)
    lanes = len(scene.impact.speed)
    collector = Collector(len(COLUMNS), lanes, journal)
    for part in in_parts(np.flatnonzero(collector.missing)):
        scenes = jax.tree.map(lambda leaf, part=part: leaf[part], scene)
        summary = summary_of(compute_part(scenes, len(part), accuracy, ARM), ARM)
        columns = [getattr(summary, name) for name in FIELDS]
        assert summary.energy is not None, "kept for its arm work"
        columns.append(summary.energy.arm)
        collector.take(part, np.stack(columns, axis=-1))
    *response, outcome, arm_work = collector.numbers
    return ImpactResponses(ImpactResponse(*response), outcome.astype(int), arm_work)

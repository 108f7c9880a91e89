"""What the figures of one run share: the ground, the accuracy, and who is told."""

import dataclasses
from collections.abc import Callable

import numpy as np

from ..accuracy import Accuracy
from ..errors import InputError, nearest
from ..parametric_sets import GROUNDS, TABLE_1, parametric_set
from ..provenance import scene_values
from ..scene import Scene
from ..sweeping import LABELS, Axes, scene_of_values

GROUND = "ground"
HALF_TURN = np.linspace(0.0, 180.0, 181)
"""Orientations for curves [deg]: what comes after repeats. (The sets have every fifth,
which is too few where curves jump.)"""


@dataclasses.dataclass(frozen=True)
class Study:
    """The paper's parametric study on one of its grounds.

    Raises InputError for an unknown ground.
    """

    ground: str = TABLE_1
    """One of `GROUNDS`."""
    accuracy: str | Accuracy = "reference"
    progress: Callable[[str], None] = lambda text: None
    """Takes lines of progress."""

    def __post_init__(self):
        if self.ground not in GROUNDS:
            known = ", ".join(repr(ground) for ground in GROUNDS)
            raise InputError(
                f"the ground must be one of {known}, but is {self.ground!r}; did you "
                f"mean {nearest(self.ground, GROUNDS)!r}?"
            )

    def parametric_set(self, name: str) -> tuple[Scene, Axes]:
        """Base and axes of a set, on this ground alone."""
        base, axes = parametric_set(name)
        place = list(axes[GROUND][LABELS]).index(self.ground)
        soil = {
            quantity: values[place]
            for quantity, values in axes[GROUND].items()
            if quantity != LABELS
        }
        others = {axis: values for axis, values in axes.items() if axis != GROUND}
        return with_values(base, soil), others


def with_values(base: Scene, values) -> Scene:
    """The scene with other values of some quantities, in the units of their columns."""
    return scene_of_values(scene_values(base) | dict(values))

"""What the figures of one run share: the ground, the accuracy, and who is told."""

import dataclasses
from collections.abc import Callable

import numpy as np

from ..accuracy import Accuracy
from ..formats.scenes import scene_of_values, scene_values
from ..parametric_sets import TABLE_1, check_ground, parametric_set
from ..runout import FullModel, Runs, simulate_runout
from ..runout.biplanar import BiplanarCase
from ..scene import Scene
from ..sweeping import Axes

SLOPE = "slope"
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
    known: dict[str, Runs] = dataclasses.field(
        default_factory=dict, repr=False, compare=False
    )
    """What has been computed and several figures need."""

    def __post_init__(self):
        check_ground(self.ground)

    def parametric_set(self, name: str) -> tuple[Scene, Axes]:
        """Base and axes of a set, on this ground alone."""
        return parametric_set(name, self.ground)

    def slope_runs(self) -> Runs:
        """The paper's runs down the slope of two planes, computed once."""
        if SLOPE not in self.known:
            case, soil = BiplanarCase(), self.parametric_set("I")[0].soil
            self.known[SLOPE] = simulate_runout(
                case.profile(soil),
                case.release(),
                FullModel(self.accuracy),
                progress=lambda done, total: self.progress(f"{done} of {total} runs"),
            )
        return self.known[SLOPE]


def with_values(base: Scene, values) -> Scene:
    """The scene with other values of some quantities, in the units of their columns."""
    return scene_of_values(scene_values(base) | dict(values))

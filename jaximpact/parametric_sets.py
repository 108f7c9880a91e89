"""The paper's parametric sets, as sweeps.

Source: Dattola et al. (2023), Table 2, Fig. 13 and the supplementary material. The
paper gives ranges; the steps within them are ours.
"""

import copy
from typing import Any

import numpy as np
import xarray as xr

from ._checks import expect
from ._settings import numpy_settings
from .accuracy import DEFAULT_ACCURACY, Accuracy
from .errors import InputError, did_you_mean
from .scene import Scene
from .scene_quantities import scene_of_values
from .sweeping import LABELS, Axes, sweep

TABLE_1 = "Table 1"
GROUNDS = (TABLE_1, "c_v 0.5, gamma_v 1.70", "c_v 0.5, gamma_v 0.85")
"""Labels along the dimension `ground`: Table 1 has c_v 1.0 and gamma_v 8.7."""
GROUND = "ground"
_GROUND: dict[str, Any] = {
    GROUND: {LABELS: GROUNDS, "c_v": [1.0, 0.5, 0.5], "gamma_v": [8.7, 1.70, 0.85]}
}
_ASPECT_RATIOS = {"aspect_ratio": np.linspace(1.0, 4.0, 7)}
_SPINS = {"angular_velocity_degps": [0.0, 500.0, 1500.0, 2000.0]}


def _orientations(last: float) -> dict[str, Any]:
    return {"orientation_deg": np.arange(0.0, last + 2.5, 5.0)}


_SETS: dict[str, tuple[dict[str, float], dict[str, Any]]] = {
    "I": ({}, _GROUND | _ASPECT_RATIOS),
    "II": ({"orientation_deg": 90.0}, _GROUND | _ASPECT_RATIOS),
    "III": (
        {},
        _GROUND
        | {"orientation_deg": [0.0, 90.0], "angle_deg": np.linspace(10.0, 80.0, 15)}
        | _ASPECT_RATIOS,
    ),
    "IV": ({}, _GROUND | _orientations(170.0) | _ASPECT_RATIOS),
    "fig13": ({"aspect_ratio": 2.0}, _GROUND | _SPINS | _orientations(180.0)),
}
PARAMETRIC_SETS = tuple(_SETS)
"""I: vertical, along the major axis; II: along the minor axis; III: inclined, along
either; IV: vertical, at all orientations; fig13: the same with initial spin."""


@numpy_settings()
def parametric_set(name: str, ground: str | None = None) -> tuple[Scene, Axes]:
    """Base and axes of a set, for `sweep`: blocks of 100 kg at 14 m/s.

    Args:
        name: one of `PARAMETRIC_SETS`.
        ground: one of `GROUNDS`, which is then part of the base. Without it the three
            of them lie along the dimension `ground`.

    Raises InputError for unknown names, with the nearest known.
    """
    if not isinstance(name, str) or name not in _SETS:
        raise InputError(f"{name} is no parametric set; {did_you_mean(name, _SETS)}")
    values, axes = copy.deepcopy(_SETS[name])
    if ground is None:
        return scene_of_values(values), axes
    check_ground(ground)
    place = GROUNDS.index(ground)
    soil = {quantity: numbers[place] for quantity, numbers in axes[GROUND].items()}
    del soil[LABELS]
    others = {axis: numbers for axis, numbers in axes.items() if axis != GROUND}
    return scene_of_values(values | soil), others


def simulate_set(
    name: str,
    ground: str | None = None,
    *,
    accuracy: str | Accuracy = DEFAULT_ACCURACY,
) -> xr.Dataset:
    """Compute a parametric set of the paper.

    Args:
        name, ground: as for `parametric_set`.
        accuracy: as for `sweep`.

    Returns:
        The dataset of `sweep`: named axes, every number of an impact with its unit, and
        the outcome in words. `sweep(*parametric_set(name))` is the same; axes and base
        may be changed there.
    """
    return sweep(*parametric_set(name, ground), accuracy=accuracy)


def check_ground(ground: str) -> None:
    """Raise InputError unless it is one of `GROUNDS`."""
    expect("ground", ground, str)
    if ground not in GROUNDS:
        raise InputError(
            f"ground {ground!r} is unknown; {did_you_mean(ground, GROUNDS, repr)}"
        )

"""The paper's parametric sets, as sweeps, and the recording of impacts of a set.

Source: Dattola et al. (2023), Table 2, Fig. 13 and the supplementary material. The
paper gives ranges; the steps within them are ours.
"""

import concurrent.futures
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .._numpy_settings import numpy_settings
from ..accuracy import Accuracy, get_accuracy
from ..backend.derivative_rules import solve_recorded
from ..backend.threads import thread_count
from ..errors import InputError, nearest
from ..impact.results import History, ImpactSummary
from ..progress import Progress
from ..scene import Scene
from ..scene_quantities import scene_of_values, scene_values
from ..sweeping import LABELS, Axes

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
        raise InputError(
            f"{name} is no parametric set; did you mean {nearest(name, _SETS)}?"
        )
    values, axes = _SETS[name]
    if ground is None:
        return scene_of_values(values), axes
    check_ground(ground)
    place = GROUNDS.index(ground)
    own = {quantity: numbers[place] for quantity, numbers in axes[GROUND].items()}
    del own[LABELS]
    others = {axis: numbers for axis, numbers in axes.items() if axis != GROUND}
    return scene_of_values(values | own), others


def check_ground(ground: str) -> None:
    """Raise InputError unless it is one of `GROUNDS`."""
    if ground not in GROUNDS:
        raise InputError(
            f"the ground must be one of {', '.join(map(repr, GROUNDS))}, but is "
            f"{ground!r}; did you mean {nearest(ground, GROUNDS)!r}?"
        )


def record_impacts(
    base: Scene,
    points: Sequence[Mapping],
    accuracy: str | Accuracy,
    progress: Progress,
) -> list[tuple[ImpactSummary, History]]:
    """Compute impacts with their histories.

    Args:
        points: what differs from the base, quantities in the units of their columns.
    """
    values, setting = scene_values(base), get_accuracy(accuracy)

    def record(point):
        return solve_recorded(scene_of_values(values | dict(point)), setting)

    progress("time series", 0, len(points))
    # The first compiles what all use.
    results = [record(points[0])]
    pool = concurrent.futures.ThreadPoolExecutor(thread_count())
    try:
        for result in pool.map(record, points[1:]):
            results.append(result)
            progress("time series", len(results), len(points))
    finally:
        pool.shutdown(cancel_futures=True)
    return results

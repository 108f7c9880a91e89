"""Courses of impacts over time."""

import concurrent.futures
from collections.abc import Iterable, Sequence

import numpy as np
import pandas as pd

from ..engines.threads import thread_count
from ..formats.columns import OUTCOME_COLUMN
from ..scene import Scene
from ..simulation import ImpactResult, simulate
from .study import Study, with_values

SERIES = {
    "time_s": "time",
    "penetration_m": "penetration",
    "normal_force_N": "normal_force",
    "rotation_rad": "rotation",
    "R_r": "rotational_ratio",
}
"""Column -> field of the history."""


def record_courses(
    study: Study,
    base: Scene,
    points: Sequence[dict[str, float]],
) -> list[ImpactResult]:
    """Results with histories.

    Args:
        study: for its accuracy, and to be told of progress.
        base: the scene.
        points: what differs from it, quantities in the units of their columns.
    """

    def record(point):
        scene = with_values(base, point)
        return simulate(
            scene.block,
            scene.soil,
            scene.impact,
            accuracy=study.accuracy,
            history=True,
        )

    total = len(points)
    study.progress(f"0 of {total} courses")
    # The first compiles what all use.
    results = [record(points[0])]
    pool = concurrent.futures.ThreadPoolExecutor(thread_count())
    try:
        for result in pool.map(record, points[1:]):
            results.append(result)
            study.progress(f"{len(results)} of {total} courses")
    finally:
        pool.shutdown(cancel_futures=True)
    return results


def course_table(
    points: Iterable[dict[str, float]],
    results: Iterable[ImpactResult],
    series: Sequence[str],
) -> pd.DataFrame:
    """Courses one below another, a row for the start and for each step of the
    integration, with the point and the outcome in every row.

    Steps are as the integration took them: dense where forces change fast, and the last
    one on the end of the contact, which a common grid of times would cut off.
    """
    parts = []
    for point, result in zip(points, results, strict=True):
        columns = {name: getattr(result.history, SERIES[name]) for name in series}
        part = pd.DataFrame(columns).assign(**{OUTCOME_COLUMN: str(result.outcome)})
        for place, (quantity, value) in enumerate(point.items()):
            part.insert(place, quantity, value)
        parts.append(part)
    return pd.concat(parts, ignore_index=True)


def peak(time: np.ndarray, values: np.ndarray) -> float:
    """Largest value of a course, between its rows too: by the parabola through the
    largest one and its neighbours. At either end it is the value there; NaN if a value
    is not finite."""
    if not np.all(np.isfinite(values)):
        return float("nan")
    place = int(np.argmax(values))
    if place in (0, len(values) - 1):
        return float(values[place])
    around = slice(place - 1, place + 2)
    scaled = (time[around] - time[place]) / (time[place + 1] - time[place - 1])
    second, first, height = np.polyfit(scaled, values[around], 2)
    return float(height - 0.25 * first**2 / second) if second < 0.0 else float(height)

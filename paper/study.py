"""Impacts of the paper's sets, step by step."""

import concurrent.futures
from collections.abc import Mapping, Sequence

from jaximpact import simulate
from jaximpact.accuracy import Accuracy
from jaximpact.impact.results import History
from jaximpact.progress import Progress
from jaximpact.scene import Scene
from jaximpact.scene_quantities import scene_with


def record_impacts(
    base: Scene,
    points: Sequence[Mapping[str, float]],
    accuracy: str | Accuracy,
    progress: Progress,
) -> list[tuple[str, History]]:
    """Return the outcome and the history of impacts.

    Args:
        points: what differs from the base, quantities in the units of their columns.
    """

    def record(point: Mapping[str, float]) -> tuple[str, History]:
        scene = scene_with(base, point)
        result = simulate(scene, accuracy=accuracy, history=True)
        assert result.history is not None  # asked for above
        return str(result.outcome), result.history

    # The first compiles what all use.
    results = [record(points[0])]
    with concurrent.futures.ThreadPoolExecutor() as pool:
        for result in pool.map(record, points[1:]):
            results.append(result)
            progress("time series", len(results), len(points))
    return results

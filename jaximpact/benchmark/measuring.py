"""Errors and times of methods."""

from collections.abc import Callable, Sequence

import numpy as np


def error_figures(values: np.ndarray, exact: np.ndarray) -> dict:
    """Median and 95 % of the largest error of each row, and the part that failed.

    An impact that did not finish counts as infinitely wrong, so that nothing is hidden;
    one whose exact value is not known is left out.

    Args:
        values, exact: `(n,)` or `(n, k)`.
    """
    values, exact = (np.reshape(x, (len(x), -1)) for x in (values, exact))
    known = np.all(np.isfinite(exact), axis=1)
    error = np.max(np.abs(values - exact), axis=1)[known]
    finished = np.isfinite(error)
    error = np.where(finished, error, np.inf)
    return {
        "error_median": float(np.quantile(error, 0.5, method="higher")),
        "error_95": float(np.quantile(error, 0.95, method="higher")),
        "error_max": float(np.max(error)),
        "failed": float(np.mean(~finished)),
    }


def interleaved_minima(
    tasks: Sequence[Callable[[], float]],
    repeats: int,
    limit_s: float,
    say: Callable[[str], None],
) -> list[float]:
    """Shortest time of each task, all of them measured in turn, round after round.

    What disturbs the machine for a while then disturbs all alike. A task that takes
    longer than `limit_s` is measured once.
    """
    shortest = [np.inf] * len(tasks)
    for turn in range(repeats):
        for place, task in enumerate(tasks):
            if turn and shortest[place] > limit_s:
                continue
            shortest[place] = min(shortest[place], task())
            say(f"round {turn + 1} of {repeats}, {place + 1} of {len(tasks)}")
    return shortest


def affordable(seconds: float, impacts: int, budget_s: float, low: int, high: int):
    """How many impacts fit a budget, from the time of a few."""
    return int(np.clip(budget_s * impacts / max(seconds, 1e-9), min(low, high), high))

"""A chart: how much is measured for it, what, how it is drawn, and its table."""

import dataclasses
import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from .methods import Method

Row = dict[str, float | str]
Table = Any
"""A pandas.DataFrame of rows, as they are read back."""


@dataclasses.dataclass(frozen=True)
class Settings:
    """Sizes of the measurements; the defaults take some 20 minutes on two cores."""

    seed: int = 1
    scenes: int = 2_000
    """Random impacts on which errors are measured, by methods that are quick enough."""
    singles: int = 24
    """Impacts solved one after another."""
    budget_s: float = 0.6
    """Time for one measurement; a slow method gets fewer impacts."""
    least_impacts: int = 16
    """Impacts that a slow method gets all the same."""
    repeats: int = 3
    """Rounds of measurements, of which the shortest count."""
    gradient_scenes: int = 96
    steps: tuple[float, ...] = (0.1, 0.03, 0.01, 0.001)
    """Steps of differences in the logarithm of a parameter, of which peers get the
    best."""
    differences_limit_s: float = 30.0
    """Peers whose differences take longer than that to find their step are left out."""
    jax_scenes: int = 4_096
    """Impacts under `jit` and `vmap`."""
    jax_singles: int = 30
    """Calls of one impact, of which the shortest counts."""
    jax_repeats: int = 10
    ladder_scenes: int = 64
    """Impacts of each parametric set."""
    batch_sizes: tuple[int, ...] = (1, 10, 100, 1_000, 10_000, 100_000)
    batch_limit_s: float = 60.0
    """Larger batches are left out where they would take longer than that."""
    first_uses: tuple[str, ...] = (
        "import",
        "vertical impact",
        "planar impact",
        "impact with dashpots",
        "gradient",
        "batch",
        "planar impact of a cylinder",
        "gradient of a cylinder",
    )
    first_uses_of_peers: tuple[str, ...] = (
        "diffrax Kvaerno5",
        "numbalsoda LSODA",
        "CVODE BDF",
    )
    map_points: int = 13
    """Points on each axis of the stability map."""
    sweep_points: int = 9
    slider_times: tuple[float, ...] = (1e-8, 1e-7, 1e-5, 1e-4)
    """tau_s [s], beside 1e-6."""
    target_scenes: int = 20_000
    target_tuning_scenes: int = 1_000
    target_repeats: int = 3
    target_error: float = 1e-3
    """95 % of impacts are within this of the exact e_n."""


def decades(low: float, high: float, points: int) -> list[float]:
    """Values at equal ratios."""
    if points == 1:
        return [math.sqrt(low * high)]
    ratio = math.log(high / low) / (points - 1)
    return [low * math.exp(ratio * k) for k in range(points)]


class Bench(NamedTuple):
    """What a measurement is given."""

    settings: Settings
    methods: list[Method]
    """This solver first."""
    peers: str
    """Directory of the peers, or an empty text."""
    say: Callable[[str], None]
    """Takes lines of progress."""


class Section(NamedTuple):
    """A chart that can be asked for by name."""

    name: str
    measure: Callable[[Bench], list[Row]]
    """Rows of the CSV; all with the same keys."""
    draw: Callable[[Table], Figure]
    table: Callable[[Table], list[tuple[str, ...]]]
    """The figures that are worth quoting: a header, then rows."""


def table_of(rows: Table, columns: dict[str, str]) -> list[tuple[str, ...]]:
    """A table with a line for each row.

    Args:
        columns: name in the header, and the format of a cell: `"{tolerance:.0e}"`.
    """
    records = rows.to_dict("records")
    lines = (tuple(f.format(**row) for f in columns.values()) for row in records)
    return [tuple(columns), *lines]


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

"""Impacts a second against the size of the batch."""

import functools
import itertools

import numpy as np
from matplotlib.figure import Figure

from jaximpact.accuracy import PRESETS
from jaximpact.plotting.style import in_style, legend_outside, panels
from jaximpact.scene import Scene

from ..impacts import choose, mixed_scenes
from .methods import Method, Ours
from .section import Bench, Row, Section, Table, interleaved_minima
from .style import log_axes, method_handles, styles_of

COMPARED = ("numbalsoda", "CVODE", "diffrax")
"""Families of peers, the first method of each."""
ENOUGH = 2_000
"""Impacts for which the programs of all larger batches are compiled."""
LONG_S = 3.0
"""What takes longer than that is measured once."""


def measure(bench: Bench) -> list[Row]:
    """Rows for each method and size, smaller sizes first."""
    settings = bench.settings
    largest = mixed_scenes(max(settings.batch_sizes), settings.seed)
    lines: list[tuple[Method, str, float]] = [
        (own, f"{own.name}, {name}", PRESETS[name].tolerance)
        for own in bench.methods
        if own.family == Ours.family
        for name in ("fast", "balanced")
    ]
    for family in COMPARED:
        method = next((m for m in bench.methods if m.family == family), None)
        if method is not None:
            tolerance = min(method.tolerances, key=lambda t: abs(np.log(t / 1e-3)))
            lines.append((method, f"{method.name}, {tolerance:g}", tolerance))
    rows, tasks = [], []
    for method, name, tolerance in lines:
        sizes = sorted(settings.batch_sizes)
        for size, next_size in itertools.pairwise([*sizes, 0]):
            scenes = choose(largest, np.arange(size))
            bench.say(f"{name}, {size} impacts")
            few = choose(largest, np.arange(min(size, ENOUGH)))
            method.solve(few, tolerance, batch=True)  # compiles
            task = functools.partial(_seconds, method, scenes, tolerance)
            seconds = task()
            rows.append({"method": name, "family": method.family, "impacts": size})
            # A long one is not measured again: this was its time.
            long = seconds > LONG_S
            tasks.append(functools.partial(float, seconds) if long else task)
            if seconds * next_size / size > settings.batch_limit_s:
                break
    seconds = interleaved_minima(tasks, settings.repeats, LONG_S, bench.say)
    return [
        row | {"impacts_per_s": row["impacts"] / shortest}
        for row, shortest in zip(rows, seconds, strict=True)
    ]


def _seconds(method: Method, scenes: Scene, tolerance: float) -> float:
    return method.solve(scenes, tolerance, batch=True).seconds


@in_style
def draw(rows: Table) -> Figure:
    """A line for each method."""
    figure, (axes,) = panels(height=4.5)
    log_axes(axes, "impacts in the batch [-]", "impacts per second [1/s]")
    for name, style in styles_of(rows).items():
        own = rows[rows["method"] == name]
        axes.plot(own["impacts"], own["impacts_per_s"], **style)
    legend_outside(figure, method_handles(rows), ncols=2)
    return figure


def table(rows: Table) -> list[tuple[str, ...]]:
    """Impacts a second: methods down, sizes across."""
    found = rows.pivot(index="method", columns="impacts", values="impacts_per_s")
    lines = [("method", *(f"{size:g}" for size in found.columns))]
    for name in rows["method"].unique():
        cells = ("-" if np.isnan(c) else f"{c:.3g}" for c in found.loc[name])
        lines.append((name, *cells))
    return lines


THROUGHPUT = Section("throughput", measure, draw, table)

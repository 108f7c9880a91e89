"""Error of e_n, and of its gradient, against the time of an impact."""

import functools
from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from ..accuracy import PRESETS
from .gradients import PARAMETERS, difference_gradient, exact_gradient, forward_gradient
from .measuring import affordable, error_figures, interleaved_minima
from .methods import Method, Ours, exact_e_n
from .scenes import choose, mixed_scenes
from .section import Bench, Row, Section
from .style import colour_of, legend_of, log_axes, markers_of, method_handles

MODES = {"single": False, "batch": True}
PRESET_OF = {preset.tolerance: name for name, preset in PRESETS.items()}


class Way(NamedTuple):
    """A method at one tolerance, as a function of scenes and of batch or not; gives
    values `(n,)` or `(n, k)`, and seconds."""

    method: Method
    tolerance: float
    run: Callable[..., tuple[np.ndarray, float]]


def measure_values(bench: Bench) -> list[Row]:
    """Rows for e_n."""
    settings = bench.settings
    scenes = mixed_scenes(settings.scenes, settings.seed)
    ways = [
        Way(method, tolerance, functools.partial(_solve, method, tolerance))
        for method in bench.methods
        for tolerance in method.tolerances
    ]
    return _measure(bench, ways, scenes, exact_e_n(scenes))


def _solve(method, tolerance, scenes, batch):
    answer = method.solve(scenes, tolerance, batch)
    return answer.e_n, answer.seconds


def measure_gradients(bench: Bench) -> list[Row]:
    """Rows for the derivatives of e_n by the logarithms of k_E, gamma_v and c_v."""
    settings = bench.settings
    scenes = mixed_scenes(settings.gradient_scenes, settings.seed)
    exact = exact_gradient(scenes)
    ways = []
    for method in bench.methods:
        for tolerance in method.tolerances:
            run = gradient_of(bench, method, tolerance, scenes, exact)
            if run is not None:
                ways.append(Way(method, tolerance, run))
    return _measure(bench, ways, scenes, exact)


def gradient_of(bench, method, tolerance, scenes, exact):
    """How a method takes derivatives, as a function of scenes and of batch or not; None
    where that would take too long."""
    if isinstance(method, Ours):
        return functools.partial(forward_gradient, tolerance=tolerance)
    if hasattr(method, "gradient"):
        return functools.partial(method.gradient, tolerance=tolerance)
    few = choose(scenes, np.arange(min(bench.settings.least_impacts, len(exact))))
    method.solve(few, tolerance, batch=True)  # compiles
    seconds = method.solve(few, tolerance, batch=True).seconds
    solves = 2 * len(PARAMETERS) * len(bench.settings.steps)
    if solves * seconds > bench.settings.differences_limit_s:
        bench.say(
            f"{method.name} at {tolerance:g}: left out, differences would take "
            f"{solves * seconds:.0f} s to find their step"
        )
        return None
    step = _best_step(bench, method, tolerance, scenes, exact)
    return functools.partial(difference_gradient, method, tolerance, step)


def _best_step(bench, method, tolerance, scenes, exact) -> float:
    """The step of differences that serves a method best, on a few scenes."""
    few = np.arange(min(bench.settings.least_impacts, len(exact)))

    def error(step):
        found, _ = difference_gradient(
            method, tolerance, step, choose(scenes, few), batch=True
        )
        return error_figures(found, exact[few])["error_95"]

    bench.say(f"{method.name} at {tolerance:g}: which step of differences")
    return min(bench.settings.steps, key=error)


def _measure(bench: Bench, ways: list[Way], scenes, exact) -> list[Row]:
    settings = bench.settings
    tasks, rows = [], []
    for way in ways:
        for mode, batch in MODES.items():
            bench.say(f"{way.method.name} at {way.tolerance:g}, {mode}")
            most = len(exact) if batch else min(settings.singles, len(exact))
            few = np.arange(min(most, settings.least_impacts if batch else 4))
            way.run(choose(scenes, few), batch=batch)  # compiles
            _, seconds = way.run(choose(scenes, few), batch=batch)
            count = affordable(
                seconds, len(few), settings.budget_s, settings.least_impacts, most
            )
            places = np.arange(count)
            values, _ = way.run(choose(scenes, places), batch=batch)
            rows.append(
                {
                    "method": way.method.name,
                    "family": way.method.family,
                    "mode": mode,
                    "tolerance": way.tolerance,
                    "preset": PRESET_OF.get(way.tolerance, "")
                    if isinstance(way.method, Ours)
                    else "",
                    "impacts": count,
                    **error_figures(values, exact[places]),
                }
            )
            tasks.append(
                lambda way=way, batch=batch, places=places: way.run(
                    choose(scenes, places), batch=batch
                )[1]
            )
    seconds = interleaved_minima(
        tasks, settings.repeats, 3.0 * settings.budget_s, bench.say
    )
    return [
        row | {"seconds_per_impact": shortest / row["impacts"]}
        for row, shortest in zip(rows, seconds, strict=True)
    ]


def draw(rows: list[Row], quantity: str) -> Figure:
    """Two panels, single and batch; medians joined by lines, 95 % as dashes."""
    figure = Figure(figsize=(13.0, 6.0), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    markers = markers_of(rows)
    titles = ("one after another, on one core", "all at once, on every core")
    for axes, mode, title in zip(panels, MODES, titles, strict=True):
        log_axes(axes, "time per impact [s]", "")
        axes.set_title(title)
        for name, marker in markers.items():
            own = [r for r in rows if r["method"] == name and r["mode"] == mode]
            if own:
                _draw_method(axes, own, marker)
        left, right = axes.get_xlim()
        axes.set_xlim(left, 3.0 * right)  # room for the names of presets
        axes.axhline(1e-3, color="black", lw=0.8, ls=":")
        axes.text(
            0.99,
            1.1e-3,
            "1e-3",
            transform=axes.get_yaxis_transform(),
            ha="right",
            va="bottom",
        )
    panels[0].set_ylabel(f"error of {quantity} [-]: median, and 95 % dashed")
    legend_of(figure, method_handles(rows))
    return figure


def _draw_method(axes, own: Iterable[Row], marker: str) -> None:
    own = sorted(own, key=lambda row: row["tolerance"])
    colour = colour_of(own[0]["family"])
    time = [row["seconds_per_impact"] for row in own]
    for key, style, size in (("error_median", "-", 6), ("error_95", "--", 0)):
        error = [min(row[key], 2.0) for row in own]
        axes.plot(
            time, error, color=colour, ls=style, marker=marker, markersize=size, lw=1.3
        )
    for row in own:
        if row["preset"]:
            axes.annotate(
                row["preset"],
                (row["seconds_per_impact"], row["error_median"]),
                xytext=(9, 0),
                textcoords="offset points",
                va="center",
                color=colour,
            )


def table(rows: list[Row]) -> list[tuple[str, ...]]:
    """Every point, by method and mode."""
    lines = [
        (
            "method",
            "tolerance",
            "mode",
            "impacts/s",
            "error, median",
            "error, 95 %",
            "failed",
        )
    ]
    for row in rows:
        lines.append(
            (
                row["method"],
                f"{row['tolerance']:.0e} {row['preset']}".strip(),
                row["mode"],
                f"{1.0 / row['seconds_per_impact']:.3g}",
                f"{row['error_median']:.0e}",
                f"{row['error_95']:.0e}",
                f"{row['failed']:.0%}",
            )
        )
    return lines


WORK_PRECISION = Section(
    "work-precision",
    measure_values,
    functools.partial(draw, quantity="$e_n$"),
    table,
)
GRADIENT = Section(
    "gradient",
    measure_gradients,
    functools.partial(draw, quantity=r"$\partial e_n/\partial\ln p$"),
    table,
)

"""Error of e_n, and of its gradient, against the time of an impact."""

import functools
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from jaximpact.accuracy import PRESETS
from jaximpact.plotting.style import in_style, legend_outside, panels

from ..impacts import PARAMETERS, choose, mixed_scenes
from .gradients import difference_gradient, exact_gradient, forward_gradient
from .methods import Method, Ours, exact_e_n
from .section import (
    Bench,
    Row,
    Section,
    Table,
    affordable,
    error_figures,
    interleaved_minima,
    table_of,
)
from .style import log_axes, method_handles, styles_of

MODES = {"single": False, "batch": True}
PRESET_OF = {preset.tolerance: name for name, preset in PRESETS.items()}


class Measured(NamedTuple):
    """A method at one tolerance, as a function of scenes and of batch or not; gives
    values `(n,)` or `(n, k)`, and seconds."""

    method: Method
    tolerance: float
    run: Callable[..., tuple[np.ndarray, float]]


def measure_values(bench: Bench) -> list[Row]:
    """Rows for e_n."""
    settings = bench.settings
    scenes = mixed_scenes(settings.scenes, settings.seed)
    measured = [
        Measured(method, tolerance, functools.partial(_solve, method, tolerance))
        for method in bench.methods
        for tolerance in method.tolerances
    ]
    return _measure(bench, measured, scenes, exact_e_n(scenes))


def _solve(method, tolerance, scenes, batch):
    answer = method.solve(scenes, tolerance, batch)
    return answer.e_n, answer.seconds


def measure_gradients(bench: Bench) -> list[Row]:
    """Rows for the derivatives of e_n with respect to logarithms of `PARAMETERS`."""
    settings = bench.settings
    scenes = mixed_scenes(settings.gradient_scenes, settings.seed)
    exact = exact_gradient(scenes)
    measured = []
    for method in bench.methods:
        for tolerance in method.tolerances:
            run = gradient_of(bench, method, tolerance, scenes, exact)
            if run is not None:
                measured.append(Measured(method, tolerance, run))
    return _measure(bench, measured, scenes, exact)


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


def _measure(bench: Bench, measured: list[Measured], scenes, exact) -> list[Row]:
    settings = bench.settings
    tasks, rows = [], []
    for each in measured:
        for mode, batch in MODES.items():
            bench.say(f"{each.method.name} at {each.tolerance:g}, {mode}")
            most = len(exact) if batch else min(settings.singles, len(exact))
            few = np.arange(min(most, settings.least_impacts if batch else 4))
            each.run(choose(scenes, few), batch=batch)  # compiles
            _, seconds = each.run(choose(scenes, few), batch=batch)
            count = affordable(
                seconds, len(few), settings.budget_s, settings.least_impacts, most
            )
            places = np.arange(count)
            values, _ = each.run(choose(scenes, places), batch=batch)
            rows.append(
                {
                    "method": each.method.name,
                    "family": each.method.family,
                    "mode": mode,
                    "tolerance": each.tolerance,
                    "preset": PRESET_OF.get(each.tolerance, "")
                    if isinstance(each.method, Ours)
                    else "",
                    "impacts": count,
                    **error_figures(values, exact[places]),
                }
            )
            tasks.append(
                lambda each=each, batch=batch, places=places: each.run(
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


@in_style
def draw(rows: Table, quantity: str) -> Figure:
    """A row of panels for the median and one for 95 %, a column for each mode."""
    figure, four = panels(2, 2, height=3.1, sharex="col", sharey=True)
    styles = styles_of(rows)
    titles = ("one after another, on one core", "all at once, on every core")
    errors = (("error_median", "median"), ("error_95", "95 %"))
    for place, axes in enumerate(four):
        (key, words), mode = errors[place // 2], list(MODES)[place % 2]
        log_axes(axes, "time per impact [s]", f"error of {quantity}, {words} [-]")
        axes.label_outer()
        if place < len(titles):
            axes.set_title(titles[place])
        here = rows[rows["mode"] == mode]
        for name, style in styles.items():
            own = here[here["method"] == name].sort_values("tolerance", kind="stable")
            if len(own):
                _draw_method(axes, own, key, style)
        axes.axhline(1e-3, color="black", lw=0.8, ls=":")
        axes.margins(0.08)
        if MODES[mode]:
            # Among impacts one after another, points of other methods are in the way.
            _name_presets(axes, here, key, styles)
            axes.set_xlim(left=here["seconds_per_impact"].min() / 10.0)
    legend_outside(figure, method_handles(rows), ncols=3)
    return figure


def _draw_method(axes: Axes, own: Table, key: str, style: dict) -> None:
    time, error = own["seconds_per_impact"], own[key].clip(upper=2.0)
    weight = {"lw": 2.0, "zorder": 3} if any(own["preset"]) else {"lw": 1.0}
    axes.plot(time, error, markersize=4, **weight, **style)


def _name_presets(axes: Axes, rows: Table, key: str, styles: dict) -> None:
    named = rows[rows["preset"] != ""]
    for preset, method, *point in zip(
        *(named["preset"], named["method"], named["seconds_per_impact"], named[key]),
        strict=True,
    ):
        axes.annotate(
            preset,
            point,
            xytext=(-6, -2),
            textcoords="offset points",
            ha="right",
            va="center",
            color=styles[method]["color"],
            fontsize=9,
        )


def table(rows: Table) -> list[tuple[str, ...]]:
    """Every point, by method and mode."""
    gap = np.where(rows["preset"] == "", "", " ")
    return table_of(
        rows.assign(rate=1.0 / rows["seconds_per_impact"], gap=gap),
        {
            "method": "{method}",
            "tolerance": "{tolerance:.0e}{gap}{preset}",
            "mode": "{mode}",
            "impacts/s": "{rate:.3g}",
            "error, median": "{error_median:.0e}",
            "error, 95 %": "{error_95:.0e}",
            "failed": "{failed:.0%}",
        },
    )


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

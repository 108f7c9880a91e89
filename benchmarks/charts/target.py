"""The one figure: impacts a second at 95 % of errors within 1e-3, against numbalsoda.

Each method gets the coarsest of its tolerances that keeps within the error on some
scenes; then all scenes are solved in turn, round after round.
"""

import numpy as np
from matplotlib.figure import Figure

from jaximpact.plotting.style import SKY, in_style, panels

from ..impacts import choose, mixed_scenes
from .methods import Method, Ours, exact_e_n
from .section import (
    Bench,
    Row,
    Section,
    Table,
    error_figures,
    interleaved_minima,
    table_of,
)
from .style import COLOURS, grouped

RIVAL = "numbalsoda"
OUR_TOLERANCES = (3e-2, 1e-2, 3e-3, 1e-3, 3e-4)


def coarsest_within(bench: Bench, method: Method, scenes, exact) -> float | None:
    """The cheapest tolerance whose 95 % error is within the target; None if none is."""
    found = {}
    ours = method.family == Ours.family
    for tolerance in OUR_TOLERANCES if ours else method.tolerances:
        bench.say(f"{method.name} at {tolerance:g}")
        method.solve(choose(scenes, np.arange(2)), tolerance, batch=True)
        answer = method.solve(scenes, tolerance, batch=True)
        error = error_figures(answer.e_n, exact)["error_95"]
        # A margin: other scenes may be a little harder than these.
        if error <= 0.9 * bench.settings.target_error:
            found[tolerance] = min(
                method.solve(scenes, tolerance, batch=True).seconds for _ in range(2)
            )
    return min(found, key=found.get, default=None)


def measure(bench: Bench) -> list[Row]:
    """A row for each method."""
    settings = bench.settings
    scenes = mixed_scenes(settings.target_scenes, settings.seed)
    few = np.arange(min(settings.target_tuning_scenes, settings.target_scenes))
    bench.say("exact e_n of all scenes")
    exact = exact_e_n(scenes)
    chosen = []
    for method in bench.methods:
        if method.family in (Ours.family, RIVAL):
            tolerance = coarsest_within(bench, method, choose(scenes, few), exact[few])
            if tolerance is None:
                bench.say(
                    f"{method.name} comes within {settings.target_error:g} at no "
                    "tolerance that it is tried at"
                )
            else:
                chosen.append((method, tolerance))
    rows = []
    for method, tolerance in chosen:
        answer = method.solve(scenes, tolerance, batch=True)
        rows.append(
            {
                "method": method.name,
                "family": method.family,
                "tolerance": tolerance,
                "impacts": settings.target_scenes,
                **error_figures(answer.e_n, exact),
            }
        )
    seconds = interleaved_minima(
        [
            lambda m=method, t=tolerance: m.solve(scenes, t, batch=True).seconds
            for method, tolerance in chosen
        ],
        settings.target_repeats,
        np.inf,
        bench.say,
    )
    return [
        row | {"impacts_per_s": row["impacts"] / shortest}
        for row, shortest in zip(rows, seconds, strict=True)
    ]


@in_style
def draw(rows: Table) -> Figure:
    """Bars, with numbers."""
    figure, (axes,) = panels(height=1.2 + 0.5 * len(rows))
    rates = rows["impacts_per_s"]
    colours = [COLOURS.get(family, SKY) for family in rows["family"]]
    bars = axes.barh(rows["method"], rates, color=colours)
    axes.bar_label(bars, [grouped(rate) for rate in rates], padding=4)
    axes.invert_yaxis()
    axes.margins(x=0.15)
    axes.set_xlabel(
        "impacts per second [1/s], all cores, 95 % of errors of $e_n$ within "
        f"{rows['error_95'].max():.0e}"
    )
    return figure


def table(rows: Table) -> list[tuple[str, ...]]:
    """The figures, with the ratio to the first peer."""
    rival = rows.loc[rows["family"] == RIVAL, "impacts_per_s"]
    times = "-"
    if len(rival):
        times = [f"{ratio:.2f}" for ratio in rows["impacts_per_s"] / rival.iloc[0]]
    return table_of(
        rows.assign(times=times),
        {
            "method": "{method}",
            "tolerance": "{tolerance:.0e}",
            "impacts/s": "{impacts_per_s:.0f}",
            "error, median": "{error_median:.0e}",
            "error, 95 %": "{error_95:.0e}",
            "failed": "{failed:.2%}",
            "times numbalsoda": "{times}",
        },
    )


TARGET = Section("target", measure, draw, table)

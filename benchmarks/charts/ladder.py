"""The ladder of models: error against cost over each parametric set."""

import time
from collections.abc import Callable

import jax
import numpy as np
from matplotlib.figure import Figure

from jaximpact.accuracy import PRESETS, Accuracy
from jaximpact.backend.native_backend import (
    compile_native,
    kernel_inputs,
    solve_rows,
)
from jaximpact.impact.problem import Assembly
from jaximpact.impact.reduced_models import MODELS, PLANAR, Model
from jaximpact.plotting.style import in_style, legend_outside, panels, points
from jaximpact.scene import Scene

from ..impacts import SETS, parametric_scenes
from .methods import EXACT
from .section import (
    Bench,
    Row,
    Section,
    cell,
    error_figures,
    interleaved_minima,
    table_of,
)
from .style import log_axes

SHOWN = ("fast", "balanced")

Rung = Callable[[Scene, Accuracy], np.ndarray]
"""e_n of scenes `(lanes,)`."""


def rung_of(model: Model) -> Rung:
    """A model by the unknowns that it integrates."""
    kernel = compile_native(Assembly(jax.tree.structure(Scene()), model, ledger=False))
    return lambda *given: solve_rows(kernel, np.stack(kernel_inputs(*given))).e_n


def ladder() -> dict[str, Rung]:
    """Every model by name, in the order of their cost."""
    return {model.name: rung_of(model) for model in MODELS}


def measure(bench: Bench) -> list[Row]:
    """Rows for each set, model and preset.

    Exact is the planar model. A model with dashpots is asked for scenes without, where
    its dashpots do nothing: what it costs.
    """
    settings = bench.settings
    rungs = ladder()
    tasks, rows = [], []
    for place, name in enumerate(SETS):
        scenes = parametric_scenes(
            np.full(settings.ladder_scenes, place), settings.seed + place
        )
        exact = rungs[PLANAR.name](scenes, EXACT)
        for model, rung in rungs.items():
            for preset in map(PRESETS.get, SHOWN):
                bench.say(f"set {name}, {model}, {preset.name}")
                arguments = rung, scenes, preset
                values = rung(scenes, preset)
                rows.append(
                    {
                        "set": name,
                        "model": model,
                        "preset": preset.name,
                        "impacts": settings.ladder_scenes,
                        **error_figures(values, exact),
                    }
                )
                tasks.append(lambda arguments=arguments: timed(*arguments))
    seconds = interleaved_minima(tasks, settings.repeats, 10.0, bench.say)
    return [
        row | {"seconds_per_impact": shortest / row["impacts"]}
        for row, shortest in zip(rows, seconds, strict=True)
    ]


def timed(rung: Rung, scenes: Scene, accuracy: Accuracy) -> float:
    """Seconds that a rung takes."""
    begin = time.perf_counter()
    rung(scenes, accuracy)
    return time.perf_counter() - begin


@in_style
def draw(rows: list[Row]) -> Figure:
    """A panel for each set, a line for each model over the presets."""
    title = f"each line from {' to '.join(SHOWN)}"
    figure, four = panels(2, 2, height=2.8, title=title, sharex=True, sharey=True)
    models = list(dict.fromkeys(row["model"] for row in rows))
    handles = {}
    titles = {
        "I": "set I: upright, vertical",
        "II": "set II: lying, vertical",
        "III": "set III: oblique",
        "IV": "set IV: turned, vertical",
    }
    for axes, name in zip(four, SETS, strict=True):
        log_axes(axes, "time per impact, one core [s]", "error of $e_n$, 95 % [-]")
        axes.label_outer()
        axes.set_title(titles[name])
        for place, model in enumerate(models):
            own = [r for r in rows if r["set"] == name and r["model"] == model]
            (handles[model],) = axes.plot(
                [row["seconds_per_impact"] for row in own],
                [min(row["error_95"], 3.0) for row in own],
                label=model,
                **points(place),
            )
        axes.axhline(1e-3, color="black", lw=0.8, ls=":")
    legend_outside(figure, list(handles.values()), ncols=3)
    return figure


def table(rows: list[Row]) -> list[tuple[str, ...]]:
    """Time at `fast`, and error at `fast`, by set and model."""
    fast = [row for row in rows if row["preset"] == "fast"]
    planar = {
        row["set"]: row["seconds_per_impact"]
        for row in fast
        if row["model"] == PLANAR.name
    }
    return table_of(
        fast,
        {
            "set": cell("set"),
            "model": cell("model"),
            "time, us": lambda row: f"{1e6 * row['seconds_per_impact']:.0f}",
            "error, median": cell("error_median", ".0e"),
            "error, 95 %": cell("error_95", ".0e"),
            "relative cost": lambda row: (
                f"{row['seconds_per_impact'] / planar[row['set']]:.2f}"
            ),
        },
    )


LADDER = Section("ladder", measure, draw, table)

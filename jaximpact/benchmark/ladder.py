"""The ladder of models: error against cost over each parametric set."""

import time
from collections.abc import Callable

import jax
import numpy as np
from matplotlib.figure import Figure

from ..accuracy import PRESETS, Accuracy
from ..engines.machine import compile_native, solve_side_by_side
from ..mechanics.model import MODELS, PLANAR, Model
from ..mechanics.problem import Assembly
from ..plotting import BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION
from ..scene import Scene
from .measuring import error_figures, interleaved_minima
from .methods import EXACT
from .scenes import SETS, parametric_scenes
from .section import Bench, Row, Section
from .style import legend_of, log_axes

SHOWN = ("fast", "balanced")
COLOURS = (SKY, GREEN, BLUE, VERMILION, ORANGE, PURPLE)

Rung = Callable[[Scene, Accuracy], np.ndarray]
"""e_n of scenes `(lanes,)`."""


def rung_of(model: Model) -> Rung:
    """A model by the unknowns that it integrates."""
    kernel = compile_native(Assembly(jax.tree.structure(Scene()), model, ledger=False))
    return lambda *given: solve_side_by_side(kernel, *given).e_n


def ladder() -> dict[str, Rung]:
    """Every model by name, from the cheapest to the dearest."""
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


def draw(rows: list[Row]) -> Figure:
    """A panel for each set, a line for each model over the presets."""
    figure = Figure(figsize=(13.0, 7.0), layout="constrained")
    panels = figure.subplots(2, 2, sharex=True, sharey=True).flat
    models = list(dict.fromkeys(row["model"] for row in rows))
    handles = {}
    titles = {
        "I": "set I: upright, vertical",
        "II": "set II: lying, vertical",
        "III": "set III: oblique",
        "IV": "set IV: turned, vertical",
    }
    for axes, name in zip(panels, SETS, strict=True):
        log_axes(axes, "time per impact, one core [s]", "error of $e_n$, 95 % [-]")
        axes.label_outer()
        axes.set_title(titles[name])
        for model, colour, marker in zip(models, COLOURS, "osD^vP", strict=False):
            own = [r for r in rows if r["set"] == name and r["model"] == model]
            (handles[model],) = axes.plot(
                [row["seconds_per_impact"] for row in own],
                [min(row["error_95"], 3.0) for row in own],
                color=colour,
                marker=marker,
                label=model,
            )
        axes.axhline(1e-3, color="black", lw=0.8, ls=":")
    figure.suptitle(f"each line from {' to '.join(SHOWN)}")
    legend_of(figure, list(handles.values()))
    return figure


def table(rows: list[Row]) -> list[tuple[str, ...]]:
    """Time at `fast`, and error at `fast`, by set and model."""
    lines = [
        ("set", "model", "time, us", "error, median", "error, 95 %", "relative cost")
    ]
    fast = [row for row in rows if row["preset"] == "fast"]
    for row in fast:
        own = next(
            r["seconds_per_impact"]
            for r in fast
            if r["set"] == row["set"] and r["model"] == PLANAR.name
        )
        lines.append(
            (
                row["set"],
                row["model"],
                f"{1e6 * row['seconds_per_impact']:.0f}",
                f"{row['error_median']:.0e}",
                f"{row['error_95']:.0e}",
                f"{row['seconds_per_impact'] / own:.2f}",
            )
        )
    return lines


LADDER = Section("ladder", measure, draw, table)

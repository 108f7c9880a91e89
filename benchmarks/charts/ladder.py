"""The ladder of models: error against cost over each parametric set."""

import time
from collections.abc import Callable

import jax
import numpy as np
from matplotlib.figure import Figure

from jaximpact.accuracy import PRESETS, Accuracy
from jaximpact.backend.native_backend import compile_native
from jaximpact.backend.simd import KernelSet
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
    Table,
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
    assert kernel is not None
    kernels = KernelSet([kernel])

    def e_n(scenes: Scene, accuracy: Accuracy) -> np.ndarray:
        leaves = np.stack(jax.tree.leaves(scenes))
        setting = [[accuracy.tolerance], [accuracy.floor]]
        rows = np.broadcast_to(setting, (2, leaves.shape[1]))
        results, _ = kernels.compute(np.concatenate([leaves, rows]), threads=1)
        return jax.tree.unflatten(kernel.structure, list(results)).e_n

    return e_n


def ladder() -> dict[str, Rung]:
    """Every model by name, in the order of their cost, but for those of round blocks:
    no set has one."""
    return {model.name: rung_of(model) for model in MODELS if not model.is_round}


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
def draw(rows: Table) -> Figure:
    """A panel for each set, a line for each model over the presets."""
    title = f"each line from {' to '.join(SHOWN)}"
    figure, four = panels(2, 2, height=2.8, title=title, sharex=True, sharey=True)
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
        for place, model in enumerate(rows["model"].unique()):
            own = rows[(rows["set"] == name) & (rows["model"] == model)]
            time, error = own["seconds_per_impact"], own["error_95"].clip(upper=3.0)
            (handles[model],) = axes.plot(time, error, label=model, **points(place))
        axes.axhline(1e-3, color="black", lw=0.8, ls=":")
    legend_outside(figure, list(handles.values()), ncols=3)
    return figure


def table(rows: Table) -> list[tuple[str, ...]]:
    """Time at `fast`, and error at `fast`, by set and model."""
    fast = rows[rows["preset"] == "fast"]
    seconds = fast["seconds_per_impact"]
    planar = fast[fast["model"] == PLANAR.name].set_index("set")["seconds_per_impact"]
    return table_of(
        fast.assign(us=1e6 * seconds, cost=seconds / fast["set"].map(planar)),
        {
            "set": "{set}",
            "model": "{model}",
            "time, us": "{us:.0f}",
            "error, median": "{error_median:.0e}",
            "error, 95 %": "{error_95:.0e}",
            "relative cost": "{cost:.2f}",
        },
    )


LADDER = Section("ladder", measure, draw, table)

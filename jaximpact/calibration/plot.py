"""The plot of a study: fit of every target, and the waterfall of the starts."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..columns import INPUT_COLUMNS
from ..plotting import BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION
from .study import StudyResult

COLOURS = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY)
MARKERS = "os^Dv<"
COLUMNS = 3


def plot_study(result: StudyResult) -> Figure:
    """Draw a study.

    A target is drawn against the impact angle where the tests differ in it alone,
    otherwise predicted against measured; the last panel is the waterfall.
    """
    study = result.study
    panels = len(study.targets) + 1
    columns = min(panels, COLUMNS)
    rows = -(-panels // columns)
    figure = Figure(figsize=(4.6 * columns, 4.0 * rows + 0.5), layout="constrained")
    figure.suptitle(study.title)
    axes = [figure.add_subplot(rows, columns, i + 1) for i in range(panels)]
    varying = [n for n, v in _inputs(result).items() if np.ptp(v) > 0.0]
    for place in range(len(study.targets)):
        if varying == ["angle_deg"]:
            _draw_against_angle(axes[place], result, place)
        else:
            _draw_against_measured(axes[place], result, place)
    _draw_waterfall(axes[-1], result)
    return figure


def _inputs(result: StudyResult) -> dict[str, np.ndarray]:
    numbers = result.study.table.numbers
    return {name: v for name, v in numbers.items() if name in INPUT_COLUMNS}


def _style(place: int) -> dict:
    return dict(
        color=COLOURS[place % len(COLOURS)], marker=MARKERS[place % len(MARKERS)]
    )


def _draw_against_angle(axes: Axes, result: StudyResult, place: int) -> None:
    study = result.study
    angle = study.table.numbers["angle_deg"]
    order = np.argsort(angle, kind="stable")
    error = study.sigma[order, place] if study.sigma_given else None
    axes.errorbar(
        angle[order],
        study.measured[order, place],
        yerr=error,
        color="black",
        marker="x",
        linestyle="none",
        label="measured",
    )
    for number, variant in enumerate(result.variants):
        fitted = variant.predicted[order, place]
        axes.plot(
            angle[order],
            fitted,
            label=variant.variant.name,
            markersize=4,
            **_style(number),
        )
    axes.set_xlabel("impact angle from the normal [deg]")
    axes.set_ylabel(study.targets[place])
    axes.legend()


def _draw_against_measured(axes: Axes, result: StudyResult, place: int) -> None:
    study = result.study
    measured = study.measured[:, place]
    error = study.sigma[:, place] if study.sigma_given else None
    for number, variant in enumerate(result.variants):
        axes.errorbar(
            measured,
            variant.predicted[:, place],
            xerr=error,
            linestyle="none",
            label=variant.variant.name,
            **_style(number),
        )
    low, high = axes.get_xlim()
    axes.axline((low, low), (high, high), color=GREY, linewidth=1)
    axes.set_xlabel(f"{study.targets[place]}, measured")
    axes.set_ylabel("fitted")
    if len(result.variants) > 1:
        axes.legend()


def _draw_waterfall(axes: Axes, result: StudyResult) -> None:
    for number, variant in enumerate(result.variants):
        costs = np.sort(variant.start_costs)
        rank = np.arange(1, len(costs) + 1)
        style = _style(number)
        axes.plot(rank, costs, label=variant.variant.name, markersize=4, **style)
    axes.set_yscale("log")
    axes.set_xlabel("start, best first")
    axes.set_ylabel("cost at the end")
    if len(result.variants) > 1:
        axes.legend()

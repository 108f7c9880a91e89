"""The plot of a study: fit of every target, and the waterfall of the starts."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..plotting import BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION, plain
from .study import StudyResult

COLOURS = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY)
MARKERS = "os^Dv<"
COLUMNS = 3
LEAST_COST = 1e-12
"""Drawn in place of less."""


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
    figure.suptitle(plain(study.title))
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
    return result.study.tests.inputs


def _style(place: int) -> dict:
    return dict(
        color=COLOURS[place % len(COLOURS)], marker=MARKERS[place % len(MARKERS)]
    )


def _draw_measured(axes: Axes, result: StudyResult, place: int, x) -> None:
    """What was measured, against x: crosses, and arrows from limits."""
    study = result.study
    measured, censored = study.measured[:, place], study.censored[:, place]
    exact = censored == 0
    axes.errorbar(
        x[exact],
        measured[exact],
        yerr=study.sigma[exact, place] if study.sigma_given[place] else None,
        color="black",
        marker="x",
        linestyle="none",
        label="measured",
    )
    for sign, marker in ((1, "^"), (-1, "v")):
        limits = censored == sign
        if np.any(limits):
            style = dict(color="black", marker=marker, linestyle="none")
            word = "above" if sign > 0 else "below"
            axes.plot(x[limits], measured[limits], label=f"{word} this", **style)


def _draw_against_angle(axes: Axes, result: StudyResult, place: int) -> None:
    study = result.study
    angle = study.tests.inputs["angle_deg"]
    order = np.argsort(angle, kind="stable")
    _draw_measured(axes, result, place, angle)
    for number, variant in enumerate(result.variants):
        axes.plot(
            angle[order],
            variant.predicted[order, place],
            label=plain(variant.variant.name),
            markersize=4,
            **_style(number),
        )
    axes.set_xlabel("impact angle from the normal [deg]")
    axes.set_ylabel(study.targets[place])
    axes.legend()


def _draw_against_measured(axes: Axes, result: StudyResult, place: int) -> None:
    study = result.study
    measured, censored = study.measured[:, place], study.censored[:, place]
    exact = (censored == 0) & study.known[:, place]
    limits = (censored != 0) & study.known[:, place]
    for number, variant in enumerate(result.variants):
        fitted, style = variant.predicted[:, place], _style(number)
        axes.errorbar(
            measured[exact],
            fitted[exact],
            xerr=study.sigma[exact, place] if study.sigma_given[place] else None,
            linestyle="none",
            label=plain(variant.variant.name),
            **style,
        )
        if np.any(limits):
            # Hollow: only a limit of the measured value is known.
            axes.plot(
                measured[limits], fitted[limits], linestyle="none", mfc="none", **style
            )
    low, high = axes.get_xlim()
    axes.axline((low, low), (high, high), color=GREY, linewidth=1)
    axes.set_xlabel(f"{study.targets[place]}, measured")
    axes.set_ylabel("fitted")
    if len(result.variants) > 1:
        axes.legend()


def _draw_waterfall(axes: Axes, result: StudyResult) -> None:
    """Costs of the starts; hollow those that are not at a minimum or above the best."""
    for number, variant in enumerate(result.variants):
        order = np.argsort(variant.start_costs, kind="stable")
        costs = np.maximum(variant.start_costs[order], LEAST_COST)
        rank = np.arange(1, len(costs) + 1)
        style, reached = _style(number), variant.reached[order]
        axes.plot(rank, costs, color=style["color"], linewidth=0.8)
        axes.plot(
            rank[reached],
            costs[reached],
            linestyle="none",
            label=plain(variant.variant.name),
            markersize=4,
            **style,
        )
        axes.plot(
            rank[~reached],
            costs[~reached],
            linestyle="none",
            mfc="white",
            markersize=4,
            **style,
        )
    axes.set_yscale("log")
    axes.set_xlabel("start, best first (hollow: stuck)")
    axes.set_ylabel("cost at the end")
    if len(result.variants) > 1:
        axes.legend()

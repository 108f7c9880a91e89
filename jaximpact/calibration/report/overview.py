"""Pictures of all variants, and of laws that were compared."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...plotting.style import BLUE, GREY, VERMILION, in_style, panels, plain, points
from ..comparison.comparison import Compared
from ..diagnostics.results import StudyResult
from .drawings import label_of, only_varying, picture, plot_waterfall


@in_style
def plot_study(result: StudyResult) -> Figure:
    """Draw the fit of every target, and the costs of the starts.

    A target stands over the impact angle where the tests differ in it alone; otherwise
    fitted stands over measured.
    """
    study = result.study
    count = len(study.targets) + 1
    columns = 2 if count in (2, 4) else 3
    rows = -(-count // columns)
    figure, axes = panels(
        rows, columns, height=3.0, title=plain(study.title), count=count
    )
    over_angle = only_varying(result) == "angle_deg"
    for target in range(len(study.targets)):
        draw = _angle_panel if over_angle else _measured_panel
        draw(axes[target], result, target)
    for number, variant in enumerate(result.variants):
        style = points(number)
        name = plain(variant.variant.name)
        plot_waterfall(axes[-1], variant, style["color"], style["marker"], name, None)
    axes[-1].set_xlabel("start, best first (hollow: not at the best fit)")
    for panel in axes[:-1] if over_angle else ():
        panel.legend()
    if len(result.variants) > 1:
        axes[-1].legend()
    return figure


def _angle_panel(axes: Axes, result: StudyResult, target: int) -> None:
    study = result.study
    angle = study.tests.inputs["angle_deg"]
    order = np.argsort(angle, kind="stable")
    measured, censored = study.measured[:, target], study.censored[:, target]
    exact = censored == 0
    style: dict[str, Any] = dict(color="black", linestyle="none")
    sigma = study.sigma[exact, target] if study.sigma_given[target] else None
    axes.errorbar(
        angle[exact], measured[exact], sigma, marker="x", label="measured", **style
    )
    for sign, marker, word in ((1, "^", "above"), (-1, "v", "below")):
        limits = censored == sign
        if np.any(limits):
            style |= dict(marker=marker, label=f"{word} this")
            axes.plot(angle[limits], measured[limits], **style)
    for number, variant in enumerate(result.variants):
        name, fitted = plain(variant.variant.name), variant.predicted[order, target]
        axes.plot(angle[order], fitted, label=name, markersize=4, **points(number))
    axes.set_xlabel("impact angle from the normal [deg]")
    axes.set_ylabel(label_of(study.targets[target]))


def _measured_panel(axes: Axes, result: StudyResult, target: int) -> None:
    study = result.study
    measured, known = study.measured[:, target], study.known[:, target]
    exact = (study.censored[:, target] == 0) & known
    limits = known & ~exact
    sigma = study.sigma[exact, target] if study.sigma_given[target] else None
    for number, variant in enumerate(result.variants):
        fitted = variant.predicted[:, target]
        style: dict[str, Any] = dict(linestyle="none", markersize=4, **points(number))
        axes.errorbar(measured[exact], fitted[exact], xerr=sigma, **style)
        if np.any(limits):
            # Hollow: only a limit of the measured value is known.
            axes.plot(measured[limits], fitted[limits], mfc="none", **style)
    low, high = axes.get_xlim()
    axes.axline((low, low), (high, high), color=GREY, linewidth=1)
    hollow = " (hollow: limit)" if np.any(limits) else ""
    axes.set_xlabel(f"measured {label_of(study.targets[target])}{hollow}")
    axes.set_ylabel("fitted")


def comparison_picture(compared: Compared) -> dict:
    """Draw the picture of the report, as `picture` does."""
    return picture(
        draw_comparison(compared),
        "Scores of the laws, less that of the best",
        "Score of each law less that of the best, with two standard errors; red: "
        "preferred, blue: ties, grey: worse.",
    )


@in_style
def draw_comparison(compared: Compared) -> Figure:
    """Draw the difference of each law to the best, with two standard errors."""
    found = compared.ranking()
    count = len(compared.laws)
    figure, (axes,) = panels(1, 1, height=0.9 + 0.28 * count)
    places = np.arange(count)
    apart, error = found.apart, np.nan_to_num(2.0 * found.error)
    for place in places:
        tied = place in found.ties
        colour = VERMILION if place == found.preferred else BLUE if tied else GREY
        axes.errorbar(
            apart[place], place, xerr=error[place], marker="o", color=colour, capsize=3
        )
    axes.axvline(0.0, color="black", lw=0.8)
    names = [plain(law.name) for law in compared.laws]
    axes.set_yticks(places, names)
    axes.invert_yaxis()
    axes.set_xlabel(
        "log predictive density less that of the best, with two standard errors"
    )
    return figure

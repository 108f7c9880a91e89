"""The drawings of the report, one panel each, readable on a phone."""

import io
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..formats.columns import RESULT_COLUMNS, InputColumn, columns_of
from ..plotting import BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION, plain
from .bands import Bands
from .draws import Draws
from .further_tests import Suggestions
from .left_out import LeftOut
from .likelihood_profile import LikelihoodProfile
from .residuals import Residuals, varying_inputs
from .study import StudyResult, VariantResult

COLOURS = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY)
MARKERS = "os^Dv<"
NOTHING: Mapping[str, InputColumn] = MappingProxyType({})
SIZE = 4.6, 3.5
DPI = 160
BAND, WIDE_BAND = 0.35, 0.15
"""Opacities."""
MOST_DEVIATIONS = 6.0
"""A profile is drawn no higher, unless the line of 95 % lies there."""
MOST_NAMED = 12
"""Tests beyond this number go by their number, not their name."""
DRAWN = 400
"""Draws shown of the posterior."""
LEAST_COST = 1e-12
DECADE = 10.0


def as_png(figure: Figure) -> bytes:
    """The bytes of a file, the same for the same figure."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=DPI, metadata={"Software": None})
    return stream.getvalue()


def _panel() -> tuple[Figure, Axes]:
    figure = Figure(figsize=SIZE, layout="constrained")
    axes = figure.add_subplot()
    axes.spines[["top", "right"]].set_visible(False)
    return figure, axes


def _style(place: int) -> dict:
    return dict(
        color=COLOURS[place % len(COLOURS)], marker=MARKERS[place % len(MARKERS)]
    )


def label_of(name: str, inputs: Mapping[str, InputColumn] = NOTHING) -> str:
    """A quantity with its unit, for an axis.

    Args:
        inputs: columns of the scene, where the quantity may be one of them.
    """
    column = inputs.get(name) or RESULT_COLUMNS.get(name)
    if column is None or column.unit == "-":
        return plain(name)
    unit = column.unit.replace("/", "p").replace(" ", "")
    # Names leave out the stroke: kgm3.
    short = unit.replace("pm3", "m3")
    return f"{name.removesuffix('_' + short)} [{column.unit}]"


def only_varying(result: StudyResult) -> str | None:
    """The quantity in which alone the tests differ, if there is one."""
    inputs = result.study.tests.inputs
    varying = [name for name, values in inputs.items() if np.ptp(values) > 0.0]
    return varying[0] if len(varying) == 1 else None


def draw_target(
    result: StudyResult, variant: VariantResult, bands: Bands, place: int
) -> Figure:
    """Fitted and measured with bands of 95 %: over the quantity in which alone the
    tests differ, otherwise fitted over measured."""
    along = only_varying(result)
    figure, axes = _panel()
    if along is None:
        _over_measured(axes, result, variant, bands, place)
    else:
        _over_input(axes, result, variant, bands, place, along)
    axes.legend(fontsize="small", frameon=False)
    return figure


def _over_input(axes, result, variant, bands, place, along) -> None:
    study = result.study
    x = study.tests.inputs[along]
    order = np.argsort(x, kind="stable")
    order = order[np.isfinite(bands.middle[order, place])]

    def band(low, high, opacity, label):
        ends = low[order, place], high[order, place]
        axes.fill_between(
            x[order], *ends, color=BLUE, alpha=opacity, linewidth=0, label=label
        )

    band(bands.measured_low, bands.measured_high, WIDE_BAND, "of a measurement, 95 %")
    band(bands.low, bands.high, BAND, "of the model, 95 %")
    axes.plot(x[order], variant.predicted[order, place], color=BLUE, label="best fit")
    _measured(axes, study, place, x, study.measured[:, place])
    axes.set_xlabel(label_of(along, study.tests.known_columns))
    axes.set_ylabel(label_of(study.targets[place]))


def _over_measured(axes, result, variant, bands, place) -> None:
    study = result.study
    known = study.known[:, place] & np.isfinite(bands.middle[:, place])
    measured = study.measured[:, place]
    ends = np.concatenate([measured[known], variant.predicted[known, place]])
    low, high = np.nanmin(ends), np.nanmax(ends)
    axes.axline((low, low), (high, high + (high == low)), color=GREY, linewidth=1)

    def bars(low, high, width, opacity, label):
        axes.vlines(
            measured[known],
            low[known, place],
            high[known, place],
            color=BLUE,
            alpha=opacity,
            linewidth=width,
            label=label,
        )

    bars(bands.measured_low, bands.measured_high, 1.2, 0.6, "of a measurement, 95 %")
    bars(bands.low, bands.high, 4.0, 0.5, "of the model, 95 %")
    exact = known & (study.censored[:, place] == 0)
    style = dict(color=BLUE, linestyle="none", marker="o", markersize=4)
    axes.plot(
        measured[exact], variant.predicted[exact, place], label="best fit", **style
    )
    limits = known & ~exact
    if np.any(limits):
        axes.plot(
            measured[limits],
            variant.predicted[limits, place],
            mfc="white",
            label="limit",
            **style,
        )
    axes.set_xlabel(f"measured {label_of(study.targets[place])}")
    axes.set_ylabel("fitted")


def _measured(axes, study, place, x, y) -> None:
    """Crosses, and arrowheads for limits."""
    censored = study.censored[:, place]
    for sign, marker, label in (
        (0, "x", "measured"),
        (1, "^", "measured: above"),
        (-1, "v", "measured: below"),
    ):
        shown = study.known[:, place] & (censored == sign)
        if np.any(shown):
            axes.plot(
                x[shown], y[shown], color="black", marker=marker, ls="none", label=label
            )


def draw_residuals(
    result: StudyResult, variant: VariantResult, residuals: Residuals, against: str
) -> Figure:
    """Residuals over an input, or over "prediction", each target scaled to its
    largest."""
    study = result.study
    figure, axes = _panel()
    axes.axhspan(-2.0, 2.0, color=GREY, alpha=0.15, linewidth=0)
    axes.axhline(0.0, color=GREY, linewidth=1)
    for place, target in enumerate(study.targets):
        y = residuals.values[:, place]
        if against == "prediction":
            x = variant.predicted[:, place]
            if len(study.targets) > 1:
                x = x / np.nanmax(np.abs(np.where(np.isfinite(y), x, np.nan)))
        else:
            x = study.tests.inputs[against]
        axes.plot(x, y, linestyle="none", markersize=5, label=target, **_style(place))
    if against != "prediction":
        axes.set_xlabel(label_of(against, study.tests.known_columns))
    elif len(study.targets) > 1:
        axes.set_xlabel("prediction, over the largest of its kind")
    else:
        axes.set_xlabel(f"predicted {label_of(study.targets[0])}")
    axes.set_ylabel("residual [standard deviations]")
    if len(study.targets) > 1:
        axes.legend(fontsize="small", frameon=False)
    return figure


def draw_quantiles(residuals: Residuals) -> Figure:
    """Residuals over those of a normal distribution."""
    figure, axes = _panel()
    expected, values = residuals.ordered()
    reach = max(np.max(np.abs(expected), initial=1.0), 2.0)
    axes.plot([-reach, reach], [-reach, reach], color=GREY, linewidth=1)
    axes.plot(expected, values, "o", color=BLUE, markersize=4)
    axes.set_xlabel("normal distribution [standard deviations]")
    axes.set_ylabel("residual [standard deviations]")
    return figure


def residual_inputs(variant: VariantResult) -> list[str]:
    """What residuals are drawn over: the prediction, and inputs that differ."""
    return ["prediction", *varying_inputs(variant.objective)]


def draw_profile(variant: VariantResult, found: LikelihoodProfile) -> Figure:
    """How the misfit rises where a parameter is held, and, where it is determined, how
    its standard error says that it does."""
    figure, axes = _panel()
    place = variant.names.index(found.name)
    bounds, uncertainty = variant.bounds, variant.uncertainty
    most = max(MOST_DEVIATIONS, 1.15 * uncertainty.quantile)
    axes.plot(
        found.values,
        np.sqrt(np.maximum(found.rise, 0.0)),
        "o-",
        color=BLUE,
        markersize=4,
        label="others fitted again",
    )
    if variant.verdicts[place].determined:
        reach = most * np.linspace(-1.0, 1.0, 61)
        x = np.tile(variant.points.x[0], (len(reach), 1))
        x[:, place] += reach * uncertainty.standard_errors[place]
        axes.plot(
            bounds.parameter(x)[:, place],
            np.abs(reach),
            "--",
            color=GREY,
            label="by the standard error",
        )
    for level, words in ((1.0, "68 %"), (uncertainty.quantile, "95 %")):
        axes.axhline(level, color=VERMILION, linewidth=0.8)
        axes.annotate(
            words,
            (1.0, level),
            xycoords=("axes fraction", "data"),
            ha="right",
            va="bottom",
            color=VERMILION,
            fontsize="small",
        )
    low, high = _shown(found, most)
    _scale(axes.set_xscale, low, high, bounds.logarithmic[place])
    axes.set_xlim(low, high)
    axes.set_ylim(-0.1, most)
    axes.set_xlabel(label_of(found.name, columns_of(variant.objective.scene)))
    axes.set_ylabel("rise of the misfit [standard deviations]")
    axes.legend(fontsize="small", frameon=False)
    return figure


def _shown(found: LikelihoodProfile, most: float) -> tuple[float, float]:
    """The stretch of a profile that is drawn: to where the misfit leaves the panel."""
    inside = np.flatnonzero(found.rise <= most**2)
    first, last = max(inside[0] - 1, 0), min(inside[-1] + 1, len(found.values) - 1)
    # A point far out, where nothing is held between, would draw a needle.
    low, high = found.values[inside[0]], found.values[inside[-1]]
    reach = max(high - low, 1e-9 * abs(high))
    low = max(found.values[first], low - 0.3 * reach)
    return low, min(found.values[last], high + 0.3 * reach)


def _scale(set_scale, low: float, high: float, logarithmic: bool) -> None:
    """A logarithmic axis for more than a decade; less has no ticks to read."""
    if logarithmic and high > DECADE * low:
        set_scale("log")


def draw_pair(variant: VariantResult, draws: Draws, first: int, second: int) -> Figure:
    """Two parameters as the data leave them, and, where both are determined, the
    ellipse of 95 % that the covariance stands for."""
    figure, axes = _panel()
    bounds, pair = variant.bounds, [first, second]
    random = np.random.default_rng(0)
    chosen = random.choice(len(draws.x), DRAWN, p=draws.weights)
    values = bounds.parameter(draws.x[chosen])[:, pair]
    axes.plot(*values.T, "o", color=BLUE, markersize=3, alpha=0.3, mec="none")
    covariance = variant.uncertainty.covariance[np.ix_(pair, pair)]
    if variant.verdicts[first].determined and variant.verdicts[second].determined:
        turn = np.linspace(0.0, 2.0 * np.pi, 200)
        # Of two normal deviations 95 % lie within 2.448 of the centre.
        circle = 2.448 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        squares, vectors = np.linalg.eigh(covariance)
        root = vectors * np.sqrt(np.maximum(squares, 0.0))
        at = np.tile(variant.points.x[0], (len(turn), 1))
        at[:, pair] += circle @ root.T
        at = np.clip(at, bounds.low, bounds.high)
        axes.plot(*bounds.parameter(at)[:, pair].T, color=VERMILION, linewidth=1)
    axes.plot(*variant.parameters[pair], "x", color="black")
    for place, of_axis, set_scale in (
        (first, values[:, 0], axes.set_xscale),
        (second, values[:, 1], axes.set_yscale),
    ):
        ends = np.min(of_axis), np.max(of_axis)
        _scale(set_scale, *ends, bounds.logarithmic[place])
    columns = columns_of(variant.objective.scene)
    axes.set_xlabel(label_of(variant.names[first], columns))
    axes.set_ylabel(label_of(variant.names[second], columns))
    return figure


def draw_left_out(result: StudyResult, left: LeftOut) -> Figure:
    """What was measured, about what the rest of the tests predicts."""
    study = result.study
    figure, axes = _panel()
    axes.axhspan(-left.quantile, left.quantile, color=GREY, alpha=0.15, linewidth=0)
    axes.axhline(0.0, color=GREY, linewidth=1)
    values = left.standardised(study.measured)
    number = np.arange(1, len(study.tests) + 1)
    for place, target in enumerate(study.targets):
        y = np.where(study.censored[:, place] == 0, values[:, place], np.nan)
        axes.plot(
            number, y, linestyle="none", markersize=5, label=target, **_style(place)
        )
    if len(number) <= MOST_NAMED:
        names = [plain(study.tests.name(test)) for test in range(len(number))]
        axes.set_xticks(number, names, rotation=45, ha="right", fontsize="small")
    else:
        axes.set_xlabel("test, in the order of the tables")
    axes.set_ylabel("measured less predicted\n[standard deviations]")
    if len(study.targets) > 1:
        axes.legend(fontsize="small", frameon=False)
    return figure


def draw_candidates(found: Suggestions) -> Figure:
    """What the next test brings, over the first quantity, a line for each value of the
    second; of the rest and of the ways to measure the best."""
    figure, axes = _panel()
    names = list(found.candidates)
    best = np.max(found.volumes, axis=1)
    along = found.candidates[names[0]]
    lines = found.candidates[names[1]] if len(names) > 1 else np.zeros(len(along))
    for place, value in enumerate(np.unique(lines)):
        of_line = lines == value
        x = np.unique(along[of_line])
        y = [np.max(best[of_line & (along == at)]) for at in x]
        label = f"{value:g}" if len(names) > 1 else None
        axes.plot(x, y, markersize=5, label=label, **_style(place))
    axes.set_xlabel(label_of(names[0], found.columns))
    axes.set_ylabel("errors are divided by\n(mean over directions)")
    if len(names) > 1:
        axes.legend(
            title=label_of(names[1], found.columns), fontsize="small", frameon=False
        )
    return figure


def draw_waterfall(variant: VariantResult) -> Figure:
    """Costs of the starts in order; hollow those that did not find the best fit."""
    figure, axes = _panel()
    order = np.argsort(variant.start_costs, kind="stable")
    costs = np.maximum(variant.start_costs[order], LEAST_COST)
    rank, reached = np.arange(1, len(costs) + 1), variant.reached[order]
    axes.plot(rank, costs, color=GREY, linewidth=0.8)
    style = dict(color=BLUE, marker="o", linestyle="none", markersize=4)
    axes.plot(rank[reached], costs[reached], label="found the best fit", **style)
    if not np.all(reached):
        label = "elsewhere or stuck"
        axes.plot(rank[~reached], costs[~reached], mfc="white", label=label, **style)
    axes.set_yscale("log")
    axes.set_xlabel("start, best first")
    axes.set_ylabel("cost at the end")
    axes.legend(fontsize="small", frameon=False)
    return figure

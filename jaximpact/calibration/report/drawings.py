"""Drawings of a calibration: of all its variants, of one, and of laws compared."""

import itertools
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter

from ...plotting.style import (
    BLUE,
    GREY,
    VERMILION,
    On,
    in_style,
    legend_outside,
    log_scale,
    panels,
    plain,
    points,
    tick_name,
)
from ...quantities import TARGET_COLUMNS, InputColumn, columns_of
from ..comparison.comparison import Compared
from ..diagnostics.cross_validation import LeftOut
from ..diagnostics.examination import Examination
from ..diagnostics.further_tests import Suggestions
from ..diagnostics.identifiability import LikelihoodProfile
from ..diagnostics.posterior import root_of
from ..diagnostics.predictive import Bands
from ..diagnostics.residuals import Residuals
from ..diagnostics.results import StudyResult, VariantResult
from ..prediction import PredictedTests, VariantPrediction
from ..problem.bounds import Bounds
from ..problem.config import Study

MEASURED = {
    0: ("x", "measured"),
    1: ("^", "measured: above"),
    -1: ("v", "measured: below"),
}
"""Marker and words of measurements and limits, by their side."""
WIDTH, HEIGHT = 4.6, 3.5
"""Size of a panel [inch]: two stand side by side on a page."""
MOST_NAMED = 16
"""Largest number of tests that are named at an axis."""


def most_correlated(variant: VariantResult) -> list[tuple[int, int]]:
    """Choose the pairs of parameters that are drawn, the most correlated first."""
    correlation = np.abs(variant.uncertainty.correlation)
    pairs = itertools.combinations(range(len(variant.verdicts)), 2)
    return sorted(pairs, key=lambda pair: -correlation[pair])[:3]


def _panel(on: On = None) -> tuple[Figure, Axes]:
    figure, (axes,) = panels(width=WIDTH, height=HEIGHT, on=on)
    axes.spines[["top", "right"]].set_visible(False)
    return figure, axes


def label_of(name: str, inputs: dict[str, InputColumn] | None = None) -> str:
    """Write a quantity, a target or one of the inputs, with its unit, for an axis."""
    column = (inputs or {}).get(name) or TARGET_COLUMNS.get(name)
    if column is None or column.unit == "-":
        return plain(name)
    unit = column.unit.replace("/", "p").replace(" ", "")
    # Names leave out the stroke: kgm3.
    short = unit.replace("pm3", "m3")
    return f"{name.removesuffix('_' + short)} [{column.unit}]"


def only_varying(result: StudyResult) -> str | None:
    """Find the only quantity in which the tests differ, if there is one: neither shapes
    nor what is fitted to each group differ beside it."""
    study, inputs = result.study, result.study.tests.inputs
    if len({*study.tests.shapes}) > 1 or any(
        len(n.groups) > 1 for n in study.nuisances
    ):
        return None
    varying = [name for name, values in inputs.items() if np.ptp(values) > 0.0]
    return varying[0] if len(varying) == 1 else None


@in_style
def draw_study(result: StudyResult, on: On = None) -> Figure:
    """Draw the fits of every target by all variants; see `_fitted`."""
    study, count = result.study, len(result.study.targets)
    columns = {1: 1, 2: 2, 4: 2}.get(count, 3)
    rows, title = -(-count // columns), plain(study.title)
    figure, axes = panels(rows, columns, height=3.0, title=title, count=count, on=on)
    for target, panel in enumerate(axes):
        _fitted(panel, result, target, result.variants)
    legend_outside(figure, of=axes, ncols=3)
    return figure


@in_style
def draw_target(
    result: StudyResult, variant: VariantResult, bands: Bands, target: int
) -> Figure:
    """Draw the fit of a target by a variant, with 95 % bands; see `_fitted`."""
    figure, axes = _panel()
    _fitted(axes, result, target, [variant], bands)
    legend_outside(figure, ncols=2)
    return figure


def _fitted(
    axes: Axes,
    result: StudyResult,
    target: int,
    variants: list[VariantResult],
    bands: Bands | None = None,
) -> None:
    """Draw fitted and measured values over the only quantity in which the tests differ;
    where there is none, fitted over measured, hollow where only a limit is known. Bands
    are those of the first variant."""
    study, along = result.study, only_varying(result)
    measured, censored = study.measured[:, target], study.censored[:, target]
    known = study.known[:, target]
    exact, limits = known & (censored == 0), known & (censored != 0)
    sigma = study.sigma[exact, target] if study.sigma_given[target] else None
    x = measured if along is None else study.tests.inputs[along]
    if bands is not None:
        drawn = np.flatnonzero(np.isfinite(bands.middle[:, target] + 0.0 * x))
        drawn = drawn[np.argsort(x[drawn], kind="stable")]
        measurement = bands.measured_low, bands.measured_high
        for (low, high), opacity, width, label in (
            (measurement, 0.2, 1.2, "measurement, 95 %"),
            ((bands.low, bands.high), 0.35, 4.0, "model, 95 %"),
        ):
            ends = x[drawn], low[drawn, target], high[drawn, target]
            style: dict[str, Any] = dict(color=BLUE, alpha=opacity, label=label)
            if along is None:
                axes.vlines(*ends, linewidth=width, **style)
            else:
                axes.fill_between(*ends, linewidth=0, **style)
    for number, variant in enumerate(variants):
        several = bands is None and len(result.variants) > 1
        name = plain(variant.variant.name) if several else "best fit"
        style: dict[str, Any] = dict(markersize=4, label=name, **points(number))
        fitted = variant.predicted[:, target]
        if along is not None:
            order = np.argsort(x, kind="stable")
            axes.plot(x[order], fitted[order], **style)
            continue
        if np.any(exact):
            axes.errorbar(x[exact], fitted[exact], xerr=sigma, ls="none", **style)
        style |= dict(mfc="white", ls="none", label=f"{name}, limit")
        if np.any(limits):
            axes.plot(x[limits], fitted[limits], **style)
    if along is None:
        low, high = axes.get_xlim()
        axes.axline((low, low), (high, high), color=GREY, linewidth=1)
        axes.set_xlabel(f"measured\n{label_of(study.targets[target])}")
        axes.set_ylabel("fitted")
        _short_numbers(axes.xaxis, high)
        _short_numbers(axes.yaxis, high)
        return
    style = dict(marker="x", label="measured", color="black", ls="none")
    axes.errorbar(x[exact], measured[exact], sigma, **style)
    _measured(axes, x, measured, censored, (1, -1))
    axes.set_xlabel(label_of(along, study.tests.known_columns))
    axes.set_ylabel(label_of(study.targets[target]))


def _measured(
    axes: Axes, x: np.ndarray, values: np.ndarray, side: np.ndarray, sides=(*MEASURED,)
) -> None:
    """Draw measurements and limits by their sides."""
    for sign in sides:
        there, (marker, words) = np.isfinite(values) & (side == sign), MEASURED[sign]
        if np.any(there):
            style: dict[str, Any] = dict(color="black", ls="none", label=words)
            axes.plot(x[there], values[there], marker=marker, **style)


def _short_numbers(axis: Axis, largest: float) -> None:
    """Write large numbers as 200 k, which leave room between them."""
    if largest >= 1e4:
        axis.set_major_formatter(EngFormatter())


@in_style
def draw_residuals(
    result: StudyResult,
    variant: VariantResult,
    residuals: Residuals,
    against: str,
    on: On = None,
) -> Figure:
    """Draw residuals over an input, or over "prediction" (of several targets, each over
    its largest)."""
    study, values = result.study, residuals.values
    if against != "prediction":
        along = np.broadcast_to(study.tests.inputs[against][:, None], values.shape)
        label = label_of(against, study.tests.known_columns)
    elif len(study.targets) == 1:
        along, label = variant.predicted, f"predicted {label_of(study.targets[0])}"
    else:
        shown = np.where(np.isfinite(values), np.abs(variant.predicted), np.nan)
        largest = np.nanmax(shown, axis=0, initial=0.0)
        # Where no impact has a force at the times of its curve all are zero.
        along = variant.predicted / np.where(largest > 0.0, largest, 1.0)
        label = "prediction over the largest of its target [-]"
    figure, axes = _about_zero(study, along, values, 2.0, on)
    axes.set_xlabel(label)
    axes.set_ylabel("residual [standard deviations]")
    return figure


def _about_zero(
    study: Study, along: np.ndarray, values: np.ndarray, band: float, on: On = None
) -> tuple[Figure, Axes]:
    """Draw values of all tests and targets about a grey band."""
    figure, axes = _panel(on)
    axes.axhspan(-band, band, color=GREY, alpha=0.15, linewidth=0)
    axes.axhline(0.0, color=GREY, linewidth=1)
    for target, name in enumerate(study.targets):
        style: dict[str, Any] = dict(linestyle="none", markersize=5, label=name)
        axes.plot(along[:, target], values[:, target], **style, **points(target))
    if len(study.targets) > 1:
        legend_outside(figure, of=[axes], ncols=3)
    return figure, axes


@in_style
def draw_quantiles(residuals: Residuals) -> Figure:
    """Draw residuals over the quantiles of a normal distribution."""
    figure, axes = _panel()
    expected, values = residuals.ordered()
    reach = max(np.max(np.abs(expected), initial=1.0), 2.0)
    axes.plot([-reach, reach], [-reach, reach], color=GREY, linewidth=1)
    axes.plot(expected, values, "o", color=BLUE, markersize=4)
    axes.set_xlabel("normal quantile [standard deviations]")
    axes.set_ylabel("residual [standard deviations]")
    return figure


@in_style
def draw_profile(
    variant: VariantResult, profile: LikelihoodProfile, on: On = None
) -> Figure:
    """Draw the likelihood ratio where a parameter is fixed, the 95 % interval and, if
    it is identifiable, the parabola of its standard error."""
    figure, axes = _panel(on)
    index = variant.names.index(profile.name)
    uncertainty = variant.uncertainty
    bounds = Bounds(*(part[index] for part in variant.bounds))
    # Three standard deviations, or beyond the 95 % interval.
    limit = uncertainty.quantile[index] ** 2
    most = max(9.0, 1.5 * limit)
    along = bounds.coordinate(profile.values)
    low, high = bounds.parameter(_shown(along, profile.rise, most))
    ends = profile.low_95, profile.high_95
    if variant.verdicts[index].determined:
        ends = variant.interval(index)
    # Where the interval has no end it reaches the bound.
    left = float(bounds.lower) if ends[0] is None else ends[0]
    right = float(bounds.upper) if ends[1] is None else ends[1]
    low, high = min(low, left), max(high, right)
    axes.axvspan(left, right, color=GREY, alpha=0.15, lw=0)
    fine = np.linspace(max(bounds.coordinate(low), along[0]), along[-1], 300)
    fine = fine[fine <= bounds.coordinate(high)]
    # As the ends of the intervals are, so that the curve is at their level there.
    root = np.interp(fine, along, np.sqrt(np.maximum(profile.rise, 0.0)))
    axes.plot(bounds.parameter(fine), root**2, color=BLUE)
    style: dict[str, Any] = dict(color=BLUE, marker="o", markersize=4, linestyle="none")
    axes.plot(profile.values, profile.rise, label="others fitted again", **style)
    if variant.verdicts[index].determined:
        reach = np.sqrt(most) * np.linspace(-1.0, 1.0, 61)
        x = variant.points.x[0, index] + reach * uncertainty.standard_errors[index]
        by_error = bounds.parameter(x)
        axes.plot(by_error, reach**2, "--", color=GREY, label="by the standard error")
    for level, words in ((1.0, "68 %"), (limit, "95 %")):
        axes.axhline(level, color=VERMILION, linewidth=0.8)
        at: dict[str, Any] = dict(ha="right", va="center", color=VERMILION)
        at["bbox"] = dict(facecolor="white", edgecolor="none", pad=1.0)
        axes.annotate(words, (1.0, level), xycoords=("axes fraction", "data"), **at)
    _scale(axes, "x", low, high, variant.bounds.logarithmic[index])
    axes.set_xlim(low, high)
    axes.set_ylim(-0.02 * most, most)
    axes.set_xlabel(label_of(profile.name, columns_of(variant.objective.scene)))
    axes.set_ylabel("likelihood ratio 2 ΔC / s² [-]")
    axes.legend(loc="upper center")
    return figure


def _shown(along: np.ndarray, rise: np.ndarray, most: float) -> np.ndarray:
    """Choose the ends of what is drawn: where the likelihood ratio leaves the panel."""
    inside = np.flatnonzero(rise <= most)
    first, last = max(inside[0] - 1, 0), min(inside[-1] + 1, len(along) - 1)
    # A point far away, with none between, would draw a needle.
    low, high = along[inside[0]], along[inside[-1]]
    reach = max(0.3 * (high - low), 1e-9)
    return np.array([max(along[first], low - reach), min(along[last], high + reach)])


def _scale(axes: Axes, which: str, low: float, high: float, logarithmic: bool) -> None:
    """Use a logarithmic axis for more than a decade."""
    if logarithmic and high > 10.0 * low:
        log_scale(axes, which)


@in_style
def draw_pair(
    variant: VariantResult,
    diagnostics: Examination,
    first: int,
    second: int,
    on: On = None,
) -> Figure:
    """Draw two parameters of the posterior and, where both are identifiable, the 95 %
    ellipse of the covariance."""
    figure, axes = _panel(on)
    bounds, pair, draws = variant.bounds, [first, second], diagnostics.posterior
    random = np.random.default_rng(0)
    chosen = random.choice(len(draws.x), 400, p=diagnostics.weights)
    values = bounds.parameter(draws.x[chosen])[:, pair]
    axes.plot(*values.T, "o", color=BLUE, markersize=3, alpha=0.3, mec="none")
    covariance = variant.uncertainty.covariance[np.ix_(pair, pair)]
    if variant.verdicts[first].determined and variant.verdicts[second].determined:
        turn = np.linspace(0.0, 2.0 * np.pi, 200)
        # The radius that holds 95 % of a normal distribution of two variables.
        circle = 2.448 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
        at = np.tile(variant.points.x[0], (len(turn), 1))
        at[:, pair] += circle @ root_of(covariance).T
        at = np.clip(at, bounds.low, bounds.high)
        axes.plot(*bounds.parameter(at)[:, pair].T, color=VERMILION, linewidth=1)
    axes.plot(*variant.parameters[pair], "x", color="black")
    columns = columns_of(variant.objective.scene)
    for index, of_axis, which in zip(pair, values.T, "xy", strict=True):
        ends = np.min(of_axis), np.max(of_axis)
        _scale(axes, which, *ends, bounds.logarithmic[index])
        axes.set(**{f"{which}label": label_of(variant.names[index], columns)})
    return figure


@in_style
def draw_left_out(result: StudyResult, left: LeftOut) -> Figure:
    """Draw measured less predicted by the fit to the other tests."""
    study = result.study
    values = left.standardised(study.measured)
    values = np.where(study.censored == 0, values, np.nan)
    names = study.tests.names_apart()
    rows = np.array([study.tests.place(test)[1] for test in range(len(values))])
    by_row = list(names) == [f"row {row}" for row in rows]
    number = rows if by_row else np.arange(len(values))
    along = np.broadcast_to(number[:, None], values.shape)
    figure, axes = _about_zero(study, along, values, left.quantile)
    if by_row:
        axes.set_xlabel(f"row of {plain(study.tests.files[0].path.name)}")
    else:
        step = -(-len(names) // MOST_NAMED)
        shown = [tick_name(name) for name in names[::step]]
        axes.set_xticks(number[::step], shown, rotation=45, ha="right")
    axes.set_ylabel("measured less predicted\n[standard deviations]")
    return figure


@in_style
def draw_candidates(suggestions: Suggestions) -> Figure:
    """Draw the gain of the next test over the first quantity, a line for each value of
    the second; the best of the others and of the ways to measure."""
    figure, axes = _panel()
    first, *others = suggestions.candidates
    best, along = np.max(suggestions.volumes, axis=1), suggestions.candidates[first]
    lines = suggestions.candidates[others[0]] if others else np.zeros(len(along))
    for number, value in enumerate(np.unique(lines)):
        of_line = lines == value
        x = np.unique(along[of_line])
        y = [np.max(best[of_line & (along == at)]) for at in x]
        axes.plot(x, y, markersize=5, label=f"{value:g}", **points(number))
    axes.set_xlabel(label_of(first, suggestions.columns))
    axes.set_ylabel("factor by which the\nmean error shrinks [-]")
    if others:
        legend_outside(figure, title=label_of(others[0], suggestions.columns))
    return figure


@in_style
def draw_comparison(compared: Compared, on: On = None) -> Figure:
    """Draw the difference of each law to the best, with two standard errors."""
    ranking = compared.ranking()
    count = len(compared.laws)
    figure, (axes,) = panels(1, 1, height=0.9 + 0.28 * count, on=on)
    places = np.arange(count)
    apart, error = ranking.apart, np.nan_to_num(2.0 * ranking.error)
    for place in places:
        tied = place in ranking.ties
        colour = VERMILION if place == ranking.preferred else BLUE if tied else GREY
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


@in_style
def draw_predictions(
    prediction: PredictedTests, variant: VariantPrediction, on: On = None
) -> Figure:
    """Draw the predicted measurements of each target, test by test: median, 50 % and
    95 % intervals, and what was measured."""
    count, tests = len(prediction.targets), np.arange(1, len(prediction.tests) + 1)
    columns = min(count, 2)
    figure, axes = panels(-(-count // columns), columns, height=3.0, count=count, on=on)
    for target, (name, panel) in enumerate(zip(prediction.targets, axes, strict=True)):
        style: dict[str, Any] = dict(color=BLUE)
        for kind, width in ((50, 4.0), (95, 1.2)):
            ends = (getattr(variant, f"{e}_{kind}")[:, target] for e in ("low", "high"))
            label = f"predicted, {kind} %"
            panel.vlines(tests, *ends, lw=width, alpha=0.5, label=label, **style)
        panel.plot(tests, variant.middle[:, target], "o", label="median", **style)
        measured = prediction.measured[:, target]
        _measured(panel, tests, measured, prediction.censored[:, target])
        if len(tests) <= 12:
            names = [tick_name(name) for name in prediction.tests.names_apart()]
            panel.set_xticks(tests, names, rotation=45, ha="right")
        else:
            panel.set_xlabel("test")
        panel.set_xlim(0.5, len(tests) + 0.5)
        panel.set_ylabel(label_of(name))
    legend_outside(figure, of=axes, ncols=4)
    return figure

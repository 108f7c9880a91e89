"""Files of a back-analysis: report.html with its pictures, fit.json and tables."""

import base64
import hashlib
import json

import numpy as np
from matplotlib.figure import Figure

from ..._packages import versions
from ...calibration.report.render import render
from ...io.display import Rows
from ...io.files import write_text
from ...io.output_files import NewFile
from ...plotting.style import (
    BLUE,
    GREY,
    VERMILION,
    in_style,
    legend_outside,
    panels,
    png_bytes,
)
from ..study.barriers import (
    COLUMNS,
    NOTE,
    barrier_rows,
    barriers_in_json,
    design_rows,
    effect_rows,
    interval_text,
    number_text,
)
from .observed import ObservedCount, ObservedPassages
from .posterior import WIDE, FittedParameter
from .predictive import RARE, ChannelPrediction, Curve, SlopeCalibration
from .problem import ENDS

FILES = ("report.html", "fit.json", "samples.csv", "exceedance.csv")
BARRIER_FILE = "barriers.csv"
PACKAGE = "jaximpact.runout.back_analysis"
PERCENTILE_KEYS = ("percent", "observed", "low", "median", "high")


def write_report(found: SlopeCalibration, new: NewFile) -> None:
    """Write the files, each whole or not at all.

    Args:
        new: gives the path of a file by its name.

    Raises OSError where the file system refuses.
    """
    contents = contents_of(found) | {"pictures": draw_report(found)}
    text = render("back_analysis", "html", contents, PACKAGE)
    write_text(new("report.html"), text)
    write_text(new("fit.json"), json.dumps(as_json(found), indent=1) + "\n")
    write_text(new("samples.csv"), _samples(found))
    write_text(new("exceedance.csv"), _exceedance(found))
    if barriers := found.predicted.barriers:
        rows = (COLUMNS, *barrier_rows(barriers))
        text = "\n".join(",".join(row) for row in rows)
        write_text(new(BARRIER_FILE), text + "\n")


def in_words(found: SlopeCalibration) -> str:
    """Report as text."""
    none = {"marginals": [], "channels": [], "curves": []}
    contents = contents_of(found) | {"pictures": none}
    return render("back_analysis", "txt", contents, PACKAGE)


def contents_of(found: SlopeCalibration) -> dict:
    """Collect the contents of the report, but for its pictures, as plain values."""
    fit, posterior, predicted = found.fit, found.posterior, found.predicted
    known = [p for p in posterior.fitted if p.determined]
    verdict = [f"{len(known)} of {len(posterior.fitted)} parameters are determined"]
    verdict += [
        f"{p.parameter.name}: {p.median:.4g}, 95 % interval {p.low:.4g} to {p.high:.4g}"
        for p in known
    ]
    check = predicted.check
    return {
        "title": fit.title,
        "verdict": verdict,
        "warnings": warnings_of(found),
        "parameters": _parameters(posterior.fitted),
        "parameters_words": "Width is that of the 95 % interval as a fraction of the "
        f"prior's, both as probabilities under the prior; from {WIDE:g} on the "
        "observations do not determine a parameter.",
        "correlation": _correlation(found),
        "check": f"Of the summaries, {check.worst} deviates most, by "
        f"{check.deviation:.3g} standard deviations; "
        f"{100 * check.probability:.2g} % of predicted data sets deviate as much "
        "somewhere. Percentiles below are those observed, and those of predicted data "
        "sets of the same size with their 95 % intervals.",
        "channels": _channels(found),
        "barriers": effect_rows(predicted.barriers) if predicted.barriers else [],
        "barrier_design": design_rows(predicted.barriers),
        "barriers_words": f"{predicted.blocks} blocks are released on each of "
        f"{predicted.draws} grounds, samples of the posterior. Shares and percentiles "
        "are of all these blocks together. Their intervals of 95 % hold the "
        "uncertainty of the fitted ground and the finite number of blocks on each; an "
        "end for which too few blocks arrive is a dash. " + NOTE,
        "curves": _design(found),
        "curves_words": "Percentiles of the blocks that arrive, with intervals of "
        f"95 %, from {predicted.draws} samples of the posterior with "
        f"{predicted.blocks} blocks each. The intervals hold the uncertainty of the "
        "fitted ground and the finite number of blocks. Curves show the share of all "
        "released blocks.",
        "coverage": _coverage(posterior.fitted),
        "coverage_words": f"The {posterior.left_out} data sets most like the observed "
        "one were taken, in turn, for observed, and fitted by the others. The table "
        "tells how many of their true parameters lie in the intervals.",
        "how": _how(found),
        "origin": _origin(found),
    }


def warnings_of(found: SlopeCalibration) -> list[str]:
    """List what a reader must know before he uses the numbers."""
    fitted, lines = found.posterior.fitted, []
    check = found.predicted.check
    if not check.explained:
        lines.append(
            f"The model does not explain the observations: {check.worst} lies "
            f"{check.deviation:.3g} standard deviations from what the fitted ground "
            "predicts. Check releases, blocks and data; do not rely on the intervals."
        )
    for p in fitted:
        name = p.parameter.name
        if not p.determined:
            lines.append(
                f"{name} is not determined: its interval is {p.ratio:.0%} as wide as "
                "the prior's."
            )
        elif p.at_bound:
            lines.append(
                f"The interval of {name} ends at a bound of its prior; a wider prior "
                "may move it."
            )
        if found.posterior.is_too_narrow(p):
            lines.append(
                f"Only {p.coverage_95:.0%} of left-out data sets have {name} in its "
                "95 % interval: it is too narrow; more data_sets may help."
            )
    for i, j in found.posterior.pairs_together:
        one, other = fitted[i].parameter.name, fitted[j].parameter.name
        lines.append(
            f"{one} and {other} act together (correlation "
            f"{found.posterior.correlation[i, j]:.2f}): rely on both together, not on "
            "each."
        )
    return [*lines, *(f"{r[0].upper()}{r[1:]}." for r in found.fit.observed.remarks)]


def _parameters(fitted: tuple[FittedParameter, ...]) -> Rows:
    rows: Rows = [
        ("parameter", "median", "95 % interval", "prior, 95 %", "width", "verdict")
    ]
    for p in fitted:
        verdict = "determined" if p.determined else "not determined"
        cells = f"{p.median:.4g}", f"{p.low:.4g} to {p.high:.4g}"
        prior = f"{p.prior_low:.4g} to {p.prior_high:.4g}"
        rows.append((p.parameter.name, *cells, prior, f"{p.ratio:.0%}", verdict))
    return rows


def _correlation(found: SlopeCalibration) -> Rows:
    names = [p.parameter.name for p in found.posterior.fitted]
    if len(names) < 2:
        return []
    rows: Rows = [("", *names)]
    for name, row in zip(names, found.posterior.correlation, strict=True):
        rows.append((name, *(f"{value:.2f}" for value in row)))
    return rows


def _channels(found: SlopeCalibration) -> Rows:
    rows: Rows = [("observed", "blocks", "", "observed", "predicted", "interval", "")]
    for prediction in found.predicted.channels:
        channel = prediction.channel
        held_out = isinstance(channel, ObservedPassages) and channel.held_out
        words = channel.words + (", held out" if held_out else "")
        first = (words, str(channel.blocks))
        for percent, ours, low, middle, high in prediction.percentiles():
            inside = "inside" if low <= ours <= high else "outside"
            interval = f"{low:.4g} to {high:.4g}"
            cells = f"{percent} %", f"{ours:.4g}", f"{middle:.4g}", interval, inside
            rows.append((*first, *cells))
            first = ("", "")
    for channel in found.fit.observed.channels:
        if isinstance(channel, ObservedCount):
            told = f"{channel.passed} of {channel.blocks}"
            rows.append((channel.words, str(channel.blocks), "", told, "", "", ""))
    return rows


def _design(found: SlopeCalibration) -> Rows:
    curves = found.predicted.curves
    if not curves:
        return []
    heads = [f"{percent} %" for percent in curves[0].design]
    rows: Rows = [("place", "quantity", *heads)]
    for curve in curves:
        place = ", ".join((*curve.names, f"x = {curve.place:g} m"))
        cells = [
            f"{number_text(value)} ({interval_text(low, high)})"
            for value, low, high in curve.design.values()
        ]
        rows.append((place, curve.quantity, *cells))
    return rows


def _coverage(fitted: tuple[FittedParameter, ...]) -> Rows:
    rows: Rows = [("parameter", "in the 68 % interval", "in the 95 % interval")]
    for p in fitted:
        rows.append((p.parameter.name, f"{p.coverage_68:.0%}", f"{p.coverage_95:.0%}"))
    return rows


def _how(found: SlopeCalibration) -> list[str]:
    fit, searched = found.fit, found.searched
    law = ", ".join(f"{k} {v}" for k, v in fit.slope.laws[0].description.items())
    volumes = ", ".join(f"{volume:.3g}" for volume in searched.volumes)
    sigma = fit.observed.sigma
    errors = ", ".join(f"{name} {value:g}" for name, value in sigma.items())
    smoothing = fit.slope.layout.smoothing
    return [
        *([f"The profile is {smoothing}."] if smoothing else []),
        f"{searched.simulated} data sets of {fit.observed.released} blocks, and the "
        f"predictions, were computed by {law}, from the first round to the last: no "
        "table or emulator stands in for it.",
        f"{len(searched.volumes)} rounds, in parts of the prior of probability "
        f"{volumes}. The posterior is a regression of the parameters on summaries of "
        f"the {len(searched.pool.z)} data sets in the last part.",
        f"{searched.without} data sets lacked a block that stops or one at a "
        "collector, and were left out, as the observations have them.",
        f"Errors of measurement, standard deviations: {errors or 'none'}.",
        "Blocks are independent samples of the releases, blocks and grounds that the "
        "study states. What was observed is no choice of blocks by their size or "
        "distance, and is of the same blocks at each place.",
        "Only the summaries count: quantiles, mean, standard deviation and number of "
        "each channel, not which block has which value.",
        "Priors bound what can be found. Intervals hold no error of the model.",
    ]


def _origin(found: SlopeCalibration) -> Rows:
    rows: Rows = [("file or program", "SHA-256 or version")]
    rows += list(_checksums(found).items())
    return [*rows, *versions().items()]


def _checksums(found: SlopeCalibration) -> dict[str, str]:
    files = dict.fromkeys(found.fit.inputs)
    return {f.name: hashlib.sha256(f.read_bytes()).hexdigest() for f in files}


def as_json(found: SlopeCalibration) -> dict:
    """Collect every number, as a tree of plain values."""
    fit, posterior, predicted = found.fit, found.posterior, found.predicted
    smoothing = fit.slope.layout.smoothing
    return {
        "title": fit.title,
        "parameters": {
            p.parameter.name: {
                "median": p.median,
                "interval_95": [p.low, p.high],
                "prior_95": [p.prior_low, p.prior_high],
                "width_ratio": p.ratio,
                "determined": p.determined,
                "coverage_68": p.coverage_68,
                "coverage_95": p.coverage_95,
            }
            for p in posterior.fitted
        },
        "correlation": posterior.correlation.tolist(),
        "model_check": {
            "probability": predicted.check.probability,
            "needed": RARE,
            "worst": predicted.check.worst,
            "deviation": min(predicted.check.deviation, 1e300),
        },
        "barriers": barriers_in_json(predicted.barriers),
        "held_out": [
            {
                "x_m": p.channel.place,
                "quantity": p.channel.quantity,
                "blocks": p.channel.blocks,
                "percentiles": [
                    dict(zip(PERCENTILE_KEYS, row, strict=True))
                    for row in p.percentiles()
                ],
            }
            for p in predicted.channels
            if isinstance(p.channel, ObservedPassages) and p.channel.held_out
        ],
        "warnings": warnings_of(found),
        "manifest": {
            "files": _checksums(found),
            "versions": versions() | {"numpy": np.__version__},
            "seed": fit.slope.seed,
            "contacts": fit.slope.laws[0].description,
            **({"profile": smoothing._asdict()} if smoothing else {}),
            "priors": {
                p.name: [type(p.prior).__name__, *p.prior] for p in fit.parameters
            },
            "rounds": found.searched.volumes,
            "data_sets": found.searched.simulated,
            "blocks_each": fit.observed.released,
        },
    }


def _samples(found: SlopeCalibration) -> str:
    names = [p.parameter.name for p in found.posterior.fitted]
    rows = (",".join(f"{v:.9g}" for v in row) for row in found.posterior.values)
    return "\n".join((",".join(names), *rows)) + "\n"


def _exceedance(found: SlopeCalibration) -> str:
    lines = ["x_m,quantity,value,share,low,high"]
    for curve in found.predicted.curves:
        columns = curve.values, curve.share, curve.low, curve.high
        for numbers in zip(*columns, strict=True):
            cells = ",".join(f"{v:.9g}" for v in numbers)
            lines.append(f"{curve.place:.10g},{curve.quantity},{cells}")
    return "\n".join(lines) + "\n"


WIDTH, HEIGHT = 4.6, 3.5
"""Size of a panel [inch]: the report shows it 460 px wide."""
BINS = 20
MOST_SAMPLES, MOST_VALUES = (0.002, 0.998), (0.01, 0.99)
"""Quantiles of samples and of predicted values between which they are drawn."""
BAND = 0.25
"""Opacity."""


def draw_report(found: SlopeCalibration) -> dict[str, list[dict]]:
    """Draw the pictures of a report, by their place in it.

    A picture has `base64` (the PNG), `description` and `caption`.
    """
    values, predicted = found.posterior.values.T, found.predicted
    return {
        "marginals": [
            _picture(
                draw_marginal(fitted, samples),
                f"Posterior of {fitted.parameter.name}",
                "Samples of the posterior, the 95 % interval, and the density of the "
                "prior.",
            )
            for fitted, samples in zip(found.posterior.fitted, values, strict=True)
        ],
        "channels": [
            _picture(
                draw_channel(channel),
                f"Observed and predicted {channel.channel.words}",
                "Observed, and 95 % of predicted data sets of the same size.",
            )
            for channel in predicted.channels
        ],
        "curves": [
            _picture(
                draw_curve(curve),
                f"Exceedance of {curve.quantity} at x = {curve.place:g} m",
                "Mean, and 95 % interval.",
            )
            for curve in predicted.curves
        ],
    }


def _picture(figure: Figure, description: str, caption: str) -> dict:
    code = base64.b64encode(png_bytes(figure)).decode()
    return {
        "base64": code,
        "description": description,
        "caption": f"{description}. {caption}",
    }


@in_style
def draw_marginal(fitted: FittedParameter, samples: np.ndarray) -> Figure:
    """Draw samples of a parameter beside its prior."""
    figure, (axes,) = panels(height=HEIGHT, width=WIDTH)
    prior, name = fitted.parameter.prior, fitted.parameter.name
    bulk = tuple(np.quantile(samples, MOST_SAMPLES))
    counts, edges, _ = axes.hist(
        samples,
        BINS,
        range=bulk,
        density=True,
        color=BLUE,
        alpha=0.6,
        label="posterior",
    )
    low, high = min(edges[0], fitted.prior_low), max(edges[-1], fitted.prior_high)
    u = np.linspace(ENDS[0], ENDS[-1], 2001)
    x = prior.values(u)
    apart = np.maximum(np.diff(x), 1e-300)
    axes.plot(0.5 * (x[1:] + x[:-1]), np.diff(u) / apart, color=GREY, label="prior")
    for end in (fitted.low, fitted.high):
        axes.axvline(end, color=VERMILION, ls="--", lw=1.0, label="95 % interval")
    axes.set(xlabel=name, ylabel="density", xlim=(low, high))
    axes.set_ylim(0.0, 1.1 * float(np.max(counts)))
    legend_outside(figure)
    return figure


@in_style
def draw_channel(prediction: ChannelPrediction) -> Figure:
    """Draw the cumulative share of observed values, and the band of predicted ones."""
    figure, (axes,) = panels(height=HEIGHT, width=WIDTH)
    channel, predicted = prediction.channel, prediction.predicted
    finite = predicted[np.isfinite(predicted)]
    observed = np.sort(channel.values)
    # One block that went far would press all others together.
    most = np.quantile(finite, MOST_VALUES) if len(finite) else observed
    every = np.concatenate([most, observed])
    x = np.linspace(np.min(every), np.max(every), 200)
    rows = [row[np.isfinite(row)] for row in predicted]
    shares = [np.searchsorted(row, x, "right") / len(row) for row in rows if len(row)]
    if shares:
        low, middle, high = np.quantile(shares, (0.025, 0.5, 0.975), axis=0)
        axes.fill_between(x, low, high, color=BLUE, alpha=BAND, label="95 %")
        axes.plot(x, middle, color=BLUE, label="predicted")
    steps = np.arange(1, len(observed) + 1) / len(observed)
    axes.step(observed, steps, where="post", color=VERMILION, label="observed")
    axes.set(xlabel=channel.words, ylabel="cumulative share", ylim=(0.0, 1.0))
    legend_outside(figure)
    return figure


@in_style
def draw_curve(curve: Curve) -> Figure:
    """Draw the share of released blocks that exceed a value."""
    figure, (axes,) = panels(height=HEIGHT, width=WIDTH)
    axes.fill_between(curve.values, curve.low, curve.high, color=BLUE, alpha=BAND)
    axes.plot(curve.values, curve.share, color=BLUE)
    axes.set(
        xlabel=f"{curve.quantity} at x = {curve.place:g} m",
        ylabel="share of blocks that exceed it",
        ylim=(0.0, max(1e-3, 1.05 * float(np.max(curve.high)))),
    )
    return figure

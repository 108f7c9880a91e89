"""Report of a back-analysis, and its files."""

import hashlib
from functools import partial

import numpy as np

from ..._packages import versions
from ...io.files import by_name, write_text
from ...io.output_files import NewFile
from ...lookup import Tabulated
from ...reports.document import Box, Document, Part, Picture, ReportSection
from ...reports.json_tree import json_text
from ...reports.tables import Table, at_x, interval_text, number_text, place_text
from ..study.barriers import (
    NOTE,
    barriers_in_json,
    design_table,
    effect_table,
    estimate_table,
)
from .data_sets import MOST_FAILED
from .observed import ObservedCount
from .posterior import WIDE, FittedParameter
from .predictive import RARE, SlopeCalibration

FILES = ("report.html", "fit.json", "samples.csv", "exceedance.csv")
BARRIER_FILE = "barriers.csv"


def write_report(result: SlopeCalibration, new: NewFile) -> None:
    """Write the files, each whole or not at all; `new` gives the path of a file by its
    name. Raises OSError where the file system refuses."""
    write_text(new("report.html"), report(result).page())
    write_text(new("fit.json"), json_text(as_json(result)))
    names = [p.parameter.name for p in result.posterior.fitted]
    write_text(new("samples.csv"), Table(names, result.posterior.values.tolist()).csv())
    exceedance = [
        (c.place, c.quantity, *numbers)
        for c in result.predicted.curves
        for numbers in zip(c.values, c.share, c.low, c.high, strict=True)
    ]
    columns = ("x_m", "quantity", "value", "share", "low", "high")
    write_text(new("exceedance.csv"), Table(columns, exceedance).csv())
    if barriers := result.predicted.barriers:
        write_text(new(BARRIER_FILE), estimate_table(barriers).csv())


def report(result: SlopeCalibration) -> Document:
    """Report the fitted parameters, what they predict, and how they were found."""
    # Matplotlib takes half a second to import, which simulating workers need not.
    from . import drawing

    fit, posterior, predicted = result.fit, result.posterior, result.predicted
    known = [p for p in posterior.fitted if p.determined]
    verdict = [f"{len(known)} of {len(posterior.fitted)} parameters are identifiable."]
    verdict += [
        f"{p.parameter.name}: {p.median:.4g} (95 %: {p.low:.4g} to {p.high:.4g})."
        for p in known
    ]
    warnings = warnings_of(result)
    marginals = [
        Picture(
            partial(drawing.draw_marginal, fitted, samples),
            f"Posterior of {fitted.parameter.name}",
            f"{fitted.parameter.name}: samples of the posterior, the 95 % interval, "
            "and the density of the prior.",
        )
        for fitted, samples in zip(posterior.fitted, posterior.values.T, strict=True)
    ]
    channels = [
        Picture(
            partial(drawing.draw_channel, prediction),
            f"Observed and predicted {prediction.channel.words}",
            f"{prediction.channel.words}: observed, and 95 % of predicted data sets of "
            "the same size.",
        )
        for prediction in predicted.channels
    ]
    answer: list[Part] = [
        Box("verdict", verdict),
        Box("warning", ["Warnings", *warnings]) if warnings else None,
        *channels[:1],
    ]
    names = [p.parameter.name for p in posterior.fitted]
    correlations = [
        (name, *(f"{value:.2f}" for value in row))
        for name, row in zip(names, posterior.correlation, strict=True)
    ]
    parameters = [
        _parameters(posterior.fitted),
        "Width is that of the 95 % interval as a fraction of the prior's, both as "
        f"probabilities under the prior; from {WIDE:g} on the observations do not "
        "identify a parameter.",
        marginals,
        ReportSection(
            "Correlation of ranks",
            [Table(("", *names), correlations if len(names) > 1 else [])],
        ),
    ]
    intervals = [
        f"The {posterior.left_out} data sets most like the observed one were each "
        "fitted by the others, as if they had been observed. The table says how many "
        "of their true parameters lie in the intervals.",
        Table(
            ("parameter", "in the 68 % interval", "in the 95 % interval"),
            [
                (p.parameter.name, f"{p.coverage_68:.0%}", f"{p.coverage_95:.0%}")
                for p in posterior.fitted
            ],
        ),
    ]
    sections = [
        ReportSection("Parameters", parameters),
        ReportSection(
            "Observed and predicted", [_check(result), _channels(result), channels]
        ),
        ReportSection("Barriers", _barriers(result)),
        ReportSection("Exceedance", _curves(result)),
        ReportSection("Are the intervals right?", intervals),
        ReportSection("How it was found, and what it assumes", [_how(result)]),
        ReportSection("Computed from", [_origin(result)]),
    ]
    return Document(fit.title, answer, sections)


def warnings_of(result: SlopeCalibration) -> list[str]:
    """List what a reader must know before he uses the numbers."""
    fitted, lines = result.posterior.fitted, []
    check = result.predicted.check
    if not check.explained:
        apart = f"lies {check.deviation:.3g} standard deviations from"
        if not np.isfinite(check.deviation):
            apart = "as observed never occurs in"
        lines.append(
            f"The model does not explain the observations: {check.worst} {apart} what "
            "the fitted ground predicts. Check releases, blocks and data; do not rely "
            "on the intervals."
        )
    if failed := result.searched.failed:
        lines.append(
            f"In {failed} of {result.searched.simulated} data sets most blocks failed: "
            "they were left out, so that no ground like theirs can be found. Look for "
            "a law or a table that has a value there."
        )
    if failed := result.predicted.failed:
        most = "These are most blocks: do not use the fit. "
        lines.append(
            f"{100.0 * failed:.3g} % of the blocks failed on the fitted ground, and "
            f"are in no number but this. {most if failed > MOST_FAILED else ''}Look "
            "for a law or a table that has a value there."
        )
    for p in fitted:
        name = p.parameter.name
        if not p.determined:
            lines.append(
                f"{name} is not identifiable: its interval is {p.ratio:.0%} as wide as "
                "the prior's."
            )
        elif p.at_bound:
            lines.append(
                f"The interval of {name} ends at a bound of its prior; a wider prior "
                "may move it."
            )
        if result.posterior.is_too_narrow(p):
            lines.append(
                f"Only {p.coverage_95:.0%} of left-out data sets have {name} in its "
                "95 % interval: it is too narrow; more data_sets may help."
            )
    for i, j in result.posterior.pairs_together:
        one, other = fitted[i].parameter.name, fitted[j].parameter.name
        lines.append(
            f"{one} and {other} act together (correlation "
            f"{result.posterior.correlation[i, j]:.2f}): rely on both together, not on "
            "each."
        )
    return [*lines, *(f"{r[0].upper()}{r[1:]}." for r in result.fit.observed.remarks)]


def _parameters(fitted: tuple[FittedParameter, ...]) -> Table:
    rows = [
        (
            *(p.parameter.name, p.median, interval_text(p.low, p.high)),
            *(interval_text(p.prior_low, p.prior_high), f"{p.ratio:.0%}"),
            "identifiable" if p.determined else "not identifiable",
        )
        for p in fitted
    ]
    columns = ("parameter", "median", "95 % interval", "prior, 95 %", "width")
    return Table((*columns, "verdict"), rows)


def _check(result: SlopeCalibration) -> str:
    check = result.predicted.check
    apart = f"by {check.deviation:.3g} standard deviations"
    if not np.isfinite(check.deviation):
        apart = "and as observed never occurs in what the fitted ground predicts"
    return (
        f"Of the summaries, {check.worst} deviates most, {apart}; "
        f"{100 * check.probability:.3g} % of predicted data sets deviate as much "
        "somewhere. Percentiles below are those observed, and those of "
        "predicted data sets of the same size with their 95 % intervals."
    )


def _channels(result: SlopeCalibration) -> Table:
    rows = []
    for prediction in result.predicted.channels:
        channel = prediction.channel
        first = (channel.words + ", held out" * channel.held_out, channel.blocks)
        # A coordinate, which may be one of a national grid.
        write = place_text if channel.place is None else number_text
        for percent, observed, low, middle, high in prediction.percentiles():
            inside = "inside" if low <= observed <= high else "outside"
            interval = interval_text(low, high, write)
            cells = write(observed), write(middle), interval, inside
            rows.append((*first, f"{percent} %", *cells))
            first = ("", "")
    for channel in result.fit.observed.channels:
        if isinstance(channel, ObservedCount):
            passed = f"{channel.passed} of {channel.blocks}"
            rows.append((channel.words, channel.blocks, "", passed, "", "", ""))
    columns = ("observed", "blocks", "", "observed", "predicted", "interval", "")
    return Table(columns, rows)


def _barriers(result: SlopeCalibration) -> list[Part]:
    predicted = result.predicted
    if not predicted.barriers:
        return []
    return [
        f"{predicted.blocks} blocks are released on each of {predicted.draws} grounds, "
        "samples of the posterior. Shares and percentiles are of all these blocks "
        "together. Their intervals of 95 % hold the uncertainty of the fitted ground "
        "and the finite number of blocks on each; an end for which too few blocks "
        f"arrive is a dash. {NOTE}",
        effect_table(predicted.barriers),
        design_table(predicted.barriers),
    ]


def _curves(result: SlopeCalibration) -> list[Part]:
    from . import drawing

    predicted, curves = result.predicted, result.predicted.curves
    if not curves:
        return []
    rows, pictures = [], []
    for curve in curves:
        place = ", ".join((*curve.names, at_x(curve.place)))
        cells = [
            f"{number_text(value)} ({interval_text(low, high)})"
            for value, low, high in curve.design.values()
        ]
        rows.append((place, curve.quantity, *cells))
        words = f"Exceedance of {curve.quantity} at {at_x(curve.place)}"
        draw = partial(drawing.draw_curve, curve)
        pictures.append(Picture(draw, words, f"{words}: mean, and 95 % interval."))
    heads = (f"{percent} %" for percent in curves[0].design)
    return [
        "Percentiles of the blocks that arrive, with intervals of 95 %, from "
        f"{predicted.draws} samples of the posterior with {predicted.blocks} blocks "
        "each. The intervals hold the uncertainty of the fitted ground and the finite "
        "number of blocks. Curves show the share of all released blocks.",
        Table(("place", "quantity", *heads), rows),
        pictures,
    ]


def _how(result: SlopeCalibration) -> list[str]:
    fit, searched = result.fit, result.searched
    law = ", ".join(f"{k} {v}" for k, v in fit.slope.laws[0].description.items())
    volumes = ", ".join(f"{volume:.3g}" for volume in searched.volumes)
    sigma = fit.observed.sigma
    errors = ", ".join(f"{name} {value:g}" for name, value in sigma.items())
    smoothing = fit.slope.layout.smoothing
    alone = ": no table or emulator stands in for it"
    if isinstance(fit.slope.laws[0].contacts, Tabulated):
        alone = ""  # the law is a table
    return [
        *([f"The profile is {smoothing}."] if smoothing else []),
        f"{searched.simulated} data sets of {fit.observed.released} blocks, and the "
        f"predictions, were computed by {law}, from the first round to the "
        f"last{alone}.",
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


def _origin(result: SlopeCalibration) -> Table:
    rows = [*_checksums(result).items(), *versions().items()]
    return Table(("file or program", "SHA-256 or version"), rows)


def _checksums(result: SlopeCalibration) -> dict[str, str]:
    files = dict.fromkeys(result.fit.inputs)
    return by_name({f: hashlib.sha256(f.read_bytes()).hexdigest() for f in files})


def as_json(result: SlopeCalibration) -> dict:
    """Collect every number, as a tree of plain values."""
    fit, posterior, predicted = result.fit, result.posterior, result.predicted
    parameters = {
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
    }
    keys = ("percent", "observed", "low", "median", "high")
    held_out = [
        {
            "x_m": p.channel.place,
            "quantity": p.channel.quantity,
            "blocks": p.channel.blocks,
            "percentiles": [dict(zip(keys, r, strict=True)) for r in p.percentiles()],
        }
        for p in predicted.channels
        if p.channel.held_out
    ]
    manifest = {
        "files": _checksums(result),
        "versions": versions() | {"numpy": np.__version__},
        "seed": fit.slope.seed,
        "contacts": fit.slope.laws[0].description,
        "priors": {p.name: [type(p.prior).__name__, *p.prior] for p in fit.parameters},
        "rounds": result.searched.volumes,
        "data_sets": result.searched.simulated,
        "blocks_each": fit.observed.released,
    }
    if smoothing := fit.slope.layout.smoothing:
        manifest["profile"] = smoothing
    return {
        "title": fit.title,
        "parameters": parameters,
        "correlation": posterior.correlation,
        "model_check": predicted.check._asdict() | {"needed": RARE},
        "barriers": barriers_in_json(predicted.barriers),
        "held_out": held_out,
        "warnings": warnings_of(result),
        "manifest": manifest,
    }

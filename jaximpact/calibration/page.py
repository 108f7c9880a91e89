"""The report of a study as a document: verdict first, then what it rests on."""

import dataclasses
import itertools

import numpy as np

from ..accuracy import PRESETS
from ..formats.columns import RESULT_COLUMNS
from ..formats.provenance import versions
from ..identity import name_of
from . import agreement, drawings, further_tests, left_out, residuals
from .document import Block, Box, Heading, Paragraph, Picture, Pictures, Points, Table
from .draws import Draws
from .examination import Examination
from .laws import unusual
from .left_out import LeftOut
from .report import (
    about_cells,
    about_laws,
    about_sigma,
    correlation_rows,
    interval,
    nuisance_rows,
    parameter_rows,
    start_rows,
    starts_in_words,
    statistics,
    target_rows,
    variant_rows,
)
from .reservations import reservations
from .sampling import Samples
from .study import StudyResult, VariantResult
from .uncertainty import USELESS_ERROR

MOST_PAIRS = 3
MOST_ROWS = 12
"""Tests listed of those left out: the worst predicted."""
AGREE = 1.01
"""R-hat up to which chains agree."""
NEARLY_NORMAL = 0.7
"""Part of the draws that count above which the posterior passes for normal."""


def study_page(result: StudyResult, examined: list[Examination]) -> list[Block]:
    """The whole report."""
    study = result.study
    blocks: list[Block] = [Heading(1, study.title)]
    several = len(result.variants) > 1
    for variant, looked in zip(result.variants, examined, strict=True):
        name = f"{variant.variant.name}: " if several else ""
        blocks.append(Box("verdict", verdict(variant, name)))
        doubts = reservations(result, variant, looked)
        if doubts:
            blocks.append(Box("warning", doubts))
    blocks += [Paragraph(line) for line in _about(result)]
    if several:
        blocks += [Heading(2, "Variants"), Table(variant_rows(result))]
    for number, (variant, looked) in enumerate(
        zip(result.variants, examined, strict=True), 1
    ):
        prefix = f"{number}-" if several else ""
        title = f": {variant.variant.name}" if several else ""
        blocks += _variant(result, variant, looked, prefix, title)
    return [*blocks, *_origin(result)]


def verdict(variant: VariantResult, name: str = "") -> list[str]:
    """What the tests determine, and what they do not."""
    known, unknown = [], []
    for place, of_one in enumerate(variant.verdicts):
        if of_one.determined:
            low, high = interval(variant, place)
            known.append(
                f"{of_one.name} = {variant.parameters[place]:.3g} "
                f"(95 %: {low:.3g} to {high:.3g})"
            )
        else:
            unknown.append(f"Not {of_one.name}: {of_one.reason}.")
    if known:
        lines = [f"{name}The tests determine {', '.join(known)}."]
    else:
        lines = [f"{name}The tests determine none of the parameters by itself."]
    lines += unknown
    if unknown and variant.uncertainty.eigenvalues[-1] * USELESS_ERROR**2 > 1.0:
        lines.append(f"Best known of all combinations is {variant.directions[0]}.")
    elif unknown:
        lines.append("Nor do they determine any combination of these.")
    if unknown and known:
        held = ", ".join(v.name for v in variant.verdicts if not v.determined)
        lines.append(
            f"The errors of the others hold near this fit only: they move with {held}."
        )
    return lines


def _about(result: StudyResult) -> list[str]:
    study = result.study
    files = ", ".join(table.path.name for table in study.tests.files)
    known = " ".join((*about_cells(study), about_sigma(study), *about_laws(study)))
    return [
        *([f"Source: {study.source}"] if study.source else []),
        *([study.notes] if study.notes else []),
        f"{len(study.tests)} tests from {files}, fitted to "
        f"{', '.join(study.targets)}. {known}",
    ]


def _variant(result, variant, looked, prefix: str, title: str) -> list[Block]:
    return [
        Heading(2, f"Parameters{title}"),
        *_parameters(result, variant, looked, prefix),
        Heading(2, f"Fit{title}"),
        *_fit(result, variant, looked, prefix),
        Heading(2, f"Residuals{title}"),
        *_residuals(result, variant, looked, prefix),
        *_left_out(result, variant, looked, prefix, title),
        Heading(2, f"Further tests{title}"),
        *_further(looked, prefix),
        Heading(2, f"Starts{title}"),
        *_starts(variant, prefix),
    ]


def _parameters(result, variant, looked, prefix) -> list[Block]:
    draws = looked.draws
    blocks: list[Block] = [
        Table(_with_profiles(variant)),
        Paragraph(
            "Standard errors follow from the curvature of the misfit at the best fit "
            "(Laplace). The profile holds a parameter and fits the others again: where "
            "it disagrees with the standard error, believe the profile."
        ),
        Pictures(
            [
                _picture(
                    f"{prefix}profile-{name}.png",
                    drawings.draw_profile(variant, found),
                    f"Profile of {name}",
                    f"Misfit with {name} held, the others fitted again.",
                )
                for name, found in variant.profiles.items()
            ]
        ),
        Heading(3, "Directions, best known first"),
        Points(variant.directions),
        Heading(3, "Correlation"),
        Table(correlation_rows(variant)),
    ]
    pairs = _pairs(variant)
    if pairs:
        blocks += [
            Pictures(
                [
                    _picture(
                        f"{prefix}pair-{variant.names[a]}-{variant.names[b]}.png",
                        drawings.draw_pair(variant, draws, a, b),
                        f"{variant.names[b]} over {variant.names[a]}",
                        "Dots: what the data allow. Cross: best fit. Line, where both "
                        "are determined: 95 % by the standard errors.",
                    )
                    for a, b in pairs
                ]
            ),
            Paragraph(_about_draws(result, variant, draws)),
        ]
    if looked.samples is not None:
        blocks += _posterior(variant, looked)
    if len(variant.names) > len(variant.verdicts):
        blocks += [
            Heading(3, "Nuisances, under their priors"),
            Table(nuisance_rows(result, variant)),
        ]
    return blocks


def _about_draws(result: StudyResult, variant: VariantResult, draws: Draws) -> str:
    first, last = draws.effective_part[0], draws.effective_part[-1]
    words = f"Of {len(draws.x)} draws about the best fit {100 * first:.0f} % count: "
    unknown = [v.name for v in variant.verdicts if not v.determined]
    if first >= NEARLY_NORMAL and unknown:
        # Draws are made between the bounds, so that cut off there they may all count.
        words += (
            "they follow the posterior between the bounds. But of what is not "
            f"determined, {', '.join(unknown)}, the bounds say where it ends: believe "
            "the verdict, and of the other parameters the dots rather than the "
            "standard errors."
        )
    elif first >= NEARLY_NORMAL:
        words += "the posterior is nearly normal, and standard errors tell its shape."
    else:
        words += (
            "the posterior is not normal, and the dots tell more than the standard "
            "errors."
        )
    if len(draws.effective_part) > 1:
        words += f" Of those drawn anew {100 * last:.0f} %."
    if not np.all(result.study.sigma_given):
        words += (
            " The draws take the estimated scatter of a target for the same in all "
            "tests, or the same part of the value; the standard errors, where "
            "measurements are many, do not."
        )
    return f"{words} {_accuracy(draws)}"


def _posterior(variant: VariantResult, looked: Examination) -> list[Block]:
    samples = looked.samples
    rows = [("parameter", "mean", "median", "95 %", "R-hat", "effective draws")]
    for place in range(len(variant.verdicts)):
        values = samples.values[:, :, place]
        low, middle, high = np.quantile(values, (0.025, 0.5, 0.975))
        rows.append(
            (
                samples.names[place],
                f"{np.mean(values):.4g}",
                f"{middle:.4g}",
                f"{low:.4g} to {high:.4g}",
                f"{samples.scale_reduction[place]:.3f}",
                f"{samples.effective[place]:.0f}",
            )
        )
    chains, count = samples.divergent.shape
    words = (
        f"{chains} chains of {count} draws by NUTS, uniform in the logarithm between "
        "the bounds where no prior is given; the intervals of what the data do not "
        "determine are those of the bounds."
    )
    divergent = int(np.sum(samples.divergent))
    if divergent:
        words += (
            f" {divergent} draws diverged, as they do where an outcome changes: the "
            "posterior beyond may be missed."
        )
    if np.max(samples.scale_reduction) > AGREE:
        words += f" The chains do not agree (R-hat above {AGREE}): draw more."
    words += f" {_accuracy(samples)}"
    return [
        Heading(3, "Posterior"),
        Table(rows),
        Paragraph(words),
        Points(agreement.in_words(variant, looked.draws, samples)),
    ]


def _accuracy(of: Draws | Samples) -> str:
    return (
        f"Impacts at {of.accuracy.name}; of some computed again, closer, costs moved "
        f"apart by at most {of.error:.1g}."
    )


def _with_profiles(variant: VariantResult) -> list[tuple[str, ...]]:
    """The parameters, with the intervals of their profiles."""
    rows = parameter_rows(variant)
    head = (*rows[0][:4], "profile, 68 %", "profile, 95 %", *rows[0][4:])
    found = [head]
    for row, of_one in zip(rows[1:], variant.verdicts, strict=True):
        profile = variant.profiles[of_one.name]
        spans = _span(profile.low, profile.high), _span(profile.low_95, profile.high_95)
        found.append((*row[:4], *spans, *row[4:]))
    return found


def _span(low: float | None, high: float | None) -> str:
    if low is None and high is None:
        return "anything"
    if low is None:
        return f"below {high:.3g}"
    return f"above {low:.3g}" if high is None else f"{low:.3g} to {high:.3g}"


def _pairs(variant: VariantResult) -> list[tuple[int, int]]:
    """Pairs of parameters, the most correlated first."""
    correlation = np.abs(variant.uncertainty.correlation)
    pairs = itertools.combinations(range(len(variant.verdicts)), 2)
    return sorted(pairs, key=lambda pair: -correlation[pair])[:MOST_PAIRS]


def _fit(result, variant, looked, prefix) -> list[Block]:
    rows = target_rows(result, variant)
    if looked.each is not None:
        outside = [_rms_left_out(result, looked.each, p) for p in range(len(rows) - 1)]
        rows = [
            (*row[:2], added, *row[2:])
            for row, added in zip(rows, ["rms left out", *outside], strict=True)
        ]
    alone = drawings.only_varying(result)
    how = f"over {alone}" if alone else "over measured"
    return [
        Table(rows),
        Points(statistics(result, variant)),
        Pictures(
            [
                _picture(
                    f"{prefix}fit-{target}.png",
                    drawings.draw_target(result, variant, looked.bands, place),
                    f"{target}, fitted {how}",
                    f"{target}: {RESULT_COLUMNS[target].meaning}.",
                )
                for place, target in enumerate(result.study.targets)
            ]
        ),
        Paragraph(
            "Bands hold 95 % of what the model gives for the parameters that the data "
            "allow, and of what a measurement with its scatter would give."
        ),
    ]


def _rms_left_out(result: StudyResult, left: LeftOut, place: int) -> str:
    study = result.study
    apart = (left.predicted - study.measured)[:, place]
    apart = apart[(study.censored[:, place] == 0) & np.isfinite(apart)]
    return f"{np.sqrt(np.mean(apart**2)):.4g}" if len(apart) else "none"


def _residuals(result, variant, looked, prefix) -> list[Block]:
    if not np.any(np.isfinite(looked.residuals.values)):
        return [Paragraph("None: the fit takes up all that was measured.")]
    pictures = [
        _picture(
            f"{prefix}residuals-{against}.png",
            drawings.draw_residuals(result, variant, looked.residuals, against),
            f"Residuals over {against}",
            f"Residuals over {against}; grey: two standard deviations.",
        )
        for against in drawings.residual_inputs(variant)
    ]
    pictures.append(
        _picture(
            f"{prefix}residuals-normal.png",
            drawings.draw_quantiles(looked.residuals),
            "Q-Q plot of the residuals",
            "Q-Q plot: on the line, they are normal with the sigmas used.",
        )
    )
    words = residuals.in_words(looked.residuals, variant.objective)
    return [
        Paragraph(
            "Measured less fitted, in standard deviations, each freed of the part that "
            "the fit takes up of it."
        ),
        *([Points(words)] if words else []),
        Pictures(pictures),
    ]


def _left_out(result, variant, looked, prefix, title) -> list[Block]:
    blocks: list[Block] = []
    for left, what, how in (
        (looked.each, "test", "one by one"),
        (looked.campaigns, "campaign", "one by one"),
    ):
        if left is None:
            continue
        blocks += [
            Heading(2, f"Each {what} left out{title}"),
            Paragraph(
                f"Each {what} is predicted by a fit to all others, {how}. The grey "
                "band holds 95 % if the errors are right."
            ),
            Points(left_out.in_words(left, variant.objective, what)),
        ]
        if not np.any(np.isfinite(left.predicted[result.study.censored == 0])):
            continue
        blocks += [
            Pictures(
                [
                    _picture(
                        f"{prefix}left-out-{what}.png",
                        drawings.draw_left_out(result, left),
                        f"Each {what} predicted from the others",
                        f"Measured less predicted by the fit without its {what}.",
                    )
                ]
            ),
            Table(_worst(result, left) if what == "test" else _campaigns(result, left)),
        ]
    return blocks


def _worst(result: StudyResult, left: LeftOut) -> list[tuple[str, ...]]:
    """The measurements predicted worst."""
    study = result.study
    values = left.standardised(study.measured)
    values = np.where(study.censored == 0, values, np.nan)
    rows = [("test", "target", "measured", "predicted", "+-", "standard deviations")]
    order = np.argsort(-np.abs(np.nan_to_num(values)), axis=None)[:MOST_ROWS]
    for test, place in zip(*np.unravel_index(order, values.shape), strict=True):
        if np.isfinite(values[test, place]):
            numbers = (study.measured, left.predicted, left.deviation)
            cells = (f"{part[test, place]:.4g}" for part in numbers)
            name = study.tests.name(test)
            row = (name, study.targets[place], *cells, f"{values[test, place]:+.2f}")
            rows.append(row)
    return rows


def _campaigns(result: StudyResult, left: LeftOut) -> list[tuple[str, ...]]:
    study = result.study
    values = left.standardised(study.measured)
    values = np.where(study.censored == 0, values, np.nan)
    rows = [("campaign", "measurements", "in the band", "mean", "rms")]
    for number, name in enumerate(left.groups):
        of_one = values[left.group == number]
        of_one = of_one[np.isfinite(of_one)]
        inside = np.sum(np.abs(of_one) <= left.quantile)
        numbers = ("none", "none")
        if len(of_one):
            numbers = f"{np.mean(of_one):+.2f}", f"{np.sqrt(np.mean(of_one**2)):.2f}"
        rows.append((name, str(len(of_one)), str(inside), *numbers))
    return rows


def _further(looked: Examination, prefix: str) -> list[Block]:
    single, together = looked.single, looked.together
    criterion = {
        "D": "the mean error over all directions becomes smallest (D-optimal)",
        "A": "the sum of the parameters' variances becomes least (A-optimal)",
    }[single.criterion]
    blocks: list[Block] = [
        Paragraph(
            f"Of {len(single.volumes)} impacts, those chosen one after the other by "
            f"which {criterion}. Errors are relative, or of half the range."
        ),
        Heading(3, "One result measured in each test"),
        Points(further_tests.in_words(single)),
        Table(further_tests.as_rows(single)),
    ]
    if together.ways != single.ways:
        blocks += [
            Heading(3, "All of them measured in each test"),
            Points(further_tests.in_words(together)[:1]),
            Table(further_tests.as_rows(together)),
        ]
    if single.fixed:
        fixed = ", ".join(f"{n} {v:.4g}" for n, v in single.fixed.items())
        blocks.append(Paragraph(f"In common: {fixed}."))
    caption = "What the next test brings, everything measured."
    picture = _picture(
        f"{prefix}further-tests.png",
        drawings.draw_candidates(together),
        "Gain of the next test",
        caption,
    )
    return [*blocks, Pictures([picture])]


def _starts(variant: VariantResult, prefix: str) -> list[Block]:
    return [
        Paragraph(f"{starts_in_words(variant)}."),
        Pictures(
            [
                _picture(
                    f"{prefix}starts.png",
                    drawings.draw_waterfall(variant),
                    "Costs of the starts",
                    "Where each start ended.",
                )
            ]
        ),
        Table(start_rows(variant)),
    ]


def _origin(result: StudyResult) -> list[Block]:
    """What it was computed from and with."""
    study = result.study
    accuracy = dataclasses.asdict(PRESETS[study.accuracy])
    rows = [("what", "value"), ("study", study.path.name)]
    rows += [(t.path.name, f"sha256 {t.sha256}") for t in study.tests.files]
    rows += [(slot, name_of(type(law))) for slot, law in unusual(study.parts).items()]
    for variant in study.variants:
        rows += [
            (f"{slot} of {variant.name}", name_of(type(law)))
            for slot, law in variant.laws.items()
        ]
    rows += [
        ("method", study.method),
        ("loss", study.loss),
        ("starts", f"{study.starts}, seed {study.seed}"),
        ("accuracy", ", ".join(f"{k} {v}" for k, v in accuracy.items())),
        ("impacts computed by", result.engine),
        ("time of the fits, in this run", f"{result.seconds:.0f} s"),
        *((name, version) for name, version in versions().items()),
    ]
    return [
        Heading(2, "Computed from"),
        Table(rows),
        Paragraph(
            "The numbers of this page are in fit.json and fitted.csv. What they mean, "
            "and when not to trust them: docs/calibration.md."
        ),
    ]


def _picture(name: str, figure, description: str, caption: str) -> Picture:
    return Picture(name, drawings.as_png(figure), description, caption)

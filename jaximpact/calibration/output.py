"""The files of a study: report.html, report.md, report.txt, fit.json, fitted.csv and
fit.png."""

import contextlib
import dataclasses
import json
import math
import re
from pathlib import Path

import numpy as np

from ..accuracy import PRESETS
from ..formats.directory import NewFile, output_directory
from ..formats.files import replacing, write_text
from ..formats.provenance import version_of, versions
from ..identity import part_names
from .examination import Examination
from .fitted_ground import FILES
from .further_tests import Suggestions
from .laws import as_entries, unusual
from .left_out import LeftOut
from .proportional import SCATTERS, least_size
from .report import as_text, fit_of_target, interval, standard_error
from .reservations import of_all
from .sampling import Samples, to_inference_data
from .scatter import part_of_size
from .study import StudyResult, VariantResult
from .study_file import Study
from .unknown_scale import freedom_of_targets, weights_of

NUMBERS = re.compile(r"\[\n\s*([^\[\]{}\"]+?)\n\s*\]")
CSV_COLUMNS = (
    *("variant", "row", "file", "target", "limit", "measured", "sigma", "fitted"),
    *("residual", "standardised", "model_low", "model_high", "low", "high"),
    *("left_out", "left_out_deviation"),
)


def study_directory(
    study: Study, out: Path, *, posterior: bool
) -> contextlib.AbstractContextManager[NewFile]:
    """The directory of a study's files; see `output_directory`."""
    names, count = [*FILES], len(study.variants)
    for number in range(1, count + 1):
        # Of the pictures only these are known before the fit.
        prefix = f"{number}-" if count > 1 else ""
        names += [f"report/{prefix}fit-{target}.png" for target in study.targets]
        if posterior:
            names.append(_posterior_name(number, count))
    return output_directory(out, "calibrate", names, inputs=study.inputs)


def write_all(result: StudyResult, examined: list[Examination], new: NewFile) -> None:
    """Write the files, each whole or not at all.

    Args:
        examined: of every variant.
        new: gives the path of a file.

    Raises OSError where the file system refuses.
    """
    # Matplotlib takes half a second to import, which a fit alone need not wait for.
    from .plot import plot_study
    from .report_files import write_report

    write_report(result, examined, new)
    for number, (variant, looked) in enumerate(
        zip(result.variants, examined, strict=True), 1
    ):
        if looked.samples is not None:
            with replacing(new(_posterior_name(number, len(examined)))) as temporary:
                to_inference_data(variant, looked.samples).to_netcdf(str(temporary))
    write_text(new("report.txt"), as_text(result, of_all(result, examined)))
    write_text(new("fit.json"), in_lines(as_json(result, examined)) + "\n")
    write_text(new("fitted.csv"), as_csv(result, examined))
    figure = plot_study(result)
    with replacing(new("fit.png")) as temporary:
        figure.savefig(temporary, dpi=120)


def _posterior_name(number: int, variants: int) -> str:
    return f"posterior-{number}.nc" if variants > 1 else "posterior.nc"


def in_lines(tree: dict) -> str:
    """JSON, a list of numbers in a line: there are thousands."""
    text = json.dumps(tree, indent=1, allow_nan=False)
    # A line end within brackets stands in no string, where it would be escaped.
    return NUMBERS.sub(lambda found: f"[{' '.join(found[1].split())}]", text)


def as_csv(result: StudyResult, examined: list[Examination]) -> str:
    """Fitted against measured, a line for each variant, test and target that holds a
    measurement.

    `row` counts the tests from 1, over all files; `limit` is `>` or `<` where only a
    limit is known. `model_low` and `model_high` hold 95 % of what the model gives for
    the parameters that the data allow, `low` and `high` 95 % of such measurements.
    `left_out` is predicted by the fit to the other tests, with a standard deviation.
    """
    study = result.study
    lines = [",".join(CSV_COLUMNS)]
    for variant, looked in zip(result.variants, examined, strict=True):
        name = _quoted(variant.variant.name)
        nothing = np.full(study.measured.shape, np.nan)
        left, bands = looked.each, looked.bands
        columns = (
            study.measured,
            variant.sigma,
            variant.predicted,
            variant.predicted - study.measured,
            looked.residuals.values,
            bands.low,
            bands.high,
            bands.measured_low,
            bands.measured_high,
            nothing if left is None else left.predicted,
            nothing if left is None else left.deviation,
        )
        for row, place in zip(*np.nonzero(study.known), strict=True):
            limit = {1: ">", -1: "<", 0: ""}[int(study.censored[row, place])]
            file = _quoted(study.tests.place(row)[0].name)
            cells = (name, str(row + 1), file, study.targets[place], limit)
            numbers = (f"{float(column[row, place]):.9g}" for column in columns)
            lines.append(",".join((*cells, *numbers)))
    return "\n".join(lines) + "\n"


def _quoted(text: str) -> str:
    return '"' + text.replace('"', '""') + '"'


def as_json(result: StudyResult, examined: list[Examination]) -> dict:
    """Everything, as a tree of plain values, None for what is not finite."""
    study = result.study
    return {
        "title": study.title,
        "source": study.source,
        "notes": study.notes,
        "sigma_given": dict(
            zip(study.targets, map(bool, study.sigma_given), strict=True)
        ),
        "fitted_tests": _fitted_tests(study),
        "variants": [
            _variant(result, variant) | _examination(result, variant, looked)
            for variant, looked in zip(result.variants, examined, strict=True)
        ],
        "manifest": {
            "study": study.path.name,
            "data": [
                {"file": table.path.name, "sha256": table.sha256}
                for table in study.tests.files
            ],
            "soil": study.soil,
            **_said("block", study.block),
            **_said("parts", as_entries(unusual(study.parts))),
            "laws": part_names(study.tests.base.soil, study.tests.base.block),
            "parameters": {
                p.name: {"start": p.start, "lower": p.lower, "upper": p.upper}
                | ({"prior": dataclasses.asdict(p.prior)} if p.prior else {})
                for p in study.parameters
            },
            "nuisances": {
                n.name: {"by": n.by, "prior": dataclasses.asdict(n.prior)}
                | {"added": n.name in study.tests.inputs}
                | ({"turns_ground": True} if n.turns_ground else {})
                for n in study.nuisances
            },
            "targets": list(study.targets),
            "weights": dict(zip(study.targets, _plain(study.weights), strict=True)),
            "scatter": {
                name: SCATTERS[int(study.proportional[place])]
                for place, name in enumerate(study.targets)
                if not study.sigma_given[place]
            },
            "loss": study.loss,
            "starts": study.starts,
            "seed": study.seed,
            "method": study.method,
            "accuracy": dataclasses.asdict(PRESETS[study.accuracy]),
            "engine": result.engine,
            "versions": versions(),
        },
    }


def _said(key: str, entries: dict) -> dict:
    """An entry of the tree where there is something to say."""
    return {key: entries} if entries else {}


def _fitted_tests(study: Study) -> dict:
    """Where the tests lie, and what they measured on the whole."""
    measured = np.where(study.censored == 0, study.measured, np.nan)
    results = {}
    for place, name in enumerate(study.targets):
        exact = measured[np.isfinite(measured[:, place]), place]
        results[name] = {"count": len(exact)}
        results[name]["mean"] = _plain(np.mean(exact)) if len(exact) else None
        spread = np.std(exact, ddof=1) if len(exact) > 1 else math.nan
        results[name]["standard_deviation"] = _plain(spread)
    ranges = {
        name: [float(np.min(values)), float(np.max(values))]
        for name, values in study.tests.columns(study.soil).items()
    }
    shapes = sorted(set(study.tests.shapes))
    found = {"count": len(study.tests), "ranges": ranges, "shapes": shapes}
    return found | {"results": results}


def _variant(result: StudyResult, variant: VariantResult) -> dict:
    uncertainty = variant.uncertainty
    parameters = {}
    for place, verdict in enumerate(variant.verdicts):
        shown = verdict.determined
        parameters[verdict.name] = {
            "value": float(variant.parameters[place]),
            "determined": shown,
            "standard_error": standard_error(variant, place) if shown else None,
            "interval_95": list(interval(variant, place)) if shown else None,
            "reason": verdict.reason or None,
        }
    count = len(variant.verdicts)
    nuisances = {
        variant.names[place]: {
            "value": float(variant.parameters[place]),
            "standard_error": standard_error(variant, place),
        }
        for place in range(count, len(variant.names))
    }
    freedom = freedom_of_targets(variant.objective, variant.points)
    study = result.study
    part = part_of_size(study, variant.sigma, variant.predicted)
    least = least_size(study.measured)
    fit = {
        name: fit_of_target(result, variant, place)
        | {"sigma": _plain(np.median(variant.sigma[:, place]))}
        | {"degrees_of_freedom": _plain(freedom[place])}
        | (
            {"part_of_size": _plain(part[place]), "least_size": _plain(least[place])}
            if study.proportional[place]
            else {}
        )
        for place, name in enumerate(study.targets)
    }
    order = np.argsort(variant.start_costs, kind="stable")
    return {
        "name": variant.variant.name,
        "soil": variant.variant.soil,
        **_said("parts", as_entries(variant.variant.laws)),
        "parameters": parameters,
        "nuisances": nuisances,
        "unknowns": variant.names,
        "covariance_of_logarithms_or_half_ranges": _plain(uncertainty.covariance),
        "correlation": _plain(uncertainty.correlation[:count, :count]),
        "eigenvalues": _plain(uncertainty.eigenvalues),
        "eigenvectors": _plain(uncertainty.eigenvectors.T),
        "directions": variant.directions,
        "profiles": {
            name: {
                "values": _plain(found.values),
                "rise": _plain(found.rise),
                "low": found.low,
                "high": found.high,
                "low_95": found.low_95,
                "high_95": found.high_95,
            }
            for name, found in variant.profiles.items()
        },
        "fit": fit,
        "cost": variant.cost,
        "degrees_of_freedom": uncertainty.degrees_of_freedom,
        "reduced_chi_square": _plain(uncertainty.reduced_chi_square),
        "inflation": uncertainty.inflation,
        "failed_predictions": variant.failed,
        "stopped": variant.reason.words,
        "starts": [
            {
                "start": _plain(variant.start_parameters[i]),
                "end": _plain(variant.end_parameters[i]),
                "cost": _plain(variant.start_costs[i]),
                "steps": int(variant.start_steps[i]),
                "begun_anew": int(variant.start_anew[i]),
                "found_best": bool(variant.reached[i]),
                "stopped": variant.start_reasons[i].words,
            }
            for i in order
        ],
    }


def _examination(
    result: StudyResult, variant: VariantResult, looked: Examination
) -> dict:
    study = result.study
    return {
        "residuals_follow": [trend._asdict() for trend in looked.residuals.trends],
        "draws": {
            "count": len(looked.draws.x),
            "effective_parts": _plain(looked.draws.effective_part),
            "accuracy": dataclasses.asdict(looked.draws.accuracy),
            "error_of_costs": _plain(looked.draws.error),
            "mean": _plain(looked.draws.mean()),
            "covariance": _plain(looked.draws.covariance()),
            "weights": _short(
                weights_of(variant.objective, variant.points, looked.draws)
            ),
            "values": [_short(row) for row in variant.bounds.parameter(looked.draws.x)],
        },
        "posterior": None if looked.samples is None else _samples(looked.samples),
        "left_out": {
            what: _left_out(study, left)
            for what, left in (("test", looked.each), ("campaign", looked.campaigns))
            if left is not None
        },
        "further_tests": {
            "one_result_each": _further(looked.single),
            "all_results": _further(looked.together),
        },
    }


def _samples(samples: Samples) -> dict:
    low, high = np.quantile(samples.values, (0.025, 0.975), axis=(0, 1))
    about = {
        "blackjax": version_of("blackjax"),
        "accuracy": dataclasses.asdict(samples.accuracy),
        "error_of_log_density": _plain(samples.error),
        "divergent": int(np.sum(samples.divergent)),
        "seconds": samples.seconds,
    }
    return about | {
        name: {
            "mean": _plain(np.mean(samples.values[:, :, place])),
            "standard_deviation": _plain(np.std(samples.values[:, :, place])),
            "interval_95": [_plain(low[place]), _plain(high[place])],
            "scale_reduction": _plain(samples.scale_reduction[place]),
            "effective_draws": _plain(samples.effective[place]),
        }
        for place, name in enumerate(samples.names)
    }


def _left_out(study: Study, left: LeftOut) -> list[dict]:
    values = np.where(study.censored == 0, left.standardised(study.measured), np.nan)
    rows = []
    for number, name in enumerate(left.groups):
        of_one = values[left.group == number]
        rows.append(
            {
                "name": name,
                "standardised": _plain(of_one),
                "fit": _plain(left.x[number]),
                "moved_in_standard_errors": _plain(left.moved[number]),
                "stopped": left.reasons[number].words,
            }
        )
    return rows


def _further(found: Suggestions) -> dict:
    return {
        "criterion": found.criterion,
        "measure": {name: sigma._asdict() for name, sigma in found.measure.items()},
        "in_common": found.fixed,
        "errors_now": dict(zip(found.names, _plain(found.now), strict=True)),
        "errors_of_the_bounds": found.stood_in,
        "chosen": [
            {
                "test": one.scene,
                "measured": one.measured,
                "expected": {n: _plain(v) for n, v in one.predicted.items()},
                "errors": dict(zip(found.names, _plain(one.errors), strict=True)),
                "divided_by": dict(zip(found.names, _plain(one.factors), strict=True)),
                "mean_divided_by": one.volume,
            }
            for one in found.chosen
        ],
        "candidates_without_result": found.left_out,
    }


def _short(values) -> list[float]:
    """Numbers with the digits that random ones need."""
    return [float(f"{value:.6g}") for value in values]


def _plain(values):
    """Arrays as lists of floats, None for what is not finite."""
    if np.ndim(values):
        return [_plain(value) for value in values]
    return float(values) if math.isfinite(values) else None

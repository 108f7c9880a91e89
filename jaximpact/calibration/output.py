"""The files of a study: report.txt, fit.json, fitted.csv and fit.png."""

import dataclasses
import json
import math
from pathlib import Path

import numpy as np

from ..accuracy import PRESETS
from ..errors import InputError
from ..files import replacing
from ..provenance import versions
from .plot import plot_study
from .report import as_text, fit_of_target, interval, standard_error
from .study import StudyResult, VariantResult


def make_directory(path: Path) -> None:
    """Make the directory; InputError where that cannot be."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"--out {path} cannot be made: {error.strerror}") from error


def write_all(result: StudyResult, out: Path) -> None:
    """Write the four files, each whole or not at all.

    Raises OSError where the file system refuses.
    """
    with replacing(out / "report.txt") as temporary:
        temporary.write_text(as_text(result), encoding="utf-8")
    with replacing(out / "fit.json") as temporary:
        text = json.dumps(as_json(result), indent=1, allow_nan=False)
        temporary.write_text(text + "\n", encoding="utf-8")
    with replacing(out / "fitted.csv") as temporary:
        temporary.write_text(as_csv(result), encoding="utf-8")
    figure = plot_study(result)
    with replacing(out / "fit.png") as temporary:
        figure.savefig(temporary, dpi=120)


def as_csv(result: StudyResult) -> str:
    """Fitted against measured, a line for each variant, test and target that holds a
    measurement.

    `row` counts the tests from 1, over all files; `limit` is `>` or `<` where only a
    limit is known.
    """
    study = result.study
    lines = ["variant,row,file,target,limit,measured,sigma,fitted,residual"]
    for variant in result.variants:
        name = _quoted(variant.variant.name)
        for row, place in zip(*np.nonzero(study.known), strict=True):
            fitted, measured = variant.predicted[row, place], study.measured[row, place]
            limit = {1: ">", -1: "<", 0: ""}[int(study.censored[row, place])]
            numbers = (measured, variant.sigma[row, place], fitted, fitted - measured)
            file = _quoted(study.tests.place(row)[0].name)
            cells = (name, str(row + 1), file, study.targets[place], limit)
            lines.append(",".join((*cells, *(f"{float(x):.9g}" for x in numbers))))
    return "\n".join(lines) + "\n"


def _quoted(text: str) -> str:
    return '"' + text.replace('"', '""') + '"'


def as_json(result: StudyResult) -> dict:
    """Everything, as a tree of plain values, None for what is not finite."""
    study = result.study
    return {
        "title": study.title,
        "source": study.source,
        "notes": study.notes,
        "sigma_given": dict(
            zip(study.targets, map(bool, study.sigma_given), strict=True)
        ),
        "variants": [_variant(result, variant) for variant in result.variants],
        "manifest": {
            "study": study.path.name,
            "data": [
                {"file": table.path.name, "sha256": table.sha256}
                for table in study.tests.files
            ],
            "soil": study.soil,
            "parameters": {
                p.name: {"start": p.start, "lower": p.lower, "upper": p.upper}
                | ({"prior": dataclasses.asdict(p.prior)} if p.prior else {})
                for p in study.parameters
            },
            "nuisances": {
                n.name: {"by": n.by, "prior": dataclasses.asdict(n.prior)}
                for n in study.nuisances
            },
            "targets": list(study.targets),
            "weights": dict(zip(study.targets, _plain(study.weights), strict=True)),
            "loss": study.loss,
            "starts": study.starts,
            "seed": study.seed,
            "method": study.method,
            "accuracy": dataclasses.asdict(PRESETS[study.accuracy]),
            "engine": result.engine,
            "versions": versions(),
        },
    }


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
    fit = {
        name: fit_of_target(result, variant, place)
        | {"sigma": _plain(np.median(variant.sigma[:, place]))}
        for place, name in enumerate(result.study.targets)
    }
    order = np.argsort(variant.start_costs, kind="stable")
    return {
        "name": variant.variant.name,
        "soil": variant.variant.soil,
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
                "found_best": bool(variant.reached[i]),
                "stopped": variant.start_reasons[i].words,
            }
            for i in order
        ],
    }


def _plain(values):
    """Arrays as lists of floats, None for what is not finite."""
    if np.ndim(values):
        return [_plain(value) for value in values]
    return float(values) if math.isfinite(values) else None

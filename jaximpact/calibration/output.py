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
from .report import as_text, fit_of_target, standard_error
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
    """Fitted against measured, a line for each variant, test and target.

    `row` counts the tests from 1.
    """
    study = result.study
    lines = ["variant,row,target,measured,sigma,fitted,residual"]
    for variant in result.variants:
        name = '"' + variant.variant.name.replace('"', '""') + '"'
        for (row, place), measured in np.ndenumerate(study.measured):
            fitted = variant.predicted[row, place]
            numbers = (measured, study.sigma[row, place], fitted, fitted - measured)
            cells = (name, str(row + 1), study.targets[place])
            lines.append(",".join((*cells, *(f"{float(x):.9g}" for x in numbers))))
    return "\n".join(lines) + "\n"


def as_json(result: StudyResult) -> dict:
    """Everything, as a tree of plain values, None for what is not finite."""
    study = result.study
    return {
        "title": study.title,
        "source": study.source,
        "notes": study.notes,
        "sigma_given": study.sigma_given,
        "variants": [_variant(result, variant) for variant in result.variants],
        "manifest": {
            "study": study.path.name,
            "data": {"file": study.table.path.name, "sha256": study.table.sha256},
            "soil": study.soil,
            "parameters": {
                p.name: {"start": p.start, "lower": p.lower, "upper": p.upper}
                for p in study.parameters
            },
            "targets": list(study.targets),
            "starts": study.starts,
            "seed": study.seed,
            "method": study.method,
            "accuracy": dataclasses.asdict(PRESETS[study.accuracy]),
            "versions": versions(),
        },
    }


def _variant(result: StudyResult, variant: VariantResult) -> dict:
    uncertainty = variant.uncertainty
    parameters = {}
    for place, verdict in enumerate(variant.verdicts):
        error = standard_error(variant, place) if verdict.determined else None
        parameters[verdict.name] = {
            "value": float(variant.parameters[place]),
            "determined": verdict.determined,
            "standard_error": error,
            "reason": verdict.reason or None,
        }
    fit = {
        name: fit_of_target(result, variant, place)
        for place, name in enumerate(result.study.targets)
    }
    order = np.argsort(variant.start_costs, kind="stable")
    return {
        "name": variant.variant.name,
        "soil": variant.variant.soil,
        "parameters": parameters,
        "correlation": _plain(uncertainty.correlation),
        "eigenvalues": _plain(uncertainty.eigenvalues),
        "eigenvectors": _plain(uncertainty.eigenvectors.T),
        "directions": variant.directions,
        "profiles": {
            name: {
                "values": _plain(found.values),
                "rise": _plain(found.rise),
                "low": found.low,
                "high": found.high,
            }
            for name, found in variant.profiles.items()
        },
        "fit": fit,
        "cost": variant.cost,
        "degrees_of_freedom": uncertainty.degrees_of_freedom,
        "reduced_chi_square": _plain(uncertainty.reduced_chi_square),
        "failed_predictions": variant.failed,
        "stopped": variant.reason,
        "starts": [
            {
                "parameters": _plain(variant.start_parameters[i]),
                "cost": _plain(variant.start_costs[i]),
                "steps": int(variant.start_steps[i]),
                "stopped": variant.start_reasons[i],
            }
            for i in order
        ],
    }


def _plain(values):
    """Arrays as lists of floats, None for what is not finite."""
    if np.ndim(values):
        return [_plain(value) for value in values]
    return float(values) if math.isfinite(values) else None

"""Files of a calibration: report.html, fit.json and fitted.csv."""

import contextlib
import itertools
from pathlib import Path

import numpy as np

from ..._packages import version_of, versions
from ...accuracy import PRESETS
from ...identity import part_names
from ...io.files import replacing, write_text
from ...io.output_files import NewFile, output_directory, together
from ...reports.json_tree import json_text, plain
from ...reports.tables import Table
from ..comparison.comparison import NO_OTHERS, OtherLaws
from ..diagnostics.examination import Examination, fit_of_target
from ..diagnostics.nuts import to_inference_data
from ..diagnostics.posterior import Draws
from ..diagnostics.results import StudyResult, VariantResult
from ..estimation.sigma import (
    freedom_of_targets,
    median_sigma,
    relative_sigma,
    sigma_factors,
)
from ..fitted_ground import FILES, FORMAT
from ..problem.config import Study
from ..problem.dataset import LIMITS
from ..problem.laws import as_entries, unusual
from ..problem.noise import SCATTERS
from ..problem.nuisance import entries_of
from .comparison import comparison_csv, comparison_json

COMPARISON = "comparison.csv"
"""Name of the table of a comparison of laws."""
CSV_COLUMNS = (
    *("variant", "row", "file", "test", "target", "limit", "measured", "sigma"),
    *("fitted", "residual", "standardised", "model_low", "model_high", "low", "high"),
    *("left_out", "left_out_deviation"),
)
SUGGESTED = (
    *("names", "criterion", "measure", "fixed", "now", "undetermined", "stood_in"),
    *("chosen", "left_out"),
)
"""What fit.json has of suggested tests: all but the many candidates."""
OF_VARIANT = (
    *("cost", "failed", "uncertainty", "errors_of_draws", "directions", "profiles"),
    *("end_parameters", "end_costs", "end_reasons", "end_steps"),
    *("members", "agreed", "found_later"),
)
"""What fit.json has of a variant as it is."""
SETTINGS = ("soil", "block", "targets", "loss", "starts", "seed", "method")
"""What fit.json has of a study as it is."""


def study_directory(
    study: Study, out: Path, *, posterior: bool, compared: bool
) -> contextlib.AbstractContextManager[NewFile]:
    """Open the directory of a study's files; see `output_directory`."""
    names = [*FILES, *([COMPARISON] if compared else [])]
    names += _posterior_names(study) if posterior else []
    return output_directory(out, "calibrate", names, inputs=study.inputs)


def write_all(
    result: StudyResult, examined: list[Examination], new: NewFile, others: OtherLaws
) -> None:
    """Write the files, all of them or none; OSError where the file system refuses."""
    # Matplotlib takes half a second to import, which workers need not.
    from .study_report import study_report

    report = study_report(result, examined, others.compared)
    with together(new) as add:
        write_text(add("report.html"), report.page())
        write_text(add("fit.json"), json_text(as_json(result, examined, others)))
        write_text(add("fitted.csv"), fitted_table(result, examined).csv())
        names = _posterior_names(result.study)
        stale = {COMPARISON, *names}
        if others.compared is not None:
            write_text(add(COMPARISON), comparison_csv(others.compared))
            stale.remove(COMPARISON)
        each = zip(names, result.variants, examined, strict=True)
        for name, variant, diagnostics in each:
            if diagnostics.samples is not None:
                sampled = to_inference_data(variant, diagnostics.samples)
                with replacing(add(name)) as temporary:
                    sampled.to_netcdf(str(temporary))
                stale.remove(name)
    # An earlier run with other options may have left them: they are of another fit.
    for name in stale:
        new(name).unlink(missing_ok=True)


def _posterior_names(study: Study) -> list[str]:
    count = len(study.variants)
    numbered = [f"posterior-{number}.nc" for number in range(1, count + 1)]
    return numbered if count > 1 else ["posterior.nc"]


def fitted_table(result: StudyResult, examined: list[Examination]) -> Table:
    """Write fitted.csv: a line for each variant, and each measurement of the tests.

    `row` is that of the file, whose header is row 1; `file` has folders where two have
    one name. `test` is the name of the test, with the time of a force. `limit` is `>`
    or `<` where only a limit is known. `residual` is fitted less measured,
    `standardised` the same in units of its standard deviation. `model_low` and
    `model_high` include 95 % of the model's values for the parameters that the tests
    allow, `low` and `high` 95 % of such measurements. `left_out` is predicted by the
    fit to the other tests, with a standard deviation.
    """
    study, rows = result.study, []
    files = study.tests.file_names
    for variant, diagnostics in zip(result.variants, examined, strict=True):
        left, bands = diagnostics.each, diagnostics.bands
        columns = [
            *(study.measured, variant.sigma, variant.predicted),
            *(variant.predicted - study.measured, -diagnostics.residuals.values),
            *(bands.low, bands.high, bands.measured_low, bands.measured_high),
        ]
        nothing = [np.full(study.measured.shape, np.nan)] * 2
        columns += nothing if left is None else [left.predicted, left.deviation]
        rows += [
            (
                *(variant.variant.name, line, files[path], study.tests.name(row)),
                *(study.targets[target], LIMITS[int(study.censored[row, target])]),
                *(column[row, target] for column in columns),
            )
            for row, target in zip(*np.nonzero(study.known), strict=True)
            for path, line in [study.tests.place(row)]
        ]
    return Table(CSV_COLUMNS, rows)


def as_json(
    result: StudyResult, examined: list[Examination], others: OtherLaws = NO_OTHERS
) -> dict:
    """Collect every number, as a tree of plain values; None for what is not finite."""
    study, compared = result.study, others.compared
    tree = {
        "format": FORMAT,
        "title": study.title,
        "source": study.source,
        "notes": study.notes,
        "sigma_given": dict(zip(study.targets, study.sigma_given, strict=True)),
        "fitted_tests": _fitted_tests(study),
        "variants": [
            _variant(result, variant) | _examination(variant, diagnostics)
            for variant, diagnostics in zip(result.variants, examined, strict=True)
        ],
        "simple_laws": [law.as_json() for law in others.simple],
        "comparison": None if compared is None else comparison_json(compared),
        "manifest": _manifest(result),
    }
    return plain(tree)


def _manifest(result: StudyResult) -> dict:
    study = result.study
    return {
        "study": study.path.name,
        "data": study.tests.checksums,
        **{name: getattr(study, name) for name in SETTINGS},
        "parts": as_entries(unusual(study.parts)),
        "laws": part_names(study.tests.base.soil, study.tests.base.block),
        "parameters": {parameter.name: parameter for parameter in study.parameters},
        "tied": {
            tied.name: {"expression": tied.text, "constants": tied.constants}
            for tied in study.tied
        },
        "nuisances": entries_of(study.nuisances, study.tests),
        "weights": dict(zip(study.targets, study.weights, strict=True)),
        "scatter": {
            name: SCATTERS[int(study.proportional[target])]
            for target, name in enumerate(study.targets)
            if not study.sigma_given[target] and name not in study.scatter_open
        },
        "accuracy": PRESETS[study.accuracy],
        "engine": result.engine,
        "versions": versions(),
    }


def _fitted_tests(study: Study) -> dict:
    results = {}
    for target, name in enumerate(study.targets):
        exact = study.measured[study.exact[:, target], target]
        results[name] = {
            "count": len(exact),
            "mean": np.mean(exact) if len(exact) else None,
            "standard_deviation": np.std(exact, ddof=1) if len(exact) > 1 else None,
        }
    group, measured = study.each_test()
    columns = study.tests.columns(study.stated)
    columns = {name: values[group >= 0] for name, values in columns.items()}
    shapes = itertools.compress(study.tests.shapes, group >= 0)
    return {
        "count": len(measured),
        "ranges": {n: (np.min(v), np.max(v)) for n, v in columns.items()},
        "shapes": sorted(set(shapes)),
        "results": results,
    }


def _variant(result: StudyResult, variant: VariantResult) -> dict:
    return {
        "name": variant.variant.name,
        "soil": variant.variant.soil,
        "parts": as_entries(variant.variant.laws),
        "unknowns": variant.names,
        "parameters": parameter_entries(variant),
        "nuisances": {
            variant.names[index]: {
                "value": variant.parameters[index],
                "standard_error": variant.standard_error(index),
            }
            for index in range(len(variant.verdicts), len(variant.names))
        },
        "fit": _targets(result, variant),
        "stopped": variant.reason,
        **{name: getattr(variant, name) for name in OF_VARIANT},
    }


def parameter_entries(variant: VariantResult) -> dict[str, dict]:
    """Collect value, standard error, interval and verdict of each parameter."""
    entries = {}
    for index, verdict in enumerate(variant.verdicts):
        known = verdict.determined
        entries[verdict.name] = {
            "value": variant.parameters[index],
            "determined": known,
            "standard_error": variant.standard_error(index) if known else None,
            "interval_95": variant.interval(index) if known else None,
            "reason": verdict.reason or None,
        }
    return plain(entries)


def _targets(result: StudyResult, variant: VariantResult) -> dict:
    study = variant.objective.study
    freedom = freedom_of_targets(variant.objective, variant.points)
    relative = relative_sigma(study, variant.sigma, variant.predicted)
    typical = median_sigma(study, variant.sigma)
    least, factors = study.least_size, sigma_factors(variant.objective)
    fit = {}
    for target, name in enumerate(study.targets):
        fit[name] = fit_of_target(result, variant, target) | {
            "sigma": typical[target],
            "degrees_of_freedom": freedom[target],
        }
        if name in factors:
            fit[name]["times_given_sigma"] = factors[name]
        if study.proportional[target]:
            fit[name]["part_of_size"] = relative[target]
            fit[name]["least_size"] = least[target]
    return fit


def _examination(variant: VariantResult, diagnostics: Examination) -> dict:
    samples = diagnostics.samples
    further = {"one_result_each": diagnostics.single}
    further["all_results"] = diagnostics.together
    return {
        "biases": diagnostics.residuals.biases,
        "trends": diagnostics.residuals.trends,
        "draws": _draws(variant, diagnostics.posterior, diagnostics.weights),
        "posterior": None if samples is None else _samples(variant, samples),
        "left_out": {"test": diagnostics.each, "campaign": diagnostics.campaigns},
        "discrepancy": diagnostics.discrepancy,
        "further_tests": {
            what: {name: getattr(suggestions, name) for name in SUGGESTED}
            for what, suggestions in further.items()
        },
    }


def _draws(variant: VariantResult, draws: Draws, weights: np.ndarray) -> dict:
    return {
        "count": len(draws.x),
        "effective_parts": draws.effective_fraction,
        "accuracy": draws.accuracy,
        "error_of_costs": draws.error,
        "mean": draws.mean(),
        "covariance": draws.covariance(),
        "weights": _short(weights),
        "values": [_short(row) for row in variant.bounds.parameter(draws.x)],
    }


def _samples(variant: VariantResult, samples: Draws) -> dict:
    chains, values = samples.chains, variant.bounds.parameter(samples.x)
    assert chains is not None
    return {
        "blackjax": version_of("blackjax"),
        "accuracy": samples.accuracy,
        "error_of_log_density": samples.error,
        "divergent": np.sum(chains.statistics["diverging"]),
        "seconds": chains.seconds,
        "mean": np.mean(values, axis=0),
        "standard_deviation": np.std(values, axis=0),
        "interval_95": np.quantile(values, (0.025, 0.975), axis=0).T,
        "scale_reduction": chains.scale_reduction,
        "effective_draws": chains.effective,
    }


def _short(values) -> list[float]:
    """Convert random numbers to floats of the six digits that they need."""
    return [float(f"{value:.6g}") for value in values]

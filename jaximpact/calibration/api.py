"""Calibration and prediction in one call each: tests in, soil parameters out."""

import contextlib
import dataclasses
import os
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .._checks import expect
from .._precision import require_float64
from .._settings import numpy_settings
from ..errors import InputError, check_choice
from ..parameters import Part
from ..progress import tell, within
from ..progress_lines import ProgressChoice, showing
from ..quantities import columns_of_part
from ..scene import Block, Soil
from .arguments import study_of_arguments, table_given
from .comparison.comparison import NO_OTHERS, OtherLaws, check_comparison, compare_study
from .comparison.fitted_law import fit_simple
from .diagnostics.examination import Examination, examine
from .diagnostics.nuts import check_extra
from .diagnostics.results import StudyResult, VariantResult
from .fitted_ground import FittedGround, files_of_fit, fitted_of, read_fitted
from .prediction import PredictedTests, predict_tests
from .problem.config import CompareTable, Study, read_study
from .problem.dataset import joined_tables
from .problem.laws import scene_of
from .report.contents import summary
from .report.files import as_json, parameter_entries, study_directory, write_all
from .report.parameters import parameter_table
from .report.prediction import (
    prediction_report,
    prediction_table,
    write_prediction,
)
from .study import fit_study

if TYPE_CHECKING:  # both take a while to load
    import pandas as pd
    import xarray as xr


class Calibration:
    """Result of `calibrate`; `print` it.

    Args:
        result: fits of the study.
        examined: diagnostics of every variant.
        others: laws beside those of the study.
    """

    def __init__(
        self,
        result: StudyResult,
        examined: list[Examination],
        others: OtherLaws = NO_OTHERS,
    ):
        self.result, self.examined, self.others = result, examined, others

    def __repr__(self) -> str:
        lines = [f"<Calibration: {self.result.study.tests.described}"]
        for variant in self.result.variants:
            lines += [f"{variant.variant.name}:"] if len(self.variants) > 1 else []
            lines.append(parameter_table(variant).text())
        return "\n".join(lines) + ">"

    @numpy_settings()
    def __str__(self) -> str:
        return self.summary()

    def _repr_html_(self) -> str:
        return summary(self.result, self.examined).html()

    def summary(self) -> str:
        """Summarise the fit: values with standard errors or why they are not
        identifiable, correlations, errors, verdict and warnings."""
        return summary(self.result, self.examined).text()

    @property
    def variants(self) -> tuple[str, ...]:
        """Names of the variants; there is one unless a study file has more."""
        return tuple(variant.variant.name for variant in self.result.variants)

    @property
    def soil(self) -> Soil:
        """Fitted ground, ready for `simulate`; of several variants, use `soil_of`."""
        return self.soil_of()

    def soil_of(self, variant: str | None = None) -> Soil:
        """Return the fitted ground of a variant, with its laws.

        Parameters that are not identifiable have the value of the best fit, which is
        one of many of equal cost. Nuisance parameters are left out.

        Raises InputError if the tests do not share one ground.
        """
        fitted, study = self._chosen(variant), self.result.study
        soil, fields = fitted.objective.scene.soil, {}
        columns = columns_of_part("soil", soil)
        for name, column in columns.items():
            of_tests = np.unique(np.asarray(getattr(soil, column.field)))
            if len(of_tests) > 1:
                raise InputError(
                    f"{name} differs from test to test; there is no one soil"
                )
            fields[column.field] = float(of_tests[0])
        names = (parameter.name for parameter in study.parameters)
        values = dict(zip(names, fitted.parameters, strict=False))
        values |= {tied.name: tied.evaluate(values) for tied in study.tied}
        for name, value in values.items():
            fields[columns[name].field] = columns[name].factor * float(value)
        return dataclasses.replace(soil, **fields)

    @property
    def parameters(self) -> dict[str, dict]:
        """Dictionary of each parameter: `value`, `determined` (whether it is
        identifiable), `standard_error` and `interval_95` (None if not) and `reason`
        (why not); of several variants, use `parameters_of`."""
        return self.parameters_of()

    @numpy_settings()
    def parameters_of(self, variant: str | None = None) -> dict[str, dict]:
        """Return the parameters of a variant."""
        return parameter_entries(self._chosen(variant))

    @numpy_settings()
    def as_json(self) -> dict:
        """Return every number, as in fit.json."""
        return as_json(self.result, self.examined, self.others)

    @numpy_settings()
    def to_dataframe(
        self, table: str = "parameters", variant: str | None = None
    ) -> "pd.DataFrame":
        """Make a table of a variant.

        Args:
            table: "parameters": values, standard errors, 95 % intervals (NaN where one
                reaches the bound), bounds, and whether each is identifiable;
                "covariance" and "correlation" of all unknowns; "profiles": likelihood
                ratios over the values at which a parameter was fixed; "draws" of the
                posterior, with a `weight`; "residuals": measurements, fits and
                residuals.
            variant: its name; of one variant it is not needed.

        Raises InputError for an unknown name.
        """
        from .report.frames import frame_of

        return frame_of(self._fit(variant), table)

    @numpy_settings()
    def to_xarray(self, variant: str | None = None) -> "xr.Dataset":
        """Make a dataset of a variant: values, standard errors, 95 % intervals, whether
        each is identifiable or the reason, covariance and correlation over `parameter`;
        `draws` and their `weight` over `draw`; measurements, `limit` (`>` or `<` where
        only a limit is known), fits, sigmas and residuals over `test` and `target`.
        Nuisances have no interval, and count as identifiable.
        """
        from .report.frames import dataset_of

        return dataset_of(self._fit(variant))

    @numpy_settings()
    def plot(self, path: str | os.PathLike | None = None, *, ax=None):
        """Draw the fit of every target, and return the axes, one for each.

        Args:
            path: file to save the figure in too; replaced once the new one is whole.
            ax: axes to draw on, as many as there are panels. Without axes and path the
                figure is one of `matplotlib.pyplot`, which notebooks show.
        """
        return self._plotted("draw_study", [self.result], path, ax)

    @numpy_settings()
    def plot_profile(
        self,
        parameter: str,
        path: str | os.PathLike | None = None,
        *,
        ax=None,
        variant: str | None = None,
    ):
        """Draw the likelihood profile of a parameter; otherwise as `plot`."""
        of = self._chosen(variant)
        check_choice("parameter", parameter, of.profiles)
        return self._plotted("draw_profile", [of, of.profiles[parameter]], path, ax)

    @numpy_settings()
    def plot_residuals(
        self,
        against: str = "prediction",
        path: str | os.PathLike | None = None,
        *,
        ax=None,
        variant: str | None = None,
    ):
        """Draw studentised residuals over the prediction, or over a column of the
        tests; otherwise as `plot`."""
        result, of, examined = self._fit(variant)
        known = ("prediction", *result.study.tests.inputs)
        check_choice("against", against, known)
        residuals = [result, of, examined.residuals, against]
        return self._plotted("draw_residuals", residuals, path, ax)

    @numpy_settings()
    def plot_draws(
        self,
        first: str,
        second: str,
        path: str | os.PathLike | None = None,
        *,
        ax=None,
        variant: str | None = None,
    ):
        """Draw two parameters of the posterior; otherwise as `plot`."""
        _, of, examined = self._fit(variant)
        for name in (first, second):
            check_choice("parameter", name, of.profiles)
        pair = [of.names.index(name) for name in (first, second)]
        return self._plotted("draw_pair", [of, examined, *pair], path, ax)

    def _plotted(self, drawing: str, of: list, path, ax):
        from ..plotting.style import plotted
        from .report import drawings

        return plotted(partial(getattr(drawings, drawing), *of), path, ax)

    @numpy_settings()
    def write(self, out: str | os.PathLike) -> None:
        """Write the report and its numbers, as `jaximpact calibrate` does."""
        with study_directory(
            self.result.study,
            Path(out),
            posterior=any(one.samples is not None for one in self.examined),
            compared=self.others.compared is not None,
        ) as new:
            write_all(self.result, self.examined, new, self.others)

    def _chosen(self, name: str | None) -> VariantResult:
        return self._fit(name)[1]

    def _fit(self, name: str | None) -> tuple[StudyResult, VariantResult, Examination]:
        if name is None and len(self.variants) > 1:
            raise InputError(
                f"there are several variants; name one of {', '.join(self.variants)}"
            )
        index = 0 if name is None else self.result.study.index_of(name)
        return self.result, self.result.variants[index], self.examined[index]


class Prediction(PredictedTests):
    """Result of `predict`; `print` it."""

    __slots__ = ()

    def __repr__(self) -> str:
        return f"<Prediction: {str(self).strip()}>"

    @numpy_settings()
    def __str__(self) -> str:
        return prediction_report(self).text()

    def _repr_html_(self) -> str:
        return prediction_report(self).html()

    @numpy_settings()
    def to_dataframe(self) -> "pd.DataFrame":
        """Make a table with one row for each variant, test and target, as `write` does:
        the measurement, the value at the `best_fit`, the median `predicted` with its
        50 % and 95 % intervals, and scores."""
        return prediction_table(self).frame()

    @numpy_settings()
    def to_xarray(self) -> "xr.Dataset":
        """Make a dataset of the same over `variant`, `test` and `target`."""
        from .report.frames import dataset_of_predictions

        return dataset_of_predictions(self)

    @numpy_settings()
    def plot(self, path: str | os.PathLike | None = None, *, ax=None, variant: int = 0):
        """Draw the predictions of each target, test by test, with 50 % and 95 %
        intervals, and what was measured; return the axes, one for each target.

        Args:
            path, ax: as for `Calibration.plot`.
            variant: number of the variant, from 0.
        """
        from ..plotting.style import plotted
        from .report.drawings import draw_predictions

        chosen = self.variants[variant]
        return plotted(partial(draw_predictions, self, chosen), path, ax)

    @numpy_settings()
    def write(self, path: str | os.PathLike) -> None:
        """Write a table of all predictions, with scores and origin beside it.

        Raises InputError for a path that would replace a file the predictions were made
        from.
        """
        write_prediction(self, Path(path))


@numpy_settings()
def calibrate(
    tests: str | os.PathLike | Mapping,
    *,
    fit: Iterable[str] | Mapping[str, dict] | None = None,
    ground: Soil | Mapping[str, float | str | Part] | None = None,
    block: Block | Mapping[str, float | str | Part] | None = None,
    targets: Iterable[str] | None = None,
    sigma: Mapping[str, float] | None = None,
    scatter: str | Mapping[str, str] | None = None,
    weights: Mapping[str, float] | None = None,
    loss: str | None = None,
    nuisance: Mapping[str, Mapping] | None = None,
    variants: Sequence[Mapping] | None = None,
    starts: int | None = None,
    method: str | None = None,
    accuracy: str | None = None,
    out: str | os.PathLike | None = None,
    seed: int | None = None,
    progress: ProgressChoice = None,
) -> Calibration:
    """Fit ground parameters to measured impacts, and judge which are identifiable.

    Args:
        tests: path of a table of tests (CSV), or its columns: a dictionary or a data
            frame. Columns are those of `jaximpact batch`, in and out, with `sigma_` of
            results; `docs/calibration.md` shows one. Or path of a study (`.toml`),
            which states all other arguments itself.
        fit: soil columns to be fitted; or a table of each as in a study file:
            `{"c_v": {}, "alpha_s": {"lower": 0.1, "upper": 2.0}}`, with `start` and
            `prior`; also parameters of the ground's own laws. Default: c_v, gamma_v and
            k_E between default bounds; other parameters need theirs.
        ground: laws, and soil parameters that are not fitted, by column in its unit:
            `{"flow": MyFlow(), "beta": 0.8}`, a law also by its name,
            `"my_laws.py:MyFlow"`; or a `Soil`: columns of the table take precedence,
            and fitted parameters start at its values. Default: Table 1 of the paper.
        block: shape and parameters of the block that all tests have in common and the
            table does not state, in the same way. Default: an ellipsoid.
        targets: result columns to fit. Default: all in the table.
        sigma: standard deviation of a target's measurements, where the table has no
            column for it. Default: estimated from the residuals.
        scatter: "constant" or "proportional", one for all targets whose sigma is
            estimated, or of each: whether sigma is the same in all tests, or the same
            fraction of the value. Default: "constant", or the better of the two for
            targets whose values span a decade.
        weights: weight of a target's losses. Default: 1.
        loss: "gaussian", or for tests with outliers "soft-l1" or "student". Default:
            "gaussian".
        nuisance: what nobody measured, fitted for each group of tests, a table of each
            as under `[nuisance]` of a study file:
            `{"slope_deg": {"by": "campaign", "prior": {"mean": 30.0, "sd": 3.0}}}`.
        variants: fits with other laws or fixed values, a table of each, as
            `[[variants]]` of a study file: `[{"dilatancy": 0.0}, {"dilatancy": 1.0}]`.
        starts: size of the population that searches; 1 fits from the start alone.
            Default: 48.
        method: "trust-region", "adam" or "l-bfgs". Default: "trust-region".
        accuracy: of the impacts: "fast", "balanced" or "reference". Default:
            "reference".
        out: directory for the report.
        seed: seed of starts and draws. Default: 0.
        progress: called with lines of text; False for none. Default: lines on stderr.

    Takes some ten seconds. Equal arguments give equal numbers on one machine.

    Raises InputError, naming file, row and column, for input that cannot be used;
    RuntimeError if JAX is set to float32.
    """
    require_float64()
    options = dict(fit=fit, ground=ground, block=block, targets=targets)
    options |= dict(sigma=sigma, scatter=scatter, weights=weights, loss=loss)
    options |= dict(nuisance=nuisance, variants=variants, starts=starts)
    options |= dict(method=method, accuracy=accuracy, seed=seed)
    study = study_of_arguments(tests, options)
    expect("out", out, str, os.PathLike, type(None))
    directory = None if out is None else Path(out)
    with showing(progress):
        return Calibration(*fit_and_examine(study, directory))


@numpy_settings()
def predict(
    result: Calibration | str | os.PathLike,
    tests: str | os.PathLike | Mapping,
    *,
    progress: ProgressChoice = None,
) -> Prediction:
    """Predict tests with a fitted ground, and score those with measurements.

    Args:
        result: result of `calibrate`, or the fit.json or directory that it wrote.
        tests: tests as for `calibrate`. Result columns are not needed; those present
            are compared with the predictions. Empty cells and limits are as there.
        progress: called with lines of text; False for none. Default: lines on stderr.

    Draws of a parameter that is not identifiable extend to the fit's bounds, and the
    intervals are as wide as that makes them.

    Raises InputError, naming file, row and column, for input that cannot be used;
    RuntimeError if JAX is set to float32.
    """
    require_float64()
    expect("result", result, Calibration, str, os.PathLike)
    if isinstance(result, Calibration):
        ground, inputs = ground_of(result), result.result.study.inputs
    else:
        ground, inputs = read_fitted(Path(result)), files_of_fit(Path(result))
    measurements = joined_tables((table_given(tests, scene_of(ground.parts)),))
    with showing(progress):
        predicted = predict_tests(ground, measurements, inputs)
    return Prediction(*predicted)


def ground_of(result: Calibration) -> FittedGround:
    """Convert a calibration as `read_fitted` does."""
    study = result.result.study
    laws = [variant.laws for variant in study.variants]
    return fitted_of(result.as_json(), study.parts, laws)


@numpy_settings()
def run_study(
    study_path: Path,
    out_dir: Path,
    *,
    posterior: bool = False,
    compare: bool = False,
    progress: ProgressChoice = None,
) -> StudyResult:
    """Fit a study, compute its diagnostics, and write the report.

    The files are report.html, fit.json and fitted.csv.

    Args:
        study_path: TOML file of the study, with its tables at paths relative to it; or
            a table of tests alone.
        out_dir: directory of the files, made if it does not exist; files of an earlier
            study there are replaced or removed, each new one once it is whole.
        posterior: whether to sample the posterior by NUTS too, and write posterior.nc
            for ArviZ, one for each variant; needs the extra `jaximpact[bayes]`.
        compare: whether to compare laws too, as `[compare]` in the study says, or all
            that `compare` compares by default, and write comparison.csv.
        progress: called with lines of text; False for none. Default: lines on stderr.

    Raises InputError for a study or a directory that cannot be used, BlockingIOError
    while another process writes there, RuntimeError if JAX is set to float32.
    """
    require_float64()
    study = read_study(study_path)
    out = Path(out_dir)
    with showing(progress):
        result, *_ = fit_and_examine(study, out, posterior=posterior, compare=compare)
    return result


def fit_and_examine(
    study: Study,
    out_dir: Path | None,
    *,
    posterior: bool = False,
    compare: bool = False,
) -> tuple[StudyResult, list[Examination], OtherLaws]:
    """Fit a study and compute its diagnostics, fit other laws beside it, and write the
    files of `run_study` if there is a directory for them."""
    require_float64()
    if posterior:
        check_extra()
    compare = compare or study.compare is not None
    stated = study.compare or CompareTable()
    if compare:
        # Before the fit, which takes its time.
        check_comparison(study, stated.laws, stated.by)

    directory = contextlib.nullcontext()
    if out_dir is not None:
        directory = study_directory(
            study, out_dir, posterior=posterior, compared=compare
        )
    with directory as new:
        result = fit_study(study)
        examined = examine(result, posterior=posterior)
        with within("simple laws: "):
            others = OtherLaws(fit_simple(study))
        if compare:
            compared = compare_study(
                study, stated.laws, by=stated.by, fits=result.variants
            )
            others = others._replace(compared=compared)
        if new is not None:
            tell("drawing")
            write_all(result, examined, new, others)
    return result, examined, others

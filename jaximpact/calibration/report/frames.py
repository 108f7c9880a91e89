"""Results of a calibration as data frames and datasets."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from ...errors import check_choice
from ...quantities import TARGET_COLUMNS, columns_of
from ..diagnostics.examination import Examination
from ..diagnostics.results import StudyResult, VariantResult
from ..prediction import PredictedTests
from ..problem.dataset import LIMITS
from .files import fitted_table
from .prediction import prediction_table

if TYPE_CHECKING:  # takes a while to load
    import xarray as xr

Fit = tuple[StudyResult, VariantResult, Examination]


def frame_of(fit: Fit, table: str) -> pd.DataFrame:
    """Make one of `FRAMES` of a variant."""
    check_choice("table", table, FRAMES)
    return FRAMES[table](fit)


def _parameters(fit: Fit) -> pd.DataFrame:
    _, variant, _ = fit
    columns = columns_of(variant.objective.scene)
    rows = []
    for index, verdict in enumerate(variant.verdicts):
        profile, known = variant.profiles[verdict.name], verdict.determined
        ends = variant.interval(index) if known else (profile.low_95, profile.high_95)
        rows.append(
            {
                "value": variant.parameters[index],
                "standard_error": variant.standard_error(index) if known else np.nan,
                "low_95": ends[0],
                "high_95": ends[1],
                "lower_bound": variant.bounds.lower[index],
                "upper_bound": variant.bounds.upper[index],
                "identifiable": known,
                "reason": verdict.reason,
                "unit": columns[verdict.name].unit,
            }
        )
    names = [verdict.name for verdict in variant.verdicts]
    frame = pd.DataFrame(rows, index=pd.Index(names, name="parameter"))
    return frame.astype({"low_95": float, "high_95": float})


def _covariance(fit: Fit) -> pd.DataFrame:
    _, variant, _ = fit
    x = variant.bounds.coordinate(variant.parameters)
    slope = variant.bounds.slope(x)
    return _square(fit, variant.uncertainty.covariance * np.outer(slope, slope))


def _correlation(fit: Fit) -> pd.DataFrame:
    return _square(fit, fit[1].uncertainty.correlation)


def _square(fit: Fit, matrix: np.ndarray) -> pd.DataFrame:
    names = pd.Index(fit[1].names, name="parameter")
    return pd.DataFrame(matrix, index=names, columns=names.rename("with"))


def _profiles(fit: Fit) -> pd.DataFrame:
    return pd.concat(
        [
            pd.DataFrame(
                {"parameter": name, "value": one.values, "likelihood_ratio": one.rise}
            )
            for name, one in fit[1].profiles.items()
        ],
        ignore_index=True,
    )


def _draws(fit: Fit) -> pd.DataFrame:
    _, variant, diagnostics = fit
    draws = diagnostics.posterior
    values = variant.bounds.parameter(draws.x)
    frame = pd.DataFrame(values, columns=variant.names).rename_axis(index="draw")
    return frame.assign(weight=diagnostics.weights)


def _residuals(fit: Fit) -> pd.DataFrame:
    result, variant, diagnostics = fit
    one = result._replace(variants=[variant])
    return fitted_table(one, [diagnostics]).frame().drop(columns="variant")


FRAMES: dict[str, Callable[[Fit], pd.DataFrame]] = {
    "parameters": _parameters,
    "covariance": _covariance,
    "correlation": _correlation,
    "profiles": _profiles,
    "draws": _draws,
    "residuals": _residuals,
}
"""Tables of a fit, by name."""


def dataset_of(fit: Fit) -> "xr.Dataset":
    """Make a dataset of a variant."""
    import xarray as xr

    result, variant, diagnostics = fit
    study, draws = result.study, diagnostics.posterior
    soil = len(variant.verdicts)
    # Nuisances have a prior, and neither an interval nor a verdict
    rows = _parameters(fit).reindex(variant.names)
    errors = [variant.standard_error(place) for place in range(len(variant.names))]
    errors[:soil] = rows.standard_error[:soil]
    cells = ("test", "target")
    dataset = xr.Dataset(
        {
            "value": ("parameter", variant.parameters),
            "standard_error": ("parameter", errors),
            "low_95": ("parameter", rows.low_95.to_numpy()),
            "high_95": ("parameter", rows.high_95.to_numpy()),
            "identifiable": ("parameter", rows.identifiable.ne(False).to_numpy(bool)),
            "reason": ("parameter", rows.reason.fillna("").to_numpy(str)),
            "covariance": (("parameter", "with"), _covariance(fit).to_numpy()),
            "correlation": (("parameter", "with"), _correlation(fit).to_numpy()),
            "draws": (("draw", "parameter"), variant.bounds.parameter(draws.x)),
            "weight": ("draw", diagnostics.weights),
            "limit": (cells, [[LIMITS[int(c)] for c in row] for row in study.censored]),
            "measured": (cells, study.measured),
            "fitted": (cells, variant.predicted),
            "sigma": (cells, variant.sigma),
            "studentised_residual": (cells, diagnostics.residuals.values),
        },
        {
            "parameter": variant.names,
            "with": variant.names,
            "test": np.arange(1, len(study.tests) + 1),
            "target": list(study.targets),
        },
        {"title": study.title, "variant": variant.variant.name},
    )
    return _with_tests(dataset, study.tests)


def dataset_of_predictions(prediction: PredictedTests) -> "xr.Dataset":
    """Make a dataset of predictions over variants, tests and targets."""
    frame = prediction_table(prediction).frame().drop(columns=["row", "outside"])
    _, number, _ = np.indices((len(prediction.variants), *prediction.measured.shape))
    frame = frame.assign(test=1 + number.ravel())
    dataset = frame.set_index(["variant", "test", "target"]).to_xarray()
    return _with_tests(dataset, prediction.tests)


def _with_tests(dataset: "xr.Dataset", tests) -> "xr.Dataset":
    """Add names of tests and units of targets."""
    units = [TARGET_COLUMNS[str(name)].unit for name in dataset.target.values]
    names = [tests.name(place) for place in range(len(tests))]
    return dataset.assign_coords(name=("test", names), unit=("target", units))

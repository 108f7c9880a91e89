"""Calibration in one call: tests in, soil parameters out."""

import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError, nearest
from ..fields import expect
from ..formats.columns import INPUT_COLUMNS
from ..formats.files import replacing
from ..formats.toml_values import SOIL_COLUMNS
from ..precision import require_float64
from ..soil import Soil
from .campaigns import joined_tables
from .examination import Examination
from .given import table_given
from .least_squares import Progress
from .output import as_json, study_directory, write_all
from .run import fit_and_examine
from .study import StudyResult, VariantResult
from .study_file import DEFAULT_BOUNDS, TOML, Study, read_study, study_of
from .summary import in_brief

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Calibration:
    """What `calibrate` found. `print` it.

    Args:
        result: of the study.
        examined: of every variant.
    """

    def __init__(self, result: StudyResult, examined: list[Examination]):
        self.result, self.examined = result, examined

    def __repr__(self) -> str:
        study = self.result.study
        names = ", ".join(parameter.name for parameter in study.parameters)
        return f"<Calibration of {names} by {len(study.tests)} tests of {study.title}>"

    def __str__(self) -> str:
        return self.summary()

    def summary(self) -> str:
        """The fit at a glance: values with standard errors, or why there are none;
        correlations, misfit, and what stands against trusting it."""
        return in_brief(self.result, self.examined)

    @property
    def variants(self) -> tuple[str, ...]:
        """Names of the variants; there is one unless a study file has more."""
        return tuple(variant.variant.name for variant in self.result.variants)

    @property
    def soil(self) -> Soil:
        """The fitted ground, ready for `simulate`; of several variants, `soil_of`."""
        return self.soil_of()

    def soil_of(self, variant: str | None = None) -> Soil:
        """The fitted ground of a variant.

        Parameters that are not determined have the value of the best fit, which is one
        of many that fit as well. Nuisances are left out.

        Raises InputError if the tests do not share one ground.
        """
        fitted, study = self._chosen(variant), self.result.study
        scene = fitted.objective.scene
        fields = {}
        for name, column in SOIL_COLUMNS.items():
            values = np.unique(np.asarray(getattr(scene.soil, column.field)))
            if len(values) > 1:
                raise InputError(
                    f"{name} differs from test to test; there is no one soil"
                )
            fields[column.field] = float(values[0])
        for place, parameter in enumerate(study.parameters):
            column = SOIL_COLUMNS[parameter.name]
            fields[column.field] = column.factor * float(fitted.parameters[place])
        return Soil(**fields)

    @property
    def parameters(self) -> dict[str, dict]:
        """Of each parameter `value`, `determined`, `standard_error` and `interval_95`
        (None where not determined) and `reason` (why not); of several variants,
        `parameters_of`."""
        return self.parameters_of()

    def parameters_of(self, variant: str | None = None) -> dict[str, dict]:
        """The parameters of a variant."""
        place = self.result.variants.index(self._chosen(variant))
        return self.as_json()["variants"][place]["parameters"]

    def as_json(self) -> dict:
        """Every number, as in fit.json."""
        return as_json(self.result, self.examined)

    def plot(self, path: str | os.PathLike | None = None) -> "Figure":
        """Draw the fit of every target, and the waterfall of the starts.

        Args:
            path: where to save the figure too; replaced once it is whole.
        """
        # Matplotlib takes half a second to import.
        from .plot import plot_study

        figure = plot_study(self.result)
        if path is not None:
            with replacing(Path(path)) as temporary:
                figure.savefig(temporary, dpi=120)
        return figure

    def write(self, out: str | os.PathLike) -> None:
        """Write the report and its numbers, as `jaximpact calibrate` does."""
        sampled = any(looked.samples is not None for looked in self.examined)
        with study_directory(self.result.study, Path(out), posterior=sampled) as new:
            write_all(self.result, self.examined, new)

    def _chosen(self, name: str | None) -> VariantResult:
        if name is None and len(self.variants) > 1:
            raise InputError(
                f"there are several variants; name one of {', '.join(self.variants)}"
            )
        if name is not None and name not in self.variants:
            raise InputError(
                f"variant {name!r} is unknown; did you mean "
                f"{nearest(name, self.variants)!r}?"
            )
        return self.result.variants[self.variants.index(name) if name else 0]


def calibrate(
    tests: str | os.PathLike | Mapping,
    *,
    fit: Iterable[str] | Mapping[str, dict] | None = None,
    ground: Soil | Mapping[str, float] | None = None,
    targets: Iterable[str] | None = None,
    sigma: Mapping[str, float] | None = None,
    scatter: str | Mapping[str, str] | None = None,
    out: str | os.PathLike | None = None,
    seed: int | None = None,
    progress: Progress | None = None,
) -> Calibration:
    """Fit ground parameters to measured impacts, and say what the tests cannot tell.

    Args:
        tests: path of a table of tests (CSV), or its columns: a dictionary or a data
            frame. Columns are those of `jaximpact batch`, in and out, with `sigma_` of
            results; `docs/calibration.md` shows one. Or path of a study (`.toml`),
            which says the rest itself.
        fit: soil columns to be fitted; or of each, what a study file says:
            `{"c_v": {}, "alpha_s": {"lower": 0.1, "upper": 2.0}}`, with `start` and
            `prior`. Default: c_v, gamma_v and k_E, between the usual bounds.
        ground: soil parameters that are not fitted, by column, in its unit; or a
            `Soil`, of which columns of the table take precedence, and fitted parameters
            start at its values. Default: Table 1 of the paper.
        targets: result columns to fit. Default: all that the table holds.
        sigma: standard deviation of a target's measurements, where the table has no
            column for it. Default: estimated from the scatter.
        scatter: "constant" or "proportional", one for all targets whose sigmas are
            estimated, or of each: whether sigma is the same in all tests, or the same
            part of the value. Default: "constant".
        out: directory for the report; a call that was interrupted goes on there.
        seed: of the starts and draws. Default: 0.
        progress: called with lines of text.

    Takes some ten seconds. The same call gives the same numbers on the same machine.

    Raises InputError, naming file, row and column, for what cannot be used;
    RuntimeError if JAX is set to float32.
    """
    require_float64()
    options = dict(fit=fit, ground=ground, targets=targets, sigma=sigma)
    options |= dict(scatter=scatter, seed=seed)
    if isinstance(tests, str | os.PathLike) and Path(tests).suffix.lower() == TOML:
        for name, value in options.items():
            if value is not None:
                raise InputError(f"{name} is for the study itself to say", file=tests)
        study = read_study(Path(tests))
    else:
        study = _study(tests, **options)
    expect("out", out, str, os.PathLike, type(None))
    directory = None if out is None else Path(out)
    return Calibration(*fit_and_examine(study, directory, progress=progress))


def _study(tests, fit, ground, targets, sigma, scatter, seed) -> Study:
    """The study that a call stands for."""
    measurements = joined_tables((table_given(tests),))
    if isinstance(fit, str):
        fit = (fit,)
    expect("fit", fit, Iterable, type(None))
    expect("ground", ground, Soil, Mapping, type(None))
    expect("targets", targets, Iterable, type(None))
    if not isinstance(fit, Mapping):
        fit = {name: {} for name in (DEFAULT_BOUNDS if fit is None else fit)}
    _check_names("fit", fit)
    for name, entry in fit.items():
        expect(f"fit of {name}", entry, Mapping)
    parameters = {name: dict(entry) for name, entry in fit.items()}
    if isinstance(ground, Soil):
        values = _columns(ground)
        for name, entry in parameters.items():
            entry.setdefault("start", values[name])
        held = {
            name: value
            for name, value in values.items()
            if name not in parameters and name not in measurements.inputs
        }
    else:
        held = {n: _plain(v) for n, v in (ground or {}).items()}
        _check_names("ground", held)
    content = {"parameters": parameters, "soil": held, "default_sigma": sigma}
    content |= {"targets": None if targets is None else list(targets), "seed": seed}
    content["scatter"] = dict(scatter) if isinstance(scatter, Mapping) else scatter
    return study_of(
        measurements,
        {key: value for key, value in content.items() if value is not None},
    )


def _columns(soil: Soil) -> dict[str, float]:
    """A ground in the units of the tables."""
    values = {}
    for name, column in SOIL_COLUMNS.items():
        value = np.asarray(getattr(soil, column.field))
        if value.ndim:
            raise InputError(
                f"ground must be one soil, but its {column.field} has shape "
                f"{value.shape}"
            )
        values[name] = float(value) / column.factor
    return values


def _plain(value):
    """A number of numpy's or JAX's as Python's, which files hold."""
    return value.item() if hasattr(value, "item") else value


def _check_names(what: str, names: Iterable[str]) -> None:
    for name in names:
        if name not in SOIL_COLUMNS:
            hint = nearest(name, SOIL_COLUMNS)
            if name in INPUT_COLUMNS:
                raise InputError(
                    f"{what} names {name!r}, which belongs to block or impact; it "
                    "stands in the table"
                )
            raise InputError(
                f"{what} names {name!r}, which is unknown; did you mean {hint}?"
            )

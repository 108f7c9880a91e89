"""Calibration in one call: tests in, soil parameters out."""

import dataclasses
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..block import Block
from ..errors import InputError, nearest
from ..fields import expect
from ..formats.columns import SLOTS, InputColumn, columns_of_part, why_unknown
from ..formats.files import replacing
from ..parameters import Composite, Part, parts_of
from ..precision import require_float64
from ..soil import Soil
from .campaigns import joined_tables
from .examination import Examination
from .given import COLUMNS, table_given
from .laws import parts_and_values, scene_of
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
        """The fitted ground of a variant, with its laws.

        Parameters that are not determined have the value of the best fit, which is one
        of many that fit as well. Nuisances are left out.

        Raises InputError if the tests do not share one ground.
        """
        fitted, study = self._chosen(variant), self.result.study
        soil = fitted.objective.scene.soil
        columns, fields = columns_of_part("soil", soil), {}
        for name, column in columns.items():
            values = np.unique(np.asarray(getattr(soil, column.field)))
            if len(values) > 1:
                raise InputError(
                    f"{name} differs from test to test; there is no one soil"
                )
            fields[column.field] = float(values[0])
        for place, parameter in enumerate(study.parameters):
            column = columns[parameter.name]
            fields[column.field] = column.factor * float(fitted.parameters[place])
        return dataclasses.replace(soil, **fields)

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
    ground: Soil | Mapping[str, float | str | Part] | None = None,
    block: Block | Mapping[str, float | str | Part] | None = None,
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
            `prior`; also parameters of the ground's own laws. Default: c_v, gamma_v and
            k_E, between the usual bounds; other parameters need theirs.
        ground: the laws, and the soil parameters that are not fitted, by column, in its
            unit: `{"flow": MyFlow(), "beta": 0.8}`, a law also by its name,
            `"my_laws.py:MyFlow"`; or a `Soil`, of which columns of the table take
            precedence, and fitted parameters start at its values. Default: Table 1 of
            the paper.
        block: likewise what all blocks have in common and the table does not say: the
            shape, and its parameters. Default: an ellipsoid, as the table says it.
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
    options = dict(fit=fit, ground=ground, block=block, targets=targets)
    options |= dict(sigma=sigma, scatter=scatter, seed=seed)
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


def _study(tests, fit, ground, block, targets, sigma, scatter, seed) -> Study:
    """The study that a call stands for."""
    if isinstance(fit, str):
        fit = (fit,)
    expect("fit", fit, Iterable, type(None))
    expect("targets", targets, Iterable, type(None))
    of_ground, of_block = _given("ground", Soil, ground), _given("block", Block, block)
    base = scene_of(of_ground.parts | of_block.parts)
    measurements = joined_tables((table_given(tests, base),))
    known = measurements.known_columns
    columns = {name: column for name, column in known.items() if column.part == "soil"}
    if not isinstance(fit, Mapping):
        fit = {n: {} for n in DEFAULT_BOUNDS if n in columns} if fit is None else fit
        fit = {name: {} for name in fit}
    _check_names("fit", fit, columns, known)
    _check_names("ground", of_ground.stated, columns, known)
    for name, entry in fit.items():
        expect(f"fit of {name}", entry, Mapping)
    parameters = {name: dict(entry) for name, entry in fit.items()}
    for name, entry in parameters.items():
        if name in of_ground.values:
            entry.setdefault("start", of_ground.values[name])
    held = {
        whole: given.stated
        | {
            name: value
            for name, value in given.values.items()
            if name in known
            and name not in (*parameters, *measurements.inputs, *given.stated)
        }
        for whole, given in (("soil", of_ground), ("block", of_block))
    }
    content = held | {"parameters": parameters, "default_sigma": sigma}
    content |= {"targets": None if targets is None else list(targets), "seed": seed}
    content["scatter"] = dict(scatter) if isinstance(scatter, Mapping) else scatter
    return study_of(
        measurements,
        {key: value for key, value in content.items() if value is not None},
    )


class _Given(NamedTuple):
    """What a call says of the ground, or of the blocks."""

    parts: dict[str, Part]
    stated: dict[str, float]
    """Values by column: what the tests or the fit must not say too."""
    values: dict[str, float]
    """Those that objects have, likewise: fits start there, and tables come first."""


def _given(
    what: str, kind: type[Composite], given: Composite | Mapping | None
) -> _Given:
    """Laws, or a shape, and values.

    Args:
        what: the argument.
        kind: of the object that it may be.
    """
    expect(what, given, kind, Mapping, type(None))
    if isinstance(given, kind):
        parts = {slot: getattr(given, slot) for slot in parts_of(kind)}
        return _Given(parts, {}, _columns(what, given, parts_of(kind)))
    whole = "soil" if kind is Soil else "block"
    parts, stated = parts_and_values(COLUMNS, what, given or {}, whole, Path())
    objects = [slot for slot in parts if isinstance(given[slot], Part)]
    values = _columns(what, kind(**parts), objects, own=False)
    return _Given(parts, {n: _plain(v) for n, v in stated.items()}, values)


def _columns(
    what: str, whole: Composite, slots: Iterable[str], *, own: bool = True
) -> dict[str, float]:
    """Values of a ground or a block in the units of the tables: of the parameters of
    some of its parts, and its own if wanted."""
    values = {}
    part = "soil" if isinstance(whole, Soil) else "block"
    slots = set(slots)
    for name, column in columns_of_part(part, whole).items():
        path = whole.path_of(column.field)
        if not (path[0] in slots if len(path) > 1 else own):
            continue
        value = np.asarray(getattr(whole, column.field))
        if value.ndim:
            raise InputError(
                f"{what} must be one {part}, but its {column.field} has shape "
                f"{value.shape}"
            )
        values[name] = float(value) / column.factor
    return values


def _plain(value):
    """A number of numpy's or JAX's as Python's, which files hold."""
    return value.item() if hasattr(value, "item") else value


def _check_names(
    what: str,
    names: Iterable[str],
    columns: Mapping[str, InputColumn],
    known: Mapping[str, InputColumn],
) -> None:
    """Raise InputError for a name that is no column of the soil.

    Args:
        known: columns of the scene.
    """
    for name in names:
        if name in columns:
            continue
        if name in known or SLOTS.get(name) == "block":
            raise InputError(
                f"{what} names {name!r}, which belongs to block or impact; it "
                "stands in the table"
            )
        raise InputError(
            f"{what} names {name!r}, which is unknown; {why_unknown(name, columns)}"
        )

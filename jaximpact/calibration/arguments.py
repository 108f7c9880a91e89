"""Arguments of `calibrate` and `predict`: tests, ground and block given in Python."""

import csv
import io
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from .._checks import expect
from ..errors import InputError
from ..io.scene_table import SIGMA_COLUMNS, SceneTable, read_table, table_of
from ..io.toml import Key
from ..parameters import Composite, Part, parts_of
from ..quantities import (
    LABEL_COLUMNS,
    SLOTS,
    TARGET_COLUMNS,
    TIME_COLUMN,
    InputColumn,
    columns_of,
    why_unknown,
)
from ..scene import Block, Scene, Soil
from .problem.config import TOML, Study, read_study, study_of
from .problem.dataset import joined_tables
from .problem.fitted_parameters import DEFAULTS, FITTED
from .problem.laws import parts_and_values, scene_of, values_by_column

COLUMNS = Path("columns given")
"""Name in errors and in the manifest of tests that come from no file."""
NAMES = (*LABEL_COLUMNS, *TARGET_COLUMNS, *SIGMA_COLUMNS, TIME_COLUMN, *SLOTS)
"""Names of columns beside those of the scene."""
MISSING = ("nan", "NaN", "<NA>", "NaT", "None")
"""Texts of numpy and pandas for a cell without a value."""


def table_given(
    tests: str | os.PathLike | Mapping, base: Scene | None = None
) -> SceneTable:
    """Make the table of tests.

    Args:
        tests: path of a CSV; or columns by name, as a dictionary or a data frame. A
            column is a sequence, or one value for all tests. Cells are those of the
            CSV: numbers, limits such as ">0.3", text; None and NaN are empty.
        base: scene of defaults, as for `read_table`.

    Columns are written as a CSV, with all digits of numbers, and read like one, so that
    they are checked alike. The first test is in row 2.

    Raises InputError for columns of different lengths, and as `read_table` does.
    """
    if isinstance(tests, str | os.PathLike):
        return read_table(Path(tests), measured=True, base=base)
    columns = _given_columns(tests, (*columns_of(base or Scene()), *NAMES))
    count = max((len(c) for c in columns.values() if c.ndim == 1), default=1)
    for name, column in columns.items():
        place = {"file": COLUMNS, "column": name}
        if column.ndim > 1:
            problem = f"must be one value a test, but has shape {column.shape}"
            raise InputError(problem, **place)
        if column.shape not in ((), (count,)):
            problem = f"holds {len(column)} values, but another column {count}"
            raise InputError(problem, **place)
    if not columns:
        raise InputError("hold no column; tests are needed", file=COLUMNS)
    written = io.StringIO()
    writer = csv.writer(written, lineterminator="\n")
    writer.writerow(columns)
    cells = [np.broadcast_to(column, count).tolist() for column in columns.values()]
    writer.writerows(
        ["" if (text := str(value)) in MISSING else text for value in row]
        for row in zip(*cells, strict=True)
    )
    # Lone surrogates are written as such, and reported as invalid UTF-8.
    data = written.getvalue().encode("utf-8", "surrogatepass")
    return table_of(data, COLUMNS, measured=True, base=base)


def _given_columns(tests: Any, known: tuple[str, ...]) -> dict[str, np.ndarray]:
    """Collect columns by name; masked cells are None.

    An index of a data frame counts too, where it has the name of a known column.
    """
    names = tests.keys() if hasattr(tests, "keys") else getattr(tests, "columns", None)
    if names is None:
        raise InputError(
            "tests must be the path of a table, or columns by name, but are of type "
            f"{type(tests).__name__}"
        )
    if hasattr(getattr(tests, "index", None), "names"):  # that of a data frame
        index = [name for name in tests.index.names if name in known]
        twice = [name for name in index if name in names]
        tests = tests if twice else tests.reset_index(index)
        names = [*twice, *tests.keys()]
    names = list(names)
    for place, name in enumerate(names):
        if not isinstance(name, str):
            raise InputError(
                f"columns must be named by a text each, but one is {name!r}",
                file=COLUMNS,
            )
        if name in names[:place]:
            raise InputError(
                "stands twice among the columns and the index",
                file=COLUMNS,
                column=name,
            )
    return {name: _cells(tests[name]) for name in names}


def _cells(values) -> np.ndarray:
    if isinstance(values, np.ma.MaskedArray):
        return np.where(np.ma.getmaskarray(values), np.array(None), values.data)
    return np.asarray(values, object)


def study_of_arguments(tests, options: Mapping) -> Study:
    """Make the study of a path or of columns of tests.

    Args:
        tests: tests as for `calibrate`, or the path of a study.
        options: the other arguments of `study_given`, None where not given.

    Raises InputError for an option that a study file states itself.
    """
    if isinstance(tests, str | os.PathLike) and Path(tests).suffix.lower() == TOML:
        for name, value in options.items():
            if value is not None:
                raise InputError(f"{name} is for the study itself to say", file=tests)
        return read_study(Path(tests))
    return study_given(tests, **options)


def study_given(
    tests,
    fit=None,
    ground=None,
    block=None,
    targets=None,
    sigma=None,
    scatter=None,
    **further,
) -> Study:
    """Make the study of the arguments of `calibrate`; further ones are keys of a study
    file."""
    if isinstance(fit, str):
        fit = (fit,)
    expect("fit", fit, Iterable, type(None))
    if isinstance(targets, str):
        targets = (targets,)
    expect("targets", targets, Iterable, type(None))
    expect("sigma", sigma, Mapping, type(None))
    of_ground, of_block = _given("ground", Soil, ground), _given("block", Block, block)
    base = scene_of(of_ground.parts | of_block.parts)
    measurements = joined_tables((table_given(tests, base),))
    known = measurements.known_columns
    columns = {name: column for name, column in known.items() if column.part == "soil"}
    if not isinstance(fit, Mapping):
        fit = {n: {} for n in FITTED if n in columns} if fit is None else fit
        fit = {name: {} for name in fit}
    _check_names("fit", fit, columns, known)
    _check_names("ground", of_ground.stated, columns, known)
    parameters: dict[str, dict] = {}
    for name, entry in fit.items():
        expect(f"fit of {name}", entry, Mapping)
        start = None if "expression" in entry else of_ground.values.get(name)
        if start == 0.0 and "start" in DEFAULTS.get(name, {}):
            start = None  # a ground without cohesion is no place to start from
        parameters[name] = ({} if start is None else {"start": start}) | dict(entry)
    fixed = {
        whole: argument.stated
        | {
            name: value
            for name, value in argument.values.items()
            if name in known
            and name not in (*parameters, *measurements.inputs, *argument.stated)
        }
        for whole, argument in (("soil", of_ground), ("block", of_block))
    }
    content = fixed | {"parameters": parameters, "default_sigma": sigma}
    content |= {"targets": None if targets is None else list(targets)}
    content |= {"scatter": scatter} | further
    return study_of(
        measurements,
        {key: _as_toml(v) for key, v in content.items() if v is not None},
    )


def _as_toml(value):
    """Convert mappings, tuples and numbers of NumPy to what a TOML file gives."""
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, Mapping):
        return {key: _as_toml(inner) for key, inner in value.items()}
    return list(map(_as_toml, value)) if isinstance(value, tuple | list) else value


class _Given(NamedTuple):
    """Laws and values of the ground, or of the blocks, as given."""

    parts: dict[str, Part]
    stated: dict[str, float]
    """Values by column that the tests or the fit must not state too."""
    values: dict[str, float]
    """Values of given objects by column: fits start there, and tables take
    precedence."""


def _given(
    what: str, kind: type[Composite], argument: Composite | Mapping | None
) -> _Given:
    """Read laws, or a shape, and values from an argument, which may be an object of a
    class."""
    expect(what, argument, kind, Mapping, type(None))
    if isinstance(argument, kind):
        parts = {slot: getattr(argument, slot) for slot in parts_of(kind)}
        return _Given(parts, {}, values_by_column(what, argument, parts_of(kind)))
    whole = "soil" if kind is Soil else "block"
    entries: Any = argument or {}
    parts, stated = parts_and_values(Key(COLUMNS)[what], entries, whole, Path())
    objects = [slot for slot in parts if isinstance(entries[slot], Part)]
    values = values_by_column(what, kind(**parts), objects, whole_too=False)
    # Numbers of numpy and JAX as Python's.
    stated = {n: v.item() if hasattr(v, "item") else v for n, v in stated.items()}
    return _Given(parts, stated, values)


def _check_names(
    what: str,
    names: Iterable[str],
    columns: Mapping[str, InputColumn],
    known: Mapping[str, InputColumn],
) -> None:
    """Raise InputError for a name that is no column of the soil, with another hint for
    the columns known of the scene."""
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

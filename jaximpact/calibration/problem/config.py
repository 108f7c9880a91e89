"""Definition of a study: parameters, targets and tests, from TOML and CSV or a CSV."""

import dataclasses
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ...accuracy import PRESETS
from ...errors import InputError, nearest
from ...io.checks import check_memory
from ...io.toml import (
    check_keys,
    choice,
    load_toml,
    number,
    typed,
    unknown,
    whole,
)
from ...parameters import Part
from ...quantities import (
    CURVE_COLUMNS,
    RESULT_COLUMNS,
    SLOTS,
    TARGET_COLUMNS,
    TIME_COLUMN,
    InputColumn,
    columns_of,
)
from ...scene import Scene
from .candidates import Candidates, read_candidates
from .compare_table import CompareTable, read_compare_table
from .dataset import Measurements, read_tests
from .expressions import Tied
from .fitted_parameters import (
    Parameter,
    check_constants,
    read_parameters,
)
from .force_curves import check_times
from .laws import KINDS, checked_values, parts_and_values, scene_of
from .noise import (
    LOSSES,
    PROPORTIONAL,
    SCATTERS,
    least_size,
    root_mean_square,
)
from .nuisance import (
    Nuisance,
    read_nuisances,
)

KEYS = (
    "title",
    "source",
    "notes",
    "data",
    "targets",
    "starts",
    "seed",
    "accuracy",
    "method",
    "loss",
    "parameters",
    "nuisance",
    "soil",
    "block",
    "default_sigma",
    "scatter",
    "weights",
    "variants",
    "further_tests",
    "compare",
)
TOML = ".toml"
METHODS = ("levenberg-marquardt", "adam", "l-bfgs")
STARTS = 64
ACCURACY = "reference"
"""Derivatives of coarser impacts are sometimes wrong by a tenth, so that a fit stops
beside its minimum. They only rank starts, whatever a study says."""
NOMINAL_SIGMA = 0.05
"""Nominal sigma, where none is given, over a target's root mean square, or over each
value where scatter is proportional."""


@dataclasses.dataclass(frozen=True)
class Variant:
    """Variant of a study, with other values of fixed parameters, or other laws."""

    name: str
    soil: dict[str, float]
    laws: dict[str, Part] = dataclasses.field(default_factory=dict)
    """Laws by slot; the others are the study's."""


@dataclasses.dataclass(frozen=True)
class Study:
    """Checked study."""

    path: Path
    title: str
    source: str
    notes: str
    tests: Measurements
    parameters: tuple[Parameter, ...]
    nuisances: tuple[Nuisance, ...]
    soil: dict[str, float]
    """Values of fixed parameters, in the units of their columns."""
    targets: tuple[str, ...]
    measured: np.ndarray
    """Measurements, shape (tests, targets); NaN where there is none."""
    censored: np.ndarray
    """1 where the true value is above, -1 where it is below, else 0; the same shape."""
    sigma: np.ndarray
    """Standard deviation of the measurements, the same shape; nominal for a target
    without sigmas: constant, or in proportion to the measurements."""
    sigma_given: np.ndarray
    """Mask of the targets whose sigmas are given, shape (targets,)."""
    proportional: np.ndarray
    """Mask of the targets whose sigma is estimated as a fraction of the value."""
    weights: np.ndarray
    """Weights of the targets on the losses, shape (targets,)."""
    loss: str
    starts: int
    seed: int
    accuracy: str
    method: str
    variants: tuple[Variant, ...]
    candidates: Candidates
    """Candidates for further tests."""
    parts: dict[str, Part] = dataclasses.field(default_factory=dict)
    """Laws of the ground, and the shape unless the tests state theirs, by slot."""
    block: dict[str, float] = dataclasses.field(default_factory=dict)
    """Values of the block that all tests share and no table states; `tests` has them
    too."""
    tied: tuple[Tied, ...] = ()
    """Soil parameters that are expressions of others."""
    compare: CompareTable | None = None
    """Comparison of laws, where the study asks for one."""

    @property
    def inputs(self) -> list[Path]:
        """Files from which the study was read."""
        return [self.path, *(table.path for table in self.tests.sources)]

    def scene_of(self, variant: Variant) -> Scene:
        """Make one scene of all tests, arrays (tests,) in SI, on the ground of a
        variant."""
        tests = self.tests.with_laws(variant.laws)
        return tests.scene(self.soil | variant.soil)

    @property
    def comparable(self) -> np.ndarray:
        """Mask of what a test can have measured, shape (tests, targets): forces at a
        time where it has one, else the other targets."""
        nothing = np.full(len(self.tests), np.nan)
        timed = np.isfinite(self.tests.inputs.get(TIME_COLUMN, nothing))
        return timed[:, None] == np.isin(self.targets, [*CURVE_COLUMNS])

    @property
    def known(self) -> np.ndarray:
        """Mask of measurements and limits, shape (tests, targets)."""
        return np.isfinite(self.measured)


SLOPE_KEYS = ("profile", "observed")
"""Keys of which a study of a slope has one, and one of impacts none."""


class SlopeStudyError(InputError):
    """A study of a slope where one of impacts is read."""


def read_study(path: Path) -> Study:
    """Read a study and its data.

    Args:
        path: file of the study, which ends in `.toml`; any other file is a table of
            tests, fitted with the defaults.

    Raises SlopeStudyError for a slope, and InputError, naming file and key, or file,
    row and column, for other input that cannot be used.
    """
    path = Path(path)
    if path.suffix.lower() != TOML:
        return study_of(read_tests([path], Scene()), {})
    content = load_toml(path)
    for key in SLOPE_KEYS:
        if key in content:
            raise SlopeStudyError(
                "is a slope, and no table of tests; jaximpact.runout.calibrate_slope "
                "fits it",
                file=path,
                key=key,
            )
    parts: dict[str, Part] = {}
    for table in KINDS:
        entries = typed(path, content, table, dict, {})
        parts |= parts_and_values(path, table, entries, table, path.parent)[0]
    try:
        base = scene_of(parts)
        columns_of(base)
    except InputError as error:  # two parameters of one name
        raise InputError(str(error), file=path) from error
    tests = read_tests(_data(path, content), base)
    content.setdefault("title", path.resolve().parent.name)
    for slot in parts:
        _check_in_study_alone(path, tests, f"{SLOTS[slot]}.{slot}", slot)
    return _study(path, content, tests)


def study_of(tests: Measurements, content: dict) -> Study:
    """Make a study of given tests.

    Args:
        tests: tests of one or several tables, with laws and shape of the study.
        content: content of a study file, without `data`, laws and shape.
    """
    path = tests.files[0].path
    return _study(path, {"title": path.stem} | content, tests)


def _study(path: Path, content: dict, tests: Measurements) -> Study:
    check_keys(path, "", content, KEYS)
    variants = _variants(path, content, tests)
    grounds = [tests.with_laws(variant.laws).known_columns for variant in variants]
    fixed = _held(path, content, "soil", _merged(grounds))
    block = _held(path, content, "block", tests.known_columns)
    for name in block:
        _check_in_study_alone(path, tests, f"block.{name}", name)
    tests = tests.with_inputs(block)
    parameters, tied, pooled = read_parameters(path, content, grounds[0], fixed, tests)
    nuisances = read_nuisances(path, content, tests.with_laws(variants[0].laws), fixed)
    _check_in_all(path, (*parameters, *tied), nuisances, variants, grounds)
    _check_fitted_once(path, tests, (*parameters, *tied), nuisances, fixed, variants)
    nuisances += pooled
    check_constants(path, tied, [variant.soil for variant in variants])
    targets = _targets(path, content, tests, nuisances)
    sigma, sigma_given = _sigma(path, content, tests, targets)
    proportional = _proportional(path, content, targets, sigma_given)
    measured = np.stack([tests.measured[name] for name in targets], axis=1)
    starts = whole(path, content, "starts", STARTS, 1)
    numbers = starts * measured.size * len(parameters)
    check_memory(numbers, f"{starts} starts", file=path, key="starts")
    size = np.fmax(np.abs(measured), least_size(measured))
    return Study(
        path=path,
        title=typed(path, content, "title", str),
        source=typed(path, content, "source", str, ""),
        notes=typed(path, content, "notes", str, ""),
        tests=tests,
        parameters=parameters,
        tied=tied,
        nuisances=nuisances,
        soil=fixed,
        targets=targets,
        measured=measured,
        censored=np.stack([tests.censored[name] for name in targets], axis=1),
        sigma=np.where(proportional, NOMINAL_SIGMA * size, sigma),
        sigma_given=sigma_given,
        proportional=proportional,
        weights=_weights(path, content, targets),
        loss=choice(path, content, "loss", LOSSES[0], LOSSES),
        starts=starts,
        seed=whole(path, content, "seed", 0, 0),
        accuracy=choice(path, content, "accuracy", ACCURACY, tuple(PRESETS)),
        method=choice(path, content, "method", METHODS[0], METHODS),
        variants=variants,
        candidates=read_candidates(
            path, content, tuple(p.name for p in parameters), grounds[0]
        ),
        parts=tests.parts,
        block=block,
        compare=read_compare_table(path, content),
    )


def _held(
    path: Path, content: dict, whole: str, columns: Mapping[str, InputColumn]
) -> dict[str, float]:
    """Read the numbers of the table `soil` or `block`."""
    entries = typed(path, content, whole, dict, {})
    values = {n: v for n, v in entries.items() if SLOTS.get(n) != whole}
    known = {name: c for name, c in columns.items() if c.part == whole}
    return checked_values(path, whole, values, known)


def _merged(grounds: list[dict[str, InputColumn]]) -> dict[str, InputColumn]:
    return {name: column for ground in grounds for name, column in ground.items()}


def _data(path: Path, content: dict) -> list[Path]:
    """List the tables that a study names."""
    if "data" not in content:
        raise InputError(
            "is missing; it names the table of tests", file=path, key="data"
        )
    names = content["data"]
    names = names if isinstance(names, list) else [names]
    if not names or not all(isinstance(name, str) for name in names):
        raise InputError(
            f"must be a file or a list of files, but is {content['data']!r}",
            file=path,
            key="data",
        )
    files = [path.parent / name for name in names]
    for place, file in enumerate(files):
        for before in range(place):
            if _is_same(file, files[before]):
                raise InputError(
                    f"names one file twice: {names[before]} and {names[place]}",
                    file=path,
                    key="data",
                )
    return files


def _is_same(first: Path, second: Path) -> bool:
    """Test whether two paths lead to one file, by links too."""
    try:
        return first == second or first.samefile(second)
    except (OSError, ValueError):  # reported where it is read
        return False


def _variants(path: Path, content: dict, tests: Measurements) -> tuple[Variant, ...]:
    entries = typed(path, content, "variants", list, [{}])
    if not entries:
        raise InputError("holds no variant; leave it out", file=path, key="variants")
    variants = []
    for place, entry in enumerate(entries, 1):
        where = f"variants[{place}]"
        if not isinstance(entry, dict):
            raise InputError(f"must be a table, but is {entry!r}", file=path, key=where)
        named = dict(entry)
        words = (
            "as given" if not entry else ", ".join(f"{k} {v}" for k, v in entry.items())
        )
        name = typed(path, named, "name", str, words)
        named.pop("name", None)
        laws, values = parts_and_values(path, where, named, "soil", path.parent)
        for slot in laws:
            _check_in_study_alone(path, tests, f"{where}.{slot}", slot)
        try:
            known = tests.with_laws(laws).known_columns
        except InputError as error:  # two parameters of one name
            raise InputError(str(error), file=path, key=where) from error
        known = {name: c for name, c in known.items() if c.part == "soil"}
        soil = checked_values(path, where, values, known)
        variants.append(Variant(name, soil, laws))
    names = [variant.name for variant in variants]
    for place, name in enumerate(names, 1):
        if names.count(name) > 1:
            raise InputError(
                f"name {name!r} stands twice", file=path, key=f"variants[{place}]"
            )
    return tuple(variants)


def _check_in_all(path, parameters, nuisances, variants, grounds) -> None:
    """Raise InputError for a fitted name that is no parameter of a variant's ground."""
    fitted = [(f"parameters.{p.name}", p.name) for p in parameters]
    fitted += [(f"nuisance.{n.name}", n.name) for n in nuisances]
    for variant, ground in zip(variants, grounds, strict=True):
        for key, name in fitted:
            if name not in ground:
                laws = " and ".join(
                    f"{slot} {type(law).__name__}" for slot, law in variant.laws.items()
                )
                raise InputError(
                    f"is no parameter of variant {variant.name!r}, whose laws are "
                    f"{laws or 'those of the study'}; leave it out, or fit the variant "
                    "in a study of its own",
                    file=path,
                    key=key,
                )


def _check_in_study_alone(path, tests: Measurements, key: str, name: str) -> None:
    """Raise InputError for a value in both the study and the tests' tables."""
    if name in tests.inputs or name in tests.slots:
        data = " or ".join(table.path.name for table in tests.files)
        raise InputError(f"stands in {data} too; remove one", file=path, key=key)


def _check_fitted_once(path, tests, parameters, nuisances, fixed, variants) -> None:
    """Raise InputError for a soil value that is stated twice."""
    data = " or ".join(table.path.name for table in tests.files)
    toml = (
        ("soil", fixed),
        *((f"variants[{i}]", v.soil) for i, v in enumerate(variants, 1)),
    )
    for parameter in parameters:
        for place, values in (*toml, (data, tests.inputs)):
            if parameter.name in values:
                raise InputError(
                    f"is fitted, but stands in {place} too; remove one",
                    file=path,
                    key=f"parameters.{parameter.name}",
                )
    fitted = {parameter.name for parameter in parameters}
    for nuisance in nuisances:
        if nuisance.name in fitted:
            raise InputError(
                "stands under parameters too; remove one",
                file=path,
                key=f"nuisance.{nuisance.name}",
            )
    for where, values in toml:
        for name in values:
            _check_in_study_alone(path, tests, f"{where}.{name}", name)


def _targets(path: Path, content: dict, tests: Measurements, nuisances):
    first = tests.files[0].path
    present = [n for n, values in tests.measured.items() if np.any(np.isfinite(values))]
    if not tests.measured:
        raise InputError(
            "has no measured result to fit; add a column like e_n, or any of "
            f"{', '.join(list(RESULT_COLUMNS)[1:])}",
            file=first,
        )
    targets = typed(path, content, "targets", list, present or [*tests.measured])
    if not targets:
        raise InputError("names no result to fit", file=path, key="targets")
    for name in targets:
        if name not in tuple(TARGET_COLUMNS):
            raise InputError(
                f"{name!r} is unknown; did you mean {nearest(name, TARGET_COLUMNS)}?",
                file=path,
                key="targets",
            )
        if name not in tests.measured:
            raise InputError(
                f"{name} is no column of {first.name}", file=path, key="targets"
            )
        if targets.count(name) > 1:
            raise InputError(f"{name} stands twice", file=path, key="targets")
        known = np.isfinite(tests.measured[name])
        if not np.any(known):
            raise InputError("holds no measurement; remove it", file=first, column=name)
        if name in CURVE_COLUMNS:
            times = tests.inputs.get(TIME_COLUMN, np.full(len(tests), np.nan))
            check_times(first, times, known, name)
    angles = tests.inputs.get("angle_deg", np.zeros(len(tests)))
    moved = any(nuisance.name == "angle_deg" for nuisance in nuisances)
    if "e_t" in targets and not moved:
        along_normal = np.isfinite(tests.measured["e_t"]) & (angles == 0.0)
        for test in np.flatnonzero(along_normal)[:1]:
            file, row = tests.place(test)
            raise InputError(
                "e_t has no meaning at angle_deg 0; leave the cell empty",
                file=file,
                row=row,
                column="e_t",
            )
    return tuple(targets)


def _of_targets(path: Path, content: dict, key: str) -> dict[str, float]:
    """Read a table of positive numbers for results."""
    values = typed(path, content, key, dict, {})
    for name, value in values.items():
        where = f"{key}.{name}"
        if name not in TARGET_COLUMNS:
            unknown(path, where, name, TARGET_COLUMNS)
        if not number(path, where, value) > 0.0:
            raise InputError(f"must be above 0, but is {value}", file=path, key=where)
    return values


def _weights(path: Path, content: dict, targets) -> np.ndarray:
    weights = _of_targets(path, content, "weights")
    return np.array([float(weights.get(name, 1.0)) for name in targets])


def _sigma(path, content, tests, targets) -> tuple[np.ndarray, np.ndarray]:
    """Collect sigmas (tests, targets), and the mask of targets with given ones."""
    defaults = _of_targets(path, content, "default_sigma")
    columns, given = [], []
    for name in targets:
        measured = tests.measured[name]
        sigma = tests.sigmas.get(name, np.full(len(tests), np.nan))
        if name in defaults:
            sigma = np.where(np.isfinite(sigma), sigma, float(defaults[name]))
        stated = bool(np.any(np.isfinite(sigma)))
        if not stated:
            scale = root_mean_square(measured)
            sigma = np.full(len(tests), NOMINAL_SIGMA * scale)
        for test in np.flatnonzero(np.isfinite(measured) & ~np.isfinite(sigma))[:1]:
            file, row = tests.place(test)
            raise InputError(
                f"has no sigma_{name}, but other rows have; give all, or a sigma for "
                f"the rest, default_sigma.{name} in a study",
                file=file,
                row=row,
                column=name,
            )
        # Without a measurement any number serves, but not NaN.
        columns.append(np.where(np.isfinite(sigma), sigma, np.nanmedian(sigma)))
        given.append(stated)
    return np.stack(columns, axis=1), np.array(given)


def _proportional(path, content, targets, sigma_given) -> np.ndarray:
    """Find the targets whose scatter is stated as proportional, shape (targets,)."""
    key = "scatter"
    stated = content.get(key, {})
    if isinstance(stated, str):
        # One word holds for all targets whose sigmas are estimated.
        choice(path, content, key, stated, SCATTERS)
        if np.all(sigma_given):
            raise InputError(
                "is for sigmas that are estimated, but all are given",
                file=path,
                key=key,
            )
        return ~sigma_given & (stated == PROPORTIONAL)
    if not isinstance(stated, dict):
        raise InputError(
            f"must be one of {', '.join(SCATTERS)}, or a table of them by target, but "
            f"is {stated!r}",
            file=path,
            key=key,
        )
    for name, word in stated.items():
        where = f"{key}.{name}"
        if name not in TARGET_COLUMNS:
            unknown(path, where, name, TARGET_COLUMNS)
        choice(path, {where: word}, where, word, SCATTERS)
        if name in targets and sigma_given[targets.index(name)]:
            raise InputError(
                f"is for a sigma that is estimated, but that of {name} is given",
                file=path,
                key=where,
            )
    return np.array([stated.get(name) == PROPORTIONAL for name in targets])

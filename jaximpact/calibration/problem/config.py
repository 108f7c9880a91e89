"""Definition of a study: parameters, targets and tests, from TOML and CSV or a CSV."""

import dataclasses
import functools
import itertools
import operator
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...accuracy import PRESETS
from ...errors import InputError, did_you_mean
from ...io.checks import check_memory
from ...io.toml import Key, check_keys, choice, known_table, load_toml, typed, whole
from ...parameters import Part
from ...quantities import CURVE_COLUMNS, SLOTS, InputColumn, columns_of
from ...scene import Scene
from .candidates import Candidates, read_candidates
from .dataset import Measurements, read_tests
from .expressions import Tied
from .fitted_parameters import Parameter, check_constants, read_parameters
from .laws import KINDS, checked_values, in_words, parts_and_values, scene_of
from .noise import LOSSES, least_size, root_mean_square
from .nuisance import Nuisance, read_nuisances
from .targets import read_targets

KEYS = (
    *("title", "source", "notes", "data", "targets", "starts", "seed", "accuracy"),
    *("method", "loss", "parameters", "nuisance", "soil", "block", "default_sigma"),
    *("scatter", "weights", "variants", "further_tests", "compare"),
)
TOML = ".toml"
SLOPE_KEYS = ("profile", "observed")
"""Keys of which a study of a slope has one, and one of impacts none."""
METHODS = ("trust-region", "adam", "l-bfgs")
STARTS = 48
ACCURACY = "reference"
"""Derivatives of coarser impacts are sometimes wrong by a tenth, so that a fit stops
beside its minimum. They only search, whatever a study says."""


@dataclasses.dataclass(frozen=True)
class Variant:
    """Variant of a study, with other values of fixed parameters, or other laws."""

    name: str
    soil: dict[str, float]
    laws: dict[str, Part] = dataclasses.field(default_factory=dict)
    """Laws by slot; the others are the study's."""


class CompareTable(NamedTuple):
    """Laws that a study compares, and the groups that it leaves out."""

    laws: tuple[str, ...] | None = None
    """Names of the laws; None for the default."""
    by: tuple[str, ...] | None = None
    """Columns whose groups are left out; None for the default."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Study:
    """Checked study."""

    path: Path
    title: str
    source: str = ""
    notes: str = ""
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
    understated: tuple[str, ...] = ()
    """Targets whose given sigmas the fit found too small: these are multiplied by a
    factor that is estimated, and do not count as given."""
    proportional: np.ndarray
    """Mask of the targets whose sigma is estimated as a fraction of the value."""
    scatter_open: tuple[str, ...] = ()
    """Targets whose kind of scatter is chosen by the fit: nobody stated it, and the
    values span a decade."""
    weights: np.ndarray
    """Weights of the targets on the losses, shape (targets,)."""
    loss: str = LOSSES[0]
    starts: int = STARTS
    """Size of the population that searches; 1 for a fit from the start alone."""
    seed: int = 0
    accuracy: str = ACCURACY
    method: str = METHODS[0]
    variants: tuple[Variant, ...]
    candidates: Candidates = dataclasses.field(default_factory=Candidates)
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

    def index_of(self, variant: str) -> int:
        """Find a variant by its name; InputError for an unknown one."""
        names = [known.name for known in self.variants]
        if variant not in names:
            raise InputError(
                f"variant {variant!r} is unknown; {did_you_mean(variant, names, repr)}"
            )
        return names.index(variant)

    @property
    def comparable(self) -> np.ndarray:
        """Mask of what a test can have measured, shape (tests, targets): forces at a
        time where it has one, else the other targets, but for points of a curve."""
        timed, first = self.tests.at_times(self.targets), self.tests.first_of_row
        there = timed | (first == np.arange(len(first)))
        of_curve = np.isin(self.targets, [*CURVE_COLUMNS])
        return there[:, None] & (timed[:, None] == of_curve)

    @property
    def known(self) -> np.ndarray:
        """Mask of measurements and limits, shape (tests, targets)."""
        return np.isfinite(self.measured)

    @property
    def exact(self) -> np.ndarray:
        """Mask of measurements that are no limits, shape (tests, targets)."""
        return self.known & (self.censored == 0)

    @property
    def is_likelihood(self) -> bool:
        """Whether the cost of the tests is their negative log-likelihood: the loss is
        Gaussian, and no target has a weight."""
        return self.loss == LOSSES[0] and bool(np.all(self.weights == 1.0))

    @property
    def stated(self) -> dict[str, float]:
        """Values that no table has: those held, and of nuisance parameters that are the
        value itself the mean of their prior."""
        meant = {n.name: n.prior.mean for n in self.nuisances if not n.pooled}
        return self.soil | meant

    def each_test(self) -> tuple[np.ndarray, np.ndarray]:
        """Find the tests with a measurement, the points of a curve as one: the index
        among them of each row, -1 without any, and the first row of each."""
        first, measured = self.tests.first_of_row, np.any(self.known, axis=1)
        rows = np.unique(first[measured])
        return np.where(measured, np.searchsorted(rows, first), -1), rows

    @property
    def scale(self) -> np.ndarray:
        """Root mean square of each target, shape (targets,)."""
        return root_mean_square(self.measured, self.censored)

    @property
    def least_size(self) -> np.ndarray:
        """y_0 of each target (`noise`), shape (targets,)."""
        return least_size(self.measured, self.censored)


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
    top, content = Key(path), load_toml(path)
    for key in SLOPE_KEYS:
        if key in content:
            raise SlopeStudyError(
                "is a slope, and no table of tests; jaximpact.runout.calibrate_slope "
                "fits it",
                **top[key].place,
            )
    parts: dict[str, Part] = {}
    for table in KINDS:
        entries = typed(top, content, table, dict, {})
        parts |= parts_and_values(top[table], entries, table, path.parent)[0]
    with top.located():  # two parameters of one name
        base = scene_of(parts)
        columns_of(base)
    tests = read_tests(_data(top, content), base)
    content.setdefault("title", path.resolve().parent.name)
    for slot in parts:
        _check_in_study_alone(top[SLOTS[slot]][slot], tests, slot)
    return _study(top, content, tests)


def study_of(tests: Measurements, content: dict) -> Study:
    """Make a study of given tests, which have its laws and shape, and of the content of
    a study file without these and `data`."""
    path = tests.files[0].path
    return _study(Key(path), {"title": path.stem} | content, tests)


def _study(top: Key, content: dict, tests: Measurements) -> Study:
    check_keys(top, content, KEYS)
    variants = _variants(top, content, tests)
    grounds = [tests.with_laws(variant.laws).known_columns for variant in variants]
    fixed = _held(top, content, "soil", functools.reduce(operator.or_, grounds))
    block = _held(top, content, "block", tests.known_columns)
    for name in block:
        _check_in_study_alone(top["block"][name], tests, name)
    tests = tests.with_inputs(block)
    parameters, tied, pooled = read_parameters(top, content, grounds[0], fixed, tests)
    nuisances = read_nuisances(top, content, tests.with_laws(variants[0].laws), fixed)
    _check_in_all(top, (*parameters, *tied), nuisances, variants, grounds)
    _check_fitted_once(top, tests, (*parameters, *tied), nuisances, fixed, variants)
    nuisances += pooled
    check_constants(
        top, tied, [variant.soil for variant in variants], [n.name for n in nuisances]
    )
    compared = read_targets(top, content, tests, nuisances)
    starts = whole(top, content, "starts", STARTS, 1)
    numbers = starts * compared["measured"].size * len(parameters)
    check_memory(numbers, f"{starts} starts", **top["starts"].place)
    return Study(
        path=top.file,
        title=typed(top, content, "title", str),
        source=typed(top, content, "source", str, ""),
        notes=typed(top, content, "notes", str, ""),
        tests=tests,
        parameters=parameters,
        tied=tied,
        nuisances=nuisances,
        soil=fixed,
        **compared,
        loss=choice(top, content, "loss", Study.loss, LOSSES),
        starts=starts,
        seed=whole(top, content, "seed", Study.seed, 0),
        accuracy=choice(top, content, "accuracy", Study.accuracy, tuple(PRESETS)),
        method=choice(top, content, "method", Study.method, METHODS),
        variants=variants,
        candidates=read_candidates(
            top, content, tuple(p.name for p in parameters), grounds[0]
        ),
        parts=tests.parts,
        block=block,
        compare=_compare(top, content),
    )


def _compare(top: Key, content: dict) -> CompareTable | None:
    """Read the table `compare`; None where there is none."""
    if "compare" not in content:
        return None
    key = top["compare"]
    entries = known_table(top, content, "compare", CompareTable._fields)
    return CompareTable(**{n: _texts(key[n], v, "name") for n, v in entries.items()})


def _texts(key: Key, value: Any, what: str) -> tuple[str, ...]:
    texts = [value] if isinstance(value, str) else value
    if not isinstance(texts, list) or not all(isinstance(text, str) for text in texts):
        raise key.error(f"must be a {what} or a list of {what}s, but is {value!r}")
    return tuple(texts)


def _held(
    top: Key, content: dict, whole: str, columns: Mapping[str, InputColumn]
) -> dict[str, float]:
    entries = typed(top, content, whole, dict, {})
    values = {n: v for n, v in entries.items() if SLOTS.get(n) != whole}
    known = {name: c for name, c in columns.items() if c.part == whole}
    return checked_values(top[whole], values, known)


def _data(top: Key, content: dict) -> list[Path]:
    key, directory = top["data"], top.file.parent
    if "data" not in content:
        raise key.error("is missing; it names the table of tests")
    names = _texts(key, content["data"], "file")
    if not names:
        raise key.error("names no table of tests")
    for first, second in itertools.combinations(names, 2):
        if _is_same(directory / first, directory / second):
            raise key.error(f"names one file twice: {first} and {second}")
    return [directory / name for name in names]


def _is_same(first: Path, second: Path) -> bool:
    try:
        return first == second or first.samefile(second)
    except (OSError, ValueError):  # reported where it is read
        return False


def _variants(top: Key, content: dict, tests: Measurements) -> tuple[Variant, ...]:
    entries = typed(top, content, "variants", list, [{}])
    if not entries:
        raise top["variants"].error("holds no variant; leave it out")
    variants = []
    for place, entry in enumerate(entries, 1):
        where = top[f"variants[{place}]"]
        if not isinstance(entry, dict):
            raise where.error(f"must be a table, but is {entry!r}")
        words = ", ".join(f"{k} {v}" for k, v in entry.items()) or "as given"
        name = typed(where, entry, "name", str, words)
        named = {key: value for key, value in entry.items() if key != "name"}
        laws, values = parts_and_values(where, named, "soil", top.file.parent)
        for slot in laws:
            _check_in_study_alone(where[slot], tests, slot)
        with where.located():  # two parameters of one name
            known = tests.with_laws(laws).known_columns
        known = {name: c for name, c in known.items() if c.part == "soil"}
        soil = checked_values(where, values, known)
        variants.append(Variant(name, soil, laws))
    names = [variant.name for variant in variants]
    for place, name in enumerate(names, 1):
        if names.count(name) > 1:
            raise top[f"variants[{place}]"].error(f"name {name!r} stands twice")
    return tuple(variants)


def _check_in_all(top, parameters, nuisances, variants, grounds) -> None:
    """Raise InputError for a fitted name that is no parameter of a variant's ground."""
    fitted = [(top["parameters"], p.name) for p in parameters]
    fitted += [(top["nuisance"], n.name) for n in nuisances]
    for variant, ground in zip(variants, grounds, strict=True):
        for table, name in fitted:
            if name not in ground:
                laws = in_words(variant.laws, " and ") or "those of the study"
                raise table[name].error(
                    f"is no parameter of variant {variant.name!r}, whose laws are "
                    f"{laws}; leave it out, or fit the variant in a study of its own"
                )


def _check_in_study_alone(key: Key, tests: Measurements, name: str) -> None:
    """Raise InputError for a value in both the study and the tests' tables."""
    if name in tests.inputs or name in tests.slots:
        data = " or ".join(tests.file_names.values())
        raise key.error(f"stands in {data} too; remove one")


def _check_fitted_once(top, tests, parameters, nuisances, fixed, variants) -> None:
    """Raise InputError for a soil value that is stated twice."""
    data = " or ".join(tests.file_names.values())
    of_variants = [(f"variants[{i}]", v.soil) for i, v in enumerate(variants, 1)]
    toml = ("soil", fixed), *of_variants
    for parameter in parameters:
        for place, values in (*toml, (data, tests.inputs)):
            if parameter.name in values:
                raise top["parameters"][parameter.name].error(
                    f"is fitted, but stands in {place} too; remove one"
                )
    fitted = "under parameters", [parameter.name for parameter in parameters]
    beside = fitted, *((f"in {place}", values) for place, values in of_variants)
    for nuisance in nuisances:
        for where, names in beside:
            if nuisance.name in names:
                raise top["nuisance"][nuisance.name].error(
                    f"stands {where} too; remove one"
                )
    for where, values in toml:
        for name in values:
            _check_in_study_alone(top[where][name], tests, name)

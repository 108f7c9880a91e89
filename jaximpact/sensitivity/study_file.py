"""A sensitivity study from a TOML file."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from ..errors import InputError
from ..formats.columns import InputColumn
from ..formats.reading import read_input
from ..formats.scene_file import scene_from
from ..formats.toml_values import allowed, check_keys, choice, parse_toml, typed, whole
from ..scene import Scene
from .morris_effects import DEFAULT_TRAJECTORIES, check_trajectories
from .names import (
    DEFAULT_OUTPUTS,
    default_parameters,
    output_columns,
    parameter_columns,
)
from .ranges import DISTRIBUTIONS, UNIFORM, Range, check_range
from .sampling import check_seed
from .sobol_indices import DEFAULT_BLOCKS, check_blocks

ELASTICITIES, MORRIS, SOBOL = METHODS = ("elasticities", "morris", "sobol")
ALL = "all"
KEYS = ("title", "method", "outputs", "blocks", "trajectories", "seed", "parameters")
RANGE_KEYS = ("lower", "upper", "distribution")


class SensitivityStudy(NamedTuple):
    """What the file says."""

    path: Path
    sha256: str
    title: str
    base: Scene
    accuracy: str | None
    """Name of a preset, or None where the file does not say."""
    methods: tuple[str, ...]
    parameters: tuple[str, ...]
    ranges: dict[str, Range]
    """Of those parameters that have one."""
    outputs: tuple[str, ...]
    blocks: int
    trajectories: int
    seed: int


def read_study(path: Path, method: str | None = None) -> SensitivityStudy:
    """Read a study: a scene as `read_scene` reads it, and what to ask of it.

    Args:
        path: the file.
        method: one of `METHODS` or "all", in place of the file's. If neither says, all
            where every parameter has a range, else elasticities.

    Raises InputError, naming file and key, for whatever cannot be used.
    """
    path = Path(path)
    data = read_input(path)
    content = parse_toml(path, data)
    base, accuracy = scene_from(path, content, KEYS)
    if "parameters" in content:
        entries = typed(path, content, "parameters", dict)
    else:
        usual = _in_file(path, "parameters", lambda: default_parameters(base))
        entries = {name: {} for name in usual}
    parameters = tuple(entries)
    columns = _in_file(path, "parameters", lambda: parameter_columns(base, parameters))
    ranges = {}
    for column, (name, entry) in zip(columns, entries.items(), strict=True):
        given = _range(path, column, entry)
        if given is not None:
            ranges[name] = given
    outputs = tuple(typed(path, content, "outputs", list, list(DEFAULT_OUTPUTS)))
    _in_file(path, "outputs", lambda: output_columns(outputs))
    if method is None and "method" in content:
        method = choice(path, content, "method", ALL, (*METHODS, ALL))
    study = SensitivityStudy(
        path=path,
        sha256=hashlib.sha256(data).hexdigest(),
        title=typed(path, content, "title", str, path.stem),
        base=base,
        accuracy=accuracy,
        methods=_methods(path, method, parameters, ranges),
        parameters=parameters,
        ranges=ranges,
        outputs=outputs,
        blocks=whole(path, content, "blocks", DEFAULT_BLOCKS, 2),
        trajectories=whole(path, content, "trajectories", DEFAULT_TRAJECTORIES, 2),
        seed=whole(path, content, "seed", 0, 0),
    )
    size = len(parameters)
    _in_file(path, "blocks", lambda: check_blocks(study.blocks, size))
    _in_file(path, "trajectories", lambda: check_trajectories(study.trajectories, size))
    _in_file(path, "seed", lambda: check_seed(study.seed))
    return study


def _methods(
    path: Path, method: str | None, parameters: tuple[str, ...], ranges: dict
) -> tuple[str, ...]:
    """What is to be done; those over ranges need them."""
    ranged = len(ranges) == len(parameters) and len(ranges) > 1
    if method is None:
        method = ALL if ranged else ELASTICITIES
    if method == ELASTICITIES:
        return (ELASTICITIES,)
    for name in parameters:
        if name not in ranges:
            raise InputError(
                f"needs a range like {{ lower = 0.1, upper = 10.0 }} for {method}; "
                f"--method {ELASTICITIES} does without",
                file=path,
                key=f"parameters.{name}",
            )
    if not ranged:
        raise InputError(
            f"must name at least two for {method}, but names only {parameters[0]}",
            file=path,
            key="parameters",
        )
    return METHODS if method == ALL else (method,)


def _range(path: Path, column: InputColumn, entry) -> Range | None:
    """The range of a parameter, None for an empty table."""
    key = f"parameters.{column.name}"
    if not isinstance(entry, dict):
        raise InputError(
            "must be a table like { lower = 0.1, upper = 10.0, "
            f'distribution = "{DISTRIBUTIONS[-1]}" }}, or {{}}, but is {entry!r}',
            file=path,
            key=key,
        )
    check_keys(path, key, entry, RANGE_KEYS)
    if not entry:
        return None
    ends = []
    for inner in ("lower", "upper"):
        if inner not in entry:
            raise InputError("is missing", file=path, key=f"{key}.{inner}")
        ends.append(allowed(path, f"{key}.{inner}", column, entry[inner]))
    distribution = choice(path, entry, "distribution", UNIFORM, DISTRIBUTIONS)
    given = Range(*ends, distribution)
    _in_file(path, key, lambda: check_range(column, given))
    return given


def _in_file(path: Path, key: str, check: Callable):
    """What a check gives; of what it refuses, say where it stands."""
    try:
        return check()
    except InputError as error:
        raise InputError(str(error), file=path, key=key) from None

"""Sensitivity studies: from a TOML file to tables, drawings and a manifest."""

import hashlib
import json
from functools import partial
from pathlib import Path
from typing import NamedTuple

import xarray as xr

from .._precision import require_float64
from ..accuracy import DEFAULT_ACCURACY
from ..io.files import read_input, write_text
from ..io.output_files import NewFile, output_directory, together
from ..io.toml import (
    Key,
    allowed,
    check_table,
    choice,
    parse_toml,
    scene_from,
    typed,
    whole,
)
from ..progress import Progress, ProgressFunction, as_progress
from ..quantities import InputColumn
from ..scene import Scene
from . import figures
from .elasticities import DEFAULT_ACCURACY as ELASTICITIES_ACCURACY
from .elasticities import Check, State, elasticities
from .global_methods import (
    DEFAULT_BLOCKS,
    DEFAULT_TRAJECTORIES,
    LARGEST_SEED,
    check_blocks,
    check_trajectories,
    morris,
    sobol,
)
from .ranges import (
    DEFAULT_OUTPUTS,
    DISTRIBUTIONS,
    LOG_UNIFORM,
    UNIFORM,
    Range,
    check_range,
    default_parameters,
    output_columns,
    parameter_columns,
)
from .text import in_words

ELASTICITIES, MORRIS, SOBOL = METHODS = ("elasticities", "morris", "sobol")
ALL = "all"
KEYS = ("title", "method", "outputs", "blocks", "trajectories", "seed", "parameters")
RANGE_KEYS = ("lower", "upper", "distribution")


class SensitivityStudy(NamedTuple):
    """Settings of a study, as its file gives them."""

    path: Path
    sha256: str
    """Checksum of the file."""
    title: str
    base: Scene
    accuracy: str | None
    """Name of a preset, or None where the file does not say."""
    methods: tuple[str, ...]
    parameters: tuple[str, ...]
    ranges: dict[str, Range]
    """Ranges of the parameters that have one."""
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
    top, content = Key(path), parse_toml(path, data)
    base, accuracy = scene_from(path, content, KEYS)
    if "parameters" in content:
        entries = typed(top, content, "parameters", dict)
    else:
        with top["parameters"].located():
            entries = {name: {} for name in default_parameters(base)}
    parameters = tuple(entries)
    with top["parameters"].located():
        columns = parameter_columns(base, parameters)
    ranges = {}
    for column, (name, entry) in zip(columns, entries.items(), strict=True):
        given = _range(top, column, entry)
        if given is not None:
            ranges[name] = given
    outputs = tuple(typed(top, content, "outputs", list, list(DEFAULT_OUTPUTS)))
    with top["outputs"].located():
        output_columns(outputs)
    if method is None and "method" in content:
        method = choice(top, content, "method", ALL, (*METHODS, ALL))
    study = SensitivityStudy(
        path=path,
        sha256=hashlib.sha256(data).hexdigest(),
        title=typed(top, content, "title", str, path.stem),
        base=base,
        accuracy=accuracy,
        methods=_methods(top, method, parameters, ranges),
        parameters=parameters,
        ranges=ranges,
        outputs=outputs,
        blocks=whole(top, content, "blocks", DEFAULT_BLOCKS, 2),
        trajectories=whole(top, content, "trajectories", DEFAULT_TRAJECTORIES, 2),
        seed=whole(top, content, "seed", 0, 0, LARGEST_SEED),
    )
    with top["blocks"].located():
        check_blocks(study.blocks, len(parameters))
    with top["trajectories"].located():
        check_trajectories(study.trajectories, len(parameters))
    return study


def _methods(
    top: Key, method: str | None, parameters: tuple[str, ...], ranges: dict
) -> tuple[str, ...]:
    """Return the methods to compute. Raises InputError where ranges are missing."""
    ranged = len(ranges) == len(parameters) and len(ranges) > 1
    if method is None:
        method = ALL if ranged else ELASTICITIES
    if method == ELASTICITIES:
        return (ELASTICITIES,)
    for name in parameters:
        if name not in ranges:
            raise top["parameters"][name].error(
                f"needs a range like {{ lower = 0.1, upper = 10.0 }} for {method}; "
                f"--method {ELASTICITIES} does without"
            )
    if not ranged:
        raise top["parameters"].error(
            f"must name at least two for {method}, but names only {parameters[0]}"
        )
    return METHODS if method == ALL else (method,)


def _range(top: Key, column: InputColumn, entry) -> Range | None:
    key = top["parameters"][column.name]
    like = f'{{ lower = 0.1, upper = 10.0, distribution = "{LOG_UNIFORM}" }}, or {{}}'
    check_table(key, entry, RANGE_KEYS, like)
    if not entry:
        return None
    ends = []
    for inner in ("lower", "upper"):
        if inner not in entry:
            raise key[inner].error("is missing")
        ends.append(allowed(key[inner], column, entry[inner]))
    distribution = choice(key, entry, "distribution", UNIFORM, DISTRIBUTIONS)
    given = Range(ends[0], ends[1], distribution)
    with key.located():
        check_range(column, given)
    return given


DRAWINGS = {
    ELASTICITIES: {
        "elasticities.png": figures.plot_heat_map,
        "tornado.png": figures.plot_tornado,
    },
    MORRIS: {"morris.png": figures.plot_morris},
    SOBOL: {"sobol.png": figures.plot_sobol},
}
CODES = {"state": State, "check": Check}
ATTRIBUTES = ("accuracy", "outcomes", "versions")


def files_of_method(name: str) -> list[str]:
    """Return the names of a method's files: its table and its drawings."""
    return [f"{name}.csv", *DRAWINGS[name]]


def write_study(
    study: SensitivityStudy, datasets: dict[str, xr.Dataset], report: str, new: NewFile
) -> None:
    """Write tables and drawings of all methods, report and manifest, each whole or not
    at all. Raises OSError where the file system refuses."""
    for name, dataset in datasets.items():
        write_text(new(f"{name}.csv"), as_csv(dataset))
        for file, draw in DRAWINGS[name].items():
            draw(dataset, new(file))
    write_text(new("report.txt"), f"{study.title}\n\n{report}\n")
    text = json.dumps(manifest(study, datasets), indent=1, allow_nan=False)
    write_text(new("manifest.json"), text + "\n")


def as_csv(dataset: xr.Dataset) -> str:
    """Write a line for each parameter and output, with whatever the dataset says of the
    pair or of one of the two; codes in words, `nan` where there is no number."""
    names = [str(name) for name in dataset.variables if dataset[name].dims]
    names.sort(key=lambda name: (name not in dataset.coords, dataset[name].ndim))
    lines = [",".join(names)]
    for output in range(dataset.sizes["output"]):
        for parameter in range(dataset.sizes["parameter"]):
            entry = dataset.isel(output=output, parameter=parameter)
            lines.append(",".join(_cell(name, entry[name].item()) for name in names))
    return "\n".join(lines) + "\n"


def _cell(name: str, value) -> str:
    if name in CODES:
        return str(CODES[name](value))
    return repr(value) if isinstance(value, float) else str(value)


def manifest(study: SensitivityStudy, datasets: dict[str, xr.Dataset]) -> dict:
    """Return what is needed to compute the study again, ready for JSON."""
    first = next(iter(datasets.values()))
    methods = {}
    for name, dataset in datasets.items():
        methods[name] = {"files": files_of_method(name)} | {
            key: json.loads(dataset.attrs[key])
            for key in ATTRIBUTES
            if key in dataset.attrs
        }
        for key in () if name == ELASTICITIES else ("groups_kept", "groups_dropped"):
            counts = zip(
                dataset.output.values.tolist(),
                dataset[key].values.tolist(),
                strict=True,
            )
            methods[name][key] = dict(counts)
    return {
        "title": study.title,
        "study": {"file": study.path.name, "sha256": study.sha256},
        "scene": json.loads(first.attrs["base"]),
        "laws": json.loads(first.attrs["laws"]),
        "parameters": list(study.parameters),
        "ranges": {name: vars(given) for name, given in study.ranges.items()},
        "outputs": list(study.outputs),
        "seed": study.seed,
        "blocks": study.blocks,
        "trajectories": study.trajectories,
        "methods": methods,
    }


def run_study(
    path: Path,
    out: Path,
    *,
    method: str | None = None,
    accuracy: str | None = None,
    progress: Progress | ProgressFunction | None = None,
) -> str:
    """Compute a study, and write report.txt, manifest.json, and for each method its
    table in CSV and its drawings. Returns the tables as text, one under the other.

    Args:
        path: the TOML file.
        out: directory, made if need be; files of an earlier study there are replaced or
            removed, each new one once it is whole. Journals lie there until all is
            written, so that an interrupted run goes on.
        method: in place of the file's.
        accuracy: in place of the file's; "reference" for elasticities and "balanced"
            for the rest where neither says.
        progress: called as `progress(done, n)`, anew for each method.

    Raises InputError for a study or a directory that cannot be used, BlockingIOError
    while another process writes there, RuntimeError if JAX is set to float32.
    """
    require_float64()
    study = read_study(path, method)
    out = Path(out)
    accuracy = accuracy or study.accuracy
    journals = {name: out / f"{name}.journal" for name in study.methods}
    names = [file for name in study.methods for file in files_of_method(name)]
    names += ["report.txt", "manifest.json"]
    datasets = {}
    with output_directory(out, "sensitivity", names, inputs=[study.path]) as new:
        for name, journal in journals.items():
            told = partial(as_progress(progress), f"impacts for {name}")
            datasets[name] = _compute(study, name, accuracy, journal, told)
        report = "\n\n".join(map(in_words, datasets.values()))
        with together(new) as add:
            write_study(study, datasets, report, add)
        for name in study.methods:
            if name != ELASTICITIES:  # which keeps none
                journals[name].unlink()
    return report


def _compute(study, name, accuracy, journal, progress) -> xr.Dataset:
    if name == ELASTICITIES:
        return elasticities(
            study.base,
            study.parameters,
            study.outputs,
            accuracy=accuracy or ELASTICITIES_ACCURACY,
            progress=progress,
        )
    how: dict = {
        "seed": study.seed,
        "accuracy": accuracy or DEFAULT_ACCURACY,
        "journal": journal,
        "progress": progress,
    }
    given = study.base, study.ranges, study.outputs
    if name == MORRIS:
        return morris(*given, trajectories=study.trajectories, **how)
    return sobol(*given, blocks=study.blocks, **how)

"""The files of a study."""

import json

import numpy as np
import xarray as xr

from ..formats.directory import NewFile
from ..formats.files import write_text
from . import drawing
from .study_file import ELASTICITIES, MORRIS, SOBOL, SensitivityStudy
from .verdicts import Check, State

DRAWINGS = {
    ELASTICITIES: {
        "elasticities.png": drawing.plot_heat_map,
        "tornado.png": drawing.plot_tornado,
    },
    MORRIS: {"morris.png": drawing.plot_morris},
    SOBOL: {"sobol.png": drawing.plot_sobol},
}
CODES = {"state": State, "check": Check}
ATTRIBUTES = ("accuracy", "outcomes", "versions")


def files_of_method(name: str) -> list[str]:
    """Names of the files of a method: its table, and its drawings."""
    return [f"{name}.csv", *DRAWINGS[name]]


def write_study(
    study: SensitivityStudy, datasets: dict[str, xr.Dataset], report: str, new: NewFile
) -> None:
    """Write tables and drawings of all methods, report and manifest, each whole or not
    at all.

    Args:
        new: gives the path of a file.

    Raises OSError where the file system refuses.
    """
    for name, dataset in datasets.items():
        write_text(new(f"{name}.csv"), as_csv(dataset))
        for file, draw in DRAWINGS[name].items():
            draw(dataset, new(file))
    write_text(new("report.txt"), f"{study.title}\n\n{report}\n")
    text = json.dumps(manifest(study, datasets), indent=1, allow_nan=False)
    write_text(new("manifest.json"), text + "\n")


def as_csv(dataset: xr.Dataset) -> str:
    """A line for each parameter and output, with whatever the dataset says of the pair,
    or of one of the two; codes in words, `nan` where there is no number."""
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
    """What is needed to compute the study again, ready for JSON."""
    first = next(iter(datasets.values()))
    methods = {}
    for name, dataset in datasets.items():
        about = {"files": files_of_method(name)}
        about |= {
            key: json.loads(dataset.attrs[key])
            for key in ATTRIBUTES
            if key in dataset.attrs
        }
        if "groups_dropped" in dataset:
            for key in ("groups_kept", "groups_dropped"):
                counts = np.atleast_1d(dataset[key].values).tolist()
                about[key] = dict(
                    zip(dataset.output.values.tolist(), counts, strict=True)
                )
        methods[name] = about
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

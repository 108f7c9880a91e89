"""The files of a study."""

import json
from pathlib import Path

import numpy as np
import xarray as xr

from ..formats.files import replacing
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


def write_method(name: str, dataset: xr.Dataset, out: Path) -> None:
    """Write the table and the drawings of a method, each whole or not at all.

    Raises OSError where the file system refuses.
    """
    with replacing(out / f"{name}.csv") as temporary:
        temporary.write_text(as_csv(dataset), encoding="utf-8")
    for file, draw in DRAWINGS[name].items():
        draw(dataset, out / file)


def write_study(
    study: SensitivityStudy, datasets: dict[str, xr.Dataset], report: str, out: Path
) -> None:
    """Write report and manifest, each whole or not at all.

    Raises OSError where the file system refuses.
    """
    with replacing(out / "report.txt") as temporary:
        temporary.write_text(f"{study.title}\n\n{report}\n", encoding="utf-8")
    with replacing(out / "manifest.json") as temporary:
        text = json.dumps(manifest(study, datasets), indent=1, allow_nan=False)
        temporary.write_text(text + "\n", encoding="utf-8")


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
        about = {"files": [f"{name}.csv", *DRAWINGS[name]]}
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
        "parameters": list(study.parameters),
        "ranges": {name: vars(given) for name, given in study.ranges.items()},
        "outputs": list(study.outputs),
        "seed": study.seed,
        "blocks": study.blocks,
        "trajectories": study.trajectories,
        "methods": methods,
    }

"""The files of a run-out study, and what it says in words."""

import json

import numpy as np
import xarray as xr

from ..formats.align import align
from ..formats.directory import NewFile
from ..formats.files import write_text
from ..formats.netcdf import write_netcdf
from . import drawing
from .runs import Ending
from .slope_file import SlopeStudy
from .study import PERCENTILES, simulate

DRAWN = 50
"""Trajectories drawn: the first ones, computed once more."""
STOP_COLUMNS = (
    *("block", "ending", "x_m", "y_m", "time_s", "impacts", "events"),
    *("energy_at_release_J", "energy_at_end_J"),
    *("max_height_m", "max_speed_mps", "max_energy_J"),
)
WHOLE = ("block", "impacts", "events")
QUANTITIES = (
    *("passage_speed_mps", "passage_energy_J", "passage_translational_energy_J"),
    *("passage_rotational_energy_J", "passage_spin_radps"),
    *("passage_centre_height_m", "passage_lowest_height_m"),
)


FILES = (
    *("blocks.nc", "stops.csv", "profile.png", "envelopes.png", "stops.png"),
    *("report.txt", "manifest.json"),
)
COLLECTOR_FILES = ("collectors.csv", "collectors.png")


def names_of_files(study: SlopeStudy) -> tuple[str, ...]:
    """Names of the files of a study."""
    return FILES + (COLLECTOR_FILES if len(study.collectors) else ())


def write_slope_study(study: SlopeStudy, dataset: xr.Dataset, new: NewFile) -> None:
    """Write blocks.nc, stops.csv, collectors.csv, report.txt, manifest.json and the
    drawings, each whole or not at all.

    Args:
        new: gives the path of a file.

    Raises OSError where the file system refuses.
    """
    write_netcdf(new("blocks.nc"), dataset)
    write_text(new("stops.csv"), _stops(dataset))
    drawn = np.arange(min(DRAWN, study.release.count))
    drawing.plot_trajectories(
        simulate(study, drawn), study.collectors, study.title, new("profile.png")
    )
    drawing.plot_envelopes(dataset, study.profile, new("envelopes.png"))
    drawing.plot_stops(dataset, new("stops.png"))
    if len(study.collectors):
        write_text(new("collectors.csv"), _collectors(dataset))
        drawing.plot_collectors(dataset, new("collectors.png"))
    write_text(new("report.txt"), in_words(dataset) + "\n")
    attributes = {k: json.loads(v) for k, v in dataset.attrs.items() if k != "title"}
    manifest = {"title": dataset.title} | attributes
    write_text(new("manifest.json"), json.dumps(manifest, indent=1) + "\n")


def in_words(dataset: xr.Dataset) -> str:
    """Endings, where blocks stopped, and what passes the collectors."""
    endings = json.loads(dataset.attrs["endings"])
    blocks, failed = dataset.sizes["block"], endings.get(str(Ending.failed), 0)
    law = json.loads(dataset.attrs["contacts"])
    told = ", ".join(f"{name} {value}" for name, value in law.items())
    lines = [
        f"{dataset.title}: {blocks} blocks, contacts by {told.removeprefix('law ')}",
        "endings: " + ", ".join(f"{count} {name}" for name, count in endings.items()),
    ]
    if failed:
        lines.append(f"The {failed} that failed are in none of the numbers below.")
    cut = sum(endings.get(str(e), 0) for e in (Ending.time_limit, Ending.event_limit))
    if cut:
        lines.append(
            f"The {cut} cut off by a limit might have gone farther: the shares that "
            "pass are lower bounds."
        )
    stopped = dataset.x_m.values[dataset.ending.values == str(Ending.stopped)]
    if len(stopped):
        values = np.percentile(stopped, (0, *PERCENTILES, 100))
        names = ("least", *(f"{p} %" for p in PERCENTILES), "largest")
        lines.append(
            "stopped at x [m]: "
            + ", ".join(f"{n} {v:.5g}" for n, v in zip(names, values, strict=True))
        )
    if "collector" in dataset.sizes:
        lines += ["first passages of collectors, percentiles of the blocks that pass"]
        lines.append(align(_passage_rows(dataset, blocks - failed)))
    return "\n".join(lines)


def _passage_rows(dataset: xr.Dataset, valid: int) -> list[tuple[str, ...]]:
    names = {
        "passage_speed_mps": ("speed", "m/s", 1.0),
        "passage_energy_J": ("energy", "kJ", 1e-3),
        "passage_centre_height_m": ("height", "m", 1.0),
    }
    rows = [("x [m]", "pass", "share", "", "unit", *(f"{p} %" for p in PERCENTILES))]
    for place, x in enumerate(dataset.collector.values):
        passing = int(dataset.blocks_passing.values[place])
        share = f"{passing / valid:.1%}" if valid else "-"
        where = (f"{x:g}", str(passing), share)
        for name, (word, unit, factor) in names.items():
            values = factor * dataset[f"{name}_percentiles"].values[:, place]
            numbers = (f"{v:.4g}" if np.isfinite(v) else "-" for v in values)
            rows.append((*where, word, unit, *numbers))
            where = ("", "", "")
    return rows


def _stops(dataset: xr.Dataset) -> str:
    columns = [dataset[name].values.tolist() for name in STOP_COLUMNS]
    lines = [",".join(STOP_COLUMNS)]
    for row in zip(*columns, strict=True):
        cells = (
            str(int(value)) if name in WHOLE else str(value)
            for name, value in zip(STOP_COLUMNS, row, strict=True)
        )
        lines.append(",".join(cells))
    return "\n".join(lines) + "\n"


COLLECTOR_COLUMNS = (
    *("collector_m", "blocks_passing", "quantity"),
    *(f"p{p}" for p in PERCENTILES),
)


def _collectors(dataset: xr.Dataset) -> str:
    rows = [COLLECTOR_COLUMNS, *collector_rows(dataset)]
    return "\n".join(",".join(row) for row in rows) + "\n"


def collector_rows(dataset: xr.Dataset) -> list[tuple[str, ...]]:
    """Percentiles of first passages, a row for each collector and quantity."""
    rows = []
    for place, x in enumerate(dataset.collector.values.tolist()):
        for name in QUANTITIES:
            values = dataset[f"{name}_percentiles"].values[:, place].tolist()
            passing = int(dataset.blocks_passing.values[place])
            cells = (x, passing, name.removeprefix("passage_"), *values)
            rows.append(tuple(map(str, cells)))
    return rows

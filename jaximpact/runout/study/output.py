"""Files and text of a run-out study, and of a comparison of contact laws."""

import json
from collections.abc import Callable, Iterable, Mapping

import numpy as np
import xarray as xr

from ...io.datasets import write_netcdf
from ...io.display import align
from ...io.files import write_text
from ...io.output_files import NewFile
from ..smoothing import Smoothing
from ..trajectory import Ending
from . import drawing
from .barriers import (
    COLUMNS,
    barrier_rows,
    barriers_in_json,
    barriers_in_words,
    effect_rows,
    estimates_of,
)
from .intervals import percentile_interval
from .map_files import names_of_map_files, write_map_files
from .report_page import report_page
from .run_study import PERCENTILES, simulate
from .slope_file import SlopeStudy

SHOWN = 50
"""Number of trajectories in the drawing: the first ones, computed once more."""
STOP_COLUMNS = (
    *("block", "ending", "x_m", "y_m", "time_s", "impacts", "hops", "events"),
    *("energy_at_release_J", "energy_at_end_J"),
    *("max_height_m", "max_speed_mps", "max_energy_J"),
)
WHOLE = ("block", "impacts", "hops", "events")
QUANTITIES = (
    *("passage_speed_mps", "passage_energy_J", "passage_translational_energy_J"),
    *("passage_rotational_energy_J", "passage_spin_radps"),
    *("passage_centre_height_m", "passage_lowest_height_m"),
)


SHOWN_PASSAGES = {
    "passage_speed_mps": ("speed", "m/s", 1.0),
    "passage_energy_J": ("energy", "kJ", 1e-3),
    "passage_centre_height_m": ("height", "m", 1.0),
}
"""Quantities at collectors in texts: word, unit and factor."""
STUDY_FILES = (
    *("blocks.nc", "stops.csv", "profile.png", "envelopes.png", "stops.png"),
    *("report.html", "manifest.json"),
)
COLLECTOR_FILES = ("collectors.csv", "collectors.png")
COLLECTOR_COLUMNS = (
    *("collector_m", "blocks_passing", "quantity"),
    *(f"p{p}" for p in PERCENTILES),
    *(f"p{p}_{end}" for p in PERCENTILES for end in ("low", "high")),
)
BARRIER_FILES = ("barriers.csv",)
STOPS = (*PERCENTILES, 100)
LAW_COLUMNS = (
    *("law", "blocks", *(str(e).replace(" ", "_") for e in Ending)),
    *("impacts_p50", *(f"stop_x_p{p}_m" for p in STOPS)),
    *("max_height_p95_m", "max_speed_p95_mps", "max_energy_p95_J"),
)
COMPARISON_FILES = ("comparison.csv", "comparison.png", "manifest.json")
COMPARED_COLLECTOR_FILES = ("comparison_collectors.csv", "comparison_collectors.png")
COMPARED_BARRIER_FILES = ("comparison_barriers.csv",)


def names_of_files(study: SlopeStudy, comparison: bool = False) -> tuple[str, ...]:
    """List the names of the files of a study, or of a comparison of its laws."""
    files = COMPARISON_FILES if comparison else STUDY_FILES
    of_collectors = COMPARED_COLLECTOR_FILES if comparison else COLLECTOR_FILES
    of_barriers = COMPARED_BARRIER_FILES if comparison else BARRIER_FILES
    files += of_collectors if len(study.settings.collectors) else ()
    files += of_barriers if study.settings.barriers else ()
    return files if comparison else files + names_of_map_files(study)


def write_slope_study(study: SlopeStudy, dataset: xr.Dataset, new: NewFile) -> None:
    """Write the files of `names_of_files`: dataset, tables, maps, reports and drawings,
    each whole or not at all.

    Args:
        dataset: result of `run_slope_study`.
        new: gives the path of a file by its name.

    Raises OSError where the file system refuses.
    """
    write_netcdf(new("blocks.nc"), dataset)
    write_text(new("stops.csv"), _stops(dataset))
    first = simulate(study, np.arange(min(SHOWN, study.release.count)))
    grounds = drawing.drawn_grounds(
        study.profile, study.inputs.materials, study.inputs.random_ground
    )
    drawing.plot_trajectories(
        first,
        grounds,
        study.settings.collectors,
        study.inputs.title,
        new("profile.png"),
    )
    write_map_files(study, dataset, first, new)
    write_text(new("report.html"), report_page(study, dataset, first))
    drawing.plot_envelopes(dataset, study.profile, grounds, new("envelopes.png"))
    drawing.plot_stops(dataset, new("stops.png"))
    if len(study.settings.collectors):
        rows = collector_rows(dataset)
        write_text(new("collectors.csv"), _csv(COLLECTOR_COLUMNS, rows))
        drawing.plot_collectors(dataset, new("collectors.png"))
    at_barriers = estimates_of(dataset)
    if study.settings.barriers:
        write_text(new("barriers.csv"), _csv(COLUMNS, barrier_rows(at_barriers)))
    manifest = {"title": dataset.title} | _attributes(dataset)
    if study.settings.barriers:
        manifest["barriers"] = barriers_in_json(at_barriers)
    write_text(new("manifest.json"), json.dumps(manifest, indent=1) + "\n")


def in_words(dataset: xr.Dataset) -> str:
    """Report endings, stopping places, and passages of the collectors as text."""
    endings = json.loads(dataset.attrs["endings"])
    blocks, failed = dataset.sizes["block"], endings.get(str(Ending.failed), 0)
    law = json.loads(dataset.attrs["contacts"])
    told = ", ".join(f"{name} {value}" for name, value in law.items())
    lines = [
        f"{dataset.title}: {blocks} blocks, contacts by {told.removeprefix('law ')}",
        *_profile_in_words(dataset),
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
    stopped = drawing.stops_of(dataset)
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
    lines += barriers_in_words(estimates_of(dataset))
    return "\n".join(lines)


def _profile_in_words(dataset: xr.Dataset) -> list[str]:
    if "profile" not in dataset.attrs:
        return []
    smoothing = Smoothing(**json.loads(dataset.attrs["profile"]))
    return [f"profile: {smoothing}"]


def _passage_rows(dataset: xr.Dataset, valid: int) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = [
        ("x [m]", "pass", "share", "", "unit", *(f"{p} %" for p in PERCENTILES))
    ]
    for place, x in enumerate(dataset.collector.values):
        passing = int(dataset.blocks_passing.values[place])
        share = f"{passing / valid:.1%}" if valid else "-"
        where = (f"{x:g}", str(passing), share)
        for name, (word, unit, factor) in SHOWN_PASSAGES.items():
            values = factor * dataset[f"{name}_percentiles"].values[:, place]
            numbers = (f"{v:.4g}" if np.isfinite(v) else "-" for v in values)
            rows.append((*where, word, unit, *numbers))
            where = ("", "", "")
    return rows


def _stops(dataset: xr.Dataset) -> str:
    columns = (
        dataset[name].astype(int) if name in WHOLE else dataset[name]
        for name in STOP_COLUMNS
    )
    rows = zip(*(column.values.tolist() for column in columns), strict=True)
    return _csv(STOP_COLUMNS, (map(str, row) for row in rows))


def collector_rows(dataset: xr.Dataset) -> list[tuple[str, ...]]:
    """List percentiles of first passages, a row for each collector and quantity, and
    the ends of the percentiles' intervals of 95 %."""
    rows, valid = [], drawing.valid_blocks(dataset)
    for place, x in enumerate(dataset.collector.values.tolist()):
        for name in QUANTITIES:
            values = dataset[f"{name}_percentiles"].values[:, place].tolist()
            passing = int(dataset.blocks_passing.values[place])
            passages = dataset[name].values[valid, place]
            ends = (e for p in PERCENTILES for e in percentile_interval(passages, p))
            cells = (x, passing, name.removeprefix("passage_"), *values, *ends)
            rows.append(tuple(map(str, cells)))
    return rows


def write_comparison(
    study: SlopeStudy, datasets: Mapping[str, xr.Dataset], new: NewFile
) -> None:
    """Write comparison.csv, comparison_collectors.csv, manifest.json and drawings, each
    whole or not at all.

    Args:
        study: any of the studies compared.
        datasets: result of each law, by its name.
        new: gives the path of a file by its name.

    Raises OSError where the file system refuses.
    """
    write_text(new("comparison.csv"), _csv(LAW_COLUMNS, _law_rows(datasets)))
    grounds = drawing.drawn_grounds(
        study.profile, study.inputs.materials, study.inputs.random_ground
    )
    drawing.plot_comparison(datasets, study.profile, grounds, new("comparison.png"))
    if len(study.settings.collectors):
        table = _csv_of_laws(COLLECTOR_COLUMNS, datasets, collector_rows)
        write_text(new("comparison_collectors.csv"), table)
        drawing.plot_compared_collectors(datasets, new("comparison_collectors.png"))
    if study.settings.barriers:
        table = _csv_of_laws(
            COLUMNS, datasets, lambda dataset: barrier_rows(estimates_of(dataset))
        )
        write_text(new("comparison_barriers.csv"), table)
    laws = {law: _attributes(dataset) for law, dataset in datasets.items()}
    manifest = {"title": study.inputs.title, "laws": laws}
    write_text(new("manifest.json"), json.dumps(manifest, indent=1) + "\n")


def compare_in_words(datasets: Mapping[str, xr.Dataset]) -> str:
    """Report endings, stopping places and passages by each law as text."""
    first = next(iter(datasets.values()))
    blocks = first.sizes["block"]
    lines = [f"{first.title}: the same {blocks} blocks by {len(datasets)} laws"]
    lines += _profile_in_words(first)
    found = [e for e in Ending if any(_count(d, e) for d in datasets.values())]
    percentiles = (f"{p} %" for p in PERCENTILES)
    rows: list[tuple[str, ...]] = [
        ("law", *map(str, found), "impacts", *percentiles, "farthest")
    ]
    for law, dataset in datasets.items():
        stops = (
            f"{v:.5g}" if np.isfinite(v) else "-" for v in _stop_percentiles(dataset)
        )
        counts = (str(_count(dataset, ending)) for ending in found)
        rows.append((law, *counts, f"{np.median(dataset.impacts):.4g}", *stops))
    lines += ["endings, median impacts, and x where blocks stopped [m]", align(rows)]
    if any(_count(d, Ending.failed) for d in datasets.values()):
        lines.append("Blocks that failed are in no number but their count.")
    collectors = first.collector.values if "collector" in first.sizes else ()
    for place, x in enumerate(collectors):
        rows: list[tuple[str, ...]] = [
            ("law", "pass", "speed", "", "energy", "", "height", "")
        ]
        for law, dataset in datasets.items():
            valid = int(np.sum(drawing.valid_blocks(dataset)))
            passing = int(dataset.blocks_passing.values[place])
            values = [
                factor * dataset[f"{name}_percentiles"].sel(percentile=p).values[place]
                for name, (_, _, factor) in SHOWN_PASSAGES.items()
                for p in (50, 95)
            ]
            cells = (f"{v:.4g}" if np.isfinite(v) else "-" for v in values)
            rows.append((law, f"{passing / valid:.1%}" if valid else "-", *cells))
        lines.append(
            f"first passages at x = {x:g} m: speed [m/s], energy [kJ] and height of "
            "the centre [m], median and 95 %"
        )
        lines.append(align(rows))
    for law, dataset in datasets.items():
        if at_barriers := estimates_of(dataset):
            lines += [f"barriers by {law}", align(effect_rows(at_barriers))]
    return "\n".join(lines)


def _law_rows(datasets: Mapping[str, xr.Dataset]) -> list[tuple[str, ...]]:
    rows = []
    for law, dataset in datasets.items():
        valid = drawing.valid_blocks(dataset)
        largest = (
            np.percentile(dataset[name].values[valid], 95) if np.any(valid) else np.nan
            for name in ("max_height_m", "max_speed_mps", "max_energy_J")
        )
        counts = (_count(dataset, ending) for ending in Ending)
        numbers = (np.median(dataset.impacts), *_stop_percentiles(dataset), *largest)
        cells = (dataset.sizes["block"], *counts, *map(float, numbers))
        rows.append((_quoted(law), *map(str, cells)))
    return rows


def _stop_percentiles(dataset: xr.Dataset) -> np.ndarray:
    x = drawing.stops_of(dataset)
    return np.percentile(x, STOPS) if len(x) else np.full(len(STOPS), np.nan)


def _count(dataset: xr.Dataset, ending: Ending) -> int:
    return int(np.sum(dataset.ending.values == str(ending)))


def _csv(heads: tuple[str, ...], rows: Iterable[Iterable[str]]) -> str:
    return "\n".join(",".join(row) for row in (heads, *rows)) + "\n"


def _csv_of_laws(heads: tuple[str, ...], datasets: Mapping, rows_of: Callable) -> str:
    rows = [
        (_quoted(k), *row) for k, found in datasets.items() for row in rows_of(found)
    ]
    return _csv(("law", *heads), rows)


def _quoted(text: str) -> str:
    return '"' + text.replace('"', '""') + '"'


def _attributes(dataset: xr.Dataset) -> dict:
    return {k: json.loads(v) for k, v in dataset.attrs.items() if k != "title"}

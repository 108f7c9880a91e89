"""Several laws of contacts beside each other, with the same blocks."""

import json
from collections.abc import Mapping

import numpy as np
import xarray as xr

from ..formats.align import align
from ..formats.directory import NewFile
from ..formats.files import write_text
from . import drawing
from .output import COLLECTOR_COLUMNS, collector_rows
from .runs import Ending
from .slope_file import SlopeStudy
from .study import PERCENTILES

STOPS = (*PERCENTILES, 100)
FILES = ("comparison.csv", "comparison.png", "report.txt", "manifest.json")
COLLECTOR_FILES = ("comparison_collectors.csv", "comparison_collectors.png")


def names_of_files(study: SlopeStudy) -> tuple[str, ...]:
    """Names of the files that compare the laws of a study."""
    return FILES + (COLLECTOR_FILES if len(study.collectors) else ())


def write_comparison(
    study: SlopeStudy, datasets: Mapping[str, xr.Dataset], new: NewFile
) -> None:
    """Write comparison.csv, comparison_collectors.csv, report.txt, manifest.json and
    drawings, each whole or not at all.

    Args:
        study: any of those compared.
        datasets: of each law, by its name.
        new: gives the path of a file.

    Raises OSError where the file system refuses.
    """
    write_text(new("comparison.csv"), _csv(_law_columns(), _law_rows(datasets)))
    drawing.plot_comparison(datasets, study.profile, new("comparison.png"))
    if len(study.collectors):
        rows = [
            (_quoted(law), *row)
            for law, dataset in datasets.items()
            for row in collector_rows(dataset)
        ]
        write_text(
            new("comparison_collectors.csv"), _csv(("law", *COLLECTOR_COLUMNS), rows)
        )
        drawing.plot_compared_collectors(datasets, new("comparison_collectors.png"))
    write_text(new("report.txt"), in_words(datasets) + "\n")
    manifest = {"title": study.title, "laws": {}}
    for law, dataset in datasets.items():
        manifest["laws"][law] = {
            k: json.loads(v) for k, v in dataset.attrs.items() if k != "title"
        }
    write_text(new("manifest.json"), json.dumps(manifest, indent=1) + "\n")


def in_words(datasets: Mapping[str, xr.Dataset]) -> str:
    """Endings, where blocks stopped and what passes the collectors, by each law."""
    first = next(iter(datasets.values()))
    blocks = first.sizes["block"]
    lines = [f"{first.title}: the same {blocks} blocks by {len(datasets)} laws"]
    found = [e for e in Ending if any(_count(d, e) for d in datasets.values())]
    percentiles = (f"{p} %" for p in PERCENTILES)
    rows = [("law", *map(str, found), "impacts", *percentiles, "farthest")]
    for law, dataset in datasets.items():
        stops = (f"{v:.5g}" if np.isfinite(v) else "-" for v in _stops(dataset))
        counts = (str(_count(dataset, ending)) for ending in found)
        rows.append((law, *counts, f"{np.median(dataset.impacts):.4g}", *stops))
    lines += ["endings, median impacts, and x where blocks stopped [m]", align(rows)]
    if any(_count(d, Ending.failed) for d in datasets.values()):
        lines.append("Blocks that failed are in no number but their count.")
    quantities = {
        "passage_speed_mps": 1.0,
        "passage_energy_J": 1e-3,
        "passage_centre_height_m": 1.0,
    }
    collectors = first.collector.values if "collector" in first.sizes else ()
    for place, x in enumerate(collectors):
        rows = [("law", "pass", "speed", "", "energy", "", "height", "")]
        for law, dataset in datasets.items():
            valid = int(np.sum(drawing.valid_blocks(dataset)))
            passing = int(dataset.blocks_passing.values[place])
            values = [
                factor * dataset[f"{name}_percentiles"].sel(percentile=p).values[place]
                for name, factor in quantities.items()
                for p in (50, 95)
            ]
            cells = (f"{v:.4g}" if np.isfinite(v) else "-" for v in values)
            rows.append((law, f"{passing / valid:.1%}" if valid else "-", *cells))
        lines.append(
            f"first passages at x = {x:g} m: speed [m/s], energy [kJ] and height of "
            "the centre [m], median and 95 %"
        )
        lines.append(align(rows))
    return "\n".join(lines)


def _law_columns() -> tuple[str, ...]:
    return (
        *("law", "blocks", *(str(e).replace(" ", "_") for e in Ending)),
        *("impacts_p50", *(f"stop_x_p{p}_m" for p in STOPS)),
        *("max_height_p95_m", "max_speed_p95_mps", "max_energy_p95_J"),
    )


def _law_rows(datasets: Mapping[str, xr.Dataset]) -> list[tuple[str, ...]]:
    rows = []
    for law, dataset in datasets.items():
        valid = drawing.valid_blocks(dataset)
        largest = (
            np.percentile(dataset[name].values[valid], 95) if np.any(valid) else np.nan
            for name in ("max_height_m", "max_speed_mps", "max_energy_J")
        )
        counts = (_count(dataset, ending) for ending in Ending)
        numbers = (np.median(dataset.impacts), *_stops(dataset), *largest)
        cells = (dataset.sizes["block"], *counts, *map(float, numbers))
        rows.append((_quoted(law), *map(str, cells)))
    return rows


def _stops(dataset: xr.Dataset) -> np.ndarray:
    """Percentiles of x where blocks stopped."""
    x = dataset.x_m.values[dataset.ending.values == str(Ending.stopped)]
    return np.percentile(x, STOPS) if len(x) else np.full(len(STOPS), np.nan)


def _count(dataset: xr.Dataset, ending: Ending) -> int:
    return int(np.sum(dataset.ending.values == str(ending)))


def _csv(heads: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    return "\n".join(",".join(row) for row in (heads, *rows)) + "\n"


def _quoted(text: str) -> str:
    return '"' + text.replace('"', '""') + '"'

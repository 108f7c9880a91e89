"""Files of a run-out study, and of a comparison of contact laws."""

import itertools
import json
from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np
import xarray as xr

from ...io.datasets import write_netcdf
from ...io.files import write_text
from ...io.output_files import NewFile
from ...plotting.style import save_figure
from ...reports.document import Box, Document, Part, Picture, ReportSection
from ...reports.json_tree import json_text
from ...reports.tables import Table, at_x, place_text
from ..trajectory import Ending
from . import drawing
from .barriers import barriers_in_json, effect_table, estimate_table, estimates_of
from .intervals import DIFFERS, Percentile, is_apart
from .map_files import names_of_map_files, write_map_files
from .report_page import slope_report
from .results import (
    RUN_LEFT,
    counts_of,
    run_left,
    second_of,
    stops_of,
    valid_blocks,
)
from .run_study import PERCENTILES, simulate
from .second_run import kinematics_of, note
from .slope_file import SlopeStudy

STOP_COLUMNS = (
    *("block", "ending", "x_m", "y_m", "time_s", "impacts", "hops", "events"),
    *("energy_at_release_J", "energy_at_end_J"),
    *("max_height_m", "max_speed_mps", "max_energy_J"),
)
QUANTITIES = (
    *("passage_speed_mps", "passage_energy_J", "passage_translational_energy_J"),
    *("passage_rotational_energy_J", "passage_spin_radps"),
    *("passage_centre_height_m", "passage_lowest_height_m"),
)
COMPARED = {
    **{"passage_speed_mps": 1.0, "passage_energy_J": 1e-3},
    "passage_centre_height_m": 1.0,
}
"""Quantities at collectors by which laws are compared, and their factors."""

STUDY_FILES = (
    *("blocks.nc", "stops.csv", "profile.png", "envelopes.png", "stops.png"),
    *("report.html", "manifest.json"),
)
COLLECTOR_COLUMNS = (
    *("collector_m", "blocks_passing", "quantity"),
    *(f"p{p}" for p in PERCENTILES),
    *(f"p{p}_{end}" for p in PERCENTILES for end in ("low", "high")),
    *(f"second_run_p{p}" for p in PERCENTILES),
    *(f"second_run_p{p}_{end}" for p in PERCENTILES for end in ("low", "high")),
    *(f"p{p}_differs" for p in PERCENTILES),
)
STOPS = (*PERCENTILES, 100)
LAW_COLUMNS = (
    *("law", "blocks", *(str(e).replace(" ", "_") for e in Ending)),
    *("impacts_p50", *(f"stop_x_p{p}_m" for p in STOPS)),
    *("max_height_p95_m", "max_speed_p95_mps", "max_energy_p95_J"),
)
COMPARISON_FILES = ("comparison.csv", "comparison.png", "report.html", "manifest.json")


def names_of_files(study: SlopeStudy, comparison: bool = False) -> tuple[str, ...]:
    """List the names of the files of a study, or of a comparison of its laws."""
    settings, prefix = study.settings, "comparison_" if comparison else ""
    names = [*(COMPARISON_FILES if comparison else STUDY_FILES)]
    if len(settings.collectors):
        names += [f"{prefix}collectors.csv", f"{prefix}collectors.png"]
    if settings.barriers:
        names.append(f"{prefix}barriers.csv")
    return (*names, *(() if comparison else names_of_map_files(study)))


def write_slope_study(study: SlopeStudy, dataset: xr.Dataset, new: NewFile) -> Document:
    """Write the files of `names_of_files`: dataset, tables, maps, report and drawings,
    each whole or not at all.

    Args:
        dataset: result of `run_slope_study`.
        new: gives the path of a file by its name.

    Returns the report. Raises OSError where the file system refuses.
    """
    write_netcdf(new("blocks.nc"), dataset)
    write_text(new("stops.csv"), _stop_table(dataset).csv())
    # The first trajectories are drawn, and so computed once more.
    first = simulate(study, np.arange(min(50, study.release.count)))
    grounds = _grounds(study)
    figures = {
        "profile": drawing.draw_trajectories(
            first, grounds, study.settings.collectors, study.inputs.title
        ),
        "envelopes": drawing.draw_envelopes(dataset, study.profile, grounds),
        "stops": drawing.draw_stops(dataset),
    }
    write_map_files(study, dataset, first, new)
    report = slope_report(study, dataset, first)
    write_text(new("report.html"), report.page())
    if len(study.settings.collectors):
        write_text(new("collectors.csv"), collector_table(dataset).csv())
        series = {dataset.title: dataset}
        if (second := second_of(dataset)) is not None:
            series = dict([(kinematics_of(study), dataset), second])
        figures["collectors"] = drawing.draw_collectors(series)
    for name, figure in figures.items():
        save_figure(figure, new(f"{name}.png"))
    manifest = {"title": dataset.title} | _attributes(dataset)
    if study.settings.barriers:
        at_barriers = estimates_of(dataset)
        write_text(new("barriers.csv"), estimate_table(at_barriers).csv())
        manifest["barriers"] = barriers_in_json(at_barriers)
    write_text(new("manifest.json"), json_text(manifest))
    return report


def _grounds(study: SlopeStudy) -> drawing.DrawnGrounds:
    inputs = study.inputs
    return drawing.drawn_grounds(study.profile, inputs.materials, inputs.random_ground)


def _stop_table(dataset: xr.Dataset) -> Table:
    whole: dict[str, type] = dict.fromkeys(("block", "impacts", "hops", "events"), int)
    columns = [
        dataset[name].values.astype(whole.get(name, dataset[name].dtype)).tolist()
        for name in STOP_COLUMNS
    ]
    return Table(STOP_COLUMNS, list(zip(*columns, strict=True)))


def collector_table(dataset: xr.Dataset) -> Table:
    """List percentiles of first passages, a row for each collector and quantity, and
    the ends of the percentiles' intervals of 95 %, of both runs."""
    rows, second = [], second_of(dataset)
    for place, x in enumerate(dataset.collector.values.tolist()):
        passing = int(dataset.blocks_passing.values[place])
        for name in QUANTITIES:
            cells, ends = _percentiles_with_ends(dataset, name, place)
            others: list = [None] * 3 * len(PERCENTILES)
            apart: list = [None] * len(PERCENTILES)
            if second is not None:
                others, other_ends = _percentiles_with_ends(second[1], name, place)
                pairs = zip(ends, other_ends, strict=True)
                apart = [DIFFERS if is_apart(*pair) else "" for pair in pairs]
            about = (x, passing, name.removeprefix("passage_"))
            rows.append((*about, *cells, *others, *apart))
    return Table(COLLECTOR_COLUMNS, rows)


def _percentiles_with_ends(
    dataset: xr.Dataset, name: str, place: int
) -> tuple[list[float], list[tuple[float, float]]]:
    """Give the values of percentiles with the ends behind them, and the ends alone."""
    passages = dataset[name].values[valid_blocks(dataset), place]
    percentiles = [Percentile.of(passages, p) for p in PERCENTILES]
    ends = [percentile.ends for percentile in percentiles]
    return [*(p.value for p in percentiles), *itertools.chain(*ends)], ends


def write_comparison(
    study: SlopeStudy, datasets: Mapping[str, xr.Dataset], new: NewFile
) -> Document:
    """Write report, tables, manifest and drawings of a comparison, each whole or not at
    all.

    Args:
        study: any of the studies compared.
        datasets: result of each law, by its name.
        new: gives the path of a file by its name.

    Returns the report. Raises OSError where the file system refuses.
    """
    draw = partial(drawing.draw_comparison, datasets, study.profile, _grounds(study))
    picture = Picture(
        draw,
        "Stops and envelopes by each law",
        "Where blocks stopped, and 95 % of the blocks' largest values, by each law.",
    )
    report = comparison_report(datasets, picture)
    write_text(new("report.html"), report.page())
    write_text(new("comparison.csv"), _law_table(datasets).csv())
    save_figure(draw(), new("comparison.png"))
    if len(study.settings.collectors):
        table = _of_laws(datasets, collector_table)
        write_text(new("comparison_collectors.csv"), table.csv())
        figure = drawing.draw_collectors(datasets)
        save_figure(figure, new("comparison_collectors.png"))
    if study.settings.barriers:
        table = _of_laws(datasets, lambda one: estimate_table(estimates_of(one)))
        write_text(new("comparison_barriers.csv"), table.csv())
    laws = {law: _attributes(dataset) for law, dataset in datasets.items()}
    manifest = {"title": study.inputs.title, "laws": laws}
    write_text(new("manifest.json"), json_text(manifest))
    return report


def comparison_report(
    datasets: Mapping[str, xr.Dataset], picture: Picture | None = None
) -> Document:
    """Report endings, stops and passages by each law."""
    first = next(iter(datasets.values()))
    counts = {law: counts_of(dataset) for law, dataset in datasets.items()}
    endings = [e for e in map(str, Ending) if any(e in of for of in counts.values())]
    rows = []
    for law, dataset in datasets.items():
        *stops, last = _stop_percentiles(dataset)
        if run_left(dataset):
            last = stops_of(dataset).min()
        places = (place_text(x, 5) for x in (*stops, last))
        ended = (counts[law].get(ending, 0) for ending in endings)
        rows.append((law, *ended, _percentile(dataset, "impacts", 50), *places))
    heads = ("impacts", *(f"{p} %" for p in PERCENTILES), "farthest")
    lines = [f"The same {first.sizes['block']} blocks by {len(datasets)} laws."]
    if str(Ending.failed) in endings:
        lines.append("Blocks that failed are in no number but their count.")
    if any(map(run_left, datasets.values())):
        lines.append(RUN_LEFT)
    for law, dataset in datasets.items():
        lines += [f"{law}: {line}" for line in note(dataset)]
    answer: list[Part] = [
        Box("verdict", lines),
        "Endings, median impacts, and x where blocks stopped [m]:",
        Table(("law", *endings, *heads), rows),
        picture,
    ]
    collectors = first.collector.values if "collector" in first.sizes else ()
    sections = [
        ReportSection(f"First passages at {at_x(x)}", _passages(datasets, place))
        for place, x in enumerate(collectors)
    ]
    sections += [
        ReportSection(f"Barriers by {law}", [effect_table(estimates_of(dataset))])
        for law, dataset in datasets.items()
    ]
    return Document(first.title, answer, sections)


def _passages(datasets: Mapping[str, xr.Dataset], place: int) -> Sequence[Part]:
    rows = []
    for law, dataset in datasets.items():
        valid = int(np.sum(valid_blocks(dataset)))
        passing = int(dataset.blocks_passing.values[place])
        values = [
            factor * dataset[f"{name}_percentiles"].sel(percentile=p).values[place]
            for name, factor in COMPARED.items()
            for p in (50, 95)
        ]
        rows.append((law, f"{passing / valid:.1%}" if valid else None, *values))
    return [
        "Speed [m/s], energy [kJ] and height of the centre [m], median and 95 %:",
        Table(("law", "pass", "speed", "", "energy", "", "height", ""), rows),
    ]


def _law_table(datasets: Mapping[str, xr.Dataset]) -> Table:
    rows = []
    for law, dataset in datasets.items():
        largest = (
            _percentile(dataset, name, 95)
            for name in ("max_height_m", "max_speed_mps", "max_energy_J")
        )
        counts = [counts_of(dataset).get(str(ending), 0) for ending in Ending]
        impacts = _percentile(dataset, "impacts", 50)
        numbers = (impacts, *_stop_percentiles(dataset), *largest)
        rows.append((law, dataset.sizes["block"], *counts, *map(float, numbers)))
    return Table(LAW_COLUMNS, rows)


def _percentile(dataset: xr.Dataset, name: str, percent: float) -> float:
    """Compute a percentile over the blocks that did not fail and have the number, which
    one that ends at its release may lack; NaN without any."""
    values = dataset[name].values[valid_blocks(dataset)]
    values = values[np.isfinite(values)]
    return float(np.percentile(values, percent)) if len(values) else float("nan")


def _stop_percentiles(dataset: xr.Dataset) -> np.ndarray:
    x = stops_of(dataset)
    return np.percentile(x, STOPS) if len(x) else np.full(len(STOPS), np.nan)


def _of_laws(
    datasets: Mapping[str, xr.Dataset], table_of: Callable[[xr.Dataset], Table]
) -> Table:
    """Join the tables of the laws."""
    tables = {law: table_of(dataset) for law, dataset in datasets.items()}
    columns = next(iter(tables.values())).columns
    rows = [(law, *row) for law, table in tables.items() for row in table.rows]
    return Table(("law", *columns), rows)


def _attributes(dataset: xr.Dataset) -> dict:
    return {k: json.loads(v) for k, v in dataset.attrs.items() if k != "title"}

"""Page of a study to hand over: one file of HTML that needs nothing else."""

import itertools
import json
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from ...reports.document import Box, Document, Interactive, Part, ReportSection
from ...reports.tables import Table, at_x, interval_text, listed, place_text
from ...scene_quantities import SHAPE
from ..contacts.contact_models import ClosedForm, FullModel
from ..terrain import ROLLING_COLUMN, ROLLING_FRICTION_ANGLE
from ..trajectory import Ending, Runs
from .barriers import (
    DESIGN_PERCENTILES,
    NOTE,
    BarrierEstimates,
    Estimate,
    design_table,
    effect_table,
    estimates_of,
    too_few,
)
from .drawing import grounds_of
from .intervals import (
    Percentile,
    interval_beside,
    least_blocks,
    percentile_interval,
)
from .map_files import NO_MAP
from .page_data import QUANTITIES, page_curves, page_profile
from .results import (
    RUN_LEFT,
    counts_of,
    run_left,
    second_of,
    stops_of,
    valid_blocks,
)
from .run_study import PERCENTILES, inputs_of
from .second_run import PASSAGES, energy_table, note
from .slope_file import SlopeStudy

if TYPE_CHECKING:
    import markupsafe

PACKAGE = "jaximpact.runout.study"
CURVES = (
    "The share of all blocks whose largest value between the two ends of a bin exceeds "
    "a value. It is at least that at any single x in the bin. Intervals hold the true "
    "percentile with 95 %, if the blocks are random samples; a dash says that there "
    "are too few blocks."
)
ARM_WORK = (
    "Arm work is the work of the normal force through the arm from the point where "
    "penetration is measured to the point where the force acts. It has no source: "
    "it is an error of the model, and zero by WorkConjugate. An impact gains energy "
    "where kinetic and potential energy after it are more than before."
)
BARRIERS = (
    "A block passes over if its lowest point, at its first passage of x, is above the "
    "top; else it breaks the barrier if its kinetic energy exceeds the capacity, and "
    "is stopped if not."
)


def slope_report(study: SlopeStudy, dataset: xr.Dataset, runs: Runs) -> Document:
    """Report a study.

    Args:
        dataset: result of the study.
        runs: trajectories to draw, the first ones.
    """
    drawing = page_profile(study, runs)
    estimates = estimates_of(dataset)
    profile = drawing | _placed(drawing["scale"]) | {"blocks": study.release.count}
    answer: list[Part] = [
        Box("verdict", _summary(study, dataset, estimates)),
        Box("warning", ["What is not known", *unknowns(study, dataset)]),
        Interactive(PACKAGE, "profile.jinja", profile),
    ]
    curves = {
        "curve_names": [words for _, words, _, _ in QUANTITIES],
        "bins": study.settings.bins,
        "percents": PERCENTILES,
        "has_collectors": bool(len(study.settings.collectors)),
        "data": _data(study, dataset, drawing["scale"]),
    }
    settings = [
        _settings(study),
        ReportSection("Blocks and releases", [_inputs(study)]),
        ReportSection("Ground along the profile", [_grounds(study)]),
    ]
    sections = [
        ReportSection(
            "Exceedance at any place",
            [CURVES, Interactive(PACKAGE, "exceedance.jinja", curves)],
            printed=False,
        ),
        ReportSection("Endings", [_ending_table(dataset), *_stops(dataset)]),
        ReportSection("Collectors", _collectors(dataset)),
        ReportSection("Barriers", barrier_parts(estimates)),
        ReportSection("Energy at impacts", _energies(study, dataset)),
        ReportSection("Settings", settings, printed=False),
        ReportSection("Computed from", [_origin(dataset)], printed=False),
    ]
    return Document(study.inputs.title, answer, sections)


def barrier_parts(estimates: Sequence[BarrierEstimates]) -> list[Part]:
    """Write what becomes of blocks at barriers; nothing where there are none."""
    if not estimates:
        return []
    return [
        BARRIERS,
        effect_table(estimates),
        "Design values of the blocks that arrive:",
        design_table(estimates),
    ]


def _placed(scale: dict) -> dict:
    """Place the drawing of the profile on the page, 960 pixels wide with margins for
    the axes: its height, and the transformation of its units to pixels."""
    height = int(np.clip(900 * scale["height"] / scale["width"] + 40, 260, 620))
    pixels = min(900 / scale["width"], (height - 40) / scale["height"])
    size = pixels * scale["unit"]
    left = 500 - 0.5 * scale["width"] * pixels
    return {
        "drawing_height": height,
        "transform": f"matrix({size:.6g} 0 0 {-size:.6g} {left:.1f} {height - 30})",
    }


def _data(study: SlopeStudy, dataset: xr.Dataset, scale: dict) -> "markupsafe.Markup":
    """Write what the script draws: curves of all bins, and names of places."""
    import markupsafe

    top = scale["y"] + scale["height"]
    places = [(x, top, at_x(x)) for x in study.settings.collectors.tolist()] + [
        (b.x, float(study.profile.height(b.x)) + b.height, b.name)
        for b in study.settings.barriers
    ]
    if places:
        start = places[-1][0]
    else:
        x = dataset.x_m.values[np.isfinite(dataset.x_m.values)]
        start = float(np.median(x)) if len(x) else float(dataset.bin_left_m.values[0])
    data = page_curves(dataset) | {
        "scale": scale,
        "places": [
            dict(zip(("x", "y", "words"), place, strict=True)) for place in places
        ],
        "start": start,
    }
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    # Within a script a title with its end would cut it off.
    return markupsafe.Markup(text.replace("<", "\\u003c"))


def _summary(
    study: SlopeStudy,
    dataset: xr.Dataset,
    at_barriers: Sequence[BarrierEstimates],
) -> list[str]:
    endings = counts_of(dataset)
    counts = ", ".join(f"{count} {name}" for name, count in endings.items())
    lines = [f"{study.release.count} blocks, contacts by {study.law.name}: {counts}."]
    stopped = stops_of(dataset)
    if len(stopped):
        left = run_left(dataset)
        percent, word = (5, "beyond") if left else (95, "before")
        ends = percentile_interval(stopped, percent)
        lines.append(
            f"95 % of those that stopped did so {word} x = "
            f"{place_text(np.percentile(stopped, percent))} m (95 % interval: "
            f"{interval_text(*ends, place_text)}{_stop_beside(dataset, ends, percent)})"
            f", the farthest at {place_text(stopped.min() if left else stopped.max())} "
            "m."
        )
    for barrier, estimates, other, others in at_barriers:
        name = barrier.name
        line = f"{name[:1].upper()}{name[1:]}: {_counts_at(estimates)} the barrier"
        if others:
            line += f" (by {other}: {_counts_at(others)} it)"
        lines.append(f"{line}.")
    if study.inputs.smoothing is not None:
        lines.append(f"The profile is {study.inputs.smoothing}.")
    return lines


def _counts_at(by_name: Mapping[str, Estimate]) -> str:
    arrive = by_name["share_arriving"].count
    over, broken = (by_name[f"share_{n}_of_all"].count or 0 for n in ("over", "broken"))
    return f"{arrive} blocks arrive, {over} pass over, and {broken} break"


def _stop_beside(dataset: xr.Dataset, ends: tuple[float, float], percent: int) -> str:
    """Write a percentile of stops of the second run, to stand in brackets."""
    second = second_of(dataset)
    stopped = stops_of(second[1]) if second else np.zeros(0)
    if second is None or not len(stopped):
        return ""
    other = Percentile.of(stopped, percent)
    interval = interval_beside(other.ends, ends, place_text)
    return f"; by {second[0]}: {place_text(other.value)} m, {interval}"


def unknowns(study: SlopeStudy, dataset: xr.Dataset) -> list[str]:
    """List what a reader must not take from the numbers."""
    endings = counts_of(dataset)
    law = f"Contacts are by {study.law.name}, whose coefficients are taken as known."
    if not isinstance(study.law.contacts, ClosedForm):
        law = (
            "The ground's laws are readings of the literature that the model's paper "
            "names, not its authors' code: docs/model.md and docs/limits.md."
        )
    lines = [
        *note(dataset),
        law,
        "Intervals say how much the numbers would change with other random blocks. "
        "They do not include errors of the model, the ground or the releases, and mean "
        "nothing where blocks are combinations of lists.",
        "The motion is plane: blocks neither leave the profile sideways nor break.",
    ]
    varied = ROLLING_COLUMN in study.inputs.random_ground
    angles = study.profile.rolling_friction_angle
    if np.all(angles == ROLLING_FRICTION_ANGLE) and not varied:
        lines.append(
            "The angle of rolling friction is its default, 20°: an assumption, unless "
            "it was measured."
        )
    if run_left(dataset):
        lines.append(RUN_LEFT)
    failed = endings.get(str(Ending.failed), 0)
    if failed:
        lines.append(f"{failed} blocks failed, and are in no number but their count.")
    cut = sum(endings.get(str(e), 0) for e in (Ending.time_limit, Ending.event_limit))
    if cut:
        lines.append(
            f"{cut} blocks were cut off by a limit and might have gone farther: shares "
            "that pass are lower bounds."
        )
    lines += _few_at_collectors(dataset) + too_few(estimates_of(dataset))
    if study.settings.barriers:
        lines.append(NOTE)
    if study.inputs.placement is None:
        lines.append(NO_MAP)
    return lines


def _few_at_collectors(dataset: xr.Dataset) -> list[str]:
    if "collector" not in dataset.sizes:
        return []
    counts = zip(dataset.collector.values, dataset.blocks_passing.values, strict=True)
    few = [f"{n} pass {at_x(x)}" for x, n in counts if n < least_blocks(99)]
    needed = f"An interval of the 99 % value needs {least_blocks(99)} blocks"
    return [f"{needed}, but {listed(few)}."] if few else []


def _ending_table(dataset: xr.Dataset) -> Table:
    endings, blocks = counts_of(dataset), dataset.sizes["block"]
    rows = [(n, count, f"{count / blocks:.1%}") for n, count in endings.items()]
    return Table(("ending", "blocks", "share"), rows)


def _stops(dataset: xr.Dataset) -> list[Part]:
    stopped = stops_of(dataset)
    lines: list[Part] = [f"x where blocks stopped [m]: {_stop_words(stopped)}."]
    if len(stopped) and (second := second_of(dataset)):
        kinematics, other = second
        words = _stop_words(stops_of(other), stopped)
        lines.append(f"The same by {kinematics}: {words}.")
    return lines if len(stopped) else ["No block stopped."]


def _stop_words(x: np.ndarray, beside: np.ndarray | None = None) -> str:
    """Write percentiles of stops with their intervals, marked where those of others do
    not overlap."""
    words = []
    for percent in PERCENTILES if len(x) else ():
        here = Percentile.of(x, percent)
        other = None if beside is None else percentile_interval(beside, percent)
        interval = interval_beside(here.ends, other, place_text)
        words.append(f"{percent} % by {place_text(here.value, 5)} ({interval})")
    return ", ".join(
        (*words, f"all by {place_text(x.max(), 5)}") if len(x) else ("no block",)
    )


def _energies(study: SlopeStudy, dataset: xr.Dataset) -> list[Part]:
    """Write the ledger of the impacts, and what it means."""
    if not isinstance(study.law.contacts, FullModel):
        return []
    second = json.loads(dataset.attrs["second_run"])
    if isinstance(second, str):
        return [energy_table(dataset), f"No second run: {second}."]
    return [ARM_WORK, energy_table(dataset)]


def _collectors(dataset: xr.Dataset) -> list[Part]:
    if "collector" not in dataset.sizes:
        return []
    heads, rows = [], []
    for p in PERCENTILES:
        heads += [f"{p} %", "interval"] if p in DESIGN_PERCENTILES else [f"{p} %"]
    valid = valid_blocks(dataset)
    for place, x in enumerate(dataset.collector.values):
        passing = int(dataset.blocks_passing.values[place])
        share = f" ({passing / np.sum(valid):.1%})" if np.any(valid) else ""
        first = (place_text(x, 6), f"{passing}{share}")
        for word, (name, unit, factor) in PASSAGES.items():
            values = factor * dataset[name].values[valid, place]
            rows.append((*first, word, unit, *_percentile_cells(values)))
            if second := second_of(dataset):
                other = second[1][name].values[valid_blocks(second[1]), place]
                cells = _percentile_cells(factor * other, values)
                rows.append(("", "", f"- by {second[0]}", unit, *cells))
            first = ("", "")
    return [
        "First passages of the blocks that pass: percentiles with their intervals.",
        Table(("x [m]", "pass", "", "unit", *heads), rows),
    ]


def _percentile_cells(values: np.ndarray, beside: np.ndarray | None = None) -> list:
    """Write percentiles of the finite values, those for design with their intervals,
    marked where those of others do not overlap."""
    cells = []
    for percent in PERCENTILES:
        percentile = Percentile.of(values, percent)
        cells.append(percentile.value)
        if percent in DESIGN_PERCENTILES:
            other = None if beside is None else percentile_interval(beside, percent)
            cells.append(interval_beside(percentile.ends, other))
    return cells


def _settings(study: SlopeStudy) -> Table:
    inputs, settings = study.inputs, study.settings
    rows = [(f"contacts: {k}", str(v)) for k, v in study.law.description.items()]
    rows += [
        ("blocks", str(study.release.count)),
        ("seed", str(inputs.seed)),
        ("bins of x", str(settings.bins)),
        ("time limit [s]", f"{settings.limits.time:g}"),
        ("event limit", str(settings.limits.events)),
        ("hop threshold", f"{settings.limits.hop_threshold:g}"),
    ]
    if inputs.smoothing is not None:
        rows.append(("profile", str(inputs.smoothing)))
    if (place := inputs.placement) is not None:
        rows += [
            ("x = 0 on the map", f"{place.easting:.2f}, {place.northing:.2f}"),
            ("direction of x, from north", f"{np.degrees(place.azimuth):g}°"),
            ("reference system", place.crs),
        ]
    # A law in closed form knows none of the soil's laws.
    closed = isinstance(study.law.contacts, ClosedForm)
    laws = {n: v for n, v in study.laws.items() if n == SHAPE or not closed}
    rows += [(f"law: {name}", str(law)) for name, law in laws.items()]
    ground = inputs.ground_table.items()
    rows += [(f"ground: {name}", _in_words(value)) for name, value in ground]
    return Table(("setting", "value"), rows)


def _in_words(value) -> str:
    """Write a value of the study's file, tables as pairs."""
    if not isinstance(value, dict):
        return str(value)
    return "; ".join(f"{name} {_in_words(inner)}" for name, inner in value.items())


def _inputs(study: SlopeStudy) -> Table:
    """Write the ranges of what each block gets."""
    rows = []
    for name, (_, values, about) in inputs_of(study).items():
        unit = about.get("units", "")
        if values.dtype.kind != "f":
            kinds = sorted({str(value) for value in values})
            rows.append((name, unit, ", ".join(kinds), "", ""))
            continue
        ends = values.min(), np.median(values), values.max()
        # Places of releases may be in national coordinates.
        rows.append((name, unit, *(place_text(end, 5) for end in ends)))
    return Table(("quantity", "unit", "least", "median", "largest"), rows)


def _grounds(study: SlopeStudy) -> Table:
    """Write the stretches of one ground each, 40 at most."""
    inputs, x = study.inputs, study.profile.x
    number, descriptions = grounds_of(
        study.profile, inputs.materials, inputs.random_ground
    )
    rows, start = [], 0
    for ground, segments in itertools.groupby(number):
        stop = start + len(list(segments))
        words = ", ".join(descriptions[ground]) or "one ground"
        rows.append((place_text(x[start], 6), place_text(x[stop], 6), words))
        start = stop
    if len(rows) > 40:
        more = f"and {len(rows) - 40} more stretches, in the study's files"
        rows = [*rows[:40], ("", "", more)]
    return Table(("x from [m]", "to [m]", "ground"), rows)


def _origin(dataset: xr.Dataset) -> Table:
    files, programs = (json.loads(dataset.attrs[key]) for key in ("files", "versions"))
    rows = [*files.items(), *programs.items()]
    return Table(("file or program", "SHA-256 or version"), rows)

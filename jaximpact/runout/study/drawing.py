"""Drawings of a run-out study."""

import itertools
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ...plotting.style import (
    BLUE,
    COLOURS,
    GREY,
    MOST_CURVES,
    ORANGE,
    SOIL,
    VERMILION,
    curve,
    empty_panel,
    in_style,
    legend_outside,
    panels,
    plain,
)
from ...reports.tables import at_x, place_text
from ..terrain import Profile, ground_columns, ground_values, stretches
from ..trajectory import Runs
from ..trajectory_drawing import add_trajectories, bottom_of, height_of
from .results import edges_of, stops_of, valid_blocks

CURVES = (
    ("passage_energy_J", "kinetic energy [kJ]", 1e-3),
    ("passage_speed_mps", "speed [m/s]", 1.0),
    ("passage_centre_height_m", "height of the centre [m]", 1.0),
)
"""Quantities at collectors: variable, label and factor."""
ENVELOPES = (
    ("envelope_height_m", "height of the centre\nabove ground [m]", 1.0),
    ("envelope_speed_mps", "speed [m/s]", 1.0),
    ("envelope_energy_J", "kinetic energy [kJ]", 1e-3),
)
"""Quantities along the profile: variable, label and factor."""
GROUNDS = (SOIL, "#c9b99a", "#dfe3d3", "#b8c4bb", "#e6cfc3", "#a89f91")
"""Colours of the segments' grounds, in the order in which they come."""
RANDOM = GROUNDS[3]
"""Colour of ground whose classes are by what differs from block to block on it."""
CLASSES = 5
"""Number of classes of a quantity of the ground that varies along the profile."""


@in_style
def draw_trajectories(
    runs: Runs, drawn: "DrawnGrounds", collectors: np.ndarray, title: str
) -> Figure:
    """Draw the trajectories of all blocks, coloured by speed, over the profile."""
    title = f"{plain(title)}: the first {runs.release.count} trajectories"
    figure, (axes,) = panels(height=height_of(runs.profile), title=title)
    grounds = _draw_ground(axes, runs.profile, drawn)
    handles = add_trajectories(axes, runs)
    for x in collectors:
        line = axes.axvline(x, color=GREY, ls="--", lw=1.0, label="collector")
    handles += [line] if len(collectors) else []
    handles += grounds
    legend_outside(figure, handles, ncols=4)
    return figure


@in_style
def draw_envelopes(
    dataset: xr.Dataset, profile: Profile, drawn: "DrawnGrounds"
) -> Figure:
    """Draw height, speed and energy along the profile: the largest, and percentiles of
    the blocks' own largest in each bin."""
    title = f"{plain(dataset.title)}: largest values of the blocks in bins of x"
    figure, axes = panels(5, height=1.7, title=title, sharex=True)
    edges = edges_of(dataset)
    for panel, (name, _, factor) in zip(axes[:3], ENVELOPES, strict=True):
        largest = factor * dataset[f"{name}_max"].values
        panel.stairs(largest, edges, color=GREY, label="largest")
        for percentile, colour in zip((99, 95, 50), COLOURS, strict=False):
            values = dataset[f"{name}_percentiles"].sel(percentile=percentile).values
            panel.stairs(
                factor * values, edges, color=colour, label=f"{percentile} % of blocks"
            )
    axes[3].stairs(dataset.blocks_in_bin.values, edges, color="black")
    axes[3].set_ylabel("blocks\nin the bin")
    axes[3].set_ylim(bottom=0.0)
    _finish_envelopes(axes[:3], axes[4], profile, drawn)
    figure.align_ylabels(axes)
    legend_outside(figure, [*axes[0].patches, *axes[4].patches][:4])
    return figure


@in_style
def draw_stops(dataset: xr.Dataset) -> Figure:
    """Draw where blocks stopped; the other endings are counted in the title."""
    names, counts = np.unique(dataset.ending.values, return_counts=True)
    endings = ", ".join(f"{c} {n}" for n, c in zip(names, counts, strict=True))
    figure, (axes,) = panels(height=3.4, title=f"{plain(dataset.title)}: {endings}")
    places = stops_of(dataset)
    if len(places):
        # Stops in one place, but for rounding, leave no room for bins.
        ends = places.min(), max(places.max(), places.min() + 1e-3)
        bins = min(60, max(10, len(places) // 20))
        axes.hist(places, bins=bins, range=ends, color=BLUE)
        # Of stops within centimetres 0.01 would stand here, and +181.3 in a corner.
        axes.ticklabel_format(axis="x", style="plain", useOffset=False)
        for percentile, colour in ((50, ORANGE), (95, VERMILION)):
            x = np.percentile(places, percentile)
            label = f"{percentile} % of them by {place_text(x)} m"
            axes.axvline(x, color=colour, lw=2.0, label=label)
        axes.set(xlabel="x where the block stopped [m]", ylabel="number of blocks")
        legend_outside(figure)
    else:
        empty_panel(axes, "no block stopped")
    return figure


@in_style
def draw_collectors(datasets: Mapping[str, xr.Dataset]) -> Figure:
    """Draw the exceedance at each collector: the fraction of all blocks that did not
    fail whose first passage exceeds a value. A curve starts at the fraction that
    passes. Of several laws, each collector has a row. Of more collectors than curves
    can be told apart, so many are drawn, from the first to the last."""
    first, several = next(iter(datasets.values())), len(datasets) > 1
    count = first.sizes["collector"]
    places = np.linspace(0, count - 1, min(count, MOST_CURVES)).round().astype(int)
    collectors = [at_x(x) for x in first.collector.values[places]]
    if several:
        rows = [
            [(law, dataset, place) for law, dataset in datasets.items()]
            for place in places
        ]
    else:
        named = zip(collectors, places, strict=True)
        rows = [[(words, first, place) for words, place in named]]
    figure, axes = panels(
        *(len(rows), len(CURVES)),
        height=2.4 if several else 3.2,
        title=f"{plain(first.title)}: exceedance at collectors, first passages",
        sharey=True,
        sharex="col",
    )
    for row, series in enumerate(rows):
        in_row = axes[row * len(CURVES) : (row + 1) * len(CURVES)]
        for number, (label, dataset, place) in enumerate(series):
            _draw_exceedance(in_row, dataset, place, label, curve(number))
        place = f"{collectors[row]}:\n" if several else ""
        in_row[0].set_ylabel(f"{place}fraction of blocks [-]")
    # Only now: a limit set on shared axes stops them from growing with the next row.
    for panel, (_, label, _) in zip(axes[-len(CURVES) :], CURVES, strict=True):
        panel.set_xlabel(label)
    for panel in axes:
        panel.set_xlim(left=0.0)
        panel.set_ylim(0.0, 1.02)
    some = f"{len(places)} of {count} collectors; the tables have all"
    title = some if len(places) < count else None
    legend_outside(figure, axes[0].lines, ncols=3, title=title)
    return figure


@in_style
def draw_comparison(
    datasets: Mapping[str, xr.Dataset], profile: Profile, drawn: "DrawnGrounds"
) -> Figure:
    """Draw where blocks stopped by each law, and its envelopes along the profile."""
    title = plain(next(iter(datasets.values())).title)
    title = f"{title}: stops, and 95 % of the blocks' largest values in bins of x"
    figure, axes = panels(5, height=1.8, title=title, sharex=True)
    for place, (law, dataset) in enumerate(datasets.items()):
        x, look = np.sort(stops_of(dataset)), curve(place)
        count = max(np.sum(valid_blocks(dataset)), 1)
        fraction = np.array([0.0, *range(1, len(x) + 1), len(x)]) / count
        places = np.concatenate([profile.x[:1], x, profile.x[-1:]])
        axes[0].step(places, fraction, where="post", label=plain(law), **look)
        for panel, (name, _, factor) in zip(axes[1:], ENVELOPES, strict=False):
            values = dataset[f"{name}_percentiles"].sel(percentile=95).values
            panel.stairs(factor * values, edges_of(dataset), baseline=None, **look)
    axes[0].set_ylabel("fraction\nstopped by x [-]")
    axes[0].set_ylim(0.0, 1.02)
    _finish_envelopes(axes[1:4], axes[4], profile, drawn)
    figure.align_ylabels(axes)
    legend_outside(figure, axes[0].lines, ncols=3)
    return figure


def _draw_exceedance(
    axes: list[Axes], dataset: xr.Dataset, collector: int, label: str, look: dict
) -> None:
    for panel, (name, _, factor) in zip(axes, CURVES, strict=True):
        values = factor * dataset[name].values[valid_blocks(dataset), collector]
        passing = np.sort(values[np.isfinite(values)])
        fraction = np.arange(len(passing), 0, -1) / max(len(values), 1)
        first = fraction[0] if len(fraction) else 0.0
        x, y = np.append(0.0, passing), np.append(first, fraction)
        panel.step(x, y, label=plain(label), **look)


def _finish_envelopes(
    axes: list[Axes], ground: Axes, profile: Profile, drawn: "DrawnGrounds"
) -> None:
    for panel, (_, label, _) in zip(axes, ENVELOPES, strict=True):
        panel.set_ylabel(label)
        panel.set_ylim(bottom=0.0)
    _draw_ground(ground, profile, drawn)
    ground.set(xlabel="x [m]", ylabel="y [m]")


def _draw_ground(axes: Axes, profile: Profile, drawn: "DrawnGrounds") -> list[Patch]:
    """Draw the profile, segments of different ground in different colours, and give the
    entries of a legend."""
    surface, bottom = np.stack([profile.x, profile.y], axis=1), bottom_of(profile)
    for ground, colour in enumerate(drawn.colours):
        areas = [
            [
                (profile.x[start], bottom),
                *surface[start : stop + 1],
                (profile.x[stop], bottom),
            ]
            for start, stop in stretches(np.equal(drawn.number, ground))
        ]
        # An edge, or pale gaps show between the cells of a ground that varies.
        filled = PolyCollection(areas, facecolor=colour, ec=colour, lw=0.3)
        axes.add_collection(filled)
    axes.plot(profile.x, profile.y, color="black", lw=1.0)
    entries = [
        Patch(color=colour, label=f"ground: {words}")
        for colour, words in zip(drawn.colours, drawn.words, strict=True)
    ]
    return entries if len(entries) > 1 else []


class DrawnGrounds(NamedTuple):
    """Grounds of a profile as they are drawn."""

    number: list[int]  # number of each segment's ground
    colours: list[str]  # colour of each ground
    words: list[str]  # description of each ground, in a few words


def drawn_grounds(
    profile: Profile,
    materials: Sequence[str] = (),
    random: Mapping[str, np.ndarray] | None = None,
) -> DrawnGrounds:
    """Choose colours and words for the grounds of a profile, by `grounds_of`.

    Where there are more than there are colours, as on a ground that varies along the
    way, they are drawn in classes of equal width of the quantity that varies most, and
    a class where that is random.
    """
    random = random or {}
    number, descriptions = grounds_of(profile, materials, random)
    if len(descriptions) > len(GROUNDS):
        classes = _classes(*_ground_values(profile, random))
        alike = f"{len(descriptions)} grounds without known differences"
        return classes or DrawnGrounds([0] * len(number), [SOIL], [alike])
    words = [", ".join(words[:3]) or "one ground" for words in descriptions]
    return DrawnGrounds(number, list(GROUNDS[: len(descriptions)]), words)


def _classes(names: list[str], values: np.ndarray) -> DrawnGrounds | None:
    """Divide ground, with names and values as `_ground_values` gives them; None where
    all known values are the same."""
    known = np.ma.masked_invalid(values)
    spread = known.std(axis=0) / np.ma.maximum(abs(known).mean(axis=0), 1e-12)
    most = int(np.argmax(spread.filled(0.0)))
    known = known[:, most]
    if not known.max() > known.min():
        return None
    edges = np.linspace(known.min(), known.max(), CLASSES + 1)
    place = np.searchsorted(edges, values[:, most], "right") - 1
    place = np.clip(place, 0, CLASSES - 1)
    # Pale colours of the map: trajectories must be seen on them.
    shades = colormaps["YlOrBr"](np.linspace(0.1, 0.55, CLASSES))
    colours = [to_hex(shade) for shade in shades]
    words = [
        f"{names[most]} = {low:.3g} to {high:.3g}"
        for low, high in itertools.pairwise(edges)
    ]
    is_random = np.isnan(values[:, most])
    if np.any(is_random):
        place[is_random] = CLASSES
        colours.append(RANDOM)
        words.append(f"{names[most]} random")
    return DrawnGrounds(place.tolist(), colours, words)


def grounds_of(
    profile: Profile, materials: Sequence[str], random: Mapping[str, np.ndarray]
) -> tuple[list[int], list[list[str]]]:
    """Number the different grounds of a profile, in the order in which they come.

    Args:
        materials: material of each segment, "" for none.
        random: quantities that differ from block to block on some segments, where the
            profile's values say nothing of them: by name, bool `(segments,)`.

    Returns:
        The number of each segment's ground, and for each ground its material, if it has
        one, and the quantities in which grounds differ, such as "c_v = 0.5" or "c_v
        random".
    """
    names, values = _ground_values(profile, random)
    known = list(materials or [""] * profile.segments)
    index = [known.index(material) for material in known]
    keys, first, number = np.unique(
        np.column_stack([index, np.where(np.isnan(values), np.inf, values)]),
        axis=0,
        return_index=True,
        return_inverse=True,
    )  # NaN would be unlike itself.
    order = list(dict.fromkeys(number.ravel().tolist()))
    differing = np.flatnonzero(np.any(keys[:, 1:] != keys[0, 1:], axis=0))
    descriptions = [
        [known[first[ground]]] * bool(known[first[ground]])
        + [_value_words(names[i], values[first[ground], i]) for i in differing]
        for ground in order
    ]
    return [order.index(ground) for ground in number.ravel().tolist()], descriptions


def _value_words(name: str, value: float) -> str:
    return f"{name} random" if np.isnan(value) else f"{name} = {value:g}"


def _ground_values(
    profile: Profile, random: Mapping[str, np.ndarray]
) -> tuple[list[str], np.ndarray]:
    """Give names and values, `(segments, quantities)` in the units of the names, of the
    ground's quantities; NaN where they are random."""
    columns, values = ground_columns(profile.soil), ground_values(profile)
    in_units = [
        np.where(random.get(name, False), np.nan, values[name] / column.factor)
        for name, column in columns.items()
    ]
    return [*columns], np.stack(in_units, axis=1)

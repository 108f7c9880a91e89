"""The drawings of a run-out study."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from ..formats.files import replacing
from ..plotting import BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, SOIL, VERMILION, plain
from .profile import Profile
from .runs import Ending, Runs

SPACING = 0.02
"""Between moments of a drawn trajectory [s]."""
CURVES = (
    ("passage_energy_J", "kinetic energy [kJ]", 1e-3),
    ("passage_speed_mps", "speed [m/s]", 1.0),
    ("passage_centre_height_m", "height of the centre [m]", 1.0),
)
ENVELOPES = (
    ("envelope_height_m", "height of the centre\nabove the ground [m]", 1.0),
    ("envelope_speed_mps", "speed [m/s]", 1.0),
    ("envelope_energy_J", "kinetic energy [kJ]", 1e-3),
)
COLOURS = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY, GREY)


def plot_trajectories(
    runs: Runs, collectors: np.ndarray, title: str, path: Path
) -> None:
    """The profile and the ways of all blocks of the runs, coloured by speed."""
    shape = np.ptp(runs.profile.y) / np.ptp(runs.profile.x)
    figure = _figure(11.0, float(np.clip(2.5 + 11.0 * shape, 4.0, 10.0)))
    axes = figure.add_subplot()
    _draw_ground(axes, runs.profile)
    lines, speeds = [], []
    for i in range(runs.release.count):
        way = runs.path(i, SPACING)
        points = np.stack([way["x"], way["y"]], axis=1)
        lines.append(np.stack([points[:-1], points[1:]], axis=1))
        speeds.append(np.hypot(way["v_x"], way["v_y"])[:-1])
    coloured = LineCollection(
        np.concatenate(lines), array=np.concatenate(speeds), cmap="viridis", lw=1.2
    )
    axes.add_collection(coloured)
    axes.plot(runs.x, runs.y, ".", color=VERMILION, ms=4, label="end")
    for x in collectors:
        axes.axvline(x, color=GREY, ls="--", lw=1.0)
    figure.colorbar(
        coloured, ax=axes, label="speed [m/s]", location="bottom", shrink=0.5, aspect=40
    )
    axes.set(xlabel="x [m]", ylabel="y [m]")
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.legend(loc="upper right")
    dashed = "; dashed: collectors" if len(collectors) else ""
    told = f"the first {runs.release.count} trajectories{dashed}"
    axes.set_title(f"{plain(title)}: {told}")
    _save(figure, path)


def plot_envelopes(dataset: xr.Dataset, profile: Profile, path: Path) -> None:
    """Height, speed and energy along the profile: the largest, and percentiles of the
    blocks' own largest in each bin."""
    figure = _figure(10.0, 9.0)
    panels = figure.subplots(4, 1, sharex=True)
    x = np.append(dataset.bin_left_m.values, dataset.bin_right_m.values[-1])
    for axes, (name, label, factor) in zip(panels, ENVELOPES, strict=False):
        axes.stairs(
            factor * dataset[f"{name}_max"].values, x, color=GREY, label="largest"
        )
        for percentile, colour in zip((99, 95, 50), COLOURS, strict=False):
            values = dataset[f"{name}_percentiles"].sel(percentile=percentile).values
            axes.stairs(factor * values, x, color=colour, label=f"{percentile} %")
        axes.set_ylabel(label)
        axes.set_ylim(bottom=0.0)
    panels[0].legend(ncols=4, loc="upper right")
    panels[0].set_title(f"{plain(dataset.title)}: along the profile, in bins of x")
    _draw_ground(panels[3], profile)
    panels[3].set(xlabel="x [m]", ylabel="y [m]")
    beside = panels[3].twinx()
    beside.stairs(dataset.blocks_in_bin.values, x, color=BLUE)
    beside.set_ylabel("blocks in the bin", color=BLUE)
    beside.set_ylim(bottom=0.0)
    _save(figure, path)


def plot_stops(dataset: xr.Dataset, path: Path) -> None:
    """Where blocks stopped; the other endings are counted in the title."""
    figure = _figure(9.0, 4.5)
    axes = figure.add_subplot()
    stopped = dataset.ending.values == str(Ending.stopped)
    places = dataset.x_m.values[stopped]
    if len(places):
        axes.hist(places, bins=min(60, max(10, len(places) // 20)), color=BLUE)
        for percentile, colour in ((50, ORANGE), (95, VERMILION)):
            x = np.percentile(places, percentile)
            label = f"{percentile} % of them by {x:.4g} m"
            axes.axvline(x, color=colour, label=label)
        axes.legend()
    else:
        axes.text(0.5, 0.5, "no block stopped", ha="center", transform=axes.transAxes)
    axes.set(xlabel="x where the block stopped [m]", ylabel="blocks")
    names, counts = np.unique(dataset.ending.values, return_counts=True)
    told = ", ".join(f"{c} {n}" for n, c in zip(names, counts, strict=True))
    axes.set_title(f"{plain(dataset.title)}: {told}")
    _save(figure, path)


def plot_collectors(dataset: xr.Dataset, path: Path) -> None:
    """Exceedance at each collector: the share of all blocks that did not fail whose
    first passage exceeds a value. A curve starts at the share that passes at all."""
    figure = _figure(12.0, 4.2)
    valid = valid_blocks(dataset)
    for axes, (name, label, factor) in zip(
        figure.subplots(1, 3, sharey=True), CURVES, strict=True
    ):
        for place, x in enumerate(dataset.collector.values):
            values = factor * dataset[name].values[valid, place]
            _exceedance(axes, values, place, f"x = {x:g} m")
        _finish_exceedance(axes, label)
    figure.axes[0].set_ylabel("share of blocks that exceed it [-]")
    figure.axes[0].legend()
    figure.suptitle(f"{plain(dataset.title)}: exceedance at collectors")
    _save(figure, path)


def plot_comparison(datasets: Mapping[str, xr.Dataset], profile, path: Path) -> None:
    """Where blocks stopped by each law, and its envelopes along the profile."""
    figure = _figure(10.0, 11.0)
    panels = figure.subplots(5, 1, sharex=True)
    for place, (law, dataset) in enumerate(datasets.items()):
        stopped = dataset.ending.values == str(Ending.stopped)
        x = np.sort(dataset.x_m.values[stopped])
        share = np.arange(1, len(x) + 1) / max(np.sum(valid_blocks(dataset)), 1)
        places = np.concatenate([profile.x[:1], x, profile.x[-1:]])
        share = np.concatenate([[0.0], share, share[-1:] if len(x) else [0.0]])
        look = _look(place)
        panels[0].step(places, share, where="post", label=plain(law), **look)
        edges = np.append(dataset.bin_left_m.values, dataset.bin_right_m.values[-1])
        for axes, (name, _, factor) in zip(panels[1:], ENVELOPES, strict=False):
            values = dataset[f"{name}_percentiles"].sel(percentile=95).values
            axes.stairs(factor * values, edges, baseline=None, **look)
    panels[0].set_ylabel("share of blocks\nstopped by x [-]")
    panels[0].set_ylim(0.0, 1.02)
    panels[0].legend()
    for axes, (_, label, _) in zip(panels[1:], ENVELOPES, strict=False):
        axes.set_ylabel(f"{label}, 95 %")
        axes.set_ylim(bottom=0.0)
    for axes in panels[:4]:
        axes.grid(alpha=0.3)
    _draw_ground(panels[4], profile)
    panels[4].set(xlabel="x [m]", ylabel="y [m]")
    title = plain(next(iter(datasets.values())).title)
    panels[0].set_title(f"{title}: the same blocks by {len(datasets)} laws of contact")
    _save(figure, path)


def plot_compared_collectors(datasets: Mapping[str, xr.Dataset], path: Path) -> None:
    """Exceedance at each collector, by each law: the share of all blocks that did not
    fail whose first passage exceeds a value."""
    first = next(iter(datasets.values()))
    places = first.collector.values
    figure = _figure(12.0, 0.8 + 3.4 * len(places))
    rows = figure.subplots(len(places), 3, sharey=True, sharex="col", squeeze=False)
    for row, x in enumerate(places):
        for axes, (name, label, factor) in zip(rows[row], CURVES, strict=True):
            for place, (law, dataset) in enumerate(datasets.items()):
                values = factor * dataset[name].values[valid_blocks(dataset), row]
                _exceedance(axes, values, place, law)
            _finish_exceedance(axes, label)
        rows[row, 0].set_ylabel(f"x = {x:g} m: share of\nblocks that exceed it [-]")
    rows[0, 0].legend()
    title = plain(first.title)
    figure.suptitle(f"{title}: exceedance at collectors by laws of contact")
    _save(figure, path)


def valid_blocks(dataset: xr.Dataset) -> np.ndarray:
    """Which blocks did not fail."""
    return dataset.ending.values != str(Ending.failed)


def _exceedance(axes, values: np.ndarray, place: int, label: str) -> None:
    """A curve of the share of values above each.

    Args:
        values: of all blocks that did not fail; NaN for those that do not pass.
    """
    passing = np.sort(values[np.isfinite(values)])
    share = np.arange(len(passing), 0, -1) / max(len(values), 1)
    axes.step(
        np.concatenate([[0.0], passing]),
        np.concatenate([share[:1] if len(share) else [0.0], share]),
        label=plain(label),
        **_look(place),
    )


def _finish_exceedance(axes, label: str) -> None:
    axes.set_xlabel(f"{label}, first passage")
    axes.set_xlim(left=0.0)
    axes.set_ylim(0.0, 1.02)
    axes.grid(alpha=0.3)


def _look(place: int) -> dict:
    """Colour and stroke of the curve in a place."""
    return {
        "color": COLOURS[place % len(COLOURS)],
        "ls": ("-", "--", ":")[place // len(COLOURS) % 3],
    }


def _figure(width: float, height: float) -> Figure:
    return Figure(figsize=(width, height), layout="constrained")


def _draw_ground(axes, profile: Profile) -> None:
    depth = 0.05 * max(np.ptp(profile.y), 0.2 * np.ptp(profile.x))
    axes.fill_between(profile.x, profile.y, profile.y.min() - depth, color=SOIL)
    axes.plot(profile.x, profile.y, color="black", lw=1.0)


def _save(figure: Figure, path: Path) -> None:
    with replacing(path) as temporary:
        figure.savefig(temporary, dpi=150)

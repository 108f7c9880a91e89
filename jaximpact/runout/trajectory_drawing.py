"""Drawing of trajectories over their profile."""

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from ..plotting.style import SOIL, VERMILION, WIDTH, On, in_style, panels
from .terrain import Profile

SPACING = 0.05
"""Time between points [s]; smooth at the size of a page."""


@in_style
def draw_runs(runs: Any, on: On = None) -> Figure:
    """Draw trajectories, coloured by speed, over the profile; `runs` is a `Runs`."""
    figure, (axes,) = panels(height=height_of(runs.profile), on=on)
    x, y = runs.profile.x, runs.profile.y
    axes.fill_between(x, y, bottom_of(runs.profile), color=SOIL)
    axes.plot(x, y, color="black", lw=1.0)
    axes.legend(handles=add_trajectories(axes, runs), loc="upper right")
    return figure


def add_trajectories(axes: Axes, runs: Any) -> list[Artist]:
    """Add trajectories to a panel, with a bar of the colours, and return the entries
    of a legend."""
    lines, speeds = [], []
    for i in range(runs.release.count):
        samples = runs.path(i, SPACING)
        points = np.stack([samples["x"], samples["y"]], axis=1)
        lines += [*np.stack([points[:-1], points[1:]], axis=1)]
        speeds.append(np.hypot(samples["v_x"], samples["v_y"])[:-1])
    coloured = LineCollection(lines, array=np.concatenate(speeds), cmap="viridis", lw=1)
    axes.add_collection(coloured)
    bar: dict[str, Any] = dict(label="speed [m/s]", shrink=0.8, pad=0.01)
    axes.figure.colorbar(coloured, ax=axes, **bar)
    axes.set(xlabel="x [m]", ylabel="y [m]")
    axes.set_aspect("equal", adjustable="datalim")
    ends = axes.plot(runs.x, runs.y, ".", color=VERMILION, ms=5, label="end")
    axes.autoscale_view()
    return [*ends]


def height_of(profile: Profile) -> float:
    """Choose the height of a panel of a profile [inch]."""
    shape = np.ptp(profile.y) / np.ptp(profile.x)
    return float(np.clip(0.9 * WIDTH * shape + 1.5, 2.8, 9.0))


def bottom_of(profile: Profile) -> float:
    """Give the height down to which the ground is drawn [m]."""
    extent = max(np.ptp(profile.y), 0.2 * float(np.ptp(profile.x)))
    return float(profile.y.min() - 0.05 * extent)

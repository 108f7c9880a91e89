r"""Data of a study's page along the profile: drawing and exceedance curves.

The profile and the trajectories are paths of SVG. A piece of a trajectory has a
constant acceleration, and so is a parabola, which a quadratic Bezier curve with the
control point

$$ P_0 + \tfrac{1}{2} v_0 T $$

draws exactly, at any zoom. Coordinates are whole numbers of a small unit, and relative,
which takes few letters and adds up no rounding.

An exceedance curve holds the largest values of the blocks in a bin by their ranks.
Where there are many blocks only some ranks are kept: all of the largest ones, then
fewer and fewer.
"""

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.colors import to_hex

from ..blocks import select
from ..terrain import Profile, stretches
from ..trajectory import Pieces, Runs, state_after
from .drawing import bottom_of, drawn_grounds
from .intervals import Percentile
from .results import edges_of, valid_blocks
from .run_study import PERCENTILES
from .slope_file import SlopeStudy

CLASSES = 5
"""Number of colours of speeds."""
MOST_LETTERS = 700_000
"""Length of all paths of trajectories beyond which there are fewer trajectories."""


class Units:
    """Conversion of coordinates of the profile to those of the drawing."""

    def __init__(self, profile: Profile, highest: float):
        self.x, self.y = float(profile.x[0]), bottom_of(profile)
        self.width = float(np.ptp(profile.x))
        self.height = max(highest, float(profile.y.max())) - self.y
        # Finer than a pixel at any zoom that the page allows.
        self.unit = max(self.width, self.height) / 200_000

    def __call__(self, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Round coordinates [m] to whole units."""
        x, y = (x - self.x) / self.unit, (y - self.y) / self.unit
        return np.round(x).astype(int), np.round(y).astype(int)


def page_profile(study: SlopeStudy, runs: Runs) -> dict:
    """Collect the drawing of the profile, with the trajectories to draw: paths, colours
    and the scale."""
    profile, inputs = study.profile, study.inputs
    barriers = [
        (b.x, ground := float(profile.height(b.x)), ground + b.height)
        for b in study.settings.barriers
    ]
    finite = runs.pieces.y[np.isfinite(runs.pieces.y)]
    tops = [top for *_, top in barriers]
    heights = np.concatenate([finite, tops])
    units = Units(profile, float(np.max(heights, initial=-np.inf)))
    speeds, shown = _trajectories(runs, units)
    drawn = drawn_grounds(profile, inputs.materials, inputs.random_ground)
    known = np.isfinite(runs.x[:shown]) & np.isfinite(runs.y[:shown])
    ends = zip(*units(runs.x[:shown][known], runs.y[:shown][known]), strict=True)
    line = zip(*units(profile.x, profile.y), strict=True)
    grounds = zip(drawn.colours, drawn.words, strict=True)
    return {
        "scale": {
            **{"x": units.x, "y": units.y, "unit": units.unit},
            **{"width": units.width, "height": units.height},
        },
        "grounds": [
            {
                "path": _ground(profile, np.equal(drawn.number, ground), units),
                "colour": colour,
                "words": words,
            }
            for ground, (colour, words) in enumerate(grounds)
        ],
        "surface": "M" + " ".join(f"{x} {y}" for x, y in line),
        "speeds": speeds,
        "ends": "".join(f"M{x} {y}h0" for x, y in ends),
        "shown": shown,
        "collectors": [
            _vertical(units, x, units.y, units.y + units.height)
            for x in study.settings.collectors
        ],
        "barriers": [_vertical(units, *barrier) for barrier in barriers],
    }


def _vertical(units: Units, x: float, low: float, high: float) -> str:
    (across, _), (below, above) = units(np.array([x, x]), np.array([low, high]))
    return f"M{across} {below}V{above}"


def _ground(profile: Profile, chosen: np.ndarray, units: Units) -> str:
    """Draw the segments of one ground, neighbours together."""
    x, y = units(profile.x, profile.y)
    paths = []
    for start, stop in stretches(chosen):
        points = (f"{x[i]} {y[i]}" for i in range(start, stop + 1))
        paths.append(f"M{x[start]} 0L{' '.join(points)}V0Z")
    return "".join(paths)


def _trajectories(runs: Runs, units: Units) -> tuple[list[dict], int]:
    """Draw trajectories by classes of speed, and count those that there is room for."""
    pieces = select(runs.pieces, np.isfinite(runs.pieces.x))
    start, stop = (state_after(pieces, t) for t in (0.0, pieces.duration))
    before, after = (np.hypot(s.v_x, s.v_y) for s in (start, stop))
    fastest = max(float(np.max(np.maximum(before, after), initial=0.0)), 1e-9)
    step = fastest / CLASSES
    # A piece on which the speed changes much gets several colours.
    parts = np.clip(np.abs(after - before) / step + 1.0, 1, 2 * CLASSES).astype(int)
    of = np.repeat(np.arange(len(parts)), parts)
    nth = np.arange(len(of)) - np.repeat(np.cumsum(parts) - parts, parts)
    duration = pieces.duration[of] / parts[of]
    cut = select(pieces, of)
    middle = state_after(cut, (nth + 0.5) * duration)
    level = np.hypot(middle.v_x, middle.v_y) / step
    level = np.clip(level, 0, CLASSES - 1).astype(int)
    paths, shown = _paths(cut, nth * duration, duration, level, units)
    # The brightest lines would be too pale on the ground's colours.
    colours = colormaps["viridis"](np.linspace(0.0, 0.9, CLASSES))
    return [
        {
            "path": path,
            "colour": to_hex(colour),
            "words": f"{i * step:.3g} to {(i + 1) * step:.3g} m/s",
        }
        for i, (path, colour) in enumerate(zip(paths, colours, strict=True))
    ], shown


def _paths(
    pieces: Pieces,
    start: np.ndarray,
    duration: np.ndarray,
    level: np.ndarray,
    units: Units,
) -> tuple[list[str], int]:
    """Write a path for each class of speed, trajectory after trajectory."""
    first, last = (state_after(pieces, t) for t in (start, start + duration))
    half = 0.5 * duration
    x_0, y_0 = units(first.x, first.y)
    x_1, y_1 = units(first.x + first.v_x * half, first.y + first.v_y * half)
    x_2, y_2 = units(last.x, last.y)
    moves = np.flatnonzero((x_0 != x_2) | (y_0 != y_2))
    rows = np.stack([x_0, y_0, x_1, y_1, x_2, y_2], axis=1)[moves].tolist()
    blocks = pieces.trajectory[moves].astype(int).tolist()
    paths: list[list[str]] = [[] for _ in range(CLASSES)]
    at: list[tuple[int, int] | None] = [None] * CLASSES
    letters, shown = 0, -1
    for block, place, row in zip(blocks, level[moves].tolist(), rows, strict=True):
        if block != shown and letters > MOST_LETTERS:
            break
        shown = block
        x, y, *control, x_end, y_end = row
        text = "" if at[place] == (x, y) else f"M{x} {y}"
        text += f"q{control[0] - x} {control[1] - y} {x_end - x} {y_end - y}"
        at[place] = (x_end, y_end)
        paths[place].append(text)
        letters += len(text)
    else:
        shown = int(np.max(pieces.trajectory, initial=-1))
    return ["".join(path) for path in paths], shown + 1


QUANTITIES = (
    ("height_m", "height of the centre above the ground", "m", 1.0),
    ("speed_mps", "speed", "m/s", 1.0),
    ("energy_J", "kinetic energy", "kJ", 1e-3),
)
"""Variable, words, unit and factor."""


def page_curves(dataset: xr.Dataset) -> dict:
    """Collect the exceedance curves of all bins, ready for JSON.

    Returns:
        `blocks` that did not fail; `edges` of the bins [m]; `counts` of blocks in them;
        `ranks`, for each bin, of the values that are kept; and `quantities`, each with
        its `values` at these ranks, and `percentiles`: value and ends of the interval,
        or None.
    """
    valid = valid_blocks(dataset)
    # Some 8000 points of all curves of a quantity together, at least 12 of each.
    most = int(np.clip(8000 // dataset.sizes["bin"], 12, 120))
    counts = dataset.blocks_in_bin.values.astype(int).tolist()
    ranks = [kept_ranks(count, most) for count in counts]
    quantities = []
    for name, words, unit, factor in QUANTITIES:
        in_bins = dataset[f"{name}_in_bin"].values[valid].astype(float).T
        falling = [
            np.sort(factor * values[np.isfinite(values)])[::-1] for values in in_bins
        ]
        kept = [
            [_short(values[rank - 1]) for rank in of_bin]
            for values, of_bin in zip(falling, ranks, strict=True)
        ]
        percentiles = [
            [[*map(_short, Percentile.of(values, p))] for p in PERCENTILES]
            for values in falling
        ]
        about = {"words": words, "unit": unit}
        quantities.append(about | {"values": kept, "percentiles": percentiles})
    return {
        "blocks": int(np.sum(valid)),
        "edges": edges_of(dataset).tolist(),
        "counts": counts,
        "ranks": ranks,
        "percents": list(PERCENTILES),
        "quantities": quantities,
    }


def kept_ranks(count: int, most: int) -> list[int]:
    """Choose at most so many ranks of sorted values, from 1 to their count: they grow
    by a constant factor, and by 1 where that is more."""
    if count <= most:
        return list(range(1, count + 1))
    return np.unique(np.round(np.geomspace(1, count, most)).astype(int)).tolist()


def _short(value: float) -> float | None:
    """Round a number to four digits; None for one that is not known."""
    return float(f"{value:.4g}") if np.isfinite(value) else None

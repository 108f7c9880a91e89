"""Exceedance curves of a study's page: at every bin along the profile, in few numbers.

A curve holds the largest values of the blocks in a bin by their ranks. Where there are
many blocks only some ranks are kept: all of the largest ones, then fewer and fewer.
"""

import numpy as np
import xarray as xr

from .drawing import valid_blocks
from .intervals import percentile_intervals
from .run_study import PERCENTILES

QUANTITIES = (
    ("height_m", "height of the centre above the ground", "m", 1.0),
    ("speed_mps", "speed", "m/s", 1.0),
    ("energy_J", "kinetic energy", "kJ", 1e-3),
)
"""Variable, words, unit and factor."""
POINTS = 8000
"""Number of points of all curves of a quantity, but for `LEAST`."""
MOST, LEAST = 120, 12
"""Number of points of a curve, at most and at least."""


def page_curves(dataset: xr.Dataset) -> dict:
    """Collect the exceedance curves of all bins, ready for JSON.

    Returns:
        `blocks` that did not fail; `edges` of the bins [m]; `counts` of blocks in them;
        `ranks`, for each bin, of the values that are kept; and `quantities`, each with
        its `values` at these ranks, and `percentiles`: value and ends of the interval,
        or None.
    """
    valid = valid_blocks(dataset)
    bins = dataset.sizes["bin"]
    most = int(np.clip(POINTS // bins, LEAST, MOST))
    counts = dataset.blocks_in_bin.values.astype(int).tolist()
    ranks = [kept_ranks(count, most) for count in counts]
    quantities = []
    for name, words, unit, factor in QUANTITIES:
        of_bins = dataset[f"{name}_in_bin"].values[valid].astype(float).T
        sorted_values = [_falling(factor * values) for values in of_bins]
        quantities.append(
            {
                "words": words,
                "unit": unit,
                "values": [
                    [_short(values[rank - 1]) for rank in of_bin]
                    for values, of_bin in zip(sorted_values, ranks, strict=True)
                ],
                "percentiles": [_percentiles(values) for values in sorted_values],
            }
        )
    edges = [*dataset.bin_left_m.values.tolist(), float(dataset.bin_right_m.values[-1])]
    return {
        "blocks": int(np.sum(valid)),
        "edges": [_short(edge, 7) for edge in edges],
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


def _falling(values: np.ndarray) -> np.ndarray:
    return np.sort(values[np.isfinite(values)])[::-1]


def _percentiles(values: np.ndarray) -> list[list[float | None]]:
    if not len(values):
        return [[None, None, None] for _ in PERCENTILES]
    found = np.percentile(values, PERCENTILES)
    intervals = percentile_intervals(values, PERCENTILES)
    return [
        [_short(v), *map(_short, ends)]
        for v, ends in zip(found, intervals, strict=True)
    ]


def _short(value: float, digits: int = 4) -> float | None:
    """Round a number; None for one that is not known."""
    return float(f"{value:.{digits}g}") if np.isfinite(value) else None

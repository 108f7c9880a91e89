"""Fig. 8: vertical impacts at all orientations (sets I, II and IV)."""

import numpy as np
import xarray as xr

from ..parts import (
    FALLS,
    MARGIN,
    NOTHING,
    RISES,
    between,
    conditions,
    from_to,
    judge,
    steps,
    steps_that_go,
    trend,
)
from ..study import Datasets
from ..symmetry import asymmetry
from ..verdict import Judgement

WING = 0.05
"""Part of the range of e_n by which it rises from its minimum to either side."""
PEAK_NEAR = (2.0, 3.0)
"""A_r between which a peak counts as one at 2.5."""


def e_n_along_the_axes(sets: Datasets) -> Judgement:
    """e_n rises with A_r along the major axis and falls along the minor one."""
    major, minor = sets["I"].e_n, sets["II"].e_n
    sphere = major.sel(aspect_ratio=1.0, drop=True)
    long = major.aspect_ratio > 1.0
    between_them = ((minor < sphere) & (sphere < major)).sel(aspect_ratio=long)
    return judge(
        f"major {from_to(major)}, {steps_that_go(major, RISES)}; "
        f"minor {from_to(minor)}, {steps_that_go(minor, FALLS)}",
        [
            trend(major, RISES),
            trend(minor, FALLS),
            conditions(between_them, "sphere in between"),
        ],
        {
            "sphere": sphere,
            "longest_along_the_major_axis": major[-1],
            "longest_along_the_minor_axis": minor[-1],
        },
    )


def swallow_wings(sets: Datasets) -> Judgement:
    """e_n over the orientation: symmetric, with a minimum on either side of 90°."""
    e_n = sets["IV"].e_n
    ranges = e_n.max("orientation_deg") - e_n.min("orientation_deg")
    half = e_n.sel(orientation_deg=e_n.orientation_deg <= 90.0)
    lowest = half.min("orientation_deg")
    rises = [
        half.sel(orientation_deg=end) - lowest > WING * ranges for end in (0.0, 90.0)
    ]
    long = e_n.aspect_ratio > 1.0
    wings = (rises[0] & rises[1]).sel(aspect_ratio=long)
    minima = half.idxmin("orientation_deg").sel(aspect_ratio=long)
    return judge(
        f"range {from_to(ranges)}, {steps_that_go(ranges, RISES)}; minimum at "
        f"{between(minima, '°')}, {between(lowest.sel(aspect_ratio=long))}",
        [
            symmetric(e_n),
            conditions(wings, "wings"),
            trend(ranges, RISES),
        ],
        {"largest_range": ranges.max(), "least_e_n": lowest.min()},
    )


def symmetric(values: xr.DataArray, sign: float = 1.0):
    """Whether values over the orientation are symmetric, at each A_r."""
    what = "symmetric" if sign > 0.0 else "antisymmetric"
    # What a sphere does not do is symmetric either way.
    values = values.where(abs(values) > NOTHING, 0.0)
    return conditions(asymmetry(values, sign).fillna(0.0) <= MARGIN, what)


def _symmetry_of(name: str, unit: str, factor: float = 1.0):
    def of_sets(sets: Datasets) -> Judgement:
        values = factor * sets["IV"][name]
        apart = asymmetry(values.where(abs(values) > NOTHING, 0.0)).fillna(0.0)
        return judge(
            f"{between(values, unit)}, mirrored to {float(apart.max()):.0e}",
            [symmetric(values)],
            {"asymmetry": apart.max()},
        )

    of_sets.__doc__ = f"`{name}` of set IV is symmetric about 90°."
    return of_sets


def rotation(sets: Datasets) -> Judgement:
    """The rotation is antisymmetric, and largest at an A_r near 2.5."""
    turn = np.degrees(sets["IV"].rotation_rad)
    inside = (turn.orientation_deg > 0.0) & (turn.orientation_deg < 90.0)
    size = abs(turn.sel(orientation_deg=inside))
    peaks = size.idxmax("aspect_ratio")
    low, high = PEAK_NEAR
    near = (peaks >= low) & (peaks <= high)
    single = xr.apply_ufunc(
        _rises_then_falls, size, input_core_dims=[["aspect_ratio"]], vectorize=True
    )
    top = size.max("orientation_deg")
    return judge(
        f"peak at A_r {between(peaks)}, median {float(peaks.median()):g}; largest over "
        f"all orientations {float(top.max()):.3g}° at A_r {float(top.idxmax()):g}, "
        f"{float(top[-1]):.3g}° at A_r 4",
        [
            symmetric(turn, -1.0),
            conditions(near & single, "rises to a peak near A_r 2.5 and falls"),
        ],
        {"median_A_r_of_peak": peaks.median(), "largest_deg": top.max()},
    )


def _rises_then_falls(values: np.ndarray) -> bool:
    peak = int(np.argmax(values))
    taken = steps(values)
    return bool(np.all(taken[:peak] > 0) and np.all(taken[peak:] < 0))


CLAIMS = {
    "C17": e_n_along_the_axes,
    "C18": swallow_wings,
    "C19": _symmetry_of("max_penetration_m", "m"),
    "C20": rotation,
    "C21": _symmetry_of("max_normal_force_N", "kN", 1e-3),
    "C22": _symmetry_of("max_moment_Nm", "kN m", 1e-3),
}

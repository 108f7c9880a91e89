"""Fig. 5 and the abstract: vertical impacts along the major and along the minor axis
(sets I and II)."""

import numpy as np
import xarray as xr

from ..parts import (
    FALLS,
    MARGIN,
    RISES,
    Part,
    Parts,
    between,
    condition,
    conditions,
    from_to,
    judge,
    steps_that_go,
    trend,
)
from ..study import Datasets
from ..verdict import Judgement, Verdict

DEPTH_EXCESS = (3.3, 50.0)
"""Percent, as in the abstract."""
FORCE_EXCESS = (0.3, 60.0)
"""Percent, as in the abstract."""
ABOUT_HALF = (40.0, 60.0)
"""Percent that counts as "about 50 %"."""


def excess_percent(sets: Datasets, name: str) -> xr.DataArray:
    """By how much a quantity is larger along the major axis than along the minor one,
    in percent, for A_r above 1."""
    major, minor = sets["I"][name], sets["II"][name]
    percent = 100.0 * (major / minor - 1.0)
    return percent.sel(aspect_ratio=percent.aspect_ratio > 1.0)


def penetration_grows_along_the_minor_axis(sets: Datasets) -> Judgement:
    """The largest u_n of set II rises with A_r."""
    depth = sets["II"].max_penetration_m.values
    return judge(
        f"{from_to(depth, 'm')}, {steps_that_go(depth, RISES)}, "
        f"{steps_that_go(depth, FALLS)}",
        [trend(depth, RISES)],
        {"sphere_m": depth[0], "longest_m": depth[-1]},
    )


def force_falls_along_the_minor_axis(sets: Datasets) -> Judgement:
    """The largest N of set II falls with A_r."""
    force = sets["II"].max_normal_force_N.values / 1e3
    return judge(
        f"{from_to(force, 'kN')}, {steps_that_go(force, FALLS)}, "
        f"{steps_that_go(force, RISES)}",
        [trend(force, FALLS)],
        {"sphere_kN": force[0], "longest_kN": force[-1]},
    )


def penetrates_more_along_the_major_axis(sets: Datasets) -> Judgement:
    """The largest u_n of set I is above that of set II."""
    excess = excess_percent(sets, "max_penetration_m")
    return judge(
        f"by {between(excess, '%')}",
        [conditions(excess > 100.0 * MARGIN, "deeper")],
        {"least_percent": excess.min(), "largest_percent": excess.max()},
    )


def excess_of_penetration(sets: Datasets) -> Judgement:
    """The excess of u_n along the major axis lies in the range of the abstract."""
    return _within(excess_percent(sets, "max_penetration_m"), DEPTH_EXCESS)


def excess_of_force(sets: Datasets) -> Judgement:
    """The excess of N along the major axis lies in the range of the abstract."""
    return _within(excess_percent(sets, "max_normal_force_N"), FORCE_EXCESS)


def _within(excess: xr.DataArray, bounds: tuple[float, float]) -> Judgement:
    low, high = bounds
    return judge(
        f"{from_to(excess, '%')} at A_r {from_to(excess.aspect_ratio)}",
        [conditions((excess >= low) & (excess <= high), "within")],
        {"at_least_A_r_percent": excess[0], "at_largest_A_r_percent": excess[-1]},
    )


def half_as_long_along_the_major_axis(sets: Datasets) -> Judgement:
    """Contacts of set I last about half as long as those of set II."""
    shorter = -excess_percent(sets, "duration_s")
    low, high = ABOUT_HALF

    def part_of(percent: float) -> Part:
        if low <= percent <= high:
            return condition(True)
        is_shorter = percent > 100.0 * MARGIN
        return Part(Verdict.partly if is_shorter else Verdict.fails, 0, 1)

    longer = -shorter
    major, minor = (1e3 * sets[name].duration_s.values for name in ("I", "II"))
    return judge(
        f"longer by {from_to(longer, '%')} at A_r {from_to(longer.aspect_ratio)}: "
        f"{from_to(major[1:], 'ms')} against {from_to(minor[1:], 'ms')}"
        if np.all(longer > 0.0)
        else f"shorter by {from_to(shorter, '%')} at A_r "
        f"{from_to(shorter.aspect_ratio)}",
        [
            Parts(
                "about half as long",
                "aspect_ratio",
                shorter.aspect_ratio.values,
                [part_of(float(percent)) for percent in shorter],
            )
        ],
        {
            "shorter_at_least_A_r_percent": shorter[0],
            "shorter_at_largest_A_r_percent": shorter[-1],
        },
    )


CLAIMS = {
    "C05": penetration_grows_along_the_minor_axis,
    "C06": force_falls_along_the_minor_axis,
    "C07": penetrates_more_along_the_major_axis,
    "C08": excess_of_penetration,
    "C09": half_as_long_along_the_major_axis,
    "C10": excess_of_force,
}

"""Fig. 7: inclined impacts along the major axis (set III)."""

import numpy as np
import xarray as xr

from ..parts import FALLS, RISES, between, conditions, judge, steps, trends
from ..study import Datasets, along_major_axis
from ..verdict import Judgement


def peaks_inside(values: xr.DataArray, dimension: str) -> xr.DataArray:
    """Whether lines along a dimension have a maximum beyond both of their ends."""

    def of_line(line):
        top = line[np.argmax(line)]
        return steps([line[0], top])[0] > 0 and steps([line[-1], top])[0] > 0

    return xr.apply_ufunc(
        of_line, values, input_core_dims=[[dimension]], vectorize=True
    )


def place_of_peak(values: xr.DataArray, dimension: str, unit: str) -> str:
    """Where lines along a dimension have their maxima, in words."""
    return f"peak at {between(values.idxmax(dimension), unit)}"


def penetration(sets: Datasets) -> Judgement:
    """The largest u_n falls with the angle and rises with A_r."""
    depth = along_major_axis(sets).max_penetration_m
    return judge(
        between(depth, "m"),
        [
            trends(depth, "angle_deg", FALLS, "falls with the angle"),
            trends(depth, "aspect_ratio", RISES, "grows with A_r"),
        ],
        {"least_m": depth.min(), "largest_m": depth.max()},
    )


def force(sets: Datasets) -> Judgement:
    """The largest N falls with A_r and with the angle."""
    force = along_major_axis(sets).max_normal_force_N / 1e3
    first, top = force.isel(angle_deg=0), force.max("angle_deg")
    rise = 100.0 * (top / first - 1.0)
    return judge(
        f"{between(force, 'kN')}, {place_of_peak(force, 'angle_deg', '°')}, above that "
        f"at {float(force.angle_deg[0]):g}° by up to {float(rise.max()):.2g} %",
        [
            trends(force, "aspect_ratio", FALLS, "falls with A_r"),
            trends(force, "angle_deg", FALLS, "falls with the angle"),
        ],
        {"rise_before_the_peak_percent": rise.max()},
    )


def rotation(sets: Datasets) -> Judgement:
    """The rotation has a peak over the angle and falls with A_r, but for the sphere."""
    turn = np.degrees(along_major_axis(sets).rotation_rad)
    sphere = turn.sel(aspect_ratio=1.0)
    others = turn.sel(aspect_ratio=turn.aspect_ratio > 1.0)
    low, high = others.min("aspect_ratio"), others.max("aspect_ratio")
    return judge(
        f"{place_of_peak(turn, 'angle_deg', '°')}; sphere {between(sphere, '°')}, "
        f"others {between(others, '°')}",
        [
            conditions(peaks_inside(turn, "angle_deg"), "peaks inside"),
            trends(others, "aspect_ratio", FALLS, "falls with A_r from 1.5"),
            conditions((sphere > low) & (sphere < high), "sphere in between"),
        ],
        {
            "largest_of_sphere_deg": sphere.max(),
            "least_of_others_deg": others.min(),
            "largest_of_others_deg": others.max(),
        },
    )


def rotational_ratio(sets: Datasets) -> Judgement:
    """The largest R_r of the course has a peak over the angle and rises with A_r."""
    ratio = sets["courses"].R_r.max("step")
    return judge(
        f"{between(ratio)}, {place_of_peak(ratio, 'angle_deg', '°')}",
        [
            conditions(peaks_inside(ratio, "angle_deg"), "peaks inside"),
            trends(ratio, "aspect_ratio", RISES, "grows with A_r"),
        ],
        {"least": ratio.min(), "largest": ratio.max()},
    )


CLAIMS = {
    "C13": penetration,
    "C14": force,
    "C15": rotation,
    "C16": rotational_ratio,
}

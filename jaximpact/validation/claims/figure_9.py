"""Fig. 9 and the abstract: restitution of inclined impacts (set III)."""

import numpy as np
import xarray as xr

from ..parts import FALLS, RISES, between, conditions, from_to, judge, steps, trends
from ..study import Datasets, along_major_axis, along_minor_axis
from ..verdict import Judgement

NEGATIVE_TO_DEG = 50.0
RISES_FROM_DEG = 65.0
RISES_BY = 0.1
TWO_ORDERS = 100.0


def e_n_falls_with_length(sets: Datasets) -> Judgement:
    """Along the major axis e_n falls with A_r."""
    e_n = along_major_axis(sets).e_n
    return judge(
        between(e_n),
        [trends(e_n, "aspect_ratio", FALLS, "falls with A_r")],
        {"least": e_n.min(), "largest": e_n.max()},
    )


def e_t_grows_with_length(sets: Datasets) -> Judgement:
    """Along the major axis e_t rises with A_r."""
    e_t = along_major_axis(sets).e_t
    return judge(
        between(e_t),
        [trends(e_t, "aspect_ratio", RISES, "grows with A_r")],
        {"least": e_t.min(), "largest": e_t.max()},
    )


def e_n_is_negative(sets: Datasets) -> Judgement:
    """Along the major axis e_n is not monotonic, and negative up to 50°."""
    e_n = along_major_axis(sets).e_n
    e_n = e_n.sel(aspect_ratio=e_n.aspect_ratio > 1.0)
    turns = xr.apply_ufunc(
        lambda line: {RISES, FALLS} <= set(steps(line)),
        e_n,
        input_core_dims=[["angle_deg"]],
        vectorize=True,
    )
    low = e_n.sel(angle_deg=e_n.angle_deg <= NEGATIVE_TO_DEG)
    negative = e_n < 0.0
    found = ", ".join(
        f"A_r {a_r:g} from {e_n.angle_deg.values[line][0]:g}°"
        for a_r, line in zip(
            e_n.aspect_ratio.values,
            negative.transpose("aspect_ratio", "angle_deg").values,
            strict=True,
        )
        if line.any()
    )
    return judge(
        f"{between(low)} up to {NEGATIVE_TO_DEG:g}°; negative {found or 'nowhere'}",
        [
            conditions(turns, "not monotonic"),
            conditions((low < 0.0).all("angle_deg"), "negative up to 50°"),
        ],
        {"least": e_n.min(), "negative_share": (low < 0.0).mean()},
    )


def e_n_rises_at_large_angles(sets: Datasets) -> Judgement:
    """Along the major axis e_n rises from 65 to 80°, by more than 0.1."""

    def rise_of(e_n: xr.DataArray) -> xr.DataArray:
        steep = e_n.sel(angle_deg=e_n.angle_deg >= RISES_FROM_DEG)
        change = steep.isel(angle_deg=-1) - steep.isel(angle_deg=0)
        up = xr.apply_ufunc(
            lambda line: bool(np.all(steps(line) == RISES)),
            steep,
            input_core_dims=[["angle_deg"]],
            vectorize=True,
        )
        return change, up & (change > RISES_BY)

    change, met = rise_of(along_major_axis(sets).e_n)
    minor, _ = rise_of(along_minor_axis(sets).e_n)
    return judge(
        f"change from 65 to 80°: {between(change)} (minor axis {between(minor)})",
        [conditions(met, "rises fast")],
        {
            "least_change": change.min(),
            "largest_change": change.max(),
            "least_change_minor_axis": minor.min(),
            "largest_change_minor_axis": minor.max(),
        },
    )


def both_fall_along_the_minor_axis(sets: Datasets) -> Judgement:
    """Along the minor axis e_n and e_t fall with A_r."""
    data = along_minor_axis(sets)
    return judge(
        f"e_n {between(data.e_n)}, e_t {between(data.e_t)}",
        [
            trends(data.e_n, "aspect_ratio", FALLS, "e_n falls with A_r"),
            trends(data.e_t, "aspect_ratio", FALLS, "e_t falls with A_r"),
        ],
        {
            "least_e_n": data.e_n.min(),
            "largest_e_n": data.e_n.max(),
            "least_e_t": data.e_t.min(),
            "largest_e_t": data.e_t.max(),
        },
    )


def two_orders_of_magnitude(sets: Datasets) -> Judgement:
    """Along the major axis |e_n| varies over the angle by more than 100 times."""
    e_n = along_major_axis(sets).e_n
    size = abs(e_n)
    ratio = size.max("angle_deg") / size.min("angle_deg")
    crosses = (e_n.min("angle_deg") < 0.0) & (e_n.max("angle_deg") > 0.0)
    signs = "its sign changes at A_r " + ", ".join(
        f"{float(a_r):g}" for a_r in e_n.aspect_ratio[crosses]
    )
    return judge(
        f"largest over least |e_n| {from_to(ratio)} at A_r "
        f"{from_to(e_n.aspect_ratio)}; "
        + (signs if crosses.any() else "its sign changes nowhere"),
        [conditions((ratio > TWO_ORDERS) | crosses, "more than 100")],
        {
            "least_ratio": ratio.min(),
            "largest_ratio": ratio.max(),
            "signs_change": crosses.sum(),
        },
    )


CLAIMS = {
    "C23": e_n_falls_with_length,
    "C24": e_t_grows_with_length,
    "C25": e_n_is_negative,
    "C26": e_n_rises_at_large_angles,
    "C27": both_fall_along_the_minor_axis,
    "C28": two_orders_of_magnitude,
}

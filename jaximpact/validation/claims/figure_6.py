"""Fig. 6: the course of inclined impacts along the major axis, at 20°."""

import numpy as np
import xarray as xr

from ..parts import between, conditions, judge
from ..study import Datasets
from ..verdict import Judgement

ANGLE_DEG = 20.0
BACK_RAD = 1e-6
"""Rotation back that counts as none."""
DIP = 0.01
"""Part of the maximum of R_r by which it may dip, or end below it, and count as not
falling."""
SLIGHT = 0.20
"""Part of the maximum of R_r up to which a fall is slight."""


def rotation_grows(sets: Datasets) -> Judgement:
    """The rotation never goes back."""
    rotation = sets["courses"].rotation_rad.sel(angle_deg=ANGLE_DEG)
    back = (-rotation.diff("step").min("step")).clip(min=0.0)
    last = np.degrees(rotation.max("step"))
    return judge(
        f"to {between(last, '°')}, back by {float(back.max()):.2g} rad at most",
        [conditions(back <= BACK_RAD, "grows")],
        {"largest_step_back_rad": back.max()},
    )


def rotational_ratio_peaks(sets: Datasets) -> Judgement:
    """R_r rises to a maximum, after which that of low A_r falls slightly."""
    ratio = sets["courses"].R_r.sel(angle_deg=ANGLE_DEG)
    largest = ratio.max("step")
    last = ratio.isel(step=-1)
    fall = (largest - last) / largest
    dip = xr.apply_ufunc(
        _deepest_dip, ratio, input_core_dims=[["step"]], vectorize=True
    )
    short, long = fall.isel(aspect_ratio=[0]), fall.isel(aspect_ratio=[-1])
    percent = 100.0 * fall
    return judge(
        f"largest {between(largest)}; falls by {float(percent[0]):.2g} % at A_r 1, "
        f"{float(percent[1]):.2g} % at {float(fall.aspect_ratio[1]):g}, "
        f"{float(percent[-1]):.2g} % at 4",
        [
            conditions(dip <= DIP, "rises to its maximum"),
            *conditions((short >= DIP) & (short <= SLIGHT), "").parts,
            *conditions(long < DIP, "").parts,
        ],
        {
            "fall_of_sphere_percent": percent[0],
            "fall_of_longest_percent": percent[-1],
            "deepest_dip_percent": 100.0 * dip.max(),
        },
    )


def _deepest_dip(ratio: np.ndarray) -> float:
    """How far the ratio falls below what it had reached, before its maximum, as a part
    of that."""
    rise = ratio[: int(np.argmax(ratio)) + 1]
    return float(np.max(np.maximum.accumulate(rise) - rise) / rise[-1])


CLAIMS = {"C11": rotation_grows, "C12": rotational_ratio_peaks}

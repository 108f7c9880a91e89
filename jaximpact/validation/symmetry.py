"""Orientations and their mirror images."""

import numpy as np
import xarray as xr


def less_mirrored(values: xr.DataArray, sign: float = 1.0) -> xr.DataArray:
    """Values over the orientation less `sign` times those at 180° less it, where both
    are there: zero for what is symmetric, with `sign` -1 for what is antisymmetric."""
    there = values.orientation_deg.values
    kept = there[np.isin(180.0 - there, there)]
    mirrored = values.sel(orientation_deg=180.0 - kept)
    return values.sel(orientation_deg=kept) - sign * mirrored.assign_coords(
        orientation_deg=kept
    )


def asymmetry(values: xr.DataArray, sign: float = 1.0) -> xr.DataArray:
    """The largest of `less_mirrored`, as a part of the largest value."""
    apart = abs(less_mirrored(values, sign)).max("orientation_deg")
    return apart / abs(values).max("orientation_deg")

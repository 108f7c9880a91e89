"""What the dataset of a result holds: blocks by how they ended, and the second run."""

import json

import numpy as np
import xarray as xr

from ..trajectory import Ending

PREFIX = "second_run_"
"""Begins the names of what the second run gives, among the variables of a dataset."""
RUN_LEFT = (
    "Blocks run to the left. Percentiles of x in tables and drawings are counted from "
    "the left, so that the 5 % value, and not that of 95 %, lies far down the slope: "
    "mirror the profile to have it as usual."
)
"""What readers must know of a slope that descends to the left."""


def valid_blocks(dataset: xr.Dataset) -> np.ndarray:
    """Tell which blocks did not fail."""
    return dataset.ending.values != str(Ending.failed)


def stops_of(dataset: xr.Dataset) -> np.ndarray:
    """Find x where blocks stopped [m]."""
    return dataset.x_m.values[dataset.ending.values == str(Ending.stopped)]


def run_left(dataset: xr.Dataset) -> bool:
    """Tell whether most blocks that stopped did so to the left of their release."""
    stopped = dataset.ending.values == str(Ending.stopped)
    way = (dataset.x_m.values - dataset.release_x_m.values)[stopped]
    return bool(len(way) and np.median(way) < 0.0)


def counts_of(dataset: xr.Dataset) -> dict[str, int]:
    """Count the blocks of each ending that occurs."""
    return json.loads(dataset.attrs["endings"])


def edges_of(dataset: xr.Dataset) -> np.ndarray:
    """Give the edges of the bins of x [m], `(bins + 1,)`."""
    return np.append(dataset.bin_left_m.values, dataset.bin_right_m.values[-1])


def second_of(dataset: xr.Dataset) -> tuple[str, xr.Dataset] | None:
    """Give the kinematics of the second run, and its results under the names of the
    first; None where there was none."""
    names = [name for name in map(str, dataset) if name.startswith(PREFIX)]
    if not names:
        return None
    renamed = {name: name.removeprefix(PREFIX) for name in names}
    kinematics = json.loads(dataset.attrs["second_run"])["kinematics"]
    return kinematics, dataset[names].rename(renamed)

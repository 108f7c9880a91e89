"""What the dataset of a result holds: blocks by how they ended, and the second run."""

import json

import numpy as np
import xarray as xr

from ..trajectory import Ending

PREFIX = "second_run_"
"""Begins the names of what the second run gives, among the variables of a dataset."""


def valid_blocks(dataset: xr.Dataset) -> np.ndarray:
    """Tell which blocks did not fail."""
    return dataset.ending.values != str(Ending.failed)


def stops_of(dataset: xr.Dataset) -> np.ndarray:
    """Find x where blocks stopped [m]."""
    return dataset.x_m.values[dataset.ending.values == str(Ending.stopped)]


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

"""Blocks of a result by how they ended."""

import json

import numpy as np
import xarray as xr

from ..trajectory import Ending


def valid_blocks(dataset: xr.Dataset) -> np.ndarray:
    """Tell which blocks did not fail."""
    return dataset.ending.values != str(Ending.failed)


def stops_of(dataset: xr.Dataset) -> np.ndarray:
    """Find x where blocks stopped [m]."""
    return dataset.x_m.values[dataset.ending.values == str(Ending.stopped)]


def counts_of(dataset: xr.Dataset) -> dict[str, int]:
    """Count the blocks of each ending that occurs."""
    return json.loads(dataset.attrs["endings"])

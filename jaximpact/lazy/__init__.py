"""Impacts of arrays that are computed block by block, when they are asked for.

Arrays are those of xarray over Dask or another engine that xarray knows; nothing of
these is imported unless the arrays are theirs.
"""

from .impacts import simulate_dataset
from .zarr_store import WrittenRegions, write_zarr

__all__ = ["WrittenRegions", "simulate_dataset", "write_zarr"]

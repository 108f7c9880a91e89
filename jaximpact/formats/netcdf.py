"""Datasets in NetCDF files."""

import os
from pathlib import Path

import xarray as xr

from ..errors import InputError
from .files import replacing
from .reading import read_input

ENGINE = "scipy"
"""NetCDF 3 with 64-bit offsets, which every program reads and JAX's own dependencies
write."""
MAGIC = b"CDF"
"""How such a file begins."""


def write_netcdf(path: Path, dataset: xr.Dataset) -> None:
    """Write a dataset. The file appears whole or not at all; one of the same name is
    replaced.

    Raises OSError where the file system refuses.
    """
    with replacing(Path(path)) as temporary:
        dataset.to_netcdf(temporary, engine=ENGINE)
        with open(temporary, "rb") as file:
            os.fsync(file.fileno())


def read_netcdf(path: Path) -> xr.Dataset:
    """Read a dataset that `write_netcdf` wrote, whole into memory.

    Raises InputError if the file cannot be read or is no such file.
    """
    path = Path(path)
    start = read_input(path)[: len(MAGIC)]
    try:
        return xr.load_dataset(path, engine=ENGINE)
    except OSError as error:
        why = error.strerror or str(error)
        raise InputError(f"cannot be read: {why}", file=path) from error
    except Exception as error:  # SciPy raises whatever the bytes lead it to
        # What it says of other files is of libraries to install.
        damaged = start == MAGIC
        why = "is a damaged NetCDF 3 file" if damaged else "is not a NetCDF 3 file"
        raise InputError(why, file=path) from error

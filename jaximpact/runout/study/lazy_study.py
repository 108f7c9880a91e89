"""Run-out studies whose blocks are computed when they are asked for."""

import numpy as np
import xarray as xr

from ..._checks import whole_number
from ..._packages import needed
from .block_rows import (
    BLOCK_NUMBERS,
    ENVELOPES,
    PASSAGE_NUMBERS,
    columns_of_rows,
    places_of,
    task_of,
)
from .run_study import (
    ABOUT_ENDING,
    about,
    attributes_of,
    coordinates_of,
    endings_in_words,
    ground_of,
    inputs_of,
)
from .slope_file import SlopeStudy

CHUNK = 1024
"""Blocks of a chunk, some seconds of work of a core."""


def lazy_slope_study(study: SlopeStudy, chunks: int = CHUNK) -> xr.Dataset:
    """Return the blocks of a study as a dataset that is computed chunk by chunk.

    For studies larger than memory: `jaximpact.write_zarr` writes it and can be
    interrupted. Chunks are computed by whatever scheduler or client of Dask there is,
    one thread a chunk.

    Args:
        study: result of `read_slope_study`.
        chunks: number of blocks of a chunk, from 1.

    Returns:
        A dataset over blocks, collectors if there are any, and bins, with what
        `run_slope_study` gives of each block, to the last bit. Percentiles, counts and
        barriers, which are of all blocks together, are not there.

    Raises InputError where Dask is not installed.
    """
    array = needed("dask.array", "a study in chunks")
    dask = needed("dask", "a study in chunks")
    count, size = study.release.count, whole_number("chunks", chunks, 1)
    columns = columns_of_rows(study)
    parts = []
    for start in range(0, count, size):
        chosen = np.arange(start, min(start + size, count))
        rows = dask.delayed(task_of(study, chosen), pure=True)()
        parts.append(array.from_delayed(rows, (len(chosen), len(columns)), float))
    rows = array.concatenate(parts)

    def numbers(names: list[str]):
        return rows[:, [columns.index(name) for name in names]]

    words = endings_in_words(np.zeros(1))
    endings = numbers(["ending"])[:, 0].map_blocks(endings_in_words, dtype=words.dtype)
    variables: dict = {"ending": ("block", endings, ABOUT_ENDING)}
    variables |= inputs_of(study.release) | ground_of(study)
    for name, told in BLOCK_NUMBERS.items():
        variables[name] = ("block", numbers([name])[:, 0], about(*told))
    here = [x for x in places_of(study) if x in study.collectors]
    for name, told in PASSAGE_NUMBERS.items() if here else ():
        of_passage = numbers([f"{name} at {x!r}" for x in here])
        variables[name] = (("block", "collector"), of_passage, about(*told))
    for name, (unit, meaning) in ENVELOPES.items():
        in_bins = numbers([f"{name} in bin {i}" for i in range(study.bins)])
        variables[f"{name}_in_bin"] = (
            ("block", "bin"),
            in_bins.astype(np.float32),
            about(unit, f"{meaning} in the bin; nan for a block that is never there"),
        )
    attributes = attributes_of(study, np.zeros(count))
    del attributes["endings"]
    return xr.Dataset(variables, coordinates_of(study), attributes)

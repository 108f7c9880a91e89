"""Tables in Parquet: columns with types, smaller and faster to read than CSV.

A table is turned into the text that a CSV of it would be, and checked as such: one
reader, one set of messages. Numbers keep every bit.
"""

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from .._packages import needed
from ..errors import InputError

SUFFIX = ".parquet"


def is_parquet(path: Path) -> bool:
    """Tell by its name whether a table is in Parquet."""
    return path.suffix.lower() == SUFFIX


def csv_of_parquet(path: Path, data: bytes) -> bytes:
    """Return the bytes of a file of Parquet as those of a CSV. Raises InputError for
    what is no such file, and where pyarrow is not installed."""
    import pandas as pd  # which takes half a second

    needed("pyarrow", f"{path}, a table in Parquet,")
    arrow: Any = needed("pyarrow.lib", f"{path}, a table in Parquet,")
    try:
        frame = pd.read_parquet(io.BytesIO(data), engine="pyarrow")
        # An index with a name is a column, as in a CSV.
        named = [name for name in frame.index.names if name is not None]
        frame = frame.reset_index(level=named) if named else frame
    except (arrow.ArrowException, OSError, ValueError) as error:
        raise InputError(f"is no table in Parquet: {error}", file=path) from error
    single = frame.select_dtypes("float32").columns
    # Which have fewer digits as text than as a number of twice the bits.
    frame[single] = frame[single].astype(float)
    return frame.to_csv(index=False).encode()


def write_columns(path: Path, columns: Mapping[str, np.ndarray]) -> None:
    """Write columns to a file of Parquet, in one go."""
    import pandas as pd

    needed("pyarrow", f"{path}, a table in Parquet,")
    with open(path, "wb") as file:
        pd.DataFrame(dict(columns)).to_parquet(file, engine="pyarrow", index=False)

"""Tables in Parquet: columns with types, smaller and faster to read than CSV.

A table is turned into the text that a CSV of it would be, and checked as such: one
reader, one set of messages. Numbers keep every bit, and columns that are carried along
their types.
"""

import csv
import io
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .._packages import needed
from ..errors import InputError

if TYPE_CHECKING:
    import pandas as pd  # which takes half a second

SUFFIX = ".parquet"


def is_parquet(path: Path) -> bool:
    """Tell by its name whether a table is in Parquet."""
    return path.suffix.lower() == SUFFIX


def read_frame(path: Path, data: bytes) -> "pd.DataFrame":
    """Return the table that the bytes of a file of Parquet hold. Raises InputError for
    what is no such file, and where pyarrow is not installed."""
    import pandas as pd

    needed("pyarrow", f"{path}, a table in Parquet,")
    arrow: Any = needed("pyarrow.lib", f"{path}, a table in Parquet,")
    parquet: Any = needed("pyarrow.parquet", f"{path}, a table in Parquet,")
    try:
        names = parquet.read_schema(io.BytesIO(data)).names
        for place, name in enumerate(names):
            if name in names[:place]:
                raise InputError("stands twice", file=path, column=name)
        frame = pd.read_parquet(io.BytesIO(data), engine="pyarrow")
        # An index with a name is a column, as in a CSV.
        named = [name for name in frame.index.names if name is not None]
        frame = frame.reset_index(level=named) if named else frame
    except InputError:
        raise
    except (arrow.ArrowException, OSError, ValueError) as error:
        raise InputError(f"is no table in Parquet: {error}", file=path) from error
    return frame.reset_index(drop=True)


def csv_of_frame(frame: "pd.DataFrame") -> bytes:
    """Return the bytes of a table as those of a CSV."""
    small = frame.select_dtypes(["float16", "float32"]).columns
    # Which have fewer digits as text than as a number of 64 bits.
    frame = frame.astype(dict.fromkeys(small, float))
    # A text that is alone in its row is quoted, as a blank line of a CSV is no row; by
    # this end of lines a carriage return in a cell is, too.
    alone = len(frame.columns) == 1
    quoting = csv.QUOTE_NONNUMERIC if alone else csv.QUOTE_MINIMAL
    return frame.to_csv(index=False, quoting=quoting, lineterminator="\r\n").encode()


def write_columns(path: Path, columns: Mapping[str, "np.ndarray | pd.Series"]) -> None:
    """Write columns to a file of Parquet, in one go."""
    import pandas as pd

    needed("pyarrow", f"{path}, a table in Parquet,")
    with open(path, "wb") as file:
        pd.DataFrame(dict(columns)).to_parquet(file, engine="pyarrow", index=False)

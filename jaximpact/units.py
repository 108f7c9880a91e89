"""Units of the columns: their sizes in SI, their names in columns, and what is mistaken
for them."""

import math
import re

import jax
import numpy as np

from ._jax_internals import Tracer
from .errors import InputError

DEGREE = math.pi / 180.0
SIZES = {"deg": DEGREE, "deg/s": DEGREE, "kN/m3": 1e3, "kPa": 1e3}
"""Units of columns that are not SI -> size in SI."""
SUFFIXES = {"deg": "_deg", "deg/s": "_degps", "kN/m3": "_kNm3", "kPa": "_kPa"}
"""Units of columns that are not SI -> suffix of the column's name."""
SI = set(["m", "kg", "s", "K", "rad", "N", "Pa", "J", "W", "Hz"])
"""Names of units in which numbers of parameters are SI."""
RESULT_SUFFIXES = {
    **{"-": "", "m": "_m", "N": "_N", "N m": "_Nm", "s": "_s"},
    **{"rad": "_rad", "m/s": "_mps", "rad/s": "_radps"},
}
"""Units of results -> what stands for them behind a column's name."""
UNITS = {
    "deg": {"deg": 1.0, "rad": 1.0 / DEGREE},
    "deg/s": {"deg/s": 1.0, "rad/s": 1.0 / DEGREE},
    "kN/m3": {"kN/m3": 1.0, "N/m3": 1e-3},
    "kPa": {"kPa": 1.0, "Pa": 1e-3, "MPa": 1e3},
    "kg/m3": {"kg/m3": 1.0, "g/cm3": 1e3, "g/m3": 1e-3},
    "m/s": {"m/s": 1.0, "km/h": 1.0 / 3.6, "mm/s": 1e-3},
    "kg": {"kg": 1.0, "g": 1e-3, "t": 1e3},
    "-": {"-": 1.0, "%": 1e-2},
}
"""Unit of a column -> units that are mistaken for it, with their sizes in it."""


def check_unit(call: str, unit: str) -> None:
    """Check the unit of a parameter.

    Raises InputError, in the name of a call, for one in which the numbers of the model
    would be others.
    """
    others = sorted({*re.findall(r"[^\W\d]+|%", unit)} - SI)
    if others and unit not in SIZES:
        raise InputError(
            f"{call}: the unit must be of {', '.join(sorted(SI))}, as in 'N s/m' or "
            f"'kg/m3', or {', '.join(SIZES)}, or '-', but has {others[0]!r}"
        )


def variable_attributes(meaning: str, unit: str = "") -> dict[str, str]:
    """Make the attributes of a variable of a dataset: `long_name`, the words of a
    meaning before its first mark, which label an axis; `comment`, the whole meaning
    where it says more; and `units` if there are any."""
    units = {"units": unit} if unit else {}
    name = re.split(r"[,;:(]", meaning, maxsplit=1)[0].strip()
    comment = {} if name == meaning else {"comment": meaning}
    return {**units, "long_name": name, **comment}


def with_unit(value, unit: str = "-", factor: float = 1.0) -> str:
    """Write a number with its unit.

    Of an array the smallest and largest value, the shape, and how many are NaN, are
    written.

    Args:
        value: in SI units; anything else than numbers is shown as it is.
        unit: shown behind the value, "-" for none.
        factor: value in SI units over value in `unit`.
    """
    unit = "" if unit == "-" else f" {unit}"
    if isinstance(value, Tracer):
        return "(traced)"
    if isinstance(value, jax.Array) and value.is_deleted():
        return "(deleted)"
    if not isinstance(value, np.ndarray | np.generic | jax.Array | int | float):
        return repr(value)
    values = np.asarray(value)
    if values.dtype.kind not in "fiu":
        return f"{values.dtype} {values.shape}"
    values = values / factor
    if values.ndim == 0:
        return f"{float(values):.6g}{unit}"
    if not values.size:
        return "(empty)"
    known = values[~np.isnan(values)]
    if not known.size:
        return f"nan{unit} {values.shape}"
    least, most = (f"{end:.6g}" for end in (np.min(known), np.max(known)))
    written = f"{least if least == most else f'{least} to {most}'}{unit} {values.shape}"
    missing = values.size - known.size
    return f"{written}, {missing} nan" if missing else written

"""Checks of values given in Python: each of its kind, or an error that names it."""

import math

import equinox as eqx
import jax
import numpy as np

from .errors import InputError


def real_numbers(name: str, value) -> np.ndarray | jax.Array:
    """Return the real numbers as a float64 array; an array of JAX as it is.

    Args:
        name: what an error calls them.
        value: a number, or whatever NumPy makes an array of numbers of: lists, arrays,
            columns of a data frame.

    Raises InputError for text, truth values, complex numbers, dates, whole numbers too
    large for a float, missing and masked values, and lists of unequal lengths.
    """
    if isinstance(value, jax.Array) and value.dtype.kind not in "bc":
        return value
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        place = int(np.argmax(np.ma.getmaskarray(value)))
        raise InputError(
            f"{name} must be numbers, but value {place} is masked; fill it or leave it "
            "out"
        )
    try:
        array = np.asarray(value)
        if array.dtype.kind == "O" and all(map(_is_real, array.flat)):
            array = array.astype(float)
    except (TypeError, ValueError, OverflowError, MemoryError) as error:
        raise InputError(
            f"{name} must be a number or an array of numbers, but is {_told(value)}: "
            f"{error}"
        ) from None
    if array.dtype.kind not in "fiu":
        raise InputError(
            f"{name} must be a number or an array of numbers, but is {_told(value)}"
        )
    return array.astype(float, copy=False)


def real_number(name: str, value) -> float:
    """Return one finite number; InputError for anything else."""
    numbers = real_numbers(name, value)
    if numbers.ndim or not math.isfinite(numbers):
        raise InputError(f"{name} must be a finite number, but is {value!r}")
    return float(numbers)


def whole_number(name: str, value, least: int, most: int = 2**63 - 1) -> int:
    """Return a whole number from `least` to `most`; InputError for anything else."""
    if isinstance(value, bool) or not hasattr(value, "__index__"):
        raise InputError(f"{name} must be a whole number, but is {_told(value)}")
    if not least <= value <= most:
        end = f"least {least}" if value < least else f"most {most}"
        raise InputError(f"{name} must be at {end}, but is {value}")
    return int(value)


def truth(name: str, value) -> bool:
    """Return True or False; InputError for anything but these, 1 and 0."""
    if not isinstance(value, int | np.bool_) or value not in (0, 1):
        raise InputError(f"{name} must be True or False, but is {_told(value)}")
    return bool(value)


def expect(name: str, value, *kinds: type) -> None:
    """Raise InputError unless a value is of one of the kinds."""
    if not isinstance(value, kinds):
        needed = " or ".join(kind.__name__ for kind in kinds)
        raise InputError(f"{name} must be of type {needed}, but is {_told(value)}")


def _is_real(value) -> bool:
    # Fractions and decimals say what they are as floats; so do texts and truth values.
    return hasattr(value, "__float__") and not isinstance(value, bool | np.bool_)


def _told(value) -> str:
    """Describe a value with its type; of what has many fields the type alone."""
    kind = type(value).__name__
    return f"of type {kind}" if isinstance(value, eqx.Module) else f"{value!r} ({kind})"

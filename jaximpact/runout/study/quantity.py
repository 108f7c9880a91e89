"""Quantities of a study: numbers, lists and distributions from its file."""

from ...io.toml import Key, check_keys, number, quantity
from ...quantities import InputColumn
from ..random_inputs import (
    BOUNDS,
    Distribution,
    Lognormal,
    Normal,
    PowerLaw,
    Quantity,
    RandomField,
    Uniform,
    fault_of,
)

KINDS = {
    Normal: ("mean", "sd"),
    Lognormal: ("median", "geometric_sd"),
    PowerLaw: ("exponent",),
}
"""Keys of each distribution that may have `BOUNDS` too."""
ENDS = ("from", "to")
"""Keys of the uniform distribution."""
LENGTH = "correlation_length_m"
"""Key of a quantity of the ground that varies along the slope."""
VALUES = ("mean", "median", *BOUNDS)
"""Keys of distributions that are values of the quantity, in its unit."""
KEYS = (*(name for names in KINDS.values() for name in names), *ENDS, *BOUNDS)


def read_quantity(key: Key, value, column: InputColumn | None) -> Quantity:
    """Read a number, a list or a distribution, of numbers that a column allows if there
    is one; InputError, naming file and key, for anything else. Warns of unusual numbers
    and parameters of distributions."""

    def one(value, key=key) -> float:
        return number(key, value) if column is None else quantity(key, column, value)

    if isinstance(value, list):
        if not value:
            raise key.error("is an empty list")
        return tuple(one(v) for v in value)
    if not isinstance(value, dict):
        return one(value)
    if LENGTH in value:
        raise key[LENGTH].error("is for quantities of the ground only")
    check_keys(key, value, (*KEYS, LENGTH))
    if set(value) == {*ENDS}:
        uniform = Uniform(*(one(value[n], key[n]) for n in ENDS))
        _check(key, uniform)
        return uniform
    numbers = {n: number(key[n], v) for n, v in value.items()}
    for name in VALUES:
        # One that is not allowed, as least = 0 of a mass, is no value of a block.
        if column and name in numbers and column.is_allowed(numbers[name]):
            quantity(key[name], column, numbers[name])
    for kind, names in KINDS.items():
        if {*names} <= set(numbers) <= {*names, *BOUNDS}:
            if kind is PowerLaw and len(numbers) < 3:
                raise key.error("needs least and most beside its exponent")
            distribution = kind(**numbers)
            _check(key, distribution)
            return distribution
    if {*ENDS} < set(value) <= {*ENDS, *BOUNDS}:
        raise key.error("takes no least or most beside from and to, which are both")
    raise key.error(
        "must be a number, a list, { from, to }, { exponent, least, most }, "
        "{ mean, sd } or { median, geometric_sd }, the last two with least and most if "
        f"wanted, but is {value!r}"
    )


def read_ground_quantity(
    key: Key, value, column: InputColumn
) -> Quantity | RandomField:
    """Read a quantity of the ground, which may vary along the slope; see
    `read_quantity`."""
    if not isinstance(value, dict) or LENGTH not in value:
        return read_quantity(key, value, column)
    length = number(key[LENGTH], value[LENGTH], above=0.0, unit="m")
    rest = {name: of for name, of in value.items() if name != LENGTH}
    distribution = read_quantity(key, rest, column)
    assert isinstance(distribution, Distribution)
    return RandomField(distribution, length)


def _check(key: Key, distribution: Distribution) -> None:
    """Raise InputError for parameters out of range, and bounds that leave nothing."""
    if fault := fault_of(distribution):
        name, words = fault
        raise (key[name] if name else key).error(words)

"""Quantities of many blocks as a TOML file says them."""

from pathlib import Path

from ..errors import InputError
from ..formats.columns import InputColumn
from ..formats.toml_values import check_keys, number, quantity
from .quantities import Normal, Quantity, Uniform


def read_quantity(path: Path, key: str, value, column: InputColumn | None) -> Quantity:
    """A number, a list or a distribution.

    Args:
        column: whose range numbers must keep, if there is one.

    Raises InputError, naming file and key, for anything else.
    """

    def one(value, key=key) -> float:
        if column is None:
            return number(path, key, value)
        return quantity(path, key, column, value)

    if isinstance(value, list):
        if not value:
            raise InputError("is an empty list", file=path, key=key)
        return tuple(one(v) for v in value)
    if not isinstance(value, dict):
        return one(value)
    kinds = (("mean", "sd", "least", "most"), ("from", "to"))
    check_keys(path, key, value, kinds[0] + kinds[1])
    if set(value) == set(kinds[1]):
        ends = [one(value[n], f"{key}.{n}") for n in kinds[1]]
        if not ends[0] < ends[1]:
            raise InputError(
                f"must go up, but goes from {ends[0]:g} to {ends[1]:g}",
                file=path,
                key=key,
            )
        return Uniform(*ends)
    if not {"mean", "sd"} <= set(value) <= set(kinds[0]):
        raise InputError(
            "must be a number, a list, { from, to } or { mean, sd }, the latter with "
            f"least and most if wanted, but is {value!r}",
            file=path,
            key=key,
        )
    given = {n: number(path, f"{key}.{n}", v) for n, v in value.items()}
    normal = Normal(**given)
    if normal.sd <= 0.0:
        raise InputError(
            f"must be above 0, but is {normal.sd:g}", file=path, key=f"{key}.sd"
        )
    if not normal.least < normal.most:
        raise InputError(
            f"needs least below most, but they are {normal.least:g} and "
            f"{normal.most:g}",
            file=path,
            key=key,
        )
    if not normal.share_inside > 0.0:
        raise InputError(
            f"holds nothing between least and most, {normal.least:g} and "
            f"{normal.most:g}, so far from a mean of {normal.mean:g} with sd "
            f"{normal.sd:g}",
            file=path,
            key=key,
        )
    return normal

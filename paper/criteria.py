"""Verdicts on claims, and criteria put together from parts.

A trend is a line of values each step of which goes in the claimed direction by more
than 0.1 % of the largest of them. It holds if every step does, fails if the last value
is not beyond the first in that direction, and else holds partly. A condition holds or
fails. Of several parts, all must hold, or none, for their claim to hold or to fail;
else it holds partly.
"""

import dataclasses
import enum
import itertools
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

MARGIN = 1e-3
"""Part of the largest value on a line that counts as a change. Values are computed to
1e-5 and better."""
NOTHING = 1e-9
"""Size below which a number is rounding, in every unit used."""
RISES, FALLS = 1, -1
_PLACES = {
    "aspect_ratio": ("A_r {}", "A_r"),
    "angle_deg": ("{}°", "angle"),
    "orientation_deg": ("{}°", "orientation"),
    "angular_velocity_degps": ("{}°/s", "spin"),
}
"""Dimension -> how its values are written, and what one is called."""


class Verdict(enum.StrEnum):
    """Whether the model bears a claim out, or does as a law says."""

    holds = "holds"
    """Every part that its criterion names holds."""
    partly = "partly"
    """Some of them hold."""
    fails = "fails"
    """None of them holds."""
    not_computed = "not computed"
    """Nothing is known; the evidence says why."""


@dataclasses.dataclass(frozen=True)
class Judgement:
    """A verdict and what decides it."""

    verdict: Verdict
    evidence: str
    """Deciding numbers with their units, in a line."""
    met: int = 0
    asked: int = 0
    """Checks that the criterion asks for, steps of trends and places of conditions: how
    many hold, and how many there are."""


class NotComputed(Exception):
    """Numbers that a claim is judged by could not be computed; the message says why."""


class Part(NamedTuple):
    """A part of a criterion: its verdict, and how many of its checks hold."""

    verdict: Verdict
    met: int
    asked: int


class Parts(NamedTuple):
    """One check of a criterion at several places."""

    what: str
    """Property asked for, as in "falls with A_r"."""
    dimension: str
    at: Sequence[float] | np.ndarray
    parts: list[Part]


def steps(values: ArrayLike) -> np.ndarray:
    """1 for each step up, -1 for each step down, 0 for those within the margin."""
    values = np.asarray(values, float)
    margin = MARGIN * np.max(np.abs(values))
    change = np.diff(values)
    return np.where(np.abs(change) > margin, np.sign(change), 0.0).astype(int)


def trend(values: ArrayLike, direction: int) -> Part:
    """Judge whether a line of values rises, or falls, at every step."""
    values = np.asarray(values, float)
    right = steps(values) == direction
    (overall,) = steps(values[[0, -1]])
    if right.all():
        verdict = Verdict.holds
    else:
        verdict = Verdict.partly if overall == direction else Verdict.fails
    return Part(verdict, int(right.sum()), len(right))


def condition(met: bool) -> Part:
    """Make a part that holds or fails."""
    return Part(Verdict.holds if met else Verdict.fails, int(met), 1)


def trends(values: xr.DataArray, along: str, direction: int, what: str) -> Parts:
    """Make the trends along one of two dimensions, at each place of the other."""
    (other,) = (str(name) for name in values.dims if name != along)
    parts = [trend(x, direction) for x in values.transpose(other, along).values]
    return Parts(what, other, values[other].values, parts)


def conditions(met: xr.DataArray, what: str) -> Parts:
    """Make a condition at each place of one dimension."""
    (dimension,) = map(str, met.dims)
    parts = [condition(bool(x)) for x in met]
    return Parts(what, dimension, met[dimension].values, parts)


def combine(verdicts: Iterable[Verdict]) -> Verdict:
    """Find the verdict of parts together."""
    kinds = set(verdicts)
    return kinds.pop() if len(kinds) == 1 else Verdict.partly


def judge(evidence: str, *groups: Part | Parts) -> Judgement:
    """Make the judgement by all parts of a criterion.

    Args:
        evidence: the numbers that decide; where the parts hold is added.
    """
    parts, texts = [], [evidence]
    for group in groups:
        if isinstance(group, Parts):
            parts += group.parts
            texts.append(tally(group))
        else:
            parts.append(group)
    return Judgement(
        combine(part.verdict for part in parts),
        "; ".join(texts),
        sum(part.met for part in parts),
        sum(part.asked for part in parts),
    )


def tally(group: Parts) -> str:
    """Say where parts hold."""
    form, name = _PLACES[group.dimension]
    verdicts = [part.verdict for part in group.parts]
    hold = [verdict is Verdict.holds for verdict in verdicts]
    if all(hold):
        return f"{group.what} at every {name}"
    if any(hold):
        where = form.format(ranges(group.at, hold))
        text = f"{group.what} at {sum(hold)} of {len(hold)}: {where}"
    else:
        text = f"{group.what} at no {name}"
    in_part = [verdict is Verdict.partly for verdict in verdicts]
    if any(in_part):
        text += f" (in part at {form.format(ranges(group.at, in_part))})"
    return text


def ranges(values: Sequence[float] | np.ndarray, chosen: Sequence[bool]) -> str:
    """Write the chosen values, neighbours of a row as a range: "10 to 30, 50"."""
    rows = []
    pairs = zip(values, chosen, strict=True)
    for is_chosen, row in itertools.groupby(pairs, key=lambda pair: pair[1]):
        if is_chosen:
            (first, _), *_, (last, _) = 2 * list(row)
            rows.append(f"{first:g}" if first == last else f"{first:g} to {last:g}")
    return ", ".join(rows)


def from_to(values: ArrayLike, unit: str = "") -> str:
    """First and last value of a line, in words."""
    values = np.asarray(values, float)
    ends = [f"{0.0 if abs(x) < NOTHING else x:.3g}" for x in values[[0, -1]]]
    space = "" if unit == "°" or not unit else " "
    return f"{' to '.join(dict.fromkeys(ends))}{space}{unit}"


def between(values: ArrayLike, unit: str = "") -> str:
    """Write the least and largest value."""
    values = np.asarray(values, float)
    return from_to([values.min(), values.max()], unit)


def trend_in_words(values: ArrayLike, unit: str, *directions: int) -> str:
    """Ends of a line, and how many of its steps go in each of the directions."""
    words = [from_to(values, unit)]
    for direction in directions:
        part = trend(values, direction)
        verb = "rises" if direction == RISES else "falls"
        words.append(f"{verb} in {part.met} of {part.asked} steps")
    return ", ".join(words)


# --- Lines of values that criteria look at.


def elongated(data):
    """Choose the values of blocks with an A_r above 1, of a dataset or an array over
    A_r."""
    return data.sel(aspect_ratio=data.aspect_ratio > 1.0)


def along_dimension(function, values: xr.DataArray, dimension: str) -> xr.DataArray:
    """Apply a function to each line of values along a dimension."""
    return xr.apply_ufunc(
        function, values, input_core_dims=[[dimension]], vectorize=True
    )


def less_mirrored(values: xr.DataArray, sign: float = 1.0) -> xr.DataArray:
    """Return values over the orientation less `sign` times those at 180° less it, where
    both are there: zero for what is symmetric, with `sign` -1 for what is
    antisymmetric."""
    there = values.orientation_deg.values
    both = there[np.isin(180.0 - there, there)]
    mirrored = values.sel(orientation_deg=180.0 - both)
    return values.sel(orientation_deg=both) - sign * mirrored.assign_coords(
        orientation_deg=both
    )


def asymmetry(values: xr.DataArray, sign: float = 1.0) -> xr.DataArray:
    """Compute the largest of `less_mirrored`, as a part of the largest value."""
    apart = abs(less_mirrored(values, sign)).max("orientation_deg")
    return apart / abs(values).max("orientation_deg")

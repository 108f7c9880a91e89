"""Comparison of derivatives with differences of blocks that start a little apart."""

import enum
from typing import NamedTuple

import numpy as np

from ..blocks import select
from ..state import Limits
from ..trajectory import Runs
from .outputs import outputs_of
from .parameters import Case, Parameter, replaced
from .results import Result, follow_case

STEPS = (1e-3, 1e-4, 1e-5, 1e-6)
"""Relative steps of the differences: each next one is for derivatives that the one
before does not confirm. Below, integration errors are too large a part of a
difference."""
AGREES_WITHIN = 1e-3
"""Relative difference between derivatives and differences that confirms them."""
SMALL = 1e-4
"""Floor of the scale of comparison: relative change of an output per relative change of
a parameter that counts as next to none."""


class Standing(enum.IntEnum):
    """Reliability of a derivative."""

    confirmed = 0
    """Blocks on both sides make the same contacts, and the differences agree."""
    unchecked = 1
    """No check was requested, or the parameter has no neighbour in its range."""
    sequence_changes = 2
    """Refused: with a relative change of 1e-6 the block makes other contacts, or moves
    in another mode between them."""
    differs = 3
    """Refused: differences of blocks that make the same contacts disagree. The output
    has a kink there, or bends too sharply for any step."""
    no_value = 4
    """The output has no value: the block did not pass, or its contact failed."""
    lost = 5
    """The output has a value, but its derivative was lost: a block started its flight
    in the ground, or something turned by an infinite rate."""

    def __str__(self) -> str:
        return self.name.replace("_", " ")


class Whole(NamedTuple):
    """Trajectories and their outputs."""

    base: Runs
    units: dict[str, str]
    """Units of the outputs by name."""
    values: np.ndarray
    """Outputs, `(blocks, outputs)`."""
    when: np.ndarray
    """Times by which the outputs are settled [s], `(blocks, outputs)`."""


def judge(
    case: Case,
    parameter: Parameter,
    whole: Whole,
    slopes: np.ndarray,
    check: bool,
    limits: Limits,
) -> dict[str, np.ndarray]:
    """Compare the derivatives with respect to one parameter with differences.

    Args:
        slopes: derivatives of the outputs, `(blocks, outputs)`, in SI units of the
            parameter.
    """
    _, _, values, when = whole
    blocks = len(values)
    size = np.broadcast_to(parameter.size(case), (blocks,))
    by_differences = np.full(values.shape, np.nan)
    disagreement = np.full(values.shape, np.nan)
    standing = np.full(values.shape, Standing.unchecked)
    same_within, compared = np.zeros(blocks), np.zeros(blocks, bool)
    exists = np.isfinite(values)
    known = exists & np.isfinite(slopes)
    undecided = np.any(known, axis=1) if check else np.zeros(blocks, bool)
    for step in STEPS:
        some = np.flatnonzero(undecided)
        if not len(some):
            break
        found = _differences(case, parameter, whole, some, step, size[some], limits)
        if found is None:
            continue
        compared[some] = True
        difference, until = found
        relative = _disagreement(difference, slopes[some], values[some], size[some])
        confirmed = standing[some] == Standing.confirmed
        new = (until[:, None] >= when[some]) & known[some] & ~confirmed
        by_differences[some] = np.where(new, difference, by_differences[some])
        disagreement[some] = np.where(new, relative, disagreement[some])
        agrees = new & (relative <= AGREES_WITHIN)
        verdict = np.where(agrees, Standing.confirmed, Standing.differs)
        standing[some] = np.where(new, verdict, standing[some])
        reached = np.where(np.isinf(until), step, 0.0)
        same_within[some] = np.maximum(same_within[some], reached)
        decided = (standing == Standing.confirmed) | ~known
        undecided = undecided & ~np.all(decided, axis=1)
    unchecked = standing == Standing.unchecked
    standing[unchecked & compared[:, None]] = Standing.sequence_changes
    standing[exists & ~known] = Standing.lost
    standing[~exists] = Standing.no_value
    given = (standing == Standing.confirmed) | (standing == Standing.unchecked)
    return {
        "derivative": np.where(given, slopes, np.nan) * parameter.factor,
        "derivative_by_differences": by_differences * parameter.factor,
        "disagreement": disagreement,
        "standing": standing,
        "same_sequence_within": np.where(compared, same_within, np.nan),
    }


def _differences(
    case: Case,
    parameter: Parameter,
    whole: Whole,
    some: np.ndarray,
    step: float,
    size: np.ndarray,
    limits: Limits,
) -> tuple[np.ndarray, np.ndarray] | None:
    """Differentiate the outputs of some blocks by central differences.

    Args:
        step, size: relative step, and the sizes that it is relative to.

    Returns:
        Differences, `(some, outputs)`, and the times until which neighbours make the
        same contacts [s]; None where a neighbour is out of range.
    """
    above = _neighbour(case, parameter, some, 1.0 * step * size, limits)
    below = _neighbour(case, parameter, some, -1.0 * step * size, limits)
    if above is None or below is None:
        return None
    own = _only(whole.base, some)
    until = np.minimum(same_until(own, above.runs), same_until(own, below.runs))
    more, less = (
        np.stack([o.value.value for o in outputs_of(result, whole.units)], axis=1)
        for result in (above, below)
    )
    return (more - less) / (2.0 * step * size[:, None]), until


def _disagreement(
    differences: np.ndarray, slopes: np.ndarray, values: np.ndarray, size: np.ndarray
) -> np.ndarray:
    """Compute the relative disagreement of derivatives and differences."""
    floor = SMALL * np.abs(values) / size[:, None]
    scale = np.maximum(np.maximum(np.abs(differences), np.abs(slopes)), floor)
    with np.errstate(invalid="ignore"):
        return np.abs(differences - slopes) / np.where(scale > 0.0, scale, 1.0)


def _neighbour(
    case: Case,
    parameter: Parameter,
    some: np.ndarray,
    amount: np.ndarray,
    limits: Limits,
) -> Result | None:
    """Simulate some blocks with a parameter shifted; None where it leaves its range."""
    release = replaced(
        case.release,
        block=select(case.release.block, some),
        **select(case.release.body, some)._asdict(),
    )
    amount = amount if np.ndim(parameter.size(case)) else amount[0]
    ground = case.ground.of_blocks(some)
    shifted = parameter.shift(case._replace(release=release, ground=ground), amount)
    return follow_case(shifted, limits) if parameter.allows(shifted) else None


def same_until(first: Runs, second: Runs) -> np.ndarray:
    """Find until when blocks make the same contacts, with the same outcomes, and move
    in the same modes between them [s]; inf where they do so to the same end."""
    until = np.where(first.ending == second.ending, np.inf, first.time)
    for name, columns in (
        ("contacts", ("segment", "outcome", "hop")),
        ("pieces", ("motion",)),
    ):
        one, other = getattr(first, name), getattr(second, name)
        owner = one.trajectory
        starts, counts = _spans(one, len(until))
        starts_of_other, counts_of_other = _spans(other, len(until))
        until = np.where(
            counts == counts_of_other, until, np.minimum(until, first.time)
        )
        rank = np.arange(len(owner)) - starts[owner]
        there = rank < counts_of_other[owner]
        place = np.where(there, starts_of_other[owner] + rank, 0)
        differs = ~there
        for column in columns if len(other.time) else ():
            differs = differs | (getattr(one, column) != getattr(other, column)[place])
        np.minimum.at(until, owner[differs], one.time[differs])
    return until


def _spans(record, blocks: int) -> tuple[np.ndarray, np.ndarray]:
    """Find the first row of each block, and the number of its rows."""
    counts = np.bincount(record.trajectory, minlength=blocks)
    return np.cumsum(counts) - counts, counts


def _only(runs: Runs, some: np.ndarray) -> Runs:
    """Select the trajectories of some blocks, for `same_until`."""
    place = np.full(runs.release.count, -1)
    place[some] = np.arange(len(some))
    records = {}
    for name in ("contacts", "pieces"):
        record = getattr(runs, name)
        kept = select(record, place[record.trajectory] >= 0)
        records[name] = kept._replace(trajectory=place[kept.trajectory])
    release = replaced(runs.release, x=runs.release.x[some])
    ends = {"ending": runs.ending[some], "time": runs.time[some]}
    return replaced(runs, release=release, **ends, **records)

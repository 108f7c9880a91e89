"""Comparison of derivatives with differences of blocks that start a little apart."""

import enum
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..blocks import select
from ..contacts.contact_models import ClosedForm, FullModel
from ..state import Limits
from ..trajectory import Runs
from .outputs import follow_case, outputs_of
from .parameters import Case, Parameter, replaced

STEPS = (1e-3, 1e-4, 1e-5, 1e-6)
"""Relative steps of the differences: each next one is for derivatives that the one
before does not confirm. Below, integration errors are too large a part of a
difference."""
AGREES_WITHIN = 1e-3
"""Relative difference between derivatives and differences that confirms them."""
SMALL = 1e-4
"""Floor of the scale of comparison: relative change of an output per relative change of
a parameter that counts as next to none."""


class Attempt(NamedTuple):
    """Comparison with differences, of what those before did not confirm."""

    together: bool
    """True if all parameters change at once, False for one by one."""
    step: float
    """Relative step."""
    contacts: FullModel | ClosedForm
    """Contact model of the differences."""


def all_attempts(contacts: FullModel | ClosedForm) -> tuple[Attempt, ...]:
    """List comparisons of all parameters at once, then one by one, by each step."""
    return tuple(Attempt(t, s, contacts) for t in (True, False) for s in STEPS)


class Standing(enum.IntEnum):
    """Reliability of a derivative."""

    confirmed = 0
    """Blocks on both sides make the same contacts, and the differences agree."""
    unchecked = 1
    """Not checked: no check was requested, or the parameter has no neighbour in its
    range."""
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


class Judgement(NamedTuple):
    """Reliability of derivatives, arrays `(blocks, outputs, parameters)`."""

    standing: np.ndarray
    """Codes of `Standing`."""
    by_differences: np.ndarray
    """Derivatives by differences, in SI units of the parameters; those of the other
    parameters are taken as right where all were changed at once."""
    disagreement: np.ndarray
    """Relative difference of derivatives and differences."""
    same_within: np.ndarray
    """Largest step within which the block makes the same contacts, 0 for none, NaN
    where nothing was compared, `(blocks, parameters)`."""

    @classmethod
    def of_none(cls, shape: tuple[int, int, int]) -> "Judgement":
        """Start with nothing compared."""
        unknown = np.full(shape, np.nan)
        within = np.full((shape[0], shape[2]), np.nan)
        return cls(np.full(shape, Standing.unchecked), unknown, unknown.copy(), within)


class Comparison(NamedTuple):
    """Derivatives, and what is needed to compare them with differences."""

    case: Case
    parameters: tuple[Parameter, ...]
    limits: Limits
    base: Runs
    units: dict[str, str]
    """Units of the outputs by name."""
    values: np.ndarray
    """Outputs, `(blocks, outputs)`."""
    when: np.ndarray
    """Times by which the outputs are settled [s], `(blocks, outputs)`."""
    slopes: np.ndarray
    """Derivatives of the outputs, `(blocks, outputs, parameters)`, in SI units of the
    parameters."""

    @property
    def known(self) -> np.ndarray:
        """True where output and derivative have a value, as `slopes`."""
        return np.isfinite(self.values)[..., None] & np.isfinite(self.slopes)

    @property
    def sizes(self) -> np.ndarray:
        """Scales of the steps, `(blocks, parameters)`."""
        shape = (len(self.slopes),)
        sizes = [np.broadcast_to(p.size(self.case), shape) for p in self.parameters]
        return np.stack(sizes, axis=1)


def judge(
    comparison: Comparison,
    attempts: tuple[Attempt, ...],
    progress: Callable[[int], None],
) -> Judgement:
    """Compare derivatives with differences.

    First all parameters of a block change at once, each by a random part, from a half
    to one, of the step, up or down. The difference has to agree with the sum of the
    derivatives so closely that the disagreement, were it that of one parameter alone,
    would be within `AGREES_WITHIN` of its derivative. A single wrong derivative is thus
    found as surely as by a difference of its own. Where several of one output and block
    are wrong, their errors may cancel: one that is wrong by k times what is allowed is
    missed with a probability of at most 2 / k for each step. What is not confirmed so
    is compared parameter by parameter.

    Args:
        attempts: comparisons, each of what those before did not confirm.
        progress: called with the number of comparisons made.
    """
    blocks, _, count = comparison.slopes.shape
    found = Judgement.of_none(comparison.slopes.shape)
    random = np.random.default_rng(0)
    for number, attempt in enumerate(attempts):
        progress(number)
        weights = random.uniform(0.5, 1.0, (blocks, count))
        weights *= random.choice([-1.0, 1.0], (blocks, count))
        unconfirmed = comparison.known & (found.standing != Standing.confirmed)
        left = np.any(unconfirmed, axis=1)
        if attempt.together:
            rows = np.flatnonzero(np.any(left, axis=1) & (count > 1))
            weights = np.where(left, weights, 0.0)[rows]
        else:
            rows, own = np.nonzero(left)
            weights = np.eye(count)[own]
        if len(rows):
            _compare(comparison, found, rows, weights, attempt)
    compared = ~np.isnan(found.same_within)[:, None]
    unsettled = (found.standing == Standing.unchecked) & compared
    found.standing[unsettled] = Standing.sequence_changes
    return found


def _compare(
    comparison: Comparison,
    found: Judgement,
    rows: np.ndarray,
    weights: np.ndarray,
    attempt: Attempt,
) -> None:
    """Compare derivatives of some blocks with central differences.

    Args:
        found: takes what is found.
        rows: blocks; one may stand there several times.
        weights: part of the step by which each parameter changes, `(rows, parameters)`.
        attempt: where the parameters of a block change at once, a disagreement tells
            nothing of one of them.
    """
    together, step, contacts = attempt
    sizes = comparison.sizes[rows]
    chosen = comparison.case.of_blocks(rows)
    amounts = (step * weights * sizes).T
    in_range = [
        parameter.allows(parameter.shift(chosen, amount))
        and parameter.allows(parameter.shift(chosen, -amount))
        for parameter, amount in zip(comparison.parameters, amounts, strict=True)
    ]
    changes = np.where(in_range, weights, 0.0) * sizes
    difference, until = _difference(comparison, rows, changes, step, contacts)
    own, changes = comparison.slopes[rows], changes[:, None]
    changing = changes != 0.0
    expected = np.sum(np.where(changing, own * changes, 0.0), axis=2)
    excess = (difference - expected)[..., None] / np.where(changing, changes, 1.0)
    values = comparison.values[rows][..., None]
    relative = _disagreement(own + excess, own, values, sizes[:, None])
    confirmed = found.standing[rows] == Standing.confirmed
    new = changing & comparison.known[rows] & ~confirmed
    new &= (until[:, None] >= comparison.when[rows])[..., None]
    agrees = new & (relative <= AGREES_WITHIN)
    verdict = np.where(agrees, Standing.confirmed, Standing.differs)
    told = np.nonzero(agrees if together else new)
    place = rows[told[0]], *told[1:]
    found.standing[place] = verdict[told]
    found.by_differences[place] = (own + excess)[told]
    found.disagreement[place] = relative[told]
    row, parameter = np.nonzero(changing[:, 0])
    place = rows[row], parameter
    reached = np.where(np.isinf(until), step, 0.0)[row]
    found.same_within[place] = np.fmax(found.same_within[place], reached)


def _difference(
    comparison: Comparison,
    rows: np.ndarray,
    changes: np.ndarray,
    step: float,
    contacts: FullModel | ClosedForm,
) -> tuple[np.ndarray, np.ndarray]:
    """Compute central differences of the outputs of some blocks.

    Args:
        changes: changes of the parameters in a step of one, `(rows, parameters)`.

    Returns:
        Differences over the step, `(rows, outputs)`, and the times until which
        neighbours make the same contacts [s].
    """
    case, parameters = comparison.case, comparison.parameters
    both = np.concatenate([rows, rows])
    amounts = step * np.concatenate([changes, -changes])
    shifted = case.of_blocks(both)._replace(contacts=contacts)
    for parameter, amount in zip(parameters, amounts.T, strict=True):
        if np.any(amount):
            shifted = parameter.shift(shifted, amount)
    result = follow_case(shifted, comparison.limits)
    found = outputs_of(result, comparison.units)
    outputs = [output.value.value for output in found]
    until = same_until(_only(comparison.base, both), result.runs)
    more, less = np.split(np.stack(outputs, axis=1), 2)
    return (more - less) / (2.0 * step), np.minimum(*np.split(until, 2))


def _disagreement(
    differences: np.ndarray, slopes: np.ndarray, values: np.ndarray, size: np.ndarray
) -> np.ndarray:
    """Compute the relative disagreement of derivatives and differences."""
    floor = SMALL * np.abs(values) / size
    scale = np.maximum(np.maximum(np.abs(differences), np.abs(slopes)), floor)
    with np.errstate(invalid="ignore"):
        return np.abs(differences - slopes) / np.where(scale > 0.0, scale, 1.0)


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


def _only(runs: Runs, rows: np.ndarray) -> Runs:
    """Select the trajectories of some blocks, for `same_until`; a block may stand there
    several times."""
    records = {}
    for name in ("contacts", "pieces"):
        record = getattr(runs, name)
        starts, counts = (column[rows] for column in _spans(record, len(runs.time)))
        ends = np.cumsum(counts)
        place = np.arange(counts.sum()) + np.repeat(starts - (ends - counts), counts)
        owner = np.repeat(np.arange(len(rows)), counts)
        records[name] = select(record, place)._replace(trajectory=owner)
    return replaced(runs, ending=runs.ending[rows], time=runs.time[rows], **records)

"""A comparison of the model with somebody's law, its verdict, and the finding that
stands beside the claims."""

import dataclasses
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from ..criteria import Finding, Judgement, Verdict

HOLDS_WITHIN = 0.10
PARTLY_WITHIN = 0.30
"""Largest relative deviations of a law that holds, and of one that holds partly. Laws
fitted to tests on soil carry exponents rounded to a tenth and scatter by some tens of
percent."""


def relative_deviation(model, law) -> np.ndarray:
    """Root mean square of the difference over that of the law, along the last axis."""
    model, law = np.asarray(model), np.asarray(law)
    return np.linalg.norm(model - law, axis=-1) / np.linalg.norm(law, axis=-1)


def verdict_of(deviation: float) -> Verdict:
    """The verdict on a relative deviation; NaN is not computed."""
    if not np.isfinite(deviation):
        return Verdict.not_computed
    if deviation <= HOLDS_WITHIN:
        return Verdict.holds
    return Verdict.partly if deviation <= PARTLY_WITHIN else Verdict.fails


class Change(NamedTuple):
    """How near one parameter of the ground alone brings the model to the law."""

    parameter: str
    """Its column."""
    present: float
    """Its value in the comparison, in the column's unit."""
    nearest: float
    """The value, of those tried, with the smallest deviation."""
    at_the_edge: bool
    """Whether that is the first or the last value tried."""
    model: tuple[float, ...]
    """The model's values with it."""
    deviation: float


@dataclasses.dataclass(frozen=True)
class Comparison:
    """A number, or a few along a curve, by a law and by the model."""

    name: str
    quantity: str
    """What the numbers are, with the unit."""
    places: tuple[str, ...]
    """Place along the curve of each number; one empty text for a number alone."""
    law: tuple[float, ...]
    model: tuple[float, ...]
    over: str
    """The range and the scenes it was measured over."""
    source: str
    note: str
    """What one must know before one reads the verdict."""
    changes: tuple[Change, ...]
    """Parameters of the ground that alone bring it nearer, the best first."""
    figure_name: str
    """Comparisons of one name share a figure."""
    draw: Callable[[], Figure]

    @property
    def deviation(self) -> float:
        """Relative deviation of the model from the law."""
        return float(relative_deviation(self.model, self.law))

    @property
    def verdict(self) -> Verdict:
        """The verdict on it."""
        return verdict_of(self.deviation)


def log_slope(x, y) -> np.ndarray:
    """Exponent of a power law: slope of least squares of log y over log x, along the
    last axis. NaN where a y is not a positive number."""
    x = np.log(np.asarray(x, float))
    positive = np.asarray(y) > 0.0
    y = np.where(positive, np.log(np.where(positive, y, 1.0)), np.nan)
    x = x - np.mean(x, axis=-1, keepdims=True)
    return np.sum(x * y, axis=-1) / np.sum(x * x, axis=-1)


CRITERION = (
    f"the model is within {100 * HOLDS_WITHIN:g} % of the law (root mean square over "
    f"the places); partly within {100 * PARTLY_WITHIN:g} %"
)


def as_findings(comparisons: list[Comparison]) -> list[Finding]:
    """The comparisons in their order, L01 and so on."""
    return [
        Finding(
            f"L{number:02d}",
            row.source,
            f"{row.name}: {row.quantity}, {row.over}",
            CRITERION,
            _judgement(row),
        )
        for number, row in enumerate(comparisons, start=1)
    ]


def _judgement(row: Comparison) -> Judgement:
    places = zip(row.places, row.law, row.model, strict=True)
    numbers = {}
    for place, law, model in places:
        at = f"_at_{place.replace(' ', '_')}" if place else ""
        numbers |= {f"law{at}": law, f"model{at}": model}
    where = f" at {', '.join(row.places)}" if any(row.places) else ""
    evidence = (
        f"model {_listed(row.model)} against {_listed(row.law)}{where}, "
        f"{100 * row.deviation:.0f} % off"
    )
    if row.changes:
        evidence += f"; {_in_words(row.changes[0])}"
    return Judgement(row.verdict, evidence, numbers)


def _listed(values: tuple[float, ...]) -> str:
    return ", ".join(f"{value:.2f}" for value in values)


def _in_words(change: Change) -> str:
    return (
        f"{100 * change.deviation:.0f} % off with {change.parameter} "
        f"{change.nearest:.3g} for {change.present:.3g}"
    )

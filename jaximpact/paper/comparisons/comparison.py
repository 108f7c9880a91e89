"""A comparison of the model with somebody's law, its verdict, and the finding that
stands beside the claims.

Beside it stands which parameter of the ground alone would bring the model nearer to the
law: each is moved through its range, one at a time. That is a measurement, not a fit:
nothing is kept.
"""

import dataclasses
from collections.abc import Callable
from typing import NamedTuple

import jax
import numpy as np
from matplotlib.figure import Figure

from ...batch import simulate_batch
from ...quantities import columns_of_part
from ...scene import Block, Impact, Scene, Soil
from ...simulation import ImpactResult
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
    """Return the verdict on a relative deviation; NaN is not computed."""
    if not np.isfinite(deviation):
        return Verdict.not_computed
    if deviation <= HOLDS_WITHIN:
        return Verdict.holds
    return Verdict.partly if deviation <= PARTLY_WITHIN else Verdict.fails


class Change(NamedTuple):
    """Effect of one parameter of the ground on the deviation from the law."""

    parameter: str
    """Column of the parameter."""
    present: float
    """Value in the comparison, in the column's unit."""
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
    """Name of the numbers, with the unit."""
    places: tuple[str, ...]
    """Place along the curve of each number; one empty text for a number alone."""
    law: tuple[float, ...]
    model: tuple[float, ...]
    over: str
    """The range and the scenes it was measured over."""
    source: str
    note: str
    """Caution for whoever reads the verdict."""
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
    """Return the comparisons in their order, L01 and so on."""
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
    numbers = {}
    for place, law, model in zip(row.places, row.law, row.model, strict=True):
        at = f"_at_{place.replace(' ', '_')}" if place else ""
        numbers |= {f"law{at}": law, f"model{at}": model}
    where = f" at {', '.join(row.places)}" if any(row.places) else ""
    model, law = (
        ", ".join(f"{value:.2f}" for value in values) for values in (row.model, row.law)
    )
    evidence = f"model {model} against {law}{where}, {100 * row.deviation:.0f} % off"
    if row.changes:
        best = row.changes[0]
        evidence += (
            f"; {100 * best.deviation:.0f} % off with {best.parameter} "
            f"{best.nearest:.3g} for {best.present:.3g}"
        )
    return Judgement(row.verdict, evidence, numbers)


# --- The ground with one parameter at a time moved through its range.

VALUES = 11
"""Values tried of each parameter."""


def _even(low: float, high: float) -> np.ndarray:
    return np.linspace(low, high, VALUES)


def _decades(low: float, high: float) -> np.ndarray:
    return np.geomspace(low, high, VALUES)


TRIED = {
    "unit_weight_kNm3": _even(12.0, 24.0),
    "friction_angle_deg": _even(20.0, 45.0),
    "relative_density": _even(0.0, 1.0),
    "k_E": _decades(30.0, 3e4),
    "n_E": _even(0.0, 1.0),
    "poisson": _even(0.0, 0.45),
    "beta": _even(0.5, 1.2),
    "c_v": _decades(0.03, 30.0),
    "gamma_v": _decades(0.1, 1e3),
    "alpha_vT": _even(0.0, 10.0),
    "alpha_vR": _even(0.0, 2.0),
    "psi": _even(0.1, 1.0),
    "alpha_s": _even(0.1, 1.5),
    "dilatancy": _even(0.0, 1.0),
}
"""Values tried, by column and in its unit: what soils may have, and no further than
docs/limits.md trusts the model. Left out is what others stand for: `S_ef` acts as
`k_E`, the two `delta` as `relative_density`. No dashpots."""
MATTERS = 0.01
"""A parameter that lessens the deviation by no more than this is not named."""


def variants_of(soil: Soil) -> Soil:
    """List the soil itself, then one variant for each parameter and value of `TRIED`,
    as fields of one shape."""
    count = 1 + len(TRIED) * VALUES
    columns = columns_of_part("soil", soil)
    fields = {}
    for place, (name, values) in enumerate(TRIED.items()):
        column, first = columns[name], 1 + place * VALUES
        field = np.full(count, float(getattr(soil, column.field)))
        field[first : first + VALUES] = column.factor * values
        fields[column.field] = field
    alike = jax.tree.map(lambda leaf: np.full(count, float(leaf)), soil)
    return dataclasses.replace(alike, **fields)


def strike(soils: Soil, block: Block, impact: Impact, **soil_axes) -> ImpactResult:
    """Compute every impact on every soil, as arrays (soils, impacts).

    Args:
        soils: fields that broadcast to (soils,). block, impact: fields that broadcast
            to (impacts,).
        soil_axes: fields of the soil that go along with the impacts instead.
    """
    down = jax.tree.map(lambda leaf: np.atleast_1d(leaf)[:, None], soils)
    scene = Scene(block, dataclasses.replace(down, **soil_axes), impact)
    shape = np.broadcast_shapes(*(np.shape(leaf) for leaf in jax.tree.leaves(scene)))
    flat = jax.tree.map(lambda leaf: np.broadcast_to(leaf, shape).ravel(), scene)
    # Coefficients to 4e-5, where verdicts see percents
    result = simulate_batch(flat, accuracy="fast")
    return jax.tree.map(lambda values: np.reshape(values, shape), result)


def changes_of(soil: Soil, model: np.ndarray, law: np.ndarray) -> tuple[Change, ...]:
    """Find which parameters alone bring the model nearer, the one that helps most
    first.

    Args:
        soil: as compared. model: (variants, places), of `variants_of(soil)`.
        law: (places,).

    Values for which an impact did not finish are passed over.
    """
    deviations = relative_deviation(model, law)
    columns = columns_of_part("soil", soil)
    changes = []
    for place, (name, values) in enumerate(TRIED.items()):
        column, first = columns[name], 1 + place * VALUES
        tried = deviations[first : first + VALUES]
        best = int(np.argmin(np.where(np.isnan(tried), np.inf, tried)))
        if not tried[best] < deviations[0] - MATTERS:
            continue
        changes.append(
            Change(
                parameter=name,
                present=float(getattr(soil, column.field)) / column.factor,
                nearest=float(values[best]),
                at_the_edge=best in (0, VALUES - 1),
                model=tuple(float(x) for x in model[first + best]),
                deviation=float(tried[best]),
            )
        )
    return tuple(sorted(changes, key=lambda change: change.deviation))

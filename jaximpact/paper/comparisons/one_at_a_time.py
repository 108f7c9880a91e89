"""The ground with one parameter at a time moved through its range: which of them would
bring the model nearer to a law. A measurement, not a fit: nothing is kept."""

import dataclasses

import jax
import numpy as np

from ...batch import simulate_batch
from ...quantities import columns_of_part
from ...scene import Block, Impact, Scene
from ...simulation import ImpactResult
from ...soil import Soil
from .comparison import Change, relative_deviation

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
    """The soil itself, then one variant for each parameter and value of `TRIED`, as
    fields of one shape."""
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
    """Every impact on every soil, as arrays (soils, impacts).

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
    """Which parameters alone bring the model nearer, the one that helps most first.

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

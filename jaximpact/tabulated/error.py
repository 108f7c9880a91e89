"""How far a table is from the model."""

import jax
import numpy as np

from ..accuracy import Accuracy
from ..mechanics.outcomes import Outcome
from ..scene import Impact
from .computing import compute
from .coordinates import SLIP_FACTOR, Direction, impact_from
from .table import ReboundTable, TableError, look_up_many

SLOWEST = 1.0
"""Least total speed of the random impacts [m/s]."""


def random_impacts(table: ReboundTable, count: int, seed: int = 0) -> Impact:
    """Impacts inside a table: every direction of closing alike, every orientation,
    speeds even on a logarithmic scale, from 1 m/s on or the table's first."""
    generator = np.random.default_rng(seed)
    low, high = max(SLOWEST, float(table.speeds[0])), float(table.speeds[-1])
    closing, slip, turning = generator.normal(size=(3, count))
    direction = Direction(
        np.exp(generator.uniform(np.log(low), np.log(high), count)),
        np.arctan2(np.abs(closing), np.hypot(slip, turning)),
        np.arctan2(turning, SLIP_FACTOR * slip),
    )
    return impact_from(
        table.block,
        direction,
        generator.uniform(0.0, np.pi, count),
        generator.uniform(float(table.slopes[0]), float(table.slopes[-1]), count),
    )


def measure_error(
    table: ReboundTable,
    impacts: Impact | int = 10_000,
    *,
    accuracy: str | Accuracy | None = None,
) -> TableError:
    """Set a table beside the model.

    Args:
        impacts: arrays `(n,)`, as those that a run-out met; or how many random ones.
        accuracy: of the model; that of the table if not given.
    """
    if isinstance(impacts, int):
        impacts = random_impacts(table, impacts)
    blows = compute(table.block, table.soil, impacts, accuracy or table.accuracy)
    entry = look_up_many(table, impacts)
    impacts = jax.tree.map(np.asarray, impacts)
    radius = float(table.block.semi_axes.minor)
    before = np.stack(
        [
            impacts.speed * np.cos(impacts.angle),
            impacts.speed * np.sin(impacts.angle),
            impacts.angular_velocity * radius,
        ]
    )
    unit = np.array([1.0, 1.0, radius])[:, None]
    speed = np.sqrt(np.sum(before**2, axis=0))
    model = unit * np.stack(blows.blow[:3]) / speed
    found = unit * np.stack(entry[:3]) / speed
    # Twice the kinetic energy per mass.
    inertia = float(table.block.shape.unit_inertia)
    shares = np.array([1.0, 1.0, inertia])

    def energy(velocities):
        return float(np.mean(shares @ velocities**2 / (shares @ (before / speed) ** 2)))

    good = (blows.outcome != Outcome.failed) & np.all(np.isfinite(found), axis=0)
    model, found = model[:, good], found[:, good]
    before, speed = before[:, good], speed[good]
    error = np.max(np.abs(found - model), axis=0)
    return TableError(
        *(float(q) for q in np.quantile(error, [0.5, 0.9, 0.99])),
        *(float(b) for b in np.mean(found - model, axis=1)),
        energy(found),
        energy(model),
        float(np.mean(np.asarray(entry.outcome)[good] != blows.outcome[good])),
        int(np.sum(good)),
        int(np.sum(~good)),
    )

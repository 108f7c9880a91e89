"""Making tables: the full model at every node, and how far a table is from it."""

import contextlib
import dataclasses
import math
from pathlib import Path
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import ArrayLike

from .._checks import expect, real_numbers, whole_number
from .._packages import versions
from .._precision import require_float64
from ..accuracy import Accuracy, get_accuracy
from ..batch import broadcast_scene
from ..errors import InputError
from ..identity import part_names
from ..impact.events import Outcome
from ..impact_response import COLUMNS, ImpactResponses, respond
from ..io.checks import NUMBERS_PER_IMPACT, check_memory, check_scene
from ..io.journal import Journal
from ..progress import Progress, ProgressFunction, as_progress, telling
from ..scene import Block, Impact, Scene, Soil
from ..scene_quantities import scene_values
from .table import (
    BEND,
    FLATTEST,
    STEEPEST,
    Direction,
    ReboundTable,
    TableError,
    gravity_speed,
    impact_from,
    look_up_many,
    slip_factor_of,
)


def compute(
    block: Block,
    soil: Soil,
    impact: Impact,
    accuracy: str | Accuracy,
    journal: Journal | None = None,
) -> ImpactResponses:
    """Compute impacts, arrays `(n,)`, of one block on one ground, scalars, by the full
    model, as `respond` does."""
    scene, _ = broadcast_scene(Scene(block, soil, impact))
    return respond(scene, get_accuracy(accuracy), journal)


def random_impacts(table: ReboundTable, count: int, seed: int = 0) -> Impact:
    """Sample impacts inside a table.

    Directions of approach, orientations and slopes are uniform, speeds log-uniform from
    1 m/s on, if the table has such, or from its first speed on.

    Raises InputError for a count that is no whole number from 1 on, or a seed that is
    none from 0 on.
    """
    count = whole_number("the number of random impacts", count, 1)
    seed = whole_number("the seed of random impacts", seed, 0)
    generator = np.random.default_rng(seed)
    first, high = float(table.speeds[0]), float(table.speeds[-1])
    low = max(first, 1.0) if high > 1.0 else first
    closing, slip, turning = generator.normal(size=(3, count))
    factor = slip_factor_of(table.outcomes.shape[3])
    direction = Direction(
        np.exp(generator.uniform(np.log(low), np.log(high), count)),
        np.arctan2(np.abs(closing), np.hypot(slip, turning)),
        np.arctan2(turning, factor * slip),
    )
    return impact_from(
        table.block,
        direction,
        generator.uniform(0.0, np.pi, count),
        generator.uniform(float(table.slopes[0]), float(table.slopes[-1]), count),
        factor,
    )


def _relative_velocities(impact: Impact, radius: float, velocities) -> np.ndarray:
    """Give v_n, v_t and Omega R, `(3, n)`, of these v_n and v_t [m/s] and Omega [rad/s]
    as fractions of the total speed before the impact, of a block's minor semi-axis R
    [m]. Errors of impacts are the largest difference of the three."""
    unit = np.array([[1.0], [1.0], [radius]])
    before = unit * np.stack(_velocities_before(impact))
    velocities = np.stack([*map(np.asarray, velocities)])
    return unit * velocities / np.sqrt(np.sum(before**2, axis=0))


def _velocities_before(impact: Impact) -> list[np.ndarray]:
    speed, angle, spin = map(
        np.asarray, (impact.speed, impact.angle, impact.angular_velocity)
    )
    return [speed * np.cos(angle), speed * np.sin(angle), spin]


def measure_error(
    table: ReboundTable,
    impacts: Impact | int = 10_000,
    *,
    accuracy: str | Accuracy | None = None,
) -> TableError:
    """Measure the error of a table beside the model.

    Args:
        table: the table.
        impacts: fields that broadcast to `(n,)`, such as the impacts of a run-out; or
            the number of random ones.
        accuracy: of the model; by default that of the table.

    Raises InputError where no impact is left to be compared, and for impacts that are
    neither an Impact nor a number of them.
    """
    are_impacts = isinstance(impacts, Impact)
    sample = impacts if are_impacts else random_impacts(table, impacts)
    sample = broadcast_scene(Scene(table.block, table.soil, sample))[0].impact
    computed = compute(table.block, table.soil, sample, accuracy or table.accuracy)
    entry = look_up_many(table, sample)
    sample = jax.tree.map(np.asarray, sample)
    radius = float(table.block.semi_axes.minor)
    before, model, looked_up = (
        _relative_velocities(sample, radius, velocities)
        for velocities in (
            _velocities_before(sample),
            computed.response[:3],
            entry[:3],
        )
    )
    failed = computed.outcome == Outcome.failed
    good = ~failed & np.all(np.isfinite(looked_up), axis=0)
    if not np.any(good):
        raise InputError(
            f"of {good.size} impacts there is none that the table has, with speeds up "
            f"to {table.speeds[-1]:g} m/s and its slopes, and the model can integrate"
        )
    before, model, looked_up = before[:, good], model[:, good], looked_up[:, good]
    # Twice the kinetic energy per mass.
    shares = np.array([1.0, 1.0, float(table.block.shape.unit_inertia)])

    def energy(velocities):
        return float(np.mean(shares @ velocities**2 / (shares @ before**2)))

    error = np.max(np.abs(looked_up - model), axis=0)
    median, of_90_percent, of_99_percent = np.quantile(error, [0.5, 0.9, 0.99]).tolist()
    normal, tangential, rotation = np.mean(looked_up - model, axis=1).tolist()
    wrong = np.asarray(entry.outcome)[good] != computed.outcome[good]
    return TableError(
        median=median,
        of_90_percent=of_90_percent,
        of_99_percent=of_99_percent,
        bias_normal=normal,
        bias_tangential=tangential,
        bias_rotation=rotation,
        energy=energy(looked_up),
        energy_of_model=energy(model),
        wrong_outcomes=float(np.mean(wrong)),
        impacts=int(np.sum(good)),
        failed=int(np.sum(failed)),
        without_entry=int(np.sum(~good & ~failed)),
    )


SPEEDS = (0.1, 120.0)
"""First and last total speed w by default [m/s]."""


class Nodes(NamedTuple):
    """Numbers of nodes along the axes of a table; see `ReboundTable`."""

    speed: int = 12
    elevation: int = 20
    azimuth: int = 37
    orientation: int = 20
    """Nodes of orientation; a round block has 1, whatever is asked for."""


def tabulate(
    block: Block | None = None,
    soil: Soil | None = None,
    *,
    slopes: ArrayLike = (0.0,),
    speeds: tuple[float, float] = SPEEDS,
    nodes: Nodes | None = None,
    accuracy: str | Accuracy = "fast",
    journal: Path | None = None,
    progress: Progress | ProgressFunction | None = None,
) -> ReboundTable:
    """Tabulate the full model's impacts of one block on one ground.

    Args:
        block, soil: scalars; by default `Block()` and `Soil()`.
        slopes: angles of the slope [rad], ascending; between them the table is linear.
        speeds: first and last total speed w [m/s]; see `table.Direction`.
        nodes: numbers of nodes along each axis.
        accuracy: as for `simulate`.
        journal: a file that keeps finished nodes: what it holds is not computed again.
            It is left for the caller to remove.
        progress: called as `progress(done, nodes)`.

    A node whose impact failed gives its outcome and nothing else. The table's `error`
    is measured on 10 000 random impacts.

    Raises ValueError, in one sentence, for values out of range or axes that are empty,
    and InputError for a journal of something else.
    """
    require_float64()
    block, soil = block or Block(), soil or Soil()
    nodes = nodes or Nodes()
    slopes = np.asarray(real_numbers("slopes of a table", slopes))
    ends = np.asarray(real_numbers("speeds of a table", speeds))
    _check(block, soil, slopes, ends, nodes)
    if block.shape.is_round():
        nodes = nodes._replace(orientation=1)
    scale = float(gravity_speed(block))
    axes = _axes(speeds_between(block, ends, nodes.speed), slopes, nodes[1:])
    shape = tuple(map(len, axes))
    places, impact = impacts_at(block, axes)
    setting = get_accuracy(accuracy)
    with (
        _opened(journal, block, soil, setting, axes) as store,
        telling(as_progress(progress)),
    ):
        computed = compute(block, soil, impact, setting, store)
    size = np.hypot(places[0], scale)
    radius = float(block.semi_axes.minor)
    after = computed.response
    entries = np.stack(
        [
            (after.normal_velocity - impact.normal_velocity) / size,
            (after.tangential_velocity - impact.tangential_velocity) / size,
            (after.angular_velocity - impact.angular_velocity) * radius / size,
            after.duration,
            after.rotation,
            after.sinking,
        ],
        axis=-1,
    )
    # A failed node has no weight, but 0 times NaN is NaN.
    entries = np.where(np.isfinite(entries), entries, 0.0)
    table = ReboundTable(
        block=block,
        soil=soil,
        entries=jnp.asarray(entries.reshape(*shape, -1)),
        outcomes=jnp.asarray(computed.outcome.reshape(shape)),
        speeds=jnp.asarray(axes[0]),
        slopes=jnp.asarray(slopes),
        accuracy=setting,
        error=None,
    )
    return dataclasses.replace(table, error=measure_error(table))


def _opened(journal: Path | None, block, soil, accuracy: Accuracy, axes):
    if journal is None:
        return contextlib.nullcontext()
    subject = {
        "table": scene_values(Scene(block, soil)),
        "laws": part_names(soil, block),
        "axes": [axis.tolist() for axis in axes],
        "slip_factor": slip_factor_of(len(axes[3])),
        "accuracy": dataclasses.asdict(accuracy),
        "versions": versions(),
    }
    count = math.prod(map(len, axes))
    return Journal(journal, subject, [*COLUMNS], count)


def speeds_between(block: Block, ends: np.ndarray, count: int) -> np.ndarray:
    """Return the total speeds of so many nodes from the first to the last [m/s]."""
    scale = float(gravity_speed(block))
    low, high = np.arcsinh(ends / scale)
    return scale * np.sinh(np.linspace(low, high, count))


def axes_of(table: ReboundTable) -> list[np.ndarray]:
    """Return the nodes of a table along its axes, in SI units and radians."""
    return _axes(
        np.asarray(table.speeds), np.asarray(table.slopes), table.outcomes.shape[1:4]
    )


def impacts_at(block: Block, axes: list[np.ndarray]) -> tuple[list[np.ndarray], Impact]:
    """Return the coordinates of all nodes, one after another, and their impacts."""
    speed, elevation, azimuth, orientation, slope = places = [
        grid.ravel() for grid in np.meshgrid(*axes, indexing="ij")
    ]
    direction = Direction(speed, elevation, azimuth)
    factor = slip_factor_of(len(axes[3]))
    impact = impact_from(block, direction, orientation, slope, factor)
    return places, jax.tree.map(np.asarray, impact)


def _axes(speeds, slopes, counts) -> list[np.ndarray]:
    flattest, steepest = FLATTEST ** (1.0 / BEND), STEEPEST ** (1.0 / BEND)
    return [
        speeds,
        np.linspace(flattest, steepest, counts[0]) ** BEND,
        np.linspace(-np.pi, np.pi, counts[1]),
        np.linspace(0.0, np.pi, counts[2]),
        slopes,
    ]


def _check(block, soil, slopes, speeds, nodes) -> None:
    check_scene(Scene(block, soil))
    if speeds.shape != (2,) or not 0.0 < speeds[0] < speeds[1] < np.inf:
        raise ValueError(
            "speeds of a table must be the first and the last, ascending from above "
            f"0, but got {speeds.tolist()}"
        )
    problem = None
    if slopes.ndim != 1 or not len(slopes) or not np.all(np.diff(slopes) > 0.0):
        problem = "a list that ascends"
    elif not np.all(np.abs(slopes) < 0.5 * np.pi):
        problem = "in (-pi/2, pi/2)"
    if problem:
        raise ValueError(
            f"slopes of a table must be {problem}, but got {slopes.tolist()}"
        )
    expect("nodes", nodes, Nodes)
    for name, count in nodes._asdict().items():
        least = 1 if name == "orientation" else 2
        whole_number(f"the number of nodes of {name}", count, least)
    size = math.prod(nodes) * len(slopes)
    check_memory(size * NUMBERS_PER_IMPACT, f"a table of {size} nodes")

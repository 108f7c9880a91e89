"""Making a table: the full model at every node."""

import contextlib
import dataclasses
import math
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from numpy.typing import ArrayLike

from ..accuracy import Accuracy, get_accuracy
from ..block import Block
from ..formats.checks import NUMBERS_PER_IMPACT, check_memory, check_scene
from ..formats.journal import Journal
from ..formats.provenance import versions
from ..formats.scenes import scene_values
from ..identity import part_names
from ..precision import require_float64
from ..runout.contact import Blow
from ..scene import Scene
from ..soil import Soil
from .computing import compute
from .coordinates import (
    BEND,
    FLATTEST,
    STEEPEST,
    Direction,
    gravity_speed,
    impact_from,
)
from .error import measure_error
from .table import ReboundTable

SPEEDS = (0.1, 120.0)
"""First and last total speed w if nothing else is asked for [m/s]."""


class Nodes(NamedTuple):
    """Nodes of a table along its axes; see `ReboundTable`."""

    speed: int = 12
    elevation: int = 20
    azimuth: int = 33
    orientation: int = 13
    """1 for a round block, whatever is asked for."""


def tabulate(
    block: Block | None = None,
    soil: Soil | None = None,
    *,
    slopes: ArrayLike = (0.0,),
    speeds: tuple[float, float] = SPEEDS,
    nodes: Nodes | None = None,
    accuracy: str | Accuracy = "fast",
    journal: Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> ReboundTable:
    """Tabulate the full model's impacts of one block on one ground.

    Args:
        block, soil: scalars; the defaults if not given.
        slopes: angles of the slope [rad], ascending; between them the table is linear.
        speeds: first and last total speed w [m/s]; see `coordinates`.
        nodes: along each axis.
        accuracy: as for `simulate`.
        journal: a file that keeps finished nodes: what stands there already is not
            computed again. It is left for the caller to remove.
        progress: called as `progress(done, nodes)`.

    Nodes whose impact failed say so, and are used for nothing but their own outcome.
    The table's `error` is measured on 10 000 random impacts.

    Raises ValueError, in one sentence, for values out of range or axes that are empty,
    and InputError for a journal of something else.
    """
    require_float64()
    block, soil = block or Block(), soil or Soil()
    nodes = nodes or Nodes()
    slopes = np.array(slopes, float)
    _check(block, soil, slopes, speeds, nodes)
    if block.shape.is_round():
        nodes = nodes._replace(orientation=1)
    scale = float(gravity_speed(block))
    low, high = np.arcsinh(np.asarray(speeds) / scale)
    axes = _axes(
        scale * np.sinh(np.linspace(low, high, nodes.speed)), slopes, nodes[1:]
    )
    shape = tuple(map(len, axes))
    speed, *rest, orientation, slope = (
        grid.ravel() for grid in np.meshgrid(*axes, indexing="ij")
    )
    impact = impact_from(block, Direction(speed, *rest), orientation, slope)
    setting = get_accuracy(accuracy)
    with _opened(journal, block, soil, setting, axes) as store:
        blows = compute(block, soil, impact, setting, progress, store)
    size = np.hypot(speed, scale)
    radius = float(block.semi_axes.minor)
    after = blows.blow
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
        outcomes=jnp.asarray(blows.outcome.reshape(shape)),
        speeds=jnp.asarray(axes[0]),
        slopes=jnp.asarray(slopes),
        accuracy=setting,
        error=None,
    )
    return dataclasses.replace(table, error=measure_error(table))


def _opened(journal: Path | None, block, soil, accuracy: Accuracy, axes):
    """The journal of a table, or nothing to keep it in."""
    if journal is None:
        return contextlib.nullcontext()
    subject = {
        "table": scene_values(Scene(block, soil)),
        "laws": part_names(soil, block),
        "axes": [axis.tolist() for axis in axes],
        "accuracy": dataclasses.asdict(accuracy),
        "versions": versions(),
    }
    count = math.prod(map(len, axes))
    return Journal(journal, subject, [*Blow._fields, "outcome"], count)


def axes_of(table: ReboundTable) -> list[np.ndarray]:
    """Places of a table's nodes along its axes, in SI units and radians."""
    return _axes(
        np.asarray(table.speeds), np.asarray(table.slopes), table.outcomes.shape[1:4]
    )


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
    low, high = speeds
    if not 0.0 < low < high < np.inf:
        raise ValueError(
            f"speeds of a table must ascend from above 0, but got {speeds}"
        )
    if slopes.ndim != 1 or not len(slopes) or not np.all(np.diff(slopes) > 0.0):
        raise ValueError(
            f"slopes of a table must be a list that ascends, but got {slopes.tolist()}"
        )
    if not np.all(np.abs(slopes) < 0.5 * np.pi):
        raise ValueError(
            f"slopes of a table must be in (-pi/2, pi/2), but got {slopes.tolist()}"
        )
    for name, count in nodes._asdict().items():
        if count < (1 if name == "orientation" else 2):
            raise ValueError(
                f"a table needs at least 2 nodes of {name}, but got {count}"
            )
    size = math.prod(nodes) * len(slopes)
    check_memory(size * NUMBERS_PER_IMPACT, f"a table of {size} nodes")

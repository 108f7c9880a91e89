"""A table of the full model's impacts, and how it is read."""

import dataclasses
import functools
import itertools
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from ..accuracy import Accuracy
from ..block import Block
from ..mechanics.outcomes import Outcome
from ..rebound import Rebound
from ..scene import Impact
from ..soil import Soil
from .coordinates import BEND, FLATTEST, STEEPEST, direction_of, gravity_speed

Scalar = Float[Array, ""]


class Entry(NamedTuple):
    """What the table says of an impact."""

    normal_velocity: Scalar
    """v_n after [m/s]."""
    tangential_velocity: Scalar
    angular_velocity: Scalar
    duration: Scalar
    """[s]"""
    rotation: Scalar
    """During contact [rad]."""
    sinking: Scalar
    """At the end [m]."""
    outcome: Int[Array, ""]
    """Code of `Outcome`."""


class TableError(NamedTuple):
    r"""Errors of a table on impacts that are not in it.

    Of each impact the error is the largest of those of v_n, v_t and Omega R after it,
    by its total speed before, $\sqrt{v^2 + (\Omega R)^2}$.
    """

    median: float
    of_90_percent: float
    """Not exceeded by so many."""
    of_99_percent: float
    bias_normal: float
    """Mean error of v_n."""
    bias_tangential: float
    bias_rotation: float
    """Mean error of Omega R."""
    energy: float
    """Mean kinetic energy after, by that before, as the table has it."""
    energy_of_model: float
    """As the model has it."""
    wrong_outcomes: float
    """Share of impacts with another outcome than in the model."""
    impacts: int
    failed: int
    """Impacts left out, as the model could not integrate them."""


class ReboundTable(eqx.Module):
    r"""The full model's impacts of one block on one ground, tabulated.

    The axes are $\sinh^{-1}(w/\sqrt{gR})$, the elevation, the azimuth, the orientation
    (of period $\pi$) and the slope; see `coordinates`. Entries are changes of velocity
    over $\sqrt{w^2 + gR}$, duration, rotation and final sinking: where an impact leaves
    the velocities alone, which is what most do that elongated blocks have in a run-out,
    nothing is lost between nodes.

    An impact takes the outcome that has most weight among the up to 32 nodes around it,
    and the mean of the entries of those with this outcome: where the model jumps from
    one outcome to another, so does the table, and mixes none. Elsewhere it is
    continuous and piecewise smooth.

    Called with a block and an impact, scalars or arrays that broadcast, it gives the
    velocities after, like the laws of `rebound`; `look_up` gives all of the entry. The
    block must be the one that the table was made for. Impacts slower than the table's
    first speed have the entry there; faster ones, and slopes outside it, have NaN and
    the outcome `failed`. A point that moves away changes nothing.
    """

    block: Block
    soil: Soil
    entries: Float[Array, "speed elevation azimuth orientation slope 6"]
    """As scaled: the fields of `Entry` but the last."""
    outcomes: Int[Array, "speed elevation azimuth orientation slope"]
    speeds: Float[Array, " speed"]
    """w of the nodes [m/s]."""
    slopes: Float[Array, " slope"]
    """[rad]"""
    accuracy: Accuracy = eqx.field(static=True)
    """With which the nodes were computed."""
    error: TableError | None
    """On random impacts; None only while it is being measured."""

    def __call__(self, block: Block, impact: Impact) -> Rebound:
        """Velocities after."""
        return Rebound(*self.look_up(impact)[:3])

    def look_up(self, impact: Impact) -> Entry:
        """The entry of an impact."""
        direction = direction_of(self.block, impact)
        scale = gravity_speed(self.block)
        shape = self.outcomes.shape
        first, last = (
            jnp.arcsinh(self.speeds[0] / scale),
            jnp.arcsinh(self.speeds[-1] / scale),
        )
        flattest, steepest = FLATTEST ** (1.0 / BEND), STEEPEST ** (1.0 / BEND)
        elevation = jnp.maximum(direction.elevation, FLATTEST) ** (1.0 / BEND)
        places = jnp.broadcast_arrays(
            (jnp.arcsinh(direction.total_speed / scale) - first) / (last - first)
            * (shape[0] - 1),
            (elevation - flattest) / (steepest - flattest) * (shape[1] - 1),
            (direction.azimuth + jnp.pi) / (2.0 * jnp.pi) * (shape[2] - 1),
            jnp.mod(impact.orientation, jnp.pi) / jnp.pi * (shape[3] - 1),
            jnp.interp(impact.slope, self.slopes, jnp.arange(shape[4], dtype=float)),
        )  # fmt: skip
        values, outcome = _read(self.entries, self.outcomes, places)
        size = jnp.hypot(direction.total_speed, scale)
        radius = self.block.semi_axes.minor
        scales = (size, size, size / radius, 1.0, 1.0, 1.0)
        values = [value * by for value, by in zip(values, scales, strict=True)]

        beyond = direction.total_speed > self.speeds[-1] * (1.0 + 1e-9)
        margin = 1e-9
        beyond |= impact.slope > self.slopes[-1] + margin
        beyond |= impact.slope < self.slopes[0] - margin
        away = direction.elevation <= 0.0
        unchanged = (
            impact.normal_velocity,
            impact.tangential_velocity,
            impact.angular_velocity,
            *(0.0, 0.0, 0.0),
        )
        failed = beyond | (outcome == int(Outcome.failed))
        values = [
            jnp.where(failed & ~away, jnp.nan, same + jnp.where(away, 0.0, change))
            for same, change in zip(unchanged, values, strict=True)
        ]
        outcome = jnp.where(failed, int(Outcome.failed), outcome)
        return Entry(*values, jnp.where(away, int(Outcome.separating), outcome))


def _read(entries, outcomes, places) -> tuple[list[Scalar], Scalar]:
    """Entries at places between nodes, and their outcome."""
    corners = []
    for place, count in zip(places, outcomes.shape, strict=True):
        if count == 1:
            corners.append([(jnp.zeros(place.shape, int), 1.0)])
            continue
        place = jnp.clip(place, 0.0, count - 1.0)
        low = jnp.minimum(place.astype(int), count - 2)
        share = place - low
        corners.append([(low, 1.0 - share), (low + 1, share)])
    found, votes = [], [0.0] * len(Outcome)
    for around in itertools.product(*corners):
        index = tuple(place for place, _ in around)
        weight = functools.reduce(jnp.multiply, [share for _, share in around])
        code = outcomes[index]
        found.append((index, weight, code))
        votes = [v + jnp.where(code == k, weight, 0.0) for k, v in enumerate(votes)]
    outcome = jnp.argmax(jnp.stack(jnp.broadcast_arrays(*votes)), axis=0)
    total, sums = 0.0, 0.0
    for index, weight, code in found:
        weight = jnp.where(code == outcome, weight, 0.0)
        total = total + weight
        sums = sums + weight[..., None] * entries[index]
    mean = sums / total[..., None]
    return [mean[..., k] for k in range(entries.shape[-1])], outcome


def look_up_many(table: ReboundTable, impact: Impact) -> Entry:
    """`look_up`, compiled, for arrays of one shape."""
    return _look_up(dataclasses.replace(table, error=None), impact)


_look_up = jax.jit(ReboundTable.look_up)

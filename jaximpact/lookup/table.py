r"""Tables of the full model's impacts, and how they are read.

With $u_n = v_n + T\Omega$ and $u_t = v_t - r\Omega$ of the point that touches, and
$s = \Omega R$, the total speed $w = \sqrt{u_n^2 + u_t^2 + s^2}$ and two angles are the
coordinates of an arriving block: the elevation $\epsilon = \arcsin(u_n/w)$, in
$(0, \pi/2]$ for every impact, and the azimuth $\alpha = \mathrm{atan2}(s, k u_t)$. So
the table holds exactly the impacts that close, those included that strike while their
centre rises. The factor k sets more azimuths where blocks strike in a run-out: of round
ones, where they roll, $u_t = 0$; of others, where they slip with little spin.
"""

import dataclasses
import functools
import html
import itertools
import math
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from .._jax_internals import Tracer
from .._safe import safe_sqrt
from .._types import Scalar
from ..accuracy import Accuracy
from ..impact.events import Outcome
from ..quantities import columns_of_part
from ..rebound import Rebound
from ..scene import GRAVITY, Block, Impact, Soil
from ..shapes import Ellipsoid
from ..units import DEGREE

SLIP_FACTOR, SLIP_FACTOR_OF_ROUND = 0.5, 3.0
"""Factors k of the azimuth. With 0.5 the error that 33 azimuths leave, all else exact,
is 0.0017 in the median of random impacts of A_r 2, and 0.004 of those of run-outs; with
3 it is 0.005 and 0.019."""
FLATTEST = 5e-4
"""Smallest elevation in a table [rad]."""
BEND = 3.0
"""Nodes of elevation are even in its root of this degree: dense where blocks graze."""
STEEPEST = 0.5 * math.pi
"""Largest elevation [rad]."""

Numbers = Scalar | np.ndarray
"""One number, or an array of NumPy with many of them."""


class Direction(NamedTuple):
    """Coordinates of the velocities of an arriving block."""

    total_speed: Numbers  # total speed w [m/s]
    elevation: Numbers  # epsilon [rad]; not positive where the point moves away
    azimuth: Numbers  # azimuth alpha [rad]


def gravity_speed(block: Block) -> Scalar:
    """Return sqrt(g R) [m/s], the speed below which gravity matters in an impact."""
    return jnp.sqrt(GRAVITY * block.semi_axes.minor)


def _arms(block: Block, orientation: Numbers) -> tuple[Scalar, Scalar]:
    axes, shape = block.semi_axes, block.shape

    def at(sin, cos):
        return shape.support(axes, sin, cos), shape.tangency_arm(axes, sin, cos)

    # Shapes are for scalars.
    return jnp.vectorize(at)(jnp.sin(orientation), jnp.cos(orientation))


def slip_factor_of(orientations: int) -> float:
    """Give the factor k of a table with so many nodes of orientation. Tables of round
    blocks have one; others with one are read as those."""
    return SLIP_FACTOR_OF_ROUND if orientations == 1 else SLIP_FACTOR


def direction_of(
    block: Block, impact: Impact, slip_factor: float = SLIP_FACTOR
) -> Direction:
    """Return the coordinates of an impact."""
    radius, arm = _arms(block, impact.orientation)
    spin = impact.angular_velocity
    closing = impact.normal_velocity + arm * spin
    slip = impact.tangential_velocity - radius * spin
    turning = spin * block.semi_axes.minor
    # Without slip and turning neither size nor angle has a derivative: another slip
    # stands there, which gives 0; and another size where nothing closes either.
    still = (slip == 0.0) & (turning == 0.0)
    slip = jnp.where(still, 1.0, slip)
    flat = jnp.where(still, 0.0, jnp.hypot(slip, turning))
    at_rest = still & (closing == 0.0)
    return Direction(
        jnp.hypot(closing, flat),
        jnp.arctan2(closing, jnp.where(at_rest, 1.0, flat)),
        jnp.arctan2(turning, slip_factor * slip),
    )


def impact_from(
    block: Block,
    direction: Direction,
    orientation: Numbers,
    slope: Numbers,
    slip_factor: float = SLIP_FACTOR,
) -> Impact:
    """Return the impact of coordinates; its angle may exceed 90 degrees."""
    radius, arm = _arms(block, orientation)
    true = jnp.arctan2(
        slip_factor * jnp.sin(direction.azimuth), jnp.cos(direction.azimuth)
    )
    flat = direction.total_speed * jnp.cos(direction.elevation)
    spin = flat * jnp.sin(true) / block.semi_axes.minor
    normal = direction.total_speed * jnp.sin(direction.elevation) - arm * spin
    tangential = flat * jnp.cos(true) + radius * spin
    return Impact(
        speed=jnp.hypot(normal, tangential),
        angle=jnp.arctan2(tangential, normal),
        orientation=orientation,
        angular_velocity=spin,
        slope=slope,
    )


class Entry(NamedTuple):
    """Result of an impact, as the table has it."""

    normal_velocity: Scalar
    """Velocity v_n of the centre after the impact [m/s]."""
    tangential_velocity: Scalar
    """Velocity v_t of the centre after the impact [m/s]."""
    angular_velocity: Scalar
    """Angular velocity after the impact [rad/s]."""
    duration: Scalar
    """Duration of the contact [s]."""
    rotation: Scalar
    """Rotation during the contact [rad]."""
    sinking: Scalar
    """Penetration of the lowest point at the end [m]."""
    outcome: Int[Array, ""]
    """Code of `Outcome`."""


class TableError(NamedTuple):
    r"""Errors of a table on impacts between its nodes.

    The error of an impact is the largest of those of v_n, v_t and Omega R after it,
    divided by the total speed before, $\sqrt{v^2 + (\Omega R)^2}$.
    """

    median: float
    """Median of the errors [-]."""
    of_90_percent: float
    """Error that 90 % of the impacts do not exceed [-]."""
    of_99_percent: float
    """Error that 99 % of the impacts do not exceed [-]."""
    bias_normal: float
    """Mean error of v_n [-]."""
    bias_tangential: float
    """Mean error of v_t [-]."""
    bias_rotation: float
    """Mean error of Omega R [-]."""
    energy: float
    """Mean ratio of the kinetic energies after and before, in the table [-]."""
    energy_of_model: float
    """Mean ratio of the kinetic energies after and before, in the model [-]."""
    wrong_outcomes: float
    """Fraction of the impacts with another outcome than in the model."""
    impacts: int
    """Number of impacts."""
    failed: int
    """Number of impacts left out, as the model could not integrate them."""
    without_entry: int = 0
    """Number of impacts left out that the model integrates, but of which the table has
    no entry: beyond its speeds or slopes, or beside nodes that failed."""


class ReboundTable(eqx.Module):
    r"""The full model's impacts of one block on one ground, tabulated.

    The axes are $\sinh^{-1}(w/\sqrt{gR})$, the elevation, the azimuth, the orientation
    (of period $\pi$) and the slope; see `Direction`. Entries are changes of velocity
    over $\sqrt{w^2 + gR}$, duration, rotation and final penetration: where an impact
    leaves the velocities alone, as most impacts of elongated blocks in a run-out do,
    interpolation is exact.

    An impact takes the outcome with most weight among the up to 32 nodes around it, and
    the weighted mean of the entries with this outcome: where the model jumps from one
    outcome to another, so does the table, and mixes none. Elsewhere it is continuous
    and piecewise smooth. Where the mean would give a block energy, its velocities are
    all reduced alike, to the energy that it had and what gravity gave it.

    Called with a block and an impact, scalars or arrays that broadcast, a table gives
    the velocities after, like the laws of `rebound`; `look_up` gives the whole entry.
    The block must be the one that the table was made for. Impacts slower than the first
    speed have the entry there; faster ones, and slopes outside the table, have NaN and
    the outcome `failed`. A point that moves away changes nothing.
    """

    block: Block
    soil: Soil
    entries: Float[Array, "speed elevation azimuth orientation slope 6"]
    """Scaled fields of `Entry` without the outcome, at the nodes."""
    outcomes: Int[Array, "speed elevation azimuth orientation slope"]
    """Codes of `Outcome` at the nodes."""
    speeds: Float[Array, " speed"]
    """Total speeds w of the nodes [m/s]."""
    slopes: Float[Array, " slope"]
    """Slopes of the nodes [rad]."""
    accuracy: Accuracy = eqx.field(static=True)
    """Accuracy with which the nodes were computed."""
    error: TableError | None
    """Error on random impacts; None only while it is being measured."""

    def __call__(self, block: Block, impact: Impact) -> Rebound:
        """Return the velocities after an impact."""
        return Rebound(*self.look_up(impact)[:3])

    def __repr__(self) -> str:
        if self.error is None or isinstance(self.speeds, Tracer):
            return super().__repr__()
        changed = []
        for name, column in columns_of_part("soil", self.soil).items():
            value = float(getattr(self.soil, column.field)) / column.factor
            if not math.isclose(value, column.default, rel_tol=1e-12):
                changed.append(f"{name} {value:g}")
        ground = ", ".join(changed) or "all values are the defaults"
        return (
            f"ReboundTable, accuracy {self.accuracy.name}: {self.in_words()}\n"
            f"ground: {ground}"
        )

    def _repr_html_(self) -> str:
        return "".join(f"<div>{html.escape(x)}</div>" for x in repr(self).split("\n"))

    def in_words(self) -> str:
        """Say what the table holds and how far it is from the model."""
        if self.error is None:
            raise ValueError("the error of this table has not been measured")
        kind, error = type(self.block.shape), self.error
        shape = "" if kind is Ellipsoid else f"shape {kind.__name__}, "
        nodes = " x ".join(map(str, self.outcomes.shape))
        slopes = ", ".join(f"{slope / DEGREE:.4g}" for slope in self.slopes.tolist())
        low, high = (float(self.speeds[end]) for end in (0, -1))
        beyond = ""
        if error.without_entry:
            beyond = f", and {error.without_entry:g} that the table does not have"
        return "\n".join(
            [
                f"{self.outcomes.size} impacts of a block of {float(self.block.mass):g}"
                f" kg, {shape}aspect ratio {float(self.block.aspect_ratio):g}: {nodes} "
                f"nodes of total speed ({low:g} to {high:g} m/s), elevation, azimuth, "
                f"orientation and slope ({slopes} deg)",
                f"error on {error.impacts:g} random impacts, by the total speed before:"
                f" median {error.median:.2g}, 90 % {error.of_90_percent:.2g}, 99 % "
                f"{error.of_99_percent:.2g}; another outcome in "
                f"{error.wrong_outcomes:.2%}; {error.failed:g} left out, as the model "
                f"failed{beyond}",
                f"kinetic energy after by that before, mean: {error.energy:.4g}, in "
                f"the model {error.energy_of_model:.4g}",
            ]
        )

    def look_up(self, impact: Impact) -> Entry:
        """Return the entry of an impact."""
        factor = slip_factor_of(self.outcomes.shape[3])
        direction = direction_of(self.block, impact, factor)
        scale = gravity_speed(self.block)
        shape = self.outcomes.shape
        first, last = (jnp.arcsinh(self.speeds[end] / scale) for end in (0, -1))
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
        unchanged = (
            impact.normal_velocity,
            impact.tangential_velocity,
            impact.angular_velocity,
            *(0.0, 0.0, 0.0),
        )
        after = [same + change for same, change in zip(unchanged, values, strict=True)]
        kept = _kept_velocity(self.block, impact, Entry._make([*after, outcome]))
        after = [*(kept * velocity for velocity in after[:3]), *after[3:]]

        margin = 1e-9
        beyond = direction.total_speed > self.speeds[-1] * (1.0 + margin)
        beyond |= impact.slope > self.slopes[-1] + margin
        beyond |= impact.slope < self.slopes[0] - margin
        beyond |= jnp.isnan(direction.total_speed + impact.slope + impact.orientation)
        away = direction.elevation <= 0.0
        failed = beyond | (outcome == int(Outcome.failed))
        values = [
            jnp.where(away, same, jnp.where(failed, jnp.nan, value))
            for same, value in zip(unchanged, after, strict=True)
        ]
        outcome = jnp.where(failed, int(Outcome.failed), outcome)
        outcome = jnp.where(away, int(Outcome.separating), outcome)
        return Entry._make([*values, outcome])


def _kept_velocity(block: Block, impact: Impact, after: Entry) -> Scalar:
    r"""Compute the fraction of the velocities after an impact that its energy allows.

    Between the nodes an impact may come out with more energy than it had. With the
    travel along the ground at the mean velocity, as a run-out takes it, and the descent
    $d$ of the centre, the fraction $s$ of the velocities is the largest one up to 1
    with

    $$ s^2 K_1 \le K_0 + m g \bigl( d \cos\omega + \tfrac{1}{2} (v_{t0} + s v_{t1})
       T \sin\omega \bigr) . $$
    """
    mass, weight = block.mass, block.mass * GRAVITY

    def kinetic(v_n, v_t, spin):
        return 0.5 * (mass * (v_n**2 + v_t**2) + block.inertia * spin**2)

    before = kinetic(
        impact.normal_velocity, impact.tangential_velocity, impact.angular_velocity
    )
    whole = kinetic(*after[:3])
    support_before, _ = _arms(block, impact.orientation)
    support_after, _ = _arms(block, impact.orientation + after.rotation)
    descent = after.sinking - support_after + support_before
    along = 0.5 * weight * jnp.sin(impact.slope) * after.duration
    available = before + weight * jnp.cos(impact.slope) * descent
    available = available + along * impact.tangential_velocity
    from_travel = along * after.tangential_velocity
    gains = whole > available + from_travel
    twice = jnp.where(gains, 2.0 * whole, 1.0)
    part = (from_travel + safe_sqrt(from_travel**2 + 2.0 * twice * available)) / twice
    return jnp.where(gains, jnp.clip(part, 0.0, 1.0), 1.0)


def _read(entries, outcomes, places) -> tuple[list[Scalar], Scalar]:
    """Interpolate entries at places between nodes, and find their outcome."""
    corners = []
    for place, count in zip(places, outcomes.shape, strict=True):
        if count == 1:
            corners.append([(jnp.zeros(place.shape, int), 1.0)])
            continue
        place = jnp.clip(place, 0.0, count - 1.0)
        low = jnp.minimum(place.astype(int), count - 2)
        share = place - low
        corners.append([(low, 1.0 - share), (low + 1, share)])
    nodes, votes = [], [0.0] * len(Outcome)
    for around in itertools.product(*corners):
        index = tuple(place for place, _ in around)
        weight = functools.reduce(jnp.multiply, [share for _, share in around])
        code = outcomes[index]
        nodes.append((index, weight, code))
        votes = [v + jnp.where(code == k, weight, 0.0) for k, v in enumerate(votes)]
    outcome = jnp.argmax(jnp.stack(jnp.broadcast_arrays(*votes)), axis=0)
    total: Any = 0.0
    sums: Any = 0.0
    for index, weight, code in nodes:
        weight = jnp.where(code == outcome, weight, 0.0)
        total = total + weight
        sums = sums + weight[..., None] * entries[index]
    mean = sums / total[..., None]
    return [mean[..., k] for k in range(entries.shape[-1])], outcome


def look_up_many(table: ReboundTable, impact: Impact) -> Entry:
    """Look up impacts in arrays of one shape, by a compiled `look_up`."""
    # Compiled code takes no errors.
    if table.error is not None:
        table = dataclasses.replace(table, error=None)
    return _look_up(table, impact)


_look_up = jax.jit(ReboundTable.look_up)

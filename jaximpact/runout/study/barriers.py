"""Barriers of a study: their table in the file, what becomes of blocks at them, and
design values with their intervals.

A barrier is a vertical screen at x, from the ground to its top. Its height is measured
vertically, since a block passes it when its centre passes the vertical at x: there its
motion is known exactly, and every point above the ground has one height, on a break of
the profile too. A fence of length h across a slope of angle w stands h / cos(w) high
over the ground below its top.

Trajectories know nothing of barriers. A block is counted at its first passage and goes
on as if no barrier stood there: what is stopped is counted, and not removed.
"""

import enum
import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr

from ...io.checks import warn_unusual
from ...io.toml import Key, check_keys, number, one_line
from ...reports.json_tree import plain
from ...reports.tables import Table, place_text
from ...units import variable_attributes
from ..coordinates import LARGEST
from ..terrain import Profile, check_inside
from .intervals import (
    DIFFERS,
    interval_beside,
    is_apart,
    least_blocks,
    percentile_interval_over_grounds,
    share_intervals_over_grounds,
)
from .results import second_of, valid_blocks

MOST_BARRIERS = 100
"""Largest number of barriers: each is rows of every table."""
KEYS = ("name", "x_m", "height_m", "capacity_kJ")
USUAL = {"height_m": 50.0, "capacity_kJ": 5e4}
"""Values beyond which a unit may be mistaken: fences take 10 MJ and are 10 m high at
most, embankments take some tens of MJ and may be some tens of metres high."""


class Barrier(NamedTuple):
    """Barrier across a profile, by which blocks are counted and not held back."""

    name: str
    x: float
    """Place along the profile [m]."""
    height: float
    """Height of its top above the ground at x, vertically [m]."""
    capacity: float
    """Largest kinetic energy of a block, of translation and rotation, that it stops
    [J]."""


def read_barriers(top: Key, content: dict, profile: Profile) -> tuple[Barrier, ...]:
    """Read the tables `[[barriers]]`, in their order; none where there are none.

    Raises InputError, naming file and key, for a barrier that is not on the profile,
    for heights and capacities that are not above 0, and for names that stand twice.
    Warns of heights and capacities that no barrier has.
    """
    key, tables = top["barriers"], content.get("barriers", [])
    if not isinstance(tables, list) or not all(isinstance(t, dict) for t in tables):
        raise key.error("must be tables, each under a line [[barriers]]")
    if len(tables) > MOST_BARRIERS:
        raise key.error(f"are {len(tables)}, but at most {MOST_BARRIERS} are counted")
    barriers: dict[str, Barrier] = {}
    for place, table in enumerate(tables, 1):
        barrier = _barrier(key[str(place)], table, profile)
        if barrier.name in barriers:
            raise key[str(place)]["name"].error(
                f"{barrier.name!r} stands twice; name tells barriers apart"
            )
        barriers[barrier.name] = barrier
    return tuple(barriers.values())


def _barrier(key: Key, table: dict, profile: Profile) -> Barrier:
    check_keys(key, table, KEYS)
    numbers = {}
    for name in KEYS[1:]:
        if name not in table:
            raise key[name].error("is needed")
        above = -math.inf if name == "x_m" else 0.0
        numbers[name] = number(key[name], table[name], above=above)
        if numbers[name] > LARGEST and name != "capacity_kJ":
            raise key[name].error(
                f"must be at most {LARGEST:g} m, but is {numbers[name]:g}"
            )
        if numbers[name] > (usual := USUAL.get(name, math.inf)):
            warn_unusual(
                f"is {numbers[name]:g}, while usual are up to {usual:g}; is it in "
                "another unit?",
                name,
                **key[name].place,
            )
    x, height, capacity = numbers.values()
    check_inside(profile, x, **key["x_m"].place)
    name = one_line(key, table, "name", f"barrier at {place_text(x, 6)} m")
    return Barrier(name, x, height, 1e3 * capacity)


DESIGN_PERCENTILES = (95, 99)
DESIGN_QUANTITIES = {
    "energy_kJ": ("energy_J", "kJ", 1e-3, "kinetic energy"),
    "speed_mps": ("speed_mps", "m/s", 1.0, "speed"),
    "centre_height_m": (
        *("centre_height_m", "m", 1.0, "height of the centre above the ground"),
    ),
    "lowest_height_m": (
        *("lowest_height_m", "m", 1.0, "height of the lowest point above the ground"),
    ),
}
"""Quantities of design values: variable, unit and factor in tables, and meaning."""
EFFECT_WORDS = {
    "arrive, of all": "arriving",
    "pass over, of these": "over_of_arriving",
    "break it": "broken_of_arriving",
    "are stopped": "stopped_of_arriving",
}
SECOND_COLUMNS = tuple(f"second_run_{n}" for n in ("value", "low", "high", "differs"))
NOTE = "A barrier changes no trajectory: blocks that it stops are counted, not removed."


class BarrierEffect(enum.StrEnum):
    """Effects of a barrier and a block on each other, at the block's first passage."""

    none = "not reached"
    over = "passes over"
    broken = "breaks it"
    stopped = "is stopped"


def effects_of(
    barrier: Barrier, lowest_height: np.ndarray, energy: np.ndarray
) -> np.ndarray:
    """Decide what becomes of each block at a barrier, as text, `(blocks,)`.

    A block passes over if its lowest point is above the top. Else it breaks the barrier
    if its kinetic energy exceeds the capacity, and is stopped if not.

    Args:
        lowest_height: height of the lowest point at first passage [m]; NaN for blocks
            that do not come there.
        energy: kinetic energy there [J].
    """
    none, over, broken, stopped = map(str, BarrierEffect)
    conditions = [
        np.isnan(lowest_height),
        lowest_height > barrier.height,
        energy > barrier.capacity,
    ]
    return np.select(conditions, [none, over, broken], stopped)


def barrier_variables(
    barriers: Sequence[Barrier], passages: Mapping[str, np.ndarray]
) -> tuple[dict, dict]:
    """Describe barriers and what becomes of each block there, as the variables and the
    coordinates of a dataset; none without barriers.

    Args:
        passages: quantities of first passages by their names, `(blocks, barriers)`.
    """
    if not barriers:
        return {}, {}
    names, x, height, capacity = zip(*barriers, strict=True)
    lowest, energy = passages["passage_lowest_height_m"], passages["passage_energy_J"]
    effects = [
        effects_of(barrier, lowest[:, place], energy[:, place])
        for place, barrier in enumerate(barriers)
    ]
    meaning = "effect of barrier and block on each other, at first passage"
    at, variables = ("block", "barrier"), {}
    variables["barrier_effect"] = (
        at,
        np.stack(effects, 1),
        variable_attributes(meaning),
    )
    for name, unit, _, words in DESIGN_QUANTITIES.values():
        unit = "J" if unit == "kJ" else unit
        about = variable_attributes(f"{words} at first passage of the barrier", unit)
        variables[f"barrier_{name}"] = (at, passages[f"passage_{name}"], about)
    coordinates: dict = {"barrier": np.array(names)}
    for name, values, unit, words in (
        ("barrier_x_m", x, "m", "x of the barrier"),
        ("barrier_height_m", height, "m", "height above the ground, vertically"),
        ("barrier_capacity_J", capacity, "J", "largest kinetic energy that it stops"),
    ):
        about = variable_attributes(words, unit)
        coordinates[name] = ("barrier", np.array(values, float), about)
    return variables, coordinates


class Estimate(NamedTuple):
    """Number estimated from blocks, with its interval of 95 %."""

    blocks: int  # number of blocks behind it
    count: int | None  # number of blocks of a share; None for a percentile
    value: float
    low: float  # lower end; NaN where there are too few blocks for one
    high: float


class BarrierEstimates(NamedTuple):
    """Estimates at a barrier, by names with the unit, such as energy_kJ_p95."""

    barrier: Barrier
    estimates: dict[str, Estimate]
    other_kinematics: str = ""  # of the soil, of the second run; "" without one
    others: dict[str, Estimate] | None = None  # the same from that run

    @property
    def place(self) -> tuple[str, float, float, float]:
        """Name, x [m], height [m] and capacity [kJ] of the barrier."""
        name, x, height, capacity = self.barrier
        return name, x, height, capacity / 1e3


def estimates_at(
    barrier: Barrier, counted: np.ndarray, passages: Mapping[str, np.ndarray]
) -> BarrierEstimates:
    """Estimate shares and design values at a barrier.

    Shares are of all blocks counted, and of those that arrive; design values of those
    that arrive. On several grounds, equally likely, numbers are those of all blocks
    together, and intervals hold that one of the grounds is the true one.

    Args:
        counted: False for blocks that failed, `(grounds, blocks)`.
        passages: the variables of `DESIGN_QUANTITIES` by name; NaN for blocks that do
            not arrive, `(grounds, blocks)`.
    """
    effects = effects_of(barrier, passages["lowest_height_m"], passages["energy_J"])
    arriving = counted & (effects != str(BarrierEffect.none))
    every, there = np.sum(counted, axis=1), np.sum(arriving, axis=1)
    estimates = {"share_arriving": _share(there, every)}
    for of, blocks in (("all", every), ("arriving", there)):
        for effect in list(BarrierEffect)[1:]:
            count = np.sum(counted & (effects == str(effect)), axis=1)
            estimates[f"share_{effect.name}_of_{of}"] = _share(count, blocks)
    for name, (variable, _, factor, _) in DESIGN_QUANTITIES.items():
        grounds = [
            factor * values[chosen]
            for values, chosen in zip(passages[variable], arriving, strict=True)
        ]
        values = np.concatenate(grounds)
        for percent in DESIGN_PERCENTILES:
            value = float(np.percentile(values, percent)) if len(values) else np.nan
            ends = percentile_interval_over_grounds(grounds, percent)
            estimate = Estimate(len(values), None, value, *ends)
            estimates[f"{name}_p{percent}"] = estimate
    return BarrierEstimates(barrier, estimates)


def _share(counts: np.ndarray, blocks: np.ndarray) -> Estimate:
    count, of = int(np.sum(counts)), int(np.sum(blocks))
    (low,), (high,) = share_intervals_over_grounds(counts[:, None], blocks)
    return Estimate(of, count, count / of if of else np.nan, float(low), float(high))


def estimates_of(dataset: xr.Dataset) -> list[BarrierEstimates]:
    """Estimate shares and design values at the barriers of a result, and from its
    second run; none where it has no barriers."""
    second, at_barriers = second_of(dataset), []
    for name in dataset.barrier.values.tolist() if "barrier" in dataset.sizes else []:
        here = dataset.sel(barrier=name)
        numbers = (here.barrier_x_m, here.barrier_height_m, here.barrier_capacity_J)
        barrier = Barrier(name, *map(float, numbers))
        found = _estimates_in(dataset, barrier)
        if second is not None:
            kinematics, other = second
            others = _estimates_in(other, barrier).estimates
            found = found._replace(other_kinematics=kinematics, others=others)
        at_barriers.append(found)
    return at_barriers


def _estimates_in(dataset: xr.Dataset, barrier: Barrier) -> BarrierEstimates:
    here = dataset.sel(barrier=barrier.name)
    passages = {
        variable: here[f"barrier_{variable}"].values[None]
        for variable, *_ in DESIGN_QUANTITIES.values()
    }
    return estimates_at(barrier, valid_blocks(dataset)[None], passages)


def mark(one: Estimate, other: Estimate) -> str:
    """Mark estimates whose intervals do not overlap."""
    return DIFFERS if is_apart(one[3:], other[3:]) else ""


def estimate_table(at_barriers: Sequence[BarrierEstimates]) -> Table:
    """List all estimates, for barriers.csv."""
    columns = ("barrier", *KEYS[1:], "quantity", *Estimate._fields)
    rows = []
    for of in at_barriers:
        for quantity, estimate in of.estimates.items():
            beside = (None,) * 4
            if of.others:
                second = of.others[quantity]
                beside = (*second[2:], mark(estimate, second))
            rows.append((*of.place, quantity, *estimate, *beside))
    return Table((*columns, *SECOND_COLUMNS), rows)


def barriers_in_json(at_barriers: Sequence[BarrierEstimates]) -> list[dict]:
    """Describe the barriers with their estimates, None for what is not known, and those
    by another kinematics with the names of the ones that differ."""
    described = []
    for of in at_barriers:
        barrier = dict(zip(KEYS, of.place, strict=True))
        barrier |= {"estimates": plain(of.estimates)}
        if others := of.others:
            apart = [name for name, e in of.estimates.items() if mark(e, others[name])]
            barrier |= {"second_run": plain(others), "differs": apart}
        described.append(barrier)
    return described


def effect_table(at_barriers: Sequence[BarrierEstimates]) -> Table:
    """Write what becomes of blocks at each barrier."""
    rows, columns = [], ("", "blocks", "share", "interval")
    for of in at_barriers:
        name, x, *size = of.place
        first = (name, place_text(x, 6), *size)
        for word, quantity in EFFECT_WORDS.items():
            estimate = of.estimates[f"share_{quantity}"]
            cells = (estimate.count, *_share_cells(estimate))
            if of.others:
                second = of.others[f"share_{quantity}"]
                cells += (*_share_cells(second), mark(estimate, second))
            rows.append((*first, word, *cells))
            first = ("",) * len(first)
    if at_barriers and (other := at_barriers[0].other_kinematics):
        columns += (f"by {other}", "interval", "")
    return Table(("barrier", "x [m]", "height [m]", "capacity [kJ]", *columns), rows)


def _share_cells(estimate: Estimate) -> tuple[str, str]:
    if not estimate.blocks:
        return "-", "-"
    ends = f"{estimate.low:.1%} to {estimate.high:.1%}"
    return f"{estimate.value:.1%}", ends


def design_table(at_barriers: Sequence[BarrierEstimates]) -> Table:
    """Write the design values at each barrier, and below each what it is by another
    kinematics."""
    rows = []
    for barrier, estimates, other, others in at_barriers:
        first = (barrier.name, estimates["share_arriving"].count)
        for name, (_, unit, *_) in DESIGN_QUANTITIES.items():
            words = name.rpartition("_")[0].replace("_", " ")
            names = [f"{name}_p{percent}" for percent in DESIGN_PERCENTILES]
            cells = (c for n in names for c in _cells(estimates[n]))
            rows.append((*first, words, unit, *cells))
            if others:
                cells = (c for n in names for c in _cells(others[n], estimates[n]))
                rows.append(("", "", f"- by {other}", unit, *cells))
            first = ("", "")
    heads = [h for percent in DESIGN_PERCENTILES for h in (f"{percent} %", "interval")]
    return Table(("barrier", "blocks", "", "unit", *heads), rows)


def _cells(estimate: Estimate, beside: Estimate | None = None) -> tuple[float, str]:
    return estimate.value, interval_beside(estimate[3:], beside and beside[3:])


def too_few(at_barriers: Sequence[BarrierEstimates]) -> list[str]:
    """Say at which barriers of a study there are too few blocks for an interval."""
    lines = []
    for barrier, estimates, *_ in at_barriers:
        count = estimates["share_arriving"].count or 0
        short = [p for p in DESIGN_PERCENTILES if count < least_blocks(p)]
        if short:
            needed = " and ".join(f"{least_blocks(p)} for {p} %" for p in short)
            lines.append(
                f"{barrier.name}: {count} blocks arrive, too few for both ends of an "
                f"interval; {needed} are needed."
            )
    return lines

"""The paper's slope run-out on two planes, and what its claims are judged by."""

import dataclasses

import numpy as np
import xarray as xr

from ..accuracy import Accuracy
from ..runout import Ending, FullModel, MotionMode, Runs, passages, simulate_runout
from ..runout.analysis import Jumps, jumps, restitutions, rise_before
from ..runout.biplanar import ASPECT_RATIOS, SPINS_DEGPS, BiplanarCase
from ..runout.trajectory import stretches_of
from ..scene import GRAVITY
from ..soil import Soil
from .criteria import NotComputed

GRID = ("aspect_ratio", "angular_velocity_degps")
COMPARED_X = np.arange(10.0, 251.0, 10.0)
"""Places where paths are compared [m]: the paper has them superimpose up to 250 m."""


@dataclasses.dataclass(frozen=True)
class SlopeReading:
    """How the paper's runs are read: the case itself, and what is counted."""

    case: BiplanarCase = dataclasses.field(default_factory=BiplanarCase)
    hop: float = 0.0
    """Rise up to which a flight counts as rolling [m]: it is no bounce and no jump, and
    the contact that ends it is no impact. With 0 every contact counts."""
    released_flight_jumps: bool = False
    """Whether the flight that a block is released in is a jump too."""
    out_of_the_crater: bool = True
    """Whether velocities after an impact are those with which the block goes on; else
    those before it climbs out of the ground."""


def slope_dataset(
    soil: Soil, reading: SlopeReading, accuracy: str | Accuracy
) -> xr.Dataset:
    """All runs on one ground.

    Returns:
        A dataset with numbers of trajectories over the aspect ratio and the spin of the
        sphere, of the paths without spin over the aspect ratio, and of all jumps and
        impacts in a row.

    Raises NotComputed if a trajectory failed or was cut off by a limit.
    """
    case = reading.case
    runs = simulate_runout(case.profile(soil), case.release(), FullModel(accuracy))
    whole = np.isin(runs.ending, [Ending.stopped, Ending.left_profile])
    if not np.all(whole):
        raise NotComputed(
            f"{np.sum(~whole)} of {len(whole)} runs failed or came to a limit"
        )
    flights = jumps(runs)
    shape = len(ASPECT_RATIOS), len(SPINS_DEGPS)
    of_trajectories = {
        "first_impact_x_m": _first(runs, "x"),
        "off_the_parabola_m": off_the_parabola(runs),
        "first_flight_m": flights.height[_firsts(flights.trajectory)],
        **bounces(runs, flights, reading.hop),
    }
    counted = flights.after_contact & (flights.rise >= reading.hop)
    if reading.released_flight_jumps:
        counted[_firsts(flights.trajectory)] = True
    coefficients = restitutions(runs, out_of_the_crater=reading.out_of_the_crater)
    impacts = np.isfinite(coefficients.e_n)
    if reading.hop > 0.0:
        impacts &= rise_before(runs, flights) > reading.hop
    of_block = np.repeat(ASPECT_RATIOS, len(SPINS_DEGPS))
    return xr.Dataset(
        {
            **{
                name: (GRID, np.reshape(values, shape))
                for name, values in of_trajectories.items()
            },
            "paths_apart_m": ("aspect_ratio", paths_apart(runs)),
            "jump_height_m": ("jump", flights.height[counted]),
            "jump_aspect_ratio": ("jump", of_block[flights.trajectory[counted]]),
            "e_n": ("impact", coefficients.e_n[impacts]),
            "e_t": ("impact", coefficients.e_t[impacts]),
        },
        {
            "aspect_ratio": np.array(ASPECT_RATIOS),
            "angular_velocity_degps": np.array(SPINS_DEGPS),
        },
    )


def _firsts(trajectory: np.ndarray) -> np.ndarray:
    """Place of the first row of each trajectory; every one has some."""
    return np.searchsorted(trajectory, np.unique(trajectory))


def _first(runs: Runs, name: str) -> np.ndarray:
    """A column of the first contact of each trajectory."""
    return getattr(runs.contacts, name)[_firsts(runs.contacts.trajectory)]


def off_the_parabola(runs: Runs) -> np.ndarray:
    """How far from the parabola of its release each centre is at its first contact, at
    the x that it has there [m]."""
    body = runs.release.body
    x, y = _first(runs, "x"), _first(runs, "y")
    time = (x - body.x) / body.v_x
    return np.abs(y - (body.y + (body.v_y - 0.5 * GRAVITY * time) * time))


def paths_apart(runs: Runs) -> np.ndarray:
    """How far the path of each shape without spin is from the sphere's, vertically, at
    the worst of `COMPARED_X` [m]; NaN for one that does not come so far."""
    still = np.arange(len(ASPECT_RATIOS)) * len(SPINS_DEGPS)
    apart = np.zeros(len(still))
    stretches = stretches_of(runs)
    for x in COMPARED_X:
        found = passages(runs, x, stretches)
        heights = [found.centre_height[found.trajectory == block] for block in still]
        for place, height in enumerate(heights):
            passed = len(height) and len(heights[0])
            worst = np.max(np.abs(height - heights[0][0])) if passed else np.nan
            apart[place] = np.maximum(apart[place], worst)
    return apart


def bounces(runs: Runs, flights: Jumps, hop: float) -> dict[str, np.ndarray]:
    """Flights between the first impact of each trajectory and its first rolling: how
    many, the largest and the middle one of their rises [m], 0 for none, and whether the
    block rolls then.

    Args:
        hop: rise up to which a flight is rolling [m].
    """
    rolling = np.flatnonzero(runs.pieces.motion == MotionMode.rolling)
    rollers = runs.pieces.trajectory[rolling].astype(int)
    count, highest, middle, rolls = np.zeros((4, runs.release.count))
    for block in range(runs.release.count):
        after = np.flatnonzero(flights.trajectory == block)[1:]
        until = np.min(rolling[rollers == block], initial=len(runs.pieces.motion))
        rolls[block] = until < len(runs.pieces.motion)
        after = after[flights.piece[after] < until]
        low = np.flatnonzero(flights.rise[after] <= hop)
        if hop > 0.0 and len(low):
            after, rolls[block] = after[: low[0]], 1.0
        rises = flights.rise[after]
        count[block] = len(rises)
        highest[block] = np.max(rises, initial=0.0)
        middle[block] = np.median(rises) if len(rises) else 0.0
    return {
        "bounces": count,
        "highest_bounce_m": highest,
        "middle_bounce_m": middle,
        "rolls": rolls > 0.0,
    }

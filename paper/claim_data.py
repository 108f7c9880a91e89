"""Datasets that claims are judged by, computed as they are asked for, and what is read
off them: one axis alone, the difference to mirrored orientations, flights down a slope.
"""

import itertools

import numpy as np
import xarray as xr

from jaximpact.accuracy import DEFAULT_ACCURACY
from jaximpact.batch import simulate_batch
from jaximpact.parametric_sets import TABLE_1, parametric_set
from jaximpact.progress import Progress
from jaximpact.runout import (
    Ending,
    FullModel,
    MotionMode,
    Runs,
    passages,
    simulate_runout,
)
from jaximpact.runout.trajectory import stretches_of
from jaximpact.scene import GRAVITY, Scene
from jaximpact.scene_quantities import scene_of_values, scene_values
from jaximpact.sweeping import Axes, sweep

from .biplanar import ASPECT_RATIOS, SPINS_DEGPS, Jumps, jumps, restitutions
from .criteria import NotComputed
from .readings import AS_IT_IS, Reading, SlopeReading, with_contact_at
from .study import record_impacts

ACCURACY = DEFAULT_ACCURACY
SERIES, SLOPE = "courses", "slope"
SERIES_ANGLES_DEG = np.arange(10.0, 81.0, 10.0)
RANDOM_IMPACTS = 10_000
SEED = 13
_SPINS_DEGPS = {
    "random, level": 2e3,
    "random, fast spin": 2e4,
    "random, on slopes": 2e3,
}
RANDOM_SETS = tuple(_SPINS_DEGPS)
"""Random impacts: on level ground with the spins of Fig. 13 and with those of the
paper's runs, and on slopes."""
COMPARED_X = np.arange(10.0, 251.0, 10.0)
"""Places where paths are compared [m]: the paper has them superimpose up to 250 m."""


class Study:
    """Datasets of one ground under one reading of the model, each computed once.

    They are taken by name, `study["III"]`: the parametric sets, `SERIES`, the random
    impacts (`RANDOM_SETS`), and the slope run-out, `SLOPE`. A set with an impact that
    failed raises NotComputed; random impacts that failed are NaN.
    """

    def __init__(
        self,
        ground: str = TABLE_1,
        reading: Reading = AS_IT_IS,
        progress: Progress = Progress(),  # noqa: B008
    ):
        self.ground, self.reading, self.progress = ground, reading, progress
        self._known: dict[str, xr.Dataset] = {}
        self._others: dict[str, Study] = {ground: self}

    def on(self, ground: str) -> "Study":
        """Return the same data on another ground."""
        if ground not in self._others:
            other = Study(ground, self.reading, self.progress)
            other._others = self._others
            self._others[ground] = other
        return self._others[ground]

    def __getitem__(self, name: str) -> xr.Dataset:
        if name not in self._known:
            self.progress(f"{self.reading.name}, {self.ground}: {name}")
            self._known[name] = self._compute(name)
        return self._known[name]

    def _compute(self, name: str) -> xr.Dataset:
        if name == SERIES:
            return self._time_series()
        if name in RANDOM_SETS:
            return self._random(name)
        if name == SLOPE:
            return self._slope(self.reading.slope)
        base, axes = self._parametric_set(name)
        dataset = sweep(base, axes, accuracy=ACCURACY)
        failed = int((dataset.outcome == "failed").sum())
        if failed:
            raise NotComputed(
                f"{failed} of {dataset.outcome.size} impacts of set {name} failed"
            )
        if name == "fig13":
            dataset = with_contact_at(dataset, base, self.reading.contact)
        return dataset

    def _parametric_set(self, name: str) -> tuple[Scene, Axes]:
        """Base and axes of a set on this ground, as the reading has it."""
        base, axes = parametric_set(name, self.ground)
        return scene_of_values(scene_values(base) | dict(self.reading.values)), axes

    def _random(self, name: str) -> xr.Dataset:
        """Energetic coefficient, outcome and gravity's work over the incoming energy
        of random impacts."""
        base, _ = self._parametric_set("I")
        values = scene_values(base) | random_quantities(name)
        scenes = scene_of_values(values)
        result = simulate_batch(scenes, accuracy=ACCURACY, ledger=True)
        ledger = result.energy
        assert ledger is not None  # asked for above
        variables = {
            "e_bar": result.e_bar,
            "gravity_share": ledger.gravity / ledger.kinetic_in,
            "outcome": result.outcome,
        }
        return xr.Dataset({key: ("impact", value) for key, value in variables.items()})

    def _time_series(self) -> xr.Dataset:
        """Rotation and ratio of energies of inclined impacts along the major axis, step
        by step and then as they ended."""
        base, axes = self._parametric_set("III")
        grid = {
            "angle_deg": SERIES_ANGLES_DEG,
            "aspect_ratio": np.asarray(axes["aspect_ratio"]),
        }
        points = [
            {"orientation_deg": 0.0, **dict(zip(grid, point, strict=True))}
            for point in itertools.product(*grid.values())
        ]
        recorded = record_impacts(base, points, ACCURACY, self.progress)
        histories = [history for _, history in recorded]
        longest = max(len(history.time) for history in histories)
        shape = *map(len, grid.values()), longest

        def padded(name: str) -> np.ndarray:
            series = [getattr(history, name) for history in histories]
            if not all(np.all(np.isfinite(row)) for row in series):
                raise NotComputed("the course of an impact of set III failed")
            rows = [np.pad(row, (0, longest - len(row)), "edge") for row in series]
            return np.reshape(rows, shape)

        columns = {"rotation_rad": "rotation", "R_r": "rotational_ratio"}
        series = {name: ((*grid, "step"), padded(of)) for name, of in columns.items()}
        return xr.Dataset(series, grid)

    def _slope(self, reading: SlopeReading) -> xr.Dataset:
        """Slope run-out: numbers of trajectories over the aspect ratio and the spin of
        the sphere, of the paths without spin over the aspect ratio, and of all jumps
        and impacts in a row. Impacts after which a block hops are counted apart."""
        case, soil = reading.case, self._parametric_set("I")[0].soil
        runs = simulate_runout(
            case.profile(soil),
            case.release(),
            FullModel(ACCURACY),
            hop_threshold=reading.hop_threshold,
        )
        whole = np.isin(runs.ending, [Ending.stopped, Ending.left_profile])
        if not np.all(whole):
            raise NotComputed(
                f"{np.sum(~whole)} of {len(whole)} runs failed or came to a limit"
            )
        flights = jumps(runs)
        grid = {
            "aspect_ratio": np.array(ASPECT_RATIOS),
            "angular_velocity_degps": np.array(SPINS_DEGPS),
        }
        of_trajectories = {
            "first_impact_x_m": _first(runs, "x"),
            "off_the_parabola_m": off_the_parabola(runs),
            "first_flight_m": flights.height[_firsts(flights.trajectory)],
            **bounces(runs, flights),
        }
        counted = flights.after_contact.copy()
        if reading.released_flight_jumps:
            counted[_firsts(flights.trajectory)] = True
        coefficients = restitutions(runs, out_of_the_crater=reading.out_of_the_crater)
        hops = runs.contacts.hop.astype(bool)
        valid = np.isfinite(coefficients.e_n)
        impacts = valid & ~hops
        of_block = np.repeat(ASPECT_RATIOS, len(SPINS_DEGPS))
        variables = {
            name: (tuple(grid), np.reshape(values, tuple(map(len, grid.values()))))
            for name, values in of_trajectories.items()
        }
        variables |= {
            "paths_apart_m": ("aspect_ratio", paths_apart(runs)),
            "jump_height_m": ("jump", flights.height[counted]),
            "jump_aspect_ratio": ("jump", of_block[flights.trajectory[counted]]),
            "e_n": ("impact", coefficients.e_n[impacts]),
            "e_t": ("impact", coefficients.e_t[impacts]),
            "impact_aspect_ratio": (
                "impact",
                of_block[runs.contacts.trajectory[impacts].astype(int)],
            ),
            "e_n_before_hops": ("hop", coefficients.e_n[valid & hops]),
        }
        return xr.Dataset(variables, grid)


def random_quantities(name: str) -> dict[str, np.ndarray]:
    """Quantities of random impacts, in the units of their columns."""
    random = np.random.default_rng(SEED + RANDOM_SETS.index(name))
    count, spin = RANDOM_IMPACTS, _SPINS_DEGPS[name]
    return {
        "mass_kg": np.exp(random.uniform(np.log(10.0), np.log(1e4), count)),
        "aspect_ratio": random.uniform(1.0, 4.0, count),
        "speed_mps": random.uniform(5.0, 30.0, count),
        "angle_deg": random.uniform(0.0, 85.0, count),
        "orientation_deg": random.uniform(0.0, 180.0, count),
        "angular_velocity_degps": random.uniform(-spin, spin, count),
        "slope_deg": random.uniform(0.0, 45.0, count) * (name == "random, on slopes"),
    }


# --- What is read off datasets.


def along_major_axis(sets: Study) -> xr.Dataset:
    """Set III along the major axis: over the angle and A_r."""
    return sets["III"].sel(orientation_deg=0.0, drop=True)


def along_minor_axis(sets: Study) -> xr.Dataset:
    """Set III along the minor axis: over the angle and A_r."""
    return sets["III"].sel(orientation_deg=90.0, drop=True)


def elongated(data):
    """Choose the values of blocks with an A_r above 1, of a dataset or an array over
    A_r."""
    return data.sel(aspect_ratio=data.aspect_ratio > 1.0)


def along_dimension(function, values: xr.DataArray, dimension: str) -> xr.DataArray:
    """Apply a function to each line of values along a dimension."""
    return xr.apply_ufunc(
        function, values, input_core_dims=[[dimension]], vectorize=True
    )


def less_mirrored(values: xr.DataArray, sign: float = 1.0) -> xr.DataArray:
    """Return values over the orientation less `sign` times those at 180° less it, where
    both are there: zero for what is symmetric, with `sign` -1 for what is
    antisymmetric."""
    there = values.orientation_deg.values
    kept = there[np.isin(180.0 - there, there)]
    mirrored = values.sel(orientation_deg=180.0 - kept)
    return values.sel(orientation_deg=kept) - sign * mirrored.assign_coords(
        orientation_deg=kept
    )


def asymmetry(values: xr.DataArray, sign: float = 1.0) -> xr.DataArray:
    """Compute the largest of `less_mirrored`, as a part of the largest value."""
    apart = abs(less_mirrored(values, sign)).max("orientation_deg")
    return apart / abs(values).max("orientation_deg")


# --- What is read off trajectories down the slope.


def _firsts(trajectory: np.ndarray) -> np.ndarray:
    """Find the index of the first row of each trajectory; every one has some."""
    return np.unique(trajectory, return_index=True)[1]


def _first(runs: Runs, name: str) -> np.ndarray:
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


def bounces(runs: Runs, flights: Jumps) -> dict[str, np.ndarray]:
    """Flights between the first impact of each trajectory and its first rolling: how
    many, the largest and the middle one of their rises [m], 0 for none, and whether the
    block rolls then."""
    rolling = np.flatnonzero(runs.pieces.motion == MotionMode.rolling)
    rollers = runs.pieces.trajectory[rolling].astype(int)
    count, highest, middle, rolls = np.zeros((4, runs.release.count))
    for block in range(runs.release.count):
        after = np.flatnonzero(flights.trajectory == block)[1:]
        until = np.min(rolling[rollers == block], initial=len(runs.pieces.motion))
        rolls[block] = until < len(runs.pieces.motion)
        after = after[flights.piece[after] < until]
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

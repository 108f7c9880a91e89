"""Datasets that claims are judged by, computed as they are asked for, and what is read
off them: one axis alone, the difference to mirrored orientations."""

import concurrent.futures
import itertools
from collections.abc import Mapping

import numpy as np
import xarray as xr

from ..accuracy import DEFAULT_ACCURACY, get_accuracy
from ..backend.derivative_rules import solve_recorded
from ..backend.threads import thread_count
from ..batch import simulate_batch
from ..impact.termination import Outcome
from ..progress import Progress, ProgressFunction, as_progress
from ..scene import Scene
from ..scene_quantities import scene_of_values, scene_values
from ..sweeping import Axes, sweep
from .criteria import NotComputed
from .readings import AS_IT_IS, Reading, with_contact_at
from .sets import PARAMETRIC_SETS, TABLE_1, parametric_set
from .slope_data import slope_dataset

Datasets = Mapping[str, xr.Dataset]
"""Datasets by name: the parametric sets on one ground, `courses`, the random impacts
(`RANDOM_SETS`), and the slope run-out, `SLOPE`."""

ACCURACY = DEFAULT_ACCURACY
SERIES = "courses"
SLOPE = "slope"
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


class Study(Datasets):
    """Datasets of one ground under one reading of the model, each computed once.

    A set with an impact that failed raises NotComputed; random impacts that failed are
    NaN.
    """

    def __init__(
        self,
        ground: str = TABLE_1,
        reading: Reading = AS_IT_IS,
        progress: Progress | ProgressFunction | None = None,
    ):
        self.ground, self.reading = ground, reading
        self.progress = as_progress(progress)
        self._known: dict[str, xr.Dataset] = {}
        self._others: dict[str, Study] = {ground: self}

    def on(self, ground: str) -> "Study":
        """The same on another ground."""
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

    def __iter__(self):
        return iter((*PARAMETRIC_SETS, SERIES, *RANDOM_SETS, SLOPE))

    def __len__(self):
        return len(list(iter(self)))

    def _compute(self, name: str) -> xr.Dataset:
        if name == SERIES:
            return self._time_series()
        if name in RANDOM_SETS:
            return self._random(name)
        if name == SLOPE:
            base, _ = self._parametric_set("I")
            reading = self.reading
            return slope_dataset(base.soil, reading.slope, ACCURACY)
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
        result = simulate_batch(
            scene_of_values(values),
            accuracy=ACCURACY,
            ledger=True,
        )
        ledger = result.energy
        assert ledger is not None  # asked for above
        names = np.array([str(outcome) for outcome in Outcome])
        variables = {
            "e_bar": result.e_bar,
            "gravity_share": ledger.gravity / ledger.kinetic_in,
            "outcome": names[np.asarray(result.outcome_code).astype(int)],
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
        values = scene_values(base) | {"orientation_deg": 0.0}

        def record(point):
            scene = scene_of_values(values | dict(zip(grid, point, strict=True)))
            return solve_recorded(scene, get_accuracy(ACCURACY))[1]

        first, *rest = itertools.product(*grid.values())
        # What the first compiles the others share.
        histories = [record(first)]
        with concurrent.futures.ThreadPoolExecutor(thread_count()) as pool:
            histories += pool.map(record, rest)
        longest = max(len(history.time) for history in histories)
        shape = *map(len, grid.values()), longest

        def padded(name: str) -> np.ndarray:
            series = [getattr(history, name) for history in histories]
            if not all(np.all(np.isfinite(row)) for row in series):
                raise NotComputed("the course of an impact of set III failed")
            rows = [np.pad(row, (0, longest - len(row)), "edge") for row in series]
            return np.reshape(rows, shape)

        dimensions = (*grid, "step")
        return xr.Dataset(
            {
                "time_s": (dimensions, padded("time")),
                "rotation_rad": (dimensions, padded("rotation")),
                "R_r": (dimensions, padded("rotational_ratio")),
            },
            grid,
        )


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


def along_major_axis(sets: Datasets) -> xr.Dataset:
    """Set III along the major axis: over the angle and A_r."""
    return sets["III"].sel(orientation_deg=0.0, drop=True)


def along_minor_axis(sets: Datasets) -> xr.Dataset:
    """Set III along the minor axis: over the angle and A_r."""
    return sets["III"].sel(orientation_deg=90.0, drop=True)


def along_dimension(function, values: xr.DataArray, dimension: str) -> xr.DataArray:
    """A function of each line of values along a dimension."""
    return xr.apply_ufunc(
        function, values, input_core_dims=[[dimension]], vectorize=True
    )


def less_mirrored(values: xr.DataArray, sign: float = 1.0) -> xr.DataArray:
    """Values over the orientation less `sign` times those at 180° less it, where both
    are there: zero for what is symmetric, with `sign` -1 for what is antisymmetric."""
    there = values.orientation_deg.values
    kept = there[np.isin(180.0 - there, there)]
    mirrored = values.sel(orientation_deg=180.0 - kept)
    return values.sel(orientation_deg=kept) - sign * mirrored.assign_coords(
        orientation_deg=kept
    )


def asymmetry(values: xr.DataArray, sign: float = 1.0) -> xr.DataArray:
    """The largest of `less_mirrored`, as a part of the largest value."""
    apart = abs(less_mirrored(values, sign)).max("orientation_deg")
    return apart / abs(values).max("orientation_deg")

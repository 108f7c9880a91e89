"""The paper's impacts and run-outs on one ground, under one reading of the model."""

import concurrent.futures
import functools
import itertools
from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from jaximpact import simulate, simulate_batch, sweep
from jaximpact.accuracy import DEFAULT_ACCURACY, Accuracy
from jaximpact.impact.results import History
from jaximpact.parametric_sets import TABLE_1, check_ground, parametric_set
from jaximpact.runout import Ending, FullModel, Runs, simulate_runout
from jaximpact.scene import Scene
from jaximpact.scene_quantities import scene_of_values, scene_values, scene_with
from jaximpact.sweeping import Axes

from .biplanar import run_numbers
from .criteria import NotComputed
from .readings import AS_IT_IS, Reading, with_contact_at

SERIES, SLOPE = "time series", "slope"
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


class Study:
    """The paper's impacts and run-outs, each computed once.

    Datasets have names, as in `study["III"]`: the parametric sets, `SERIES`, the random
    impacts (`RANDOM_SETS`), and the slope run-out, `SLOPE`. A set with an impact that
    failed raises NotComputed; random impacts that failed are NaN.

    Raises InputError for an unknown ground.
    """

    def __init__(
        self,
        ground: str = TABLE_1,
        reading: Reading = AS_IT_IS,
        accuracy: str | Accuracy = DEFAULT_ACCURACY,
    ):
        check_ground(ground)
        self.ground, self.reading, self.accuracy = ground, reading, accuracy
        self._known: dict[str, xr.Dataset] = {}
        self._by_ground: dict[str, Study] = {ground: self}

    def on(self, ground: str) -> "Study":
        """Return the same study on another ground."""
        if ground not in self._by_ground:
            other = Study(ground, self.reading, self.accuracy)
            other._by_ground = self._by_ground
            self._by_ground[ground] = other
        return self._by_ground[ground]

    def parametric_set(self, name: str) -> tuple[Scene, Axes]:
        """Base and axes of a set on this ground, as the reading has it."""
        base, axes = parametric_set(name, self.ground)
        if self.reading.values:
            base = scene_of_values(scene_values(base) | dict(self.reading.values))
        return base, axes

    @functools.cached_property
    def runs(self) -> Runs:
        """The slope run-out on two planes."""
        reading, soil = self.reading.slope, self.parametric_set("I")[0].soil
        return simulate_runout(
            reading.case.profile(soil),
            reading.case.release(),
            FullModel(self.accuracy),
            hop_threshold=reading.hop_threshold,
        )

    def record(
        self, name: str, points: Sequence[Mapping[str, float]]
    ) -> list[tuple[str, History]]:
        """Return the outcome and the history of impacts.

        Args:
            name: of the parametric set.
            points: what differs from its base, quantities in the units of their
                columns.
        """
        base, _ = self.parametric_set(name)

        def record(point: Mapping[str, float]) -> tuple[str, History]:
            scene = scene_with(base, point)
            result = simulate(scene, accuracy=self.accuracy, history=True)
            assert result.history is not None  # asked for above
            return str(result.outcome), result.history

        first = record(points[0])  # compiles what all use
        with concurrent.futures.ThreadPoolExecutor() as pool:
            return [first, *pool.map(record, points[1:])]

    def __getitem__(self, name: str) -> xr.Dataset:
        if name not in self._known:
            self._known[name] = self._compute(name)
        return self._known[name]

    def _compute(self, name: str) -> xr.Dataset:
        if name == SERIES:
            return self._time_series()
        if name == SLOPE:
            return self._slope()
        if name in RANDOM_SETS:
            return self._random(name)
        base, axes = self.parametric_set(name)
        dataset = sweep(base, axes, accuracy=self.accuracy)
        failed = int((dataset.outcome == "failed").sum())
        if failed:
            raise NotComputed(
                f"{failed} of {dataset.outcome.size} impacts of set {name} failed"
            )
        if name == "fig13":
            dataset = with_contact_at(dataset, base, self.reading.contact)
        return dataset

    def _random(self, name: str) -> xr.Dataset:
        """Energetic coefficient, outcome and gravity's work over the incoming energy
        of random impacts."""
        base, _ = self.parametric_set("I")
        scenes = scene_of_values(scene_values(base) | random_quantities(name))
        result = simulate_batch(scenes, accuracy=self.accuracy, ledger=True)
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
        _, axes = self.parametric_set("III")
        grid = {
            "angle_deg": SERIES_ANGLES_DEG,
            "aspect_ratio": np.asarray(axes["aspect_ratio"]),
        }
        points = [
            {"orientation_deg": 0.0, **dict(zip(grid, point, strict=True))}
            for point in itertools.product(*grid.values())
        ]
        histories = [history for _, history in self.record("III", points)]
        longest = max(len(history.time) for history in histories)
        shape = *map(len, grid.values()), longest

        def padded(name: str) -> np.ndarray:
            series = [getattr(history, name) for history in histories]
            if not all(np.all(np.isfinite(row)) for row in series):
                raise NotComputed("a time series of set III failed")
            rows = [np.pad(row, (0, longest - len(row)), "edge") for row in series]
            return np.reshape(rows, shape)

        fields = {"rotation_rad": "rotation", "R_r": "rotational_ratio"}
        series = {name: ((*grid, "step"), padded(of)) for name, of in fields.items()}
        return xr.Dataset(series, grid)

    def _slope(self) -> xr.Dataset:
        whole = np.isin(self.runs.ending, [Ending.stopped, Ending.left_profile])
        if not np.all(whole):
            raise NotComputed(
                f"{np.sum(~whole)} of {len(whole)} runs failed or came to a limit"
            )
        reading = self.reading.slope
        return run_numbers(
            self.runs,
            released_flight_jumps=reading.released_flight_jumps,
            out_of_the_crater=reading.out_of_the_crater,
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

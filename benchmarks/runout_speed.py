"""Trajectories per second beside PyRockfall, on one core, in one run.

    python -m benchmarks.runout_speed [BLOCKS]

Spheres of 100 kg down the paper's slope of two planes, with 20 m/s and coefficients of
restitution that differ from block to block. Both take the same numbers; what they model
is not the same: PyRockfall's blocks are points that slide in time steps of 0.01 s where
they bounce no more, ours are spheres that roll, by an equation. So roughly the same
is PyRockfall's friction angle and our angle of rolling friction.

It needs `pip install pyrockfall`, whose dependencies have 4 GB; on its slopes in the
plane it imports scikit-learn and plyfile of these.
"""

import importlib
import os
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

os.environ["OMP_NUM_THREADS"] = "1"
ANGLE = 20.0
"""Angle of friction [deg]."""
POINTS = np.array([[0.0, 230.0], [400.0, 0.0], [1000.0, 0.0]])
SPEED = np.array([19.7, -3.5])
REPEATS = 3


def ours(blocks: int) -> tuple[dict[str, float], dict[str, np.ndarray]]:
    """Give trajectories per second, and x where blocks stopped [m], by contact law."""
    import jax

    jax.config.update("jax_enable_x64", True)
    from jaximpact import Block
    from jaximpact.rebound import ConstantCoefficients
    from jaximpact.runout import (
        ClosedForm,
        FullModel,
        Profile,
        Release,
        simulate_runout,
    )

    random = np.random.default_rng(0)
    e_n, e_t = random.normal([[0.35], [0.85]], 0.04, (2, blocks))
    profile = Profile(*POINTS.T, rolling_friction_angle=np.radians(ANGLE))
    block = Block(mass=np.full(blocks, 100.0))
    release = Release(block, 2.0, 231.5, *SPEED)
    speeds, stops = {}, {}
    for name, contacts in (
        ("constant coefficients", ClosedForm(ConstantCoefficients(e_n, e_t))),
        ("full model", FullModel()),
    ):
        seconds, runs = _best(lambda c=contacts: simulate_runout(profile, release, c))
        speeds[name], stops[name] = blocks / seconds, runs.x
    return speeds, stops


def pyrockfall(blocks: int) -> tuple[float, np.ndarray]:
    """Give trajectories per second, and x where blocks stopped [m]."""
    package: Any = importlib.import_module("pyrockfall")
    stats = package.stats
    material = package.Material(
        name="ground",
        normalRestitution=stats.Normal(0.35, 0.04),
        tangentialRestitution=stats.Normal(0.85, 0.04),
        frictionAngle=ANGLE,
        roughness=0.0,
    )

    def run():
        analysis = package.Analysis()
        analysis.slope = package.Slope(package.Geometry(POINTS), materials=material)
        rock = package.Rock(name="block", mass=100.0, density=2577.8)
        seeder = package.Seeder(np.array([2.0, 231.5]), rocks=[rock])
        seeder.numberOfRocks = blocks
        seeder.translationalVelocity = SPEED.tolist()
        analysis.seeders = [seeder]
        # Its 1000 iterations would end most blocks before they stop.
        analysis.maxIter = 100_000
        analysis.run()
        return analysis.trajectories

    seconds, found = _best(run)
    return blocks / seconds, found.position(found.stopTime)[0].ravel()


def _best(run: Callable) -> tuple[float, Any]:
    """Give the least processor time of some runs, after one that compiles, and the
    last result."""
    run()
    found, seconds = None, []
    for _ in range(REPEATS):
        begin = time.process_time()
        found = run()
        seconds.append(time.process_time() - begin)
    return min(seconds), found


def main() -> None:
    """Measure both, and print a line for each."""
    blocks = int(sys.argv[1]) if len(sys.argv) > 1 else 2000
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    speeds, stops = ours(blocks)
    try:
        speeds["PyRockfall"], stops["PyRockfall"] = pyrockfall(blocks)
    except ImportError as error:
        print(f"without PyRockfall: {error}")
    for name, speed in speeds.items():
        median, far = np.nanpercentile(stops[name], [50, 95])
        print(f"{name}: {speed:.3g} trajectories/s; x {median:.0f} m, 95 % {far:.0f} m")


if __name__ == "__main__":
    main()

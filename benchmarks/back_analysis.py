"""Coverage of back-analyses: twins of three slopes, whose ground is known.

    python -m benchmarks.back_analysis DIR [REPEATS [SLOPE ...]]
        [--workers N | --scheduler ADDRESS]

In each repeat blocks are released on the true ground, observed, and fitted anew;
counted is how often each parameter lies in its stated interval. Data sets are kept in
DIR, and results in DIR/coverage.csv, from where the same command goes on. Printed at
last is a table of the coverage; with 0 repeats that of what is there.
"""

import os

os.environ["JAX_ENABLE_X64"] = "1"

import argparse
import csv
import dataclasses
import itertools
import time
from concurrent.futures import Executor
from pathlib import Path

import numpy as np
import pandas as pd

from jaximpact.cli import options
from jaximpact.progress import Progress
from jaximpact.runout.back_analysis.data_sets import simulate_data_sets
from jaximpact.runout.back_analysis.observed import Count, Passages, Stops
from jaximpact.runout.back_analysis.posterior import posterior_of, search
from jaximpact.runout.back_analysis.problem import SlopeFit, read_slope_fit
from jaximpact.store import Store

SCREE = """
[profile]
points_m = [[0, 120], [60, 60], [120, 20], [300, 0]]

[ground.materials.scree]
from_x_m = 0
to_x_m = 120

[ground.materials.meadow]
from_x_m = 120
to_x_m = 300

[block]
mass_kg = { median = 500, geometric_sd = 1.8 }

[release]
x_m = { from = 2, to = 10 }
clearance_m = 1
speed_mps = 1

[contacts]
law = "constant coefficients"
e_n = 0.35
e_t = 0.85

[fit]
data_sets = 500

[fit.materials.scree]
rolling_friction_angle_deg = { from = 10, to = 45 }
roughness_deg = { from = 0, to = 10 }

[fit.materials.meadow]
rolling_friction_angle_deg = { from = 10, to = 45 }

[observed]
counts = [{ x_m = 110, passed = 1, of = 40 }]
"""
BENCHES = """
[profile]
points_m = [[0, 90], [30, 55], [42, 54], [70, 25], [82, 24.5], [110, 3], [260, 0]]

[ground]
rolling_friction_angle_deg = 25

[block]
shape = "RectangularPrism"
mass_kg = { median = 300, geometric_sd = 2, least = 20 }
aspect_ratio = { from = 1, to = 1.6 }

[release]
along_x_m = [1, 8]
clearance_m = 0.5
speed_mps = 1

[contacts]
law = "Pfeiffer and Bowen"
normal_coefficient = 0.35
tangential_coefficient = 0.85

[fit]
data_sets = 400
roughness_deg = { from = 0, to = 12 }

[fit.segment.6]
rolling_friction_angle_deg = { median = 25, geometric_sd = 1.4, least = 10, most = 60 }

[observed]
counts = [{ x_m = 76, passed = 1, of = 30 }, { x_m = 112, passed = 1, of = 30 }]
"""
SOIL = """
[profile]
points_m = [[0, 60], [90, 5], [250, 0]]

[ground]
roughness_deg = 2

[block]
mass_kg = { mean = 200, sd = 60, least = 40 }
aspect_ratio = 1.5

[release]
x_m = 2
clearance_m = 2
speed_mps = 4
direction_deg = { from = 0, to = 20 }
orientation_deg = { from = 0, to = 180 }

[fit]
data_sets = 300
gamma_v = { median = 5, geometric_sd = 2, least = 0.5, most = 50 }
rolling_friction_angle_deg = { from = 10, to = 40 }

[observed]
counts = [{ x_m = 88, passed = 1, of = 20 }]
"""
SLOPES = {
    "scree and meadow": (SCREE, 40, ("speed_mps",), 20, (0.5, 0.4, 0.45)),
    "benches": (BENCHES, 30, ("energy_kJ", "height_m"), 15, (0.45, 0.5)),
    "full model": (SOIL, 20, ("speed_mps", "height_m"), 20, (0.45, 0.4)),
}
"""Study, blocks released, quantities at the collectors, blocks measured there, and true
parameters as probabilities under the priors."""
TRUTH_STREAM = 1000
COLUMNS = ("slope", "repeat", "parameter", "low", "median", "high", "true", "in_68")


def observe(fit: SlopeFit, blocks: np.ndarray, quantities, most: int) -> SlopeFit:
    """Observe a data set: all stopping points, values at the first line of the counts,
    and the counts themselves."""
    stops = blocks[np.isfinite(blocks[:, 0]), 0]
    channels: list = [Stops(stops)] if len(stops) else []
    columns = {"speed_mps": 1, "height_m": 2, "energy_kJ": 3}
    lines = [c for c in fit.observed.channels if isinstance(c, Count)]
    for quantity in quantities:
        values = blocks[:, columns[quantity] + 3 * fit.places.index(lines[0].place)]
        values = values[np.isfinite(values)][:most]
        if len(values):
            channels.append(Passages(lines[0].place, quantity, values, False))
    for line in lines:
        passing = blocks[:, 1 + 3 * fit.places.index(line.place)]
        passed = int(np.sum(np.isfinite(passing)))
        channels.append(Count(line.place, passed, len(blocks)))
    observed = fit.observed._replace(channels=tuple(channels))
    return dataclasses.replace(fit, observed=observed)


def main() -> None:
    """Repeat what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, metavar="DIR")
    parser.add_argument("repeats", type=int, nargs="?", default=100)
    parser.add_argument("names", nargs="*", metavar="SLOPE", default=[*SLOPES])
    options.add_engine(parser)
    arguments = parser.parse_args()
    with options.engine_of(arguments) as executor:
        repeat_twins(arguments.folder, arguments.repeats, arguments.names, executor)


def repeat_twins(
    folder: Path, repeats: int, names: list[str], executor: Executor | None
) -> None:
    """Repeat the twins of each slope; an executor computes their data sets."""
    folder.mkdir(parents=True, exist_ok=True)
    results = folder / "coverage.csv"
    if not results.exists():
        results.write_text(",".join(COLUMNS) + "\n")
    with open(results) as file:
        done = {(row["slope"], int(row["repeat"])) for row in csv.DictReader(file)}
    twins = {name: _make_twins(folder, name, repeats) for name in names if repeats}
    store = Store(folder)
    # In turn, so that all slopes are as far when it is cut short.
    for repeat, name in itertools.product(range(repeats), names):
        if (name, repeat) in done:
            continue
        begin, (fit, blocks) = time.process_time(), twins[name]
        _, _, quantities, most, truth = SLOPES[name]
        true = fit.values(np.array(truth))
        twin = observe(fit, blocks[repeat], quantities, most)
        found = posterior_of(twin, search(twin, store, Progress(), executor))
        inside = np.abs(np.mean(found.values < true, axis=0) - 0.5) < 0.34
        with open(results, "a") as file:
            for i, p in enumerate(found.fitted):
                cells = (name, repeat, p.parameter.name, p.low, p.median, p.high)
                print(*cells, true[i], int(inside[i]), sep=",", file=file)
        seconds = time.process_time() - begin
        print(name, repeat, f"{seconds:.0f} s of processor time", flush=True)
    print(table_of(results))


def table_of(results: Path) -> str:
    """Write how often the true parameters lie in their intervals, as Markdown."""
    found = pd.read_csv(results)
    found["in_95"] = (found.low <= found.true) & (found.true <= found.high)
    found["width"] = found.high - found.low
    lines = [
        "| slope | parameter | true | width of the 95 % interval, median | repeats "
        "| in the 68 % interval | in the 95 % interval |",
        "|---|---|---|---|---|---|---|",
    ]
    for (slope, parameter), rows in found.groupby(["slope", "parameter"], sort=False):
        cells = (
            *(slope, f"`{parameter}`", f"{rows.true.iloc[0]:.3g}"),
            *(f"{rows.width.median():.2g}", len(rows)),
            *(f"{rows.in_68.mean():.0%}", f"{rows.in_95.mean():.0%}"),
        )
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(lines)


def _make_twins(folder: Path, name: str, repeats: int) -> tuple[SlopeFit, np.ndarray]:
    """Read a slope, and release blocks on its true ground as often as asked."""
    text, released, _, _, truth = SLOPES[name]
    path = folder / f"{name.replace(' ', '-')}.toml"
    path.write_text(text)
    fit = read_slope_fit(path)
    u = np.tile(truth, (repeats, 1))
    blocks = simulate_data_sets(fit, u, released, TRUTH_STREAM, Store(folder))
    return fit, blocks


if __name__ == "__main__":
    main()

"""Coverage of back-analyses: twins of three slopes, whose ground is known.

    python -m benchmarks.back_analysis DIR [REPEATS [SLOPE ...]] [--from-priors]
        [--workers N | --scheduler ADDRESS]

In each repeat blocks are released on the true ground, observed, and fitted anew;
counted is how often each parameter, and each number at a barrier, lies in its stated
interval. The true ground is the same in all repeats, or one more sample of the priors
in each. Data sets are kept in DIR, and results in DIR/coverage.csv and
DIR/barriers.csv, or DIR/coverage-from-priors.csv and DIR/barriers-from-priors.csv, from
where the same command goes on. Printed at last are tables of the coverage; with 0
repeats those of what is there.
"""

import os

os.environ["JAX_ENABLE_X64"] = "1"

import argparse
import csv
import dataclasses
import itertools
import time
from pathlib import Path

import numpy as np
import pandas as pd

from jaximpact.cli import options
from jaximpact.runout.back_analysis.data_sets import column_of, simulate_data_sets
from jaximpact.runout.back_analysis.observed import (
    PASSAGE_COLUMNS,
    STOP_COLUMN,
    ObservedCount,
    ObservedValues,
)
from jaximpact.runout.back_analysis.posterior import Posterior, posterior_of, search
from jaximpact.runout.back_analysis.predictive import at_barrier, predict
from jaximpact.runout.back_analysis.problem import SlopeFit, read_slope_fit
from jaximpact.store import Store
from jaximpact.tasks import computing

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

[[barriers]]
name = "fence"
x_m = 140
height_m = 1
capacity_kJ = 80

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
kinematics = "DeepestPoint"
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
TRUTH_STREAM, TRUE_BARRIER_STREAM = 1000, 1001
TRUE_BLOCKS = 100_000
"""Number of blocks on the true ground that tell the true numbers at a barrier."""
COLUMNS = (
    *("slope", "repeat", "parameter", "low", "median", "high", "true", "in_68"),
    "sd",
)
BARRIER_COLUMNS = (
    *("slope", "repeat", "barrier", "quantity", "low", "value", "high", "true"),
)


def observe(fit: SlopeFit, blocks: np.ndarray, quantities, most: int) -> SlopeFit:
    """Observe a data set: all stopping points, values at the first line of the counts,
    and the counts themselves."""
    stops = blocks[np.isfinite(blocks[:, 0]), 0]
    channels: list = []
    if len(stops):
        channels.append(ObservedValues(STOP_COLUMN, None, stops))
    lines = [c for c in fit.observed.channels if isinstance(c, ObservedCount)]
    for quantity in quantities:
        values = blocks[:, column_of(fit.places, lines[0].place, quantity)]
        values = values[np.isfinite(values)][:most]
        if len(values):
            channels.append(ObservedValues(quantity, lines[0].place, values))
    for line in lines:
        passing = blocks[:, column_of(fit.places, line.place, PASSAGE_COLUMNS[0])]
        passed = int(np.sum(np.isfinite(passing)))
        channels.append(ObservedCount(line.place, passed, len(blocks)))
    observed = fit.observed._replace(channels=tuple(channels))
    return dataclasses.replace(fit, observed=observed)


def main() -> None:
    """Repeat what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, metavar="DIR")
    parser.add_argument("repeats", type=int, nargs="?", default=100)
    parser.add_argument("names", nargs="*", metavar="SLOPE", default=[*SLOPES])
    parser.add_argument(
        "--from-priors",
        action="store_true",
        help="sample the true ground of each repeat from the priors",
    )
    options.add_engine(parser)
    arguments = parser.parse_args()
    with options.engine_of(arguments) as executor, computing(executor=executor):
        repeat_twins(
            *(arguments.folder, arguments.repeats, arguments.names),
            arguments.from_priors,
        )


def repeat_twins(
    folder: Path,
    repeats: int,
    names: list[str],
    from_priors: bool,
) -> None:
    """Repeat the twins of each slope."""
    folder.mkdir(parents=True, exist_ok=True)
    of = "-from-priors" if from_priors else ""
    results, barriers = folder / f"coverage{of}.csv", folder / f"barriers{of}.csv"
    for path, columns in ((results, COLUMNS), (barriers, BARRIER_COLUMNS)):
        if not path.exists():
            path.write_text(",".join(columns) + "\n")
    with open(results) as file:
        done = {(row["slope"], int(row["repeat"])) for row in csv.DictReader(file)}
    twins = {
        name: _make_twins(folder, name, repeats, from_priors)
        for name in names
        if repeats
    }
    store = Store(folder)
    # In turn, so that all slopes are as far when it is cut short.
    for repeat, name in itertools.product(range(repeats), names):
        if (name, repeat) in done:
            continue
        begin, (fit, truths, blocks) = time.process_time(), twins[name]
        _, _, quantities, most, _ = SLOPES[name]
        twin = observe(fit, blocks[repeat], quantities, most)
        found = posterior_of(twin, search(twin, store))
        u = truths[repeat]
        _append(barriers, _rows_of_barriers(twin, found, u, name, repeat))
        true = fit.values(u)
        inside = np.abs(np.mean(found.values < true, axis=0) - 0.5) < 0.34
        sd = np.std(found.values, axis=0)
        _append(
            results,
            [
                (
                    *(name, repeat, p.parameter.name, p.low, p.median, p.high),
                    *(true[i], int(inside[i]), sd[i]),
                )
                for i, p in enumerate(found.fitted)
            ],
        )
        seconds = time.process_time() - begin
        print(name, repeat, f"{seconds:.0f} s of processor time", flush=True)
    print(table_of(results, from_priors), table_of_barriers(barriers), sep="\n\n")


def _append(path: Path, rows: list[tuple]) -> None:
    with open(path, "a") as file:
        for row in rows:
            print(*row, sep=",", file=file)


def _rows_of_barriers(
    fit: SlopeFit,
    found: Posterior,
    u: np.ndarray,
    name: str,
    repeat: int,
) -> list[tuple]:
    """Compare what a fit says of its barriers with the truth."""
    if not fit.barriers:
        return []
    predicted = predict(fit, found, None)
    outcomes = simulate_data_sets(fit, u[None], TRUE_BLOCKS, TRUE_BARRIER_STREAM)
    rows: list[tuple] = []
    for told in predicted.barriers:
        true = at_barrier(fit, outcomes, told.barrier).estimates
        rows += [
            (
                *(name, repeat, told.barrier.name, quantity),
                *(e.low, e.value, e.high, true[quantity].value),
            )
            for quantity, e in told.estimates.items()
        ]
    return rows


def table_of(results: Path, from_priors: bool = False) -> str:
    """Write how often the true parameters lie in their intervals, as Markdown.

    With one true ground for all repeats the posterior's standard deviation is compared
    with the standard deviation of the medians over the repeats.
    """
    found = pd.read_csv(results)
    found["in_95"] = (found.low <= found.true) & (found.true <= found.high)
    found["width"] = found.high - found.low
    lines = [
        "| slope | parameter | true | width of the 95 % interval, median | standard "
        "deviation over scatter | repeats | in the 68 % interval "
        "| in the 95 % interval |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for (slope, parameter), rows in found.groupby(["slope", "parameter"], sort=False):
        ratio = rows.sd.mean() / rows["median"].std()
        cells = (
            *(slope, f"`{parameter}`"),
            "of the prior" if from_priors else f"{rows.true.iloc[0]:.3g}",
            f"{rows.width.median():.2g}",
            "-" if from_priors else f"{ratio:.2f}",
            *(len(rows), f"{rows.in_68.mean():.0%}", f"{rows.in_95.mean():.0%}"),
        )
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(lines)


def table_of_barriers(results: Path) -> str:
    """Write how often the true numbers at barriers lie in their intervals, as Markdown.

    An interval without an end, for which too few blocks arrive, is left out.
    """
    found = pd.read_csv(results).dropna(subset=["low", "high", "true"])
    found["inside"] = (found.low <= found.true) & (found.true <= found.high)
    found["width"] = found.high - found.low
    lines = [
        "| slope | quantity | true, median | width of the 95 % interval, median "
        "| repeats | in the 95 % interval |",
        "|---|---|---|---|---|---|",
    ]
    for (slope, quantity), rows in found.groupby(["slope", "quantity"], sort=False):
        cells = (
            *(slope, f"`{quantity}`", f"{rows.true.median():.3g}"),
            *(f"{rows.width.median():.2g}", len(rows), f"{rows.inside.mean():.0%}"),
        )
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(lines)


def _make_twins(
    folder: Path, name: str, repeats: int, from_priors: bool
) -> tuple[SlopeFit, np.ndarray, np.ndarray]:
    """Read a slope, and release blocks on the true ground of each repeat.

    Returns:
        The fit; the true grounds as probabilities under the priors, `(repeats,
        parameters)`; and the blocks.
    """
    text, released, _, _, truth = SLOPES[name]
    path = folder / f"{name.replace(' ', '-')}.toml"
    path.write_text(text)
    fit = read_slope_fit(path)
    u = np.tile(truth, (repeats, 1))
    if from_priors:
        u = np.random.default_rng(TRUTH_STREAM).uniform(size=u.shape)
    blocks = simulate_data_sets(fit, u, released, TRUTH_STREAM, Store(folder))
    return fit, u, blocks


if __name__ == "__main__":
    main()

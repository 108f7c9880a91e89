"""The package's least squares beside SciPy's trust-region method, on one objective.

    python -m benchmarks.trust_region [--starts 16] [STUDY.toml ...]

Both fit from the same starts at the accuracy "reference" with the derivatives of the
machine code and end at the same tolerances. Ours fits all starts side by side, SciPy
(`scipy.optimize.least_squares`, method "trf", between the bounds) one after the other.
Processor times of one thread; without compilation.
"""

import argparse
import os
import time
from pathlib import Path

os.environ.setdefault("JAXIMPACT_THREADS", "1")

import jax
import numpy as np
from scipy.optimize import least_squares

jax.config.update("jax_enable_x64", True)

from jaximpact.calibration import read_study  # noqa: E402
from jaximpact.calibration.estimation.least_squares import FINE  # noqa: E402
from jaximpact.calibration.estimation.starts import fit  # noqa: E402
from jaximpact.calibration.problem.forward_model import models_of  # noqa: E402
from jaximpact.calibration.problem.objective import Objective  # noqa: E402
from jaximpact.calibration.study import starts_of  # noqa: E402

FOLDER = Path(__file__).parent.parent / "calibration"
STUDIES = ("wyllie/study.toml", "labiouse1996/study.toml", "twins/slow/noisy.toml")


def trust_region(objective: Objective, x: np.ndarray) -> float:
    """Fit one start by SciPy; return the cost at its end."""
    kept = {}

    def at(x):
        x = np.clip(x, objective.bounds.low, objective.bounds.high)
        if kept.get("x") is None or np.any(kept["x"] != x):
            kept.update(x=x.copy(), points=objective(x[None]))
        points = kept["points"]
        known = objective.study.known & np.isfinite(points.predicted[0])
        scale = np.sqrt(np.broadcast_to(objective.study.weights, known.shape))
        factor = np.where(known, scale / objective.sigma, 0.0)
        apart = np.where(known, points.predicted[0] - objective.study.measured, 0.0)
        rows = points.jacobian[0] * factor[..., None]
        return (apart * factor).ravel(), rows.reshape(-1, len(x))

    bounds = objective.bounds
    room = 1e-9 * (bounds.high - bounds.low)
    found = least_squares(
        lambda x: at(x)[0],
        np.clip(x, bounds.low + room, bounds.high - room),
        jac=lambda x: at(x)[1],
        bounds=(bounds.low, bounds.high),
        method="trf",
        max_nfev=FINE.steps,
    )
    return float(objective.values(found.x[None]).cost[0])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("studies", nargs="*", type=Path)
    parser.add_argument("--starts", type=int, default=16)
    arguments = parser.parse_args()
    print("study  starts  ours s, at the best  SciPy s, at the best  ratio")
    for path in arguments.studies or [FOLDER / name for name in STUDIES]:
        study = read_study(path)
        for variant in study.variants:
            objective = Objective(study, variant, models_of(study)[0])
            x = starts_of(objective)[: arguments.starts]
            objective(x[:1])  # compiles
            begin = time.process_time()
            ours = fit(objective, x, rule=FINE._replace(joins=True)).points.cost
            middle = time.process_time()
            theirs = np.array([trust_region(objective, one) for one in x])
            seconds = middle - begin, time.process_time() - middle
            least = min(np.min(ours), np.min(theirs))
            allowed = least + 1e-3 * (least + objective.unit(least))
            print(
                f"{path.parent.name}, {variant.name}  {len(x)}  "
                f"{seconds[0]:.1f} s, {np.sum(ours <= allowed)}  "
                f"{seconds[1]:.1f} s, {np.sum(theirs <= allowed)}  "
                f"{seconds[1] / seconds[0]:.2f}",
                flush=True,
            )


if __name__ == "__main__":
    main()

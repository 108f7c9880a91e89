"""How often intervals of 95 % cover the truth.

    python -m benchmarks.coverage [--repeats 200] [--starts 2] [--twin NAME]
        [--sigmas stated|estimated] [--workers N | --scheduler ADDRESS]

Targets of the twins (`calibration/twins`) get noise of 2 %, again and again, and are
fitted as `jaximpact calibrate` fits them, once with the sigmas stated and once with
sigmas estimated from the scatter. An interval is right if it covers the truth in 95 %
of the repeats, within the chance of so many repeats: 90 to 98 % of 200.
"""

import argparse
import dataclasses
import sys
import time
from pathlib import Path

import jax
import numpy as np

FOLDER = Path(__file__).parent.parent / "calibration" / "twins"


def main() -> None:
    jax.config.update("jax_enable_x64", True)
    sys.path.insert(0, str(FOLDER))
    import make

    from jaximpact.calibration.problem.config import read_study
    from jaximpact.calibration.problem.forward_model import models_of
    from jaximpact.calibration.problem.objective import Objective
    from jaximpact.cli import options
    from jaximpact.tasks import call_each, computing

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=200)
    parser.add_argument("--starts", type=int, default=2)
    parser.add_argument("--twin", choices=make.TWINS, help="one alone")
    parser.add_argument("--sigmas", choices=("stated", "estimated"), help="one alone")
    options.add_engine(parser)
    arguments = parser.parse_args()
    print("twin        sigmas     parameter  covered  median error  median interval")
    chosen = [arguments.twin] if arguments.twin else make.TWINS
    with options.engine_of(arguments) as executor, computing(executor=executor):
        for name in chosen:
            study = read_study(FOLDER / name / "study.toml")
            study = dataclasses.replace(study, starts=arguments.starts)
            model = models_of(study)[0]
            sigma = make.NOISE * np.where(study.known, np.abs(study.measured), 1.0)
            for stated in (True, False):
                if arguments.sigmas not in (None, "stated" if stated else "estimated"):
                    continue
                begin, rows = time.perf_counter(), {}
                known = dataclasses.replace(
                    study, sigma=sigma, sigma_given=np.full(len(study.targets), True)
                )
                studies = (
                    dataclasses.replace(
                        known if stated else study,
                        measured=make.noisy(study.measured, seed),
                    )
                    for seed in range(1, arguments.repeats + 1)
                )
                objectives = ((Objective(s, s.variants[0], model),) for s in studies)
                call_each(_repeat, objectives, rows.__setitem__)
                seconds = time.perf_counter() - begin
                in_order = [rows[place] for place in sorted(rows)]
                _print(name, make.TWINS[name], stated, in_order, seconds)


def _repeat(objective):
    """Fit and interval of one repeat, in x, and whether the fit is a minimum."""
    from jaximpact.calibration.diagnostics.uncertainty import estimate
    from jaximpact.calibration.study import best_fit

    objective, best, *_ = best_fit(objective)
    found = estimate(objective, best.points)
    x = best.points.x[0]
    return x, found.quantile * found.standard_errors, best.reasons[0].at_minimum


def _print(name, soil, stated, rows, seconds) -> None:
    x, reach = (np.array([row[place] for row in rows]) for place in (0, 1))
    good = np.array([row[2] for row in rows])
    true = np.log(list(soil.values()))
    covered = np.abs(x - true) <= reach
    for place, parameter in enumerate(soil):
        print(
            f"{name:11} {'stated' if stated else 'estimated':10} {parameter:10} "
            f"{100 * np.mean(covered[:, place]):5.1f} %  "
            f"{100 * np.median(np.abs(x - true)[:, place]):8.2f} %  "
            f"{100 * np.median(reach[:, place]):10.2f} %"
        )
    print(
        f"  {len(rows)} repeats in {seconds:.0f} s, {np.sum(~good)} of them not at a "
        "minimum"
    )


if __name__ == "__main__":
    # Workers look for functions in this module, not in the one that is run.
    from benchmarks import coverage

    coverage.main()

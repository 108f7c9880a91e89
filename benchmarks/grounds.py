"""Which ground law follows which campaign: fits of each to each.

    python -m benchmarks.grounds [--only golf ...]

c_v, gamma_v and k_E are fitted, and what is named beside the law. Errors are root mean
squares: of e_n absolute, of forces and depths relative to the measurement. Golf balls
are those of `e_n_against_speed`, the others the studies of `calibration/`.
"""

import argparse
from pathlib import Path
from typing import NamedTuple

import jax
import numpy as np

from .e_n_against_speed import measured_drops

CALIBRATION = Path(__file__).parents[1] / "calibration"
CAMPAIGNS = ("golf", "labiouse1996", "gerber2019", "katsuragi2007")


class Ground(NamedTuple):
    """A law, and what is fitted beside the usual parameters."""

    name: str
    laws: dict[str, str]
    more: tuple[str, ...] = ()


GROUNDS = (
    Ground("default", {}),
    Ground("modulus at the contact pressure", {"elasticity": "ContactPressureModulus"}),
    Ground("no surcharge", {"bearing": "VesicWithoutSurcharge"}),
    Ground("inertia", {"bearing": "VesicWithInertia"}),
    Ground("cohesion", {}, ("cohesion_kPa",)),
    Ground("cohesion, inertia", {"bearing": "VesicWithInertia"}, ("cohesion_kPa",)),
    Ground(
        "cohesion, modulus at the contact pressure",
        {"elasticity": "ContactPressureModulus"},
        ("cohesion_kPa",),
    ),
)


def main() -> None:
    jax.config.update("jax_enable_x64", True)
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=CAMPAIGNS, default=CAMPAIGNS)
    for campaign in parser.parse_args().only:
        for ground in GROUNDS:
            print(f"{campaign}, {ground.name}: {errors(campaign, ground)}", flush=True)


def errors(campaign: str, ground: Ground) -> str:
    """Fit a ground to a campaign, and say how far it is from each target."""
    from jaximpact.calibration.estimation.search import fit_places
    from jaximpact.calibration.problem.forward_model import models_of
    from jaximpact.calibration.problem.objective import Objective

    study = study_of_campaign(campaign, ground)
    objective = Objective(study, study.variants[0], models_of(study)[0])
    ends, _ = fit_places(objective)
    best = ends.points.take([ends.best])
    words = []
    for place, target in enumerate(study.targets):
        measured = study.measured[:, place]
        error = np.asarray(best.predicted)[0, :, place] - measured
        size = 1.0 if target.startswith("e_") else measured
        words.append(f"{target} {np.sqrt(np.nanmean((error / size) ** 2)):.4f}")
    values = objective.bounds.parameter(best.x[0])
    names = [parameter.name for parameter in study.parameters]
    fitted = (f"{n} {v:.3g}" for n, v in zip(names, values, strict=True))
    return f"{', '.join(words)} ({', '.join(fitted)})"


def study_of_campaign(campaign: str, ground: Ground):
    """Make the study of a campaign, on a ground."""
    from jaximpact.calibration.arguments import study_given
    from jaximpact.calibration.problem.config import read_study

    tests, soil = measured_drops(), {}
    if campaign != "golf":
        tests = CALIBRATION / campaign / "tests.csv"
        soil = read_study(CALIBRATION / campaign / "study.toml").soil
    fit = "c_v", "gamma_v", "k_E", *ground.more
    return study_given(tests, fit, soil | ground.laws)


if __name__ == "__main__":
    main()

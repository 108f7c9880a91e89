"""Whether the comparison of laws finds the law that made the measurements.

    python -m benchmarks.laws_compared [--repeats 10] [--first 0] [--tests 30]
        [--starts 16] [--truth NAME]

Six laws each make campaigns of impacts of ellipsoids (50 to 500 kg, aspect ratio 1.5,
any orientation, 5 to 70 degrees, 3 to 20 m/s), e_n and e_t with noise of 0.03.
Parameters of the truth differ from campaign to campaign by a factor of up to 1.3. All
six are fitted to each campaign, sigmas estimated, and compared by single tests. Told
are, of each truth, how often it was best alone, how often it was preferred in a tie,
how often it tied with another that was preferred, and how often another was called
better.
"""

import argparse
import time

import jax
import numpy as np

NOISE = 0.03
TRUTHS = {
    "model": {"c_v": 1.0, "gamma_v": 8.7, "k_E": 900.0},
    "ContactPressureModulus": {"c_v": 1.0, "gamma_v": 8.7, "k_E": 900.0},
    "constant coefficients": {"e_n": 0.35, "e_t": 0.75},
    "Pfeiffer and Bowen": {"normal_coefficient": 0.4, "tangential_coefficient": 0.75},
    "power law in the angle": {"e_45": 0.35, "angle_exponent": 0.6, "e_t": 0.75},
    "rigid ellipsoid": {"e_contact": 0.4},
}
TARGETS = "e_n", "e_t"


def main() -> None:
    jax.config.update("jax_enable_x64", True)
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=10)
    parser.add_argument("--first", type=int, default=0, help="seed")
    parser.add_argument("--tests", type=int, default=30)
    parser.add_argument("--starts", type=int, default=16)
    parser.add_argument("--truth", choices=(*TRUTHS,), action="append")
    arguments = parser.parse_args()
    for truth in arguments.truth or TRUTHS:
        begin, counts, others = time.process_time(), dict.fromkeys(WORDS, 0), []
        for seed in range(arguments.first, arguments.first + arguments.repeats):
            kind, ties = _compared(truth, seed, arguments.tests, arguments.starts)
            counts[kind] += 1
            others.append(ties)
            print(f"  {truth}, {seed}: {kind}; {', '.join(ties)}", flush=True)
        told = ", ".join(f"{kind} {count}" for kind, count in counts.items())
        seconds = time.process_time() - begin
        print(f"{truth}: {told}; {seconds:.0f} s of processor time", flush=True)


WORDS = "best alone", "preferred in a tie", "in a tie", "another called better"


def _compared(truth: str, seed: int, tests: int, starts: int):
    """Compare the laws on one campaign of a truth."""
    import dataclasses

    from jaximpact.calibration.arguments import study_given
    from jaximpact.calibration.compare_laws import Comparison
    from jaximpact.calibration.comparison.comparison import compare_study

    columns = _campaign(truth, np.random.default_rng((seed, *truth.encode())), tests)
    study = study_given(columns)
    study = dataclasses.replace(study, starts=starts)
    found = Comparison(compare_study(study, list(TRUTHS)))
    name = next(law for law in found.laws if truth in law)
    if name not in found.ties:
        return WORDS[3], found.ties
    if found.preferred != name:
        return WORDS[2], found.ties
    return WORDS[0 if found.ties == (name,) else 1], found.ties


def _campaign(truth: str, random: np.random.Generator, tests: int) -> dict:
    """Make the tests of a truth, as columns."""
    from jaximpact.calibration.arguments import study_given
    from jaximpact.calibration.comparison.contenders import contenders_of
    from jaximpact.calibration.comparison.fitted_law import objective_of

    columns = {
        "mass_kg": np.exp(random.uniform(np.log(50.0), np.log(500.0), tests)),
        "aspect_ratio": np.full(tests, 1.5),
        "orientation_deg": random.uniform(0.0, 180.0, tests),
        "angle_deg": random.uniform(5.0, 70.0, tests),
        "speed_mps": random.uniform(3.0, 20.0, tests),
    }
    empty = columns | {name: np.ones(tests) for name in TARGETS}
    study = study_given(empty)
    (contender,) = contenders_of([truth], study)
    objective = objective_of(study, contender)
    values = np.array([*TRUTHS[truth].values()])
    values = values * np.exp(random.uniform(-1.0, 1.0, len(values)) * np.log(1.3))
    x = objective.bounds.coordinate(values)[None]
    exact = objective.values(x).predicted[0]
    measured = exact + NOISE * random.normal(size=exact.shape)
    return columns | dict(zip(TARGETS, measured.T, strict=True))


if __name__ == "__main__":
    main()

"""Trajectories per second of processor time over profiles of many points, in one run.

    python -m benchmarks.fine_profiles [BLOCKS]

A slope of two planes cut into more and more segments, and a smooth hillside with points
closer and closer; constant coefficients, and the full model with a tenth of the blocks.
"""

import sys
import time

import numpy as np


def main() -> None:
    """Measure, and print a line for each profile and law."""
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

    count = int(sys.argv[1]) if len(sys.argv) > 1 else 4000
    laws = {
        "constant coefficients": (ClosedForm(ConstantCoefficients(0.35, 0.85)), count),
        "full model, fast": (FullModel("fast"), max(count // 10, 20)),
    }
    for name, profile in _profiles(Profile):
        for law, (contacts, blocks) in laws.items():
            random = np.random.default_rng(0)
            block = Block(mass=300.0 * np.exp(random.normal(0.0, 0.5, blocks)))
            x = random.uniform(3.0, 8.0, blocks)
            release = Release(
                block, x, profile.height(x) + 2.5, random.uniform(2.0, 12.0, blocks)
            )
            simulate_runout(profile, release.of_blocks(np.arange(10)), contacts)
            begin = time.process_time()
            runs = simulate_runout(profile, release, contacts)
            seconds = time.process_time() - begin
            print(
                f"{name}, {profile.segments} segments, {law}: "
                f"{blocks / seconds:.3g} trajectories/s, "
                f"{len(runs.pieces.x) / blocks:.0f} pieces each, "
                f"median stop {np.median(runs.x):.1f} m",
                flush=True,
            )


def _profiles(profile_of):
    friction = np.radians(22.0)
    for segments in (2, 200, 2_000, 20_000):
        x = np.array([0.0, 400.0, 1000.0])
        if segments > 2:
            x = np.linspace(0.0, 1000.0, segments + 1)
        y = np.maximum(200.0 - 0.5 * x, 0.0)
        yield "two planes", profile_of(x, y, rolling_friction_angle=friction)
    for spacing in (5.0, 1.0, 0.5, 0.1):
        x = np.arange(0.0, 1000.0 + 0.5 * spacing, spacing)
        y = 200.0 * np.exp(-x / 150.0) + 4.0 * np.sin(x / 25.0)
        yield "hillside", profile_of(x, y, rolling_friction_angle=friction)


if __name__ == "__main__":
    main()

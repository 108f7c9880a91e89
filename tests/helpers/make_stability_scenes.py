"""Regenerate data/stability_scenes.csv: scenes far out, with the ends that "reference"
gives them.

    python make_stability_scenes.py [--every 8] [--out FILE]

Each axis is swept alone, far beyond what is likely, from five usual scenes; then come
corners of the box of all axes, and random scenes within it, half of them with random
grounds. `docs/limits.md` tells how the whole map fares (`--every 1`). For the tests'
time every eighth scene is kept, and of these those that take "balanced" no more than
800 steps. The seeds are fixed.
"""

import argparse
import itertools
import math
from pathlib import Path

import jax
import numpy as np
from paths import DATA
from text_files import write_rows

from jaximpact import Block, Impact, Scene, Soil, simulate_batch

DEGREE = math.pi / 180.0
SPIN = 20_000 * DEGREE
MOST_STEPS = 800
ENDS = ("normal_velocity", "tangential_velocity", "angular_velocity", "outcome_code")

BLOCK = dict(mass=100.0, aspect_ratio=2.0, out_of_plane_ratio=1.0)
IMPACT = dict(speed=14.0, angle=0.3, orientation=0.5, angular_velocity=0.0, slope=0.0)
SOIL = dict(
    gamma_v=8.7,
    k_E=900.0,
    c_v=1.0,
    friction_angle=30 * DEGREE,
    relative_density=0.9,
    n_E=0.4,
    poisson=0.3,
    beta=0.9,
    alpha_vT=2.53,
    alpha_vR=0.0,
    psi=0.33,
    alpha_s=1.0,
    dilatancy=0.0,
)
USUAL = BLOCK | IMPACT | SOIL
STARTS = (
    {},
    dict(angle=0.0, orientation=0.0),
    dict(angle=70 * DEGREE, orientation=100 * DEGREE, angular_velocity=-50, slope=0.6),
    dict(aspect_ratio=1.0, angle=0.8),
    dict(angle=85 * DEGREE, speed=5.0, angular_velocity=40.0),
)
ANGLES = (-89.9999, -89.9, -45.0, -1e-9, 0.0, 1e-9, 45.0, 89.0, 89.9, 89.9999)
ORIENTATIONS = (-1e-9, 0.0, 1e-9, 1e-3, 45.0, 90 - 1e-9, 90.0, 90 + 1e-9, 135.0, 180.0)
AXES = dict(
    gamma_v=[1e-12, *np.logspace(-8, 3, 23)],
    k_E=np.logspace(-1, 6, 22),
    c_v=[0.0, *np.logspace(-6, 4, 20)],
    mass=np.logspace(-3, 5, 17),
    aspect_ratio=[*np.linspace(0.2, 6.0, 30), 1 - 1e-9, 1 - 1e-12, 1.0, 1 + 1e-9],
    speed=np.logspace(-1, math.log10(60), 15),
    angle=DEGREE * np.array(ANGLES),
    orientation=DEGREE * np.array(ORIENTATIONS),
    angular_velocity=SPIN * np.array([-1, -1e-3, -1e-10, 1e-12, 1e-5, 0.1, 1, 10]),
    slope=DEGREE * np.array([-89.9, -60.0, -1.0, 1e-9, 45.0, 80.0, 89.9]),
    friction_angle=DEGREE * np.array([0.1, 1.0, 5.0, 20.0, 45.0, 60.0]),
    relative_density=[0.0, 0.2, 0.5, 1.0],
    n_E=[0.0, 0.2, 0.8, 1.0],
    poisson=[0.0, 0.1, 0.45, 0.49],
    beta=[0.1, 0.3, 0.6, 1.0, 1.2],
    alpha_vT=[0.0, 0.1, 10.0, 100.0],
    alpha_vR=[0.0, 1.0, 10.0, 100.0],
    psi=[0.01, 0.05, 0.5, 2.0],
    alpha_s=[0.0, 1e-3, 0.1, 10.0, 100.0],
    dilatancy=[0.0, 1e-6, 0.5, 1.0],
    out_of_plane_ratio=[0.2, 0.5, 2.0, 5.0],
)
CORNERS = dict(
    gamma_v=(1e-6, 1e3),
    k_E=(1e-1, 1e6),
    angle=(0.0, 89.9 * DEGREE),
    angular_velocity=(-SPIN, 0.0, SPIN),
    aspect_ratio=(0.2, 6.0),
    mass=(1e-3, 1e5),
    speed=(0.1, 60.0),
    orientation=(0.0, 1e-9 * DEGREE, 0.7),
)


def swept():
    """Scenes with one value moved."""
    return [
        USUAL | start | {name: value}
        for start in STARTS
        for name, values in AXES.items()
        for value in values
    ]


def corners():
    """Corners of the box."""
    values = itertools.product(*CORNERS.values())
    return [USUAL | dict(zip(CORNERS, corner, strict=True)) for corner in values]


def inside(count, seed, any_ground):
    """Random scenes in the box."""
    draw = np.random.default_rng(seed)

    def log(low, high):
        return math.exp(draw.uniform(math.log(low), math.log(high)))

    def sometimes(value, share):
        return value if draw.uniform() < share else 0.0

    def scene():
        at_random = dict(
            gamma_v=log(1e-7, 1e3),
            k_E=log(1e-1, 1e6),
            c_v=log(1e-4, 1e2),
            mass=log(1e-3, 1e5),
            aspect_ratio=draw.uniform(0.2, 6.0),
            speed=log(0.1, 60.0),
            angle=draw.uniform(-89.9, 89.9) * DEGREE,
            orientation=draw.uniform(0.0, math.pi),
            angular_velocity=sometimes(draw.uniform(-SPIN, SPIN), 0.7),
            slope=sometimes(draw.uniform(-1.0, 1.0), 0.5),
        )
        ground = dict(
            friction_angle=draw.uniform(15.0, 50.0) * DEGREE,
            relative_density=draw.uniform(0.0, 1.0),
            n_E=draw.uniform(0.0, 1.0),
            poisson=draw.uniform(0.0, 0.49),
            beta=draw.uniform(0.4, 1.2),
            alpha_vT=draw.uniform(0.0, 5.0),
            alpha_vR=sometimes(draw.uniform(0.0, 3.0), 0.5),
            psi=draw.uniform(0.1, 0.7),
            alpha_s=log(0.05, 5.0),
            dilatancy=sometimes(draw.uniform(0.0, 1.0), 0.5),
            out_of_plane_ratio=log(0.3, 3.0),
        )
        return USUAL | at_random | (ground if any_ground else {})

    return [scene() for _ in range(count)]


def scene_of(columns) -> Scene:
    """The scenes of columns named as above."""

    def part(names):
        return {name: columns[name] for name in names}

    return Scene(Block(**part(BLOCK)), Soil(**part(SOIL)), Impact(**part(IMPACT)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--every", type=int, default=8)
    default = DATA / "stability_scenes.csv"
    parser.add_argument("--out", type=Path, default=default)
    args = parser.parse_args()
    jax.config.update("jax_enable_x64", True)

    rows = swept() + corners() + inside(800, 1, True) + inside(700, 2, False)
    rows = rows[:: args.every]
    columns = {name: np.array([float(row[name]) for row in rows]) for name in USUAL}
    quick = simulate_batch(scene_of(columns), accuracy="balanced").steps <= MOST_STEPS
    columns = {name: values[quick] for name, values in columns.items()}
    result = simulate_batch(scene_of(columns), accuracy="reference")
    columns |= {f"end_{name}": getattr(result, name) for name in ENDS}

    rows = zip(*columns.values(), strict=True)
    write_rows(args.out, columns, ([f"{x:.16g}" for x in row] for row in rows))


if __name__ == "__main__":
    main()

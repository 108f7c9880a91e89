"""Makes the tables of the twins: restitution coefficients that the model gives for a
known soil, and the same with noise.

    python calibration/twins/make.py

writes tests.csv and noisy.csv into the folder of each twin.
"""

from pathlib import Path

import jax
import numpy as np

jax.config.update("jax_enable_x64", True)
from jaximpact import Block, Impact, Soil, simulate_batch  # noqa: E402
from jaximpact.scene import Scene  # noqa: E402

TWINS = {
    "very-dense": {"c_v": 1.0, "gamma_v": 8.7, "k_E": 900.0},
    "slow": {"c_v": 0.5, "gamma_v": 1.70, "k_E": 900.0},
    "slower": {"c_v": 0.5, "gamma_v": 0.85, "k_E": 900.0},
}
"""The three soils of Table 1 of Dattola, Crosta and di Prisco (2023)."""
COLUMNS = ("mass_kg", "aspect_ratio", "speed_mps", "angle_deg", "orientation_deg")
TARGETS = ("e_n", "e_t", "e_bar")
NOISE, SEED = 0.02, 0


def tests() -> np.ndarray:
    """Masses and speeds crossed with three ways to arrive, `(tests, columns)`."""
    arrivals = ((1.0, 0.0, 0.0), (2.0, 40.0, 30.0), (1.5, 60.0, 60.0))
    return np.array(
        [
            (mass, aspect_ratio, speed, angle, orientation)
            for mass in (100.0, 500.0, 2000.0)
            for speed in (5.0, 15.0, 25.0)
            for aspect_ratio, angle, orientation in arrivals
        ]
    )


def targets(soil: dict[str, float], rows: np.ndarray) -> np.ndarray:
    """What the model gives, `(tests, targets)`; NaN for e_t along the normal."""
    mass, aspect_ratio, speed, angle, orientation = rows.T
    scene = Scene(
        Block(mass=mass, aspect_ratio=aspect_ratio),
        Soil(**soil),
        Impact(
            speed=speed,
            angle=np.deg2rad(angle),
            orientation=np.deg2rad(orientation),
        ),
    )
    result = simulate_batch(scene, accuracy="reference")
    values = np.stack([getattr(result, name) for name in TARGETS], axis=1)
    return np.where(angle[:, None] == 0.0, values * [1.0, np.nan, 1.0], values)


def noisy(values: np.ndarray, seed: int) -> np.ndarray:
    """With Gaussian noise of 2 %, each value of its own."""
    random = np.random.default_rng(seed)
    return values * (1.0 + NOISE * random.normal(size=values.shape))


def write(path: Path, rows: np.ndarray, values: np.ndarray) -> None:
    """A table; no cell where there is no value."""
    lines = [",".join((*COLUMNS, *TARGETS))]
    for row, of_row in zip(rows, values, strict=True):
        cells = [f"{x:g}" for x in row]
        cells += ["" if np.isnan(x) else f"{x:.12g}" for x in of_row]
        lines.append(",".join(cells))
    path.write_text("\n".join(lines) + "\n")


def main() -> None:
    rows = tests()
    for name, soil in TWINS.items():
        folder = Path(__file__).parent / name
        folder.mkdir(exist_ok=True)
        values = targets(soil, rows)
        write(folder / "tests.csv", rows, values)
        write(folder / "noisy.csv", rows, noisy(values, SEED))


if __name__ == "__main__":
    main()

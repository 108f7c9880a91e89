"""Realistic twins: thirty tests of known ground, made by the model itself with noise.

Blocks of 5 to 20 kg, round and twice as long as wide, strike at 4 to 12 m/s and 0 to 70
degrees from the normal; e_n, e_t, the largest force, the largest penetration and the
duration are measured with noise of 5 to 10 %. Five ground parameters are fitted.
"""

import jax
import numpy as np

from jaximpact import Block, Impact, Soil, simulate_batch
from jaximpact.calibration.arguments import study_given
from jaximpact.scene import Scene

TESTS = 30
BOUNDS = {
    "c_v": (0.01, 10.0),
    "gamma_v": (0.05, 500.0),
    "k_E": (10.0, 1e5),
    "friction_angle_deg": (20.0, 45.0),
    "dilatancy": (0.0, 1.0),
}
LIKELY = {
    "c_v": (0.3, 2.0),
    "gamma_v": (2.0, 20.0),
    "k_E": (300.0, 3000.0),
    "friction_angle_deg": (26.0, 38.0),
    "dilatancy": (0.15, 0.8),
}
"""Ranges from which the true values of a twin are sampled."""
NOISE = {
    "e_n": 0.10,
    "e_t": 0.05,
    "max_normal_force_N": 0.07,
    "max_penetration_m": 0.05,
    "duration_s": 0.05,
}
"""Standard deviation of each target over its value, and at least over a tenth of its
root mean square."""


class Twin:
    """Tests of one ground.

    Args:
        seed: of the ground, the tests and the noise.
    """

    def __init__(self, seed: int):
        random = np.random.default_rng(seed)
        low, high = np.array(list(LIKELY.values())).T
        logarithmic = low > 1e-9
        part = random.random(len(low))
        logarithm = np.log(low) + part * np.log(high / low)
        values = np.where(logarithmic, np.exp(logarithm), low + part * (high - low))
        self.truth = dict(zip(LIKELY, map(float, values), strict=True))
        self.columns = {
            "mass_kg": random.uniform(5.0, 20.0, TESTS),
            "aspect_ratio": random.choice([1.0, 2.0], TESTS),
            "speed_mps": random.uniform(4.0, 12.0, TESTS),
            "angle_deg": random.uniform(0.0, 70.0, TESTS),
            "orientation_deg": random.uniform(0.0, 180.0, TESTS),
        }
        self.values = self._simulate()
        scale = np.sqrt(np.nanmean(self.values**2, axis=0))
        size = np.maximum(np.abs(self.values), 0.1 * scale)
        self.sigma = np.array(list(NOISE.values())) * size

    def _simulate(self) -> np.ndarray:
        mass, ratio, speed, angle, orientation = self.columns.values()
        soil = dict(self.truth)
        soil["friction_angle"] = np.deg2rad(soil.pop("friction_angle_deg"))
        scene = Scene(
            Block(mass=mass, aspect_ratio=ratio),
            Soil(**soil),
            Impact(
                speed=speed,
                angle=np.deg2rad(angle),
                orientation=np.deg2rad(orientation),
            ),
        )
        made = simulate_batch(scene, accuracy="reference")
        self.outcomes = np.asarray(made.outcome_code)
        fields = ("e_n", "e_t", "max_normal_force", "max_penetration", "duration")
        return np.stack([np.asarray(getattr(made, name)) for name in fields], axis=1)

    def study(self, noise_seed: int, stated: bool = True):
        """Make the study of these tests with noise of one seed.

        Args:
            stated: whether the table states the sigmas; else they are estimated.
        """
        random = np.random.default_rng((7, noise_seed))
        measured = self.values + self.sigma * random.normal(size=self.values.shape)
        table = dict(self.columns)
        for place, name in enumerate(NOISE):
            table[name] = measured[:, place]
            if stated:
                table[f"sigma_{name}"] = self.sigma[:, place]
        middle = {"c_v": 0.3, "gamma_v": 5.0, "k_E": 1000.0}
        middle |= {"friction_angle_deg": 32.0, "dilatancy": 0.5}
        fit = {
            name: {"lower": low, "upper": high, "start": middle[name]}
            for name, (low, high) in BOUNDS.items()
        }
        scatter = None if stated else "proportional"
        return study_given(table, fit, scatter=scatter, seed=0)


jax.config.update("jax_enable_x64", True)

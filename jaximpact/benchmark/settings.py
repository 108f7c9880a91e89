"""How much is measured."""

import dataclasses
import math


@dataclasses.dataclass(frozen=True)
class Settings:
    """Sizes of the measurements; the defaults take some 20 minutes on two cores."""

    seed: int = 1
    scenes: int = 2_000
    """Random impacts on which errors are measured, by methods that are quick enough."""
    singles: int = 24
    """Impacts solved one after another."""
    budget_s: float = 0.6
    """Time for one measurement; a slow method gets fewer impacts."""
    least_impacts: int = 16
    """Impacts that a slow method gets all the same."""
    repeats: int = 3
    """Rounds of measurements, of which the shortest count."""
    gradient_scenes: int = 96
    steps: tuple[float, ...] = (0.1, 0.03, 0.01, 0.001)
    """Steps of differences in the logarithm of a parameter, of which peers get the
    best."""
    differences_limit_s: float = 30.0
    """Peers whose differences take longer than that to find their step are left out."""
    jax_scenes: int = 4_096
    """Impacts under `jit` and `vmap`."""
    jax_singles: int = 30
    """Calls of one impact, of which the shortest counts."""
    jax_repeats: int = 10
    ladder_scenes: int = 64
    """Impacts of each parametric set."""
    batch_sizes: tuple[int, ...] = (1, 10, 100, 1_000, 10_000, 100_000)
    batch_limit_s: float = 60.0
    """Larger batches are left out where they would take longer than that."""
    first_uses: tuple[str, ...] = (
        "import",
        "vertical impact",
        "planar impact",
        "impact with dashpots",
        "gradient",
        "batch",
    )
    first_uses_of_peers: tuple[str, ...] = (
        "diffrax Kvaerno5",
        "numbalsoda LSODA",
        "CVODE BDF",
    )
    map_points: int = 13
    """Points on each axis of the stability map."""
    sweep_points: int = 9
    slider_times: tuple[float, ...] = (1e-8, 1e-7, 1e-5, 1e-4)
    """tau_s [s], beside 1e-6."""
    target_scenes: int = 20_000
    target_tuning_scenes: int = 1_000
    target_repeats: int = 3
    target_error: float = 1e-3
    """95 % of impacts are within this of the exact e_n."""


def decades(low: float, high: float, points: int) -> list[float]:
    """Values at equal ratios."""
    if points == 1:
        return [math.sqrt(low * high)]
    ratio = math.log(high / low) / (points - 1)
    return [low * math.exp(ratio * k) for k in range(points)]

"""Starting points spread over the ranges of the unknowns."""

import numpy as np
from scipy.special import ndtri

from ..problem.bounds import Bounds

SPREAD = 0.02
"""Distance of starts from the bounds, as a fraction of the range."""


def spread_starts(
    bounds: Bounds, start: np.ndarray, mean, sd, count: int, seed: int | tuple[int, ...]
) -> np.ndarray:
    """Sample starts (count, unknowns) in x: the given one, then a Latin hypercube.

    The hypercube divides the range of each unknown into as many strata as there are
    points; of an unknown with a prior (`sd` finite), its prior distribution.
    """
    random = np.random.default_rng(seed)
    others, size = count - 1, len(start)
    strata = np.stack([random.permutation(others) for _ in range(size)], axis=-1)
    part = (strata + random.random((others, size))) / max(others, 1)
    spread = bounds.at_fraction(SPREAD + (1.0 - 2.0 * SPREAD) * part)
    has_prior = np.isfinite(sd)
    drawn = mean + np.where(has_prior, sd, 0.0) * ndtri(np.clip(part, 1e-3, 1 - 1e-3))
    drawn = np.clip(drawn, bounds.lower, bounds.upper)
    drawn = bounds.coordinate(np.where(has_prior, drawn, bounds.lower))
    spread = np.where(has_prior, drawn, spread)
    return np.concatenate([np.asarray(start, float)[None], spread])

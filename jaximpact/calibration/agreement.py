"""Whether standard errors, draws and NUTS tell the same of each unknown, and which of
them to believe."""

import numpy as np

from .draws import Draws
from .sampling import Samples
from .study import VariantResult

SHIFT = 0.25
"""Standard errors by which a mean may lie off the best fit."""
RATIO = 1.25
"""By which a standard deviation may differ from the standard error, either way."""
CHANCE = 3.0
"""Standard deviations of its noise for which chance alone is taken."""


def in_words(fitted: VariantResult, draws: Draws, samples: Samples) -> list[str]:
    """What they tell of the parameters, a sentence for each way to agree or not.

    All in x. The mean of n independent draws of standard deviation s scatters by s /
    sqrt(n), their standard deviation by a part of 1 / sqrt(2 n), if they are normal.
    """
    count = len(fitted.verdicts)
    names = samples.names[:count]
    flat = samples.x.reshape(-1, samples.x.shape[-1])[:, :count]
    mean, deviation = np.mean(flat, axis=0), np.std(flat, axis=0)
    effective = samples.effective[:count]
    error = fitted.uncertainty.standard_errors[:count]
    best = fitted.points.x[0][:count]
    drawn = draws.effective_part[-1] * len(draws.x)
    noise = deviation * np.sqrt(1.0 / effective + 1.0 / drawn)
    differ = np.abs(mean - draws.mean()[:count]) > CHANCE * noise
    shift = np.abs(mean - best) / error
    allowed = SHIFT + CHANCE * deviation / (error * np.sqrt(effective))
    ratio = deviation / error
    widest = RATIO * (1.0 + CHANCE / np.sqrt(2.0 * effective))
    skew = (shift > allowed) | (np.maximum(ratio, 1.0 / ratio) > widest)
    known = np.array([verdict.determined for verdict in fitted.verdicts])
    lines = []
    if np.any(differ):
        lines.append(
            "Draws and NUTS differ by more than chance in "
            f"{_names(names, differ)}: one of them has not gone everywhere. Believe "
            "neither, and draw more."
        )
    if np.any(~known):
        lines.append(
            f"Not determined: {_names(names, ~known)}. There is no standard error to "
            "compare; the posterior lies where the bounds let it. Believe the verdict, "
            "and no mean."
        )
    skew &= known & ~differ
    for place in np.flatnonzero(skew):
        lines.append(
            f"{names[place]}: the mean of the posterior lies {shift[place]:.2g} "
            "standard errors off the best fit, and its standard deviation is "
            f"{ratio[place]:.2g} of one. Believe the posterior, not the standard error."
        )
    alike = known & ~(differ | skew)
    if np.any(alike):
        lines.append(
            f"Standard errors, draws and NUTS agree on {_names(names, alike)}, as far "
            f"as {np.min(effective[alike]):.0f} independent draws can tell."
        )
    return lines


def _names(names: list[str], chosen: np.ndarray) -> str:
    return ", ".join(name for name, one in zip(names, chosen, strict=True) if one)

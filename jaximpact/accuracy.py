"""Accuracy of the integration: named settings."""

import dataclasses
import math

from .errors import InputError, check_choice

MAX_STEPS = 300_000
"""Steps after which an impact is given up as failed. Small blocks on very hard ground
vibrate thousands of times and take tens of thousands of steps."""
MAX_STEPS_DAMPED = 50_000
"""Limit of steps with dashpots, where forces that oscillate without end take steps."""
RETRIES = (0.5, 0.2, 0.1, 0.05, 0.03, 0.01, 0.003)
"""Factors of the tolerance with which a failed impact is tried again. Whether the
forces of dashpots come to rest at the onset hangs on the last digits of the steps."""


@dataclasses.dataclass(frozen=True)
class Accuracy:
    """Error control of the integration.

    A step is accepted when the root mean square over the unknowns of
    `error / (tolerance (|value| + floor scale))` is below one; of springs more is
    allowed, of velocities less, and at the onset more (`Problem.allowed_error`).

    Measured on 1 024 random scenes of the paper's parametric sets, against a tolerance
    of 1e-10; gradients are those of six results (e_n, e_contact, e_bar, largest
    penetration and normal force, duration) by log k_E, gamma_v and c_v, relative to the
    larger of gradient and result:

    | name | steps | e_n, median | e_n, 95 % | gradient, median | gradient, 95 % |
    |---|---|---|---|---|---|
    | fast | 59 | 3e-6 | 1e-5 | 6e-5 | 1e-3 |
    | balanced | 89 | 7e-8 | 4e-7 | 2e-6 | 7e-5 |
    | reference | 447 | 1e-10 | 3e-10 | 3e-9 | 2e-7 |
    """

    name: str
    tolerance: float
    """Relative tolerance [-], above 0."""
    floor: float
    """Fraction of each unknown's scale below which errors count as absolute [-]."""

    def __post_init__(self):
        for name in ("tolerance", "floor"):
            value = getattr(self, name)
            if not isinstance(value, float | int) or not 0.0 < value < math.inf:
                raise InputError(
                    f"{name} of an accuracy must be a number above 0, but is {value!r}"
                )


PRESETS = {
    "fast": Accuracy("fast", 1e-3, 5e-3),
    "balanced": Accuracy("balanced", 3e-5, 5e-3),
    "reference": Accuracy("reference", 1e-8, 5e-3),
}
"""Settings of the error control by name: `fast`, `balanced` and `reference`."""


DEFAULT_ACCURACY = "balanced"


def get_accuracy(accuracy: str | Accuracy) -> Accuracy:
    """Return the named setting, or the one given. Raises ValueError for an unknown
    name, with the nearest known."""
    if isinstance(accuracy, Accuracy):
        return accuracy
    check_choice("accuracy", accuracy, PRESETS)
    return PRESETS[accuracy]

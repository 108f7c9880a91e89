"""How exactly an impact is integrated: the named settings."""

import dataclasses
import difflib

MAX_STEPS = 20_000
"""Steps after which an impact is given up as failed; hard ones take about 3 000."""


@dataclasses.dataclass(frozen=True)
class Accuracy:
    """Error control of the integration.

    A step is accepted when the root mean square over the unknowns of
    `error / (tolerance (|value| + floor scale))` is below one.
    """

    name: str
    tolerance: float
    floor: float


PRESETS = {
    "fast": Accuracy("fast", 1e-3, 1e-2),
    "balanced": Accuracy("balanced", 1e-5, 1e-2),
    "reference": Accuracy("reference", 1e-8, 1e-2),
}


def get_accuracy(accuracy: str | Accuracy) -> Accuracy:
    """The named setting, or the one given.

    Raises ValueError for an unknown name, with the nearest known.
    """
    if isinstance(accuracy, Accuracy):
        return accuracy
    if accuracy not in PRESETS:
        near = difflib.get_close_matches(str(accuracy), PRESETS, n=1, cutoff=0.0)
        raise ValueError(
            f"accuracy must be one of {', '.join(PRESETS)}, but {accuracy!r} was "
            f"given; did you mean {near[0]!r}?"
        )
    return PRESETS[accuracy]

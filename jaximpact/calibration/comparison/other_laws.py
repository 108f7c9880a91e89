"""Laws that stand beside a calibration: simple ones always, others where asked for."""

from typing import NamedTuple

from ...errors import InputError
from ...progress import Progress
from ..estimation.starts import SILENT
from ..problem.config import Study
from .comparison import Compared
from .contenders import SIMPLE, Contender
from .fitted_law import (
    FittedLaw,
    LawPrediction,
    fit_law,
    of_targets,
    predict_law,
    predicted_by_rebound,
)

SIMPLE_LAWS = {law.words: Contender(law.words, law) for law in SIMPLE}
"""Simple laws by name."""


class OtherLaws(NamedTuple):
    """Laws beside those of a calibration."""

    simple: tuple[FittedLaw, ...] = ()
    """Simple laws fitted to the same tests; none where they predict no target, or
    cannot be fitted."""
    compared: Compared | None = None
    """Comparison of many laws, where one was asked for."""


NO_OTHERS = OtherLaws()


def fit_simple(study: Study, progress: Progress = SILENT) -> tuple[FittedLaw, ...]:
    """Fit constant coefficients, and Pfeiffer and Bowen, to the targets that they
    predict."""
    targets, found = predicted_by_rebound(study), []
    if not targets:
        return ()
    study = of_targets(study, targets)
    for name, contender in SIMPLE_LAWS.items():
        progress(name)
        try:
            found.append(fit_law(study, contender).fitted)
        except InputError:
            continue  # the predictions say that it is not there
    return tuple(found)


def predict_simple(
    simple: tuple[FittedLaw, ...], study: Study
) -> tuple[LawPrediction, ...]:
    """Predict the tests of a study, which is not fitted, with simple laws."""
    return tuple(predict_law(law, SIMPLE_LAWS[law.name], study) for law in simple)

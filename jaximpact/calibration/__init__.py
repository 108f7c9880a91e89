"""Soil parameters from measured impacts, with what the data do not determine."""

from .run import run_study
from .study import StudyResult, VariantResult, fit_study
from .study_file import Study, read_study

__all__ = [
    "Study",
    "StudyResult",
    "VariantResult",
    "fit_study",
    "read_study",
    "run_study",
]

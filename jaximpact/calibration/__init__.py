"""Soil parameters from measured impacts, and which of them are identifiable."""

from .api import Calibration, Prediction, calibrate, predict, run_study
from .compare_laws import Comparison, compare
from .diagnostics.examination import Examination, examine
from .diagnostics.further_tests import suggest_tests
from .diagnostics.nuts import sample_posterior, to_inference_data
from .diagnostics.results import StudyResult, VariantResult
from .problem.candidates import Sigma
from .problem.config import Study, read_study
from .problem.residual_function import residuals
from .study import fit_study

__all__ = [
    "Calibration",
    "Comparison",
    "Examination",
    "Prediction",
    "Sigma",
    "Study",
    "StudyResult",
    "VariantResult",
    "calibrate",
    "compare",
    "examine",
    "fit_study",
    "predict",
    "read_study",
    "residuals",
    "run_study",
    "sample_posterior",
    "suggest_tests",
    "to_inference_data",
]

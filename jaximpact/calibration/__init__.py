"""Soil parameters from measured impacts, with what the data do not determine."""

from .candidates import Sigma
from .examination import Examination, examine
from .further_tests import suggest_tests
from .one_call import Calibration, calibrate
from .prediction import Prediction, predict
from .run import run_study
from .sampling import sample_posterior, to_inference_data
from .study import StudyResult, VariantResult, fit_study
from .study_file import Study, read_study

__all__ = [
    "Calibration",
    "Examination",
    "Prediction",
    "Sigma",
    "Study",
    "StudyResult",
    "VariantResult",
    "calibrate",
    "examine",
    "fit_study",
    "predict",
    "read_study",
    "run_study",
    "sample_posterior",
    "suggest_tests",
    "to_inference_data",
]

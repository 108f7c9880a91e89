"""What the tests of calibration share: studies of files and of columns, their
objectives and fits, and a linear model in place of impacts, of which every answer is
known."""

import numpy as np
from text_files import write_columns, write_rows

from jaximpact.backend import MACHINE_CODE
from jaximpact.calibration import read_study
from jaximpact.calibration.arguments import table_given
from jaximpact.calibration.estimation.least_squares import fit
from jaximpact.calibration.estimation.sigma import settle
from jaximpact.calibration.problem.config import study_of
from jaximpact.calibration.problem.dataset import joined_tables
from jaximpact.calibration.problem.forward_model import models_of
from jaximpact.calibration.problem.objective import Objective, start_of


def write_study_of(folder, text, columns, rows=None):
    """A study in a folder, of a text and a table of tests: columns by name, or their
    names and rows."""
    if rows is None:
        write_columns(folder / "tests.csv", columns)
    else:
        write_rows(folder / "tests.csv", columns, rows)
    path = folder / "study.toml"
    path.write_text(text)
    return path


def study_of_columns(columns, **content):
    """A study of columns of tests, and of what a study file says beside them."""
    return study_of(joined_tables((table_given(columns),)), content)


def objective_of(study, accuracy=None):
    """The objective of the first variant of a study, or of its path."""
    study = read_study(study) if hasattr(study, "open") else study
    return Objective(study, study.variants[0], models_of(study)[0], accuracy)


def fitted(objective, x=None):
    """The objective and its fit from x, else from the study's start, with sigmas
    estimated where none are given."""
    x = start_of(objective.study) if x is None else x
    return settle(objective, fit(objective, np.atleast_2d(x)))


class NoModel:
    """Stands for the model of impacts where predictions are made otherwise."""

    engine = MACHINE_CODE

    def of_tests(self, tests):
        return self


class Linear(Objective):
    """Predictions that are linear in x: `matrix @ x`, one target."""

    matrix = None

    def __init__(self, study, variant=None, model=None, matrix=None):
        super().__init__(study, study.variants[0], NoModel())
        if matrix is not None:
            self.matrix = matrix

    def _predict(self, x, derivatives):
        predicted = (x @ self.matrix.T)[:, :, None]
        jacobian = np.zeros((*predicted.shape, x.shape[1]))
        if derivatives:
            jacobian[:] = self.matrix[:, None, :]
        return predicted, np.zeros((len(x), len(self.matrix))), jacobian

    def of_tests(self, tests):
        part = super().of_tests(tests)
        part.matrix = self.matrix[tests]
        return part

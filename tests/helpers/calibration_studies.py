"""What the tests of calibration share: studies in files, their objectives, and a linear
model in place of impacts, of which every answer is known."""

import numpy as np
from text_files import write_rows

from jaximpact.backend import MACHINE_CODE
from jaximpact.calibration import read_study
from jaximpact.calibration.problem.forward_model import models_of
from jaximpact.calibration.problem.objective import Objective


def write_study_of(folder, text, columns, rows):
    """A study in a folder, of a text and a table of tests."""
    write_rows(folder / "tests.csv", columns, rows)
    path = folder / "study.toml"
    path.write_text(text)
    return path


def objective_of(path, accuracy=None):
    """The objective of the first variant of a study."""
    study = read_study(path)
    return Objective(study, study.variants[0], models_of(study)[0], accuracy)


class NoModel:
    """Stands for the model of impacts where predictions are made otherwise."""

    engine = MACHINE_CODE

    def of_tests(self, tests):
        return self


class Linear(Objective):
    """Predictions that are linear in x: `matrix @ x`, one target."""

    matrix = None

    def __init__(self, study, variant, model=None):
        super().__init__(study, variant, NoModel())

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

"""What the tests of calibration share: studies in files, their objectives, and a linear
model in place of impacts, of which every answer is known."""

import numpy as np
from text_files import write_rows

from jaximpact.calibration import read_study
from jaximpact.calibration.problem.objective import Objective


def write_study_of(folder, text, columns, rows):
    """A study in a folder, of a text and a table of tests."""
    write_rows(folder / "tests.csv", columns, rows)
    path = folder / "study.toml"
    path.write_text(text)
    return path


def objective_of(path, engine, accuracy=None):
    """The objective of the first variant of a study."""
    study = read_study(path)
    return Objective(study, study.variants[0], engine, accuracy)


class Linear(Objective):
    """Predictions that are linear in x: `matrix @ x`, one target."""

    matrix = None

    def _predict(self, x, wanted):
        predicted = (x @ self.matrix.T)[:, :, None]
        jacobian = np.where(wanted.T[:, None, None, :], self.matrix[:, None, :], 0.0)
        return predicted, np.zeros((len(x), len(self.matrix))), jacobian

    def of_tests(self, tests):
        part = super().of_tests(tests)
        part.matrix = self.matrix[tests]
        return part

    def values(self, x, of=0):
        return self.evaluate_partially(x, np.zeros(x.shape, bool))

"""Predictions of new tests by several laws, and by all of them with their weights."""

import dataclasses
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...io.display import align
from ..diagnostics.predictive import Predictive
from ..diagnostics.uncertainty import CONFIDENCE
from ..problem.dataset import Measurements
from ..problem.nuisance import entries_of, open_nuisances
from .comparison import Compared
from .fitted_law import LawPrediction, predict_law

if TYPE_CHECKING:
    import pandas as pd

LEAST_WEIGHT = 1e-4
"""Weight below which a law has no part in the stacked prediction."""


class StackedPrediction(NamedTuple):
    """Predictions of tests; arrays of shape (tests, targets), NaN where there is
    none."""

    tests: Measurements
    targets: tuple[str, ...]
    laws: tuple[LawPrediction, ...]
    """Predictions of each law, the best predictor of the fitted tests first."""
    weights: np.ndarray
    """Stacking weights, shape (laws,)."""
    middle: np.ndarray
    """Median of the stacked prediction of a measurement."""
    low: np.ndarray
    """Lower end of its 95 % interval; `high` the upper."""
    high: np.ndarray

    def __str__(self) -> str:
        rows = [("test", *self.targets)]
        for test in range(len(self.tests)):
            cells = (
                f"{self.middle[test, target]:.3g} ({self.low[test, target]:.3g} to "
                f"{self.high[test, target]:.3g})"
                for target in range(len(self.targets))
            )
            rows.append((self.tests.name(test), *cells))
        return f"Stacked prediction: median (95 %)\n{align(rows)}\n"

    def to_dataframe(self) -> "pd.DataFrame":
        """Make a table with one row for each test and target: `predicted`, `low_95` and
        `high_95` of the stacked prediction, and the prediction of each law under its
        name. Needs pandas."""
        import pandas as pd

        rows = [
            {
                "test": self.tests.name(test),
                "target": name,
                "predicted": self.middle[test, target],
                "low_95": self.low[test, target],
                "high_95": self.high[test, target],
            }
            | {law.name: law.best[test, target] for law in self.laws}
            for test in range(len(self.tests))
            for target, name in enumerate(self.targets)
        ]
        return pd.DataFrame(rows)


def predict_stacked(compared: Compared, tests: Measurements) -> StackedPrediction:
    """Predict tests with every law, and with all of them by their weights."""
    study, count = compared.study, len(tests)
    shape = count, len(study.targets)
    added = {n: v for n, v in study.block.items() if n not in tests.inputs}
    tests = tests.with_inputs(added)
    new = dataclasses.replace(
        study,
        path=tests.files[0].path,
        tests=tests,
        nuisances=open_nuisances(
            entries_of(study.nuisances, study.tests), tests, study.soil
        ),
        measured=np.full(shape, np.nan),
        censored=np.zeros(shape, int),
        sigma=np.ones(shape),
    )
    laws = tuple(predict_law(law.fitted, law.contender, new) for law in compared.laws)
    found = np.full((3, *shape), np.nan)
    tail = (1.0 - CONFIDENCE) / 2.0
    for cell in np.ndindex(*shape):
        mixture = _mixture(laws, compared.weights, cell)
        if mixture is not None:
            found[:, *cell] = [mixture.quantile(p) for p in (0.5, tail, 1.0 - tail)]
    return StackedPrediction(tests, study.targets, laws, compared.weights, *found)


def _mixture(laws, weights: np.ndarray, cell) -> Predictive | None:
    """Mix the distributions of one measurement; None where no law has one."""
    parts = [
        (law.distribution(*cell), weight)
        for law, weight in zip(laws, weights, strict=True)
        if weight > LEAST_WEIGHT
    ]
    there = [(found, weight) for found, weight in parts if found is not None]
    if not there:
        return None
    atoms = np.concatenate([found.atoms for found, _ in there])
    of_atoms = np.concatenate([weight * found.weights for found, weight in there])
    order = np.argsort(atoms, kind="stable")
    return Predictive(atoms[order], of_atoms[order] / np.sum(of_atoms))

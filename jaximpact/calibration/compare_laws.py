"""Comparison of laws in one call: tests in, which law they prefer out, and what all of
them predict."""

import dataclasses
import os
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .._checks import expect
from .._precision import require_float64
from .._settings import numpy_settings
from ..io.files import write_text
from ..io.output_files import output_directory, together
from ..parameters import Part
from ..progress_lines import ProgressChoice, showing
from ..reports.document import Document
from ..reports.json_tree import json_text
from ..reports.tables import Table
from ..scene import Block, Soil
from .arguments import study_of_arguments, table_given
from .comparison.comparison import Compared, ScoredLaw, compare_study
from .comparison.contenders import Law
from .comparison.fitted_law import LawPrediction, predict_law
from .diagnostics.predictive import Predictive
from .diagnostics.uncertainty import TAIL
from .prediction import check_laws, with_ground_of_fit
from .problem.dataset import Measurements, joined_tables
from .problem.laws import scene_of
from .problem.nuisance import entries_of, open_nuisances
from .report.comparison import (
    comparison_csv,
    comparison_json,
    comparison_parts,
    comparison_pictures,
    verdict,
)

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

FILES = ("comparison.html", "comparison.csv", "comparison.json")


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
        rows = []
        for test, name in enumerate(self.tests.names_apart()):
            cells = (
                f"{self.middle[test, target]:.3g} ({self.low[test, target]:.3g} to "
                f"{self.high[test, target]:.3g})"
                for target in range(len(self.targets))
            )
            rows.append((name, *cells))
        table = Table(("test", *self.targets), rows)
        missing = self.tests.missing_in_words()
        lines = ["Stacked prediction: median (95 %)", table.text(), missing]
        return "".join(f"{line}\n" for line in lines if line)

    def to_dataframe(self) -> "pd.DataFrame":
        """Make a table with one row for each test and target: `predicted`, `low_95` and
        `high_95` of the stacked prediction, and the prediction of each law under its
        name. Needs pandas."""
        values = [self.middle, self.low, self.high, *(law.best for law in self.laws)]
        rows = [
            (name, target, *(of_one[test, place] for of_one in values))
            for test, name in enumerate(self.tests.names_apart())
            for place, target in enumerate(self.targets)
        ]
        head = ("test", "target", "predicted", "low_95", "high_95")
        return Table((*head, *(law.name for law in self.laws)), rows).frame()


def predict_stacked(compared: Compared, tests: Measurements) -> StackedPrediction:
    """Predict tests with every law, and with all of them by their weights."""
    study = compared.study
    shape = len(tests), len(study.targets)
    check_laws(study.parts, tests)
    columns = study.tests.inputs.items()
    tests = with_ground_of_fit(
        tests,
        study,
        study.variants,
        {name: (np.min(v), np.max(v)) for name, v in columns},
        nuisances=[one.name for one in study.nuisances],
        more=[name for law in compared.laws for name in law.contender.more],
    )
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
    laws = tuple(
        predict_law(law.fitted.of_targets(study.targets), law.contender, new)
        for law in compared.laws
    )
    quantiles = np.full((3, *shape), np.nan)
    for cell in np.ndindex(*shape):
        mixture = _mixture(laws, compared.weights, cell)
        if mixture is not None:
            quantiles[:, *cell] = [mixture.quantile(p) for p in (0.5, TAIL, 1.0 - TAIL)]
    return StackedPrediction(tests, study.targets, laws, compared.weights, *quantiles)


def _mixture(laws, weights: np.ndarray, cell) -> Predictive | None:
    """Mix the distributions of one measurement; None where no law has one."""
    parts = [
        (distribution, weight)
        for law, weight in zip(laws, weights, strict=True)
        # Others have no part in it.
        if weight > 1e-4 and (distribution := law.distribution(*cell)) is not None
    ]
    if not parts:
        return None
    atoms = np.concatenate([one.atoms for one, _ in parts])
    of_atoms = np.concatenate(
        [weight * distribution.weights for distribution, weight in parts]
    )
    order = np.argsort(atoms, kind="stable")
    return Predictive(atoms[order], of_atoms[order] / np.sum(of_atoms))


class Comparison:
    """Result of `compare`; `print` it.

    Args:
        compared: fits and scores of the laws.
    """

    def __init__(self, compared: Compared):
        self.compared = compared

    def __repr__(self) -> str:
        return f"<Comparison: {verdict(self.compared)[0]}>"

    @numpy_settings()
    def __str__(self) -> str:
        return Document("", comparison_parts(self.compared), []).text()

    def _repr_html_(self) -> str:
        return Document("", comparison_parts(self.compared), []).html()

    @property
    def with_rebound(self) -> "Comparison | None":
        """The grounds beside laws of rebound, on the targets that these predict, where
        other targets were measured too; None where all laws are compared on all
        targets."""
        beside = self.compared.with_rebound
        return None if beside is None else Comparison(beside)

    @property
    def targets(self) -> tuple[str, ...]:
        """Names of the targets on which the laws are compared."""
        return self.compared.study.targets

    @property
    def laws(self) -> tuple[str, ...]:
        """Names of the laws, the best predictor first."""
        return tuple(law.name for law in self.compared.laws)

    @property
    def best(self) -> str:
        """Name of the law that predicts best, whether or not others tie with it."""
        return self.laws[self.compared.ranking().best]

    @property
    def ties(self) -> tuple[str, ...]:
        """Names of the laws that predict as well as the best, the best among them."""
        return tuple(self.laws[place] for place in self.compared.ranking().ties)

    @property
    def preferred(self) -> str:
        """Name of the law with the fewest parameters among the ties; of several the one
        that was named first."""
        return self.laws[self.compared.ranking().preferred]

    @property
    def weights(self) -> dict[str, float]:
        """Stacking weights by law; their sum is 1."""
        return dict(zip(self.laws, self.compared.weights.tolist(), strict=True))

    def law(self, name: str) -> ScoredLaw:
        """Return a law with its fit and its predictions of tests left out.

        Raises KeyError for a name that is not among `laws`.
        """
        if name not in self.laws:
            raise KeyError(f"{name!r} is none of {', '.join(self.laws)}")
        return self.compared.laws[self.laws.index(name)]

    @numpy_settings()
    def to_dataframe(self) -> "pd.DataFrame":
        """Make a table with one row a law: its number of `parameters` that have an
        influence, `score` (the log predictive density of all tests), `difference` to
        the best and its `standard_error`, stacking `weight`, and `rms` and
        `rms_left_out` of each target. Needs pandas."""
        import pandas as pd

        ranking = self.compared.ranking()
        columns = {
            "parameters": [law.count for law in self.compared.laws],
            "score": self.compared.by_test.totals,
            "difference": ranking.apart,
            "standard_error": ranking.error,
            "weight": self.compared.weights,
        }
        for place, target in enumerate(self.compared.study.targets):
            for kind in ("rms", "rms_left_out"):
                columns[f"{kind}_{target}"] = [
                    getattr(law, kind)[place] for law in self.compared.laws
                ]
        return pd.DataFrame(columns, index=pd.Index(self.laws, name="law"))

    @numpy_settings()
    def to_xarray(self) -> "xr.Dataset":
        """Make a dataset of the same over `law`."""
        return self.to_dataframe().to_xarray()

    @numpy_settings()
    def plot(self, path: str | os.PathLike | None = None, *, ax=None):
        """Draw the difference of each law to the best, with two standard errors, and
        return the axes.

        Args:
            path, ax: as for `Calibration.plot`.
        """
        from ..plotting.style import plotted
        from .report.drawings import draw_comparison

        return plotted(partial(draw_comparison, self.compared), path, ax)

    @numpy_settings()
    def predict(self, tests: str | os.PathLike | Mapping) -> StackedPrediction:
        """Predict tests with every law, and with all of them by their stacking
        weights.

        Args:
            tests: tests as for `predict`.

        Raises InputError for input that cannot be used.
        """
        study = self.compared.study
        table = table_given(tests, scene_of(study.parts))
        return predict_stacked(self.compared, joined_tables((table,)))

    @numpy_settings()
    def write(self, out: str | os.PathLike) -> None:
        """Write comparison.html, comparison.csv and comparison.json into a directory.

        Raises InputError for a directory that cannot be used.
        """
        inputs = self.compared.study.inputs
        directory = output_directory(Path(out), "compare", FILES, inputs=inputs)
        with directory as listed, together(listed) as new:
            parts = comparison_parts(self.compared)
            parts += comparison_pictures(self.compared)
            page = Document("Laws compared", parts, []).page()
            write_text(new(FILES[0]), page)
            write_text(new(FILES[1]), comparison_csv(self.compared))
            write_text(new(FILES[2]), json_text(comparison_json(self.compared)))


@numpy_settings()
def compare(
    tests: str | os.PathLike | Mapping,
    laws: Iterable[Law] | None = None,
    *,
    by: str | Sequence[str] | None = None,
    exact: bool = False,
    fit: Iterable[str] | Mapping[str, dict] | None = None,
    ground: Soil | Mapping[str, float | str | Part] | None = None,
    block: Block | Mapping[str, float | str | Part] | None = None,
    targets: Iterable[str] | None = None,
    sigma: Mapping[str, float] | None = None,
    scatter: str | Mapping[str, str] | None = None,
    seed: int | None = None,
    progress: ProgressChoice = None,
) -> Comparison:
    """Find out which law predicts measured impacts best.

    Every law is fitted to the same tests with the same errors of measurement, and
    scored by the log predictive density of each test by the fit to the others.

    Args:
        tests: as for `calibrate`: a table of tests or a study (`.toml`).
        laws: laws that are compared: "model", the ground as it is given; "model with
            cohesion", "model with modulus at contact pressure", "model with inertia",
            "... and cohesion"; a law of the ground by name or as an object, in place of
            the ground's ("FluidityRate", "my_laws.py:MyFlow"); a `Soil` with laws of
            its own; of these objects, values that are no defaults too, unless they are
            fitted or stand in the table; a law of rebound by its words or its class
            ("constant coefficients", `PfeifferBowen`, "my_laws.py:MyRebound"), or an
            object of it, whose values have no effect: all are fitted. Default: the
            model and all these grounds, constant coefficients, Pfeiffer and Bowen,
            a power law in the angle, and a rigid ellipsoid (Vijayakumar).
        by: columns whose groups are left out too: of text, "shape", or of numbers.
            Default: campaign and shape, where there are several.
        exact: whether each fit without a test is made to the end; otherwise one step
            from the fit to all stands for it where it is short.
        fit, ground, block, targets, sigma, scatter, seed: as for `calibrate`.
        progress: as for `calibrate`.

    Laws of the ground are compared on all targets. Laws of rebound predict coefficients
    and velocities alone: where other targets were measured too, they are compared with
    the grounds on those (`with_rebound`).

    Raises InputError for input that cannot be used; RuntimeError if JAX is set to
    float32.
    """
    require_float64()
    if not isinstance(exact, np.bool_):  # whose name is that of `bool`
        expect("exact", exact, bool)
    options = dict(fit=fit, ground=ground, block=block, targets=targets)
    options |= dict(sigma=sigma, scatter=scatter, seed=seed)
    study = study_of_arguments(tests, options)
    with showing(progress):
        return Comparison(compare_study(study, laws, by=by, exact=bool(exact)))

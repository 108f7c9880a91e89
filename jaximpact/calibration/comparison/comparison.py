"""Comparison of laws on the same tests, by their predictions of what they have not
seen."""

from collections.abc import Iterable, Sequence
from concurrent.futures import Executor
from typing import NamedTuple

import numpy as np

from ...errors import InputError, nearest
from ...progress import Progress, ProgressFunction, as_progress
from ..problem.config import Study
from ..problem.forward_model import for_each
from .contenders import Contender, Law, contenders_of
from .fitted_law import FittedLaw, LawFit, fit_law, of_targets, predicted_by_rebound
from .held_out import HeldOut, held_out
from .stacking import stacking_weights

CAMPAIGN, SHAPE, TEST = "campaign", "shape", "test"
MOST_VALUES = 12
"""Different numbers in a column up to which each is a group."""
PARTS = 5
"""Groups of equal count of a column with more different numbers."""


class ScoredLaw(NamedTuple):
    """A law with its fit, and how well it predicts what it was not fitted to."""

    contender: Contender
    fitted: FittedLaw
    rms: np.ndarray
    """Root mean square residual of the fit to all, shape (targets,)."""
    rms_left_out: np.ndarray
    """Root mean square error of predictions without the test, shape (targets,)."""
    left_out: HeldOut
    """Predictions of each test by the fit to the others."""
    acts: tuple[bool, ...]
    """Whether each parameter of the law changes any of the measured values."""
    bounds_reached: tuple[str | None, ...]
    """The bound that each parameter has reached: "lower", "upper" or None."""

    @property
    def count(self) -> int:
        """Number of parameters that the tests can tell anything of."""
        return sum(self.acts)

    @property
    def name(self) -> str:
        """Name of the law."""
        return self.contender.name

    @property
    def parameters(self) -> dict[str, float]:
        """Parameters of the law at its fit, in the units of their columns."""
        count = self.fitted.parameters
        names, values = self.fitted.unknowns[:count], self.fitted.values[:count]
        return dict(zip(names, values.tolist(), strict=True))


class GroupScores(NamedTuple):
    """Log predictive densities of groups of tests, each predicted by the others."""

    by: str
    """Column whose groups were left out; "test" for each test by itself."""
    groups: tuple[str, ...]
    scores: np.ndarray
    """Log predictive densities, shape (groups, laws)."""

    @property
    def totals(self) -> np.ndarray:
        """Expected log predictive density of each law, shape (laws,)."""
        return np.sum(self.scores, axis=0)


class Compared(NamedTuple):
    """Laws fitted to the same tests, the best predictor first."""

    study: Study
    """Tests with the targets that were compared."""
    targets_left_out: tuple[str, ...]
    """Targets that laws of rebound do not predict."""
    laws: list[ScoredLaw]
    by_test: GroupScores
    by_group: list[GroupScores]
    weights: np.ndarray
    """Stacking weights, shape (laws,)."""
    refused: dict[str, str]
    """Laws that could not be fitted, with the reason."""


def check_comparison(
    study: Study, laws: Iterable[Law] | None, by: str | Sequence[str] | None
) -> None:
    """Raise InputError for laws or columns that `compare_study` would refuse."""
    contenders_of(laws, study)
    for name in _columns(study, by):
        _groups(study, name)


def compare_study(
    study: Study,
    laws: Iterable[Law] | None = None,
    *,
    by: str | Sequence[str] | None = None,
    exact: bool = False,
    executor: Executor | None = None,
    progress: Progress | ProgressFunction | None = None,
) -> Compared:
    """Fit laws to the tests of a study and score their predictions.

    Args:
        study: tests, targets, errors of measurement and fitted parameters.
        laws: laws that are compared; see `contenders_of`.
        by: columns whose groups are left out too: of text, `shape`, or of numbers.
            Default: `campaign` and `shape` where there are several.
        exact: whether each fit without a test is made to the end. Otherwise one step
            from the fit to all stands for it where it is short; laws of rebound are
            always fitted to the end.
        executor: makes fits in other processes, those of all laws, and of all groups
            left out, at a time.
        progress: called with lines of text.

    Raises InputError for laws or columns that cannot be used, and where no law can be
    fitted.
    """
    progress = as_progress(progress)
    contenders = contenders_of(laws, study)
    common = predicted_by_rebound(study)
    chosen = any(contender.is_rebound for contender in contenders)
    if chosen and not common:
        if laws is not None:
            raise InputError(
                f"laws of rebound predict none of {', '.join(study.targets)}; name "
                "laws of the ground alone, or measure velocities or coefficients too"
            )
        contenders = [c for c in contenders if not c.is_rebound]
        chosen = False
    targets = common if chosen else study.targets
    left_out = tuple(name for name in study.targets if name not in targets)
    study = of_targets(study, targets)
    groups = [(TEST, *_each(study))]
    groups += [(name, *_groups(study, name)) for name in _columns(study, by)]

    def fitted(number: int, progress: Progress) -> tuple[ScoredLaw, list] | str:
        contender = contenders[number]
        within = progress.within(f"law {number + 1} of {len(contenders)}: ")
        within(contender.name)
        try:
            found = fit_law(study, contender, within, executor)
        except InputError as error:
            return str(error)
        return _score(contender, found, groups, exact, within)

    every = for_each(fitted, range(len(contenders)), progress, executor)
    named = zip((contender.name for contender in contenders), every, strict=True)
    refused = {name: found for name, found in named if isinstance(found, str)}
    scored = [found for found in every if not isinstance(found, str)]
    if not scored:
        raise InputError(f"no law could be fitted: {'; '.join(refused.values())}")
    fits, densities = zip(*scored, strict=True)
    scores = [
        GroupScores(name, names, np.stack([d[i] for d in densities], axis=1))
        for i, (name, names, _) in enumerate(groups)
    ]
    order = np.argsort(-scores[0].totals, kind="stable")
    scores = [one._replace(scores=one.scores[:, order]) for one in scores]
    return Compared(
        study=study,
        targets_left_out=left_out,
        laws=[fits[place] for place in order],
        by_test=scores[0],
        by_group=scores[1:],
        weights=stacking_weights(scores[0].scores),
        refused=refused,
    )


def _score(
    contender: Contender, found: LawFit, groups: list, exact: bool, progress: Progress
) -> tuple[ScoredLaw, list[np.ndarray]]:
    """Score a law by each kind of groups left out; log densities of these."""
    held = [
        held_out(
            *(found.objective, found.points, found.uncertainty, group),
            exact=exact or contender.is_rebound or name != TEST,
            progress=progress,
        )
        for name, _, group in groups
    ]
    densities = [_summed(one, g) for one, (_, _, g) in zip(held, groups, strict=True)]
    return _scored(contender, found, held[0]), densities


def _scored(contender: Contender, found: LawFit, left: HeldOut) -> ScoredLaw:
    study = found.objective.study
    exact = study.known & (study.censored == 0)

    def rms(predicted: np.ndarray) -> np.ndarray:
        there = exact & np.isfinite(predicted)
        squares = np.where(there, (predicted - study.measured) ** 2, 0.0)
        return np.sqrt(np.sum(squares, axis=0) / np.maximum(np.sum(there, axis=0), 1))

    points, count = found.points, found.fitted.parameters
    acts = np.any(points.jacobian[0][study.known] != 0.0, axis=0)[:count]
    return ScoredLaw(
        contender=contender,
        fitted=found.fitted,
        rms=rms(points.predicted[0]),
        rms_left_out=rms(left.predicted),
        left_out=left,
        acts=tuple(bool(one) for one in acts),
        bounds_reached=tuple(found.objective.bounds.bound_reached(points.x[0])[:count]),
    )


def _summed(held: HeldOut, group: np.ndarray) -> np.ndarray:
    """Sum log densities within the groups, shape (groups,)."""
    inside = group >= 0
    return np.bincount(group[inside], held.density[inside])


def _each(study: Study) -> tuple[tuple[str, ...], np.ndarray]:
    """Number the tests that have a measurement; -1 for the others."""
    there = np.any(study.known, axis=1)
    group = np.where(there, np.cumsum(there) - 1, -1)
    names = tuple(study.tests.name(int(test)) for test in np.flatnonzero(there))
    return names, group


def _columns(study: Study, by: str | Sequence[str] | None) -> list[str]:
    """List the columns whose groups are left out."""
    if by is None:
        several = [
            name for name in (CAMPAIGN, SHAPE) if len(set(_labels(study, name))) > 1
        ]
        return several
    return [by] if isinstance(by, str) else list(by)


def _labels(study: Study, name: str) -> list[str]:
    return study.tests.shapes if name == SHAPE else study.tests.labels[name]


def _groups(study: Study, name: str) -> tuple[tuple[str, ...], np.ndarray]:
    """Group the tests by a column. Raises InputError for one that is not there, or has
    one value alone."""
    tests = study.tests
    texts = [*tests.labels, SHAPE]
    if name in texts:
        labels = _labels(study, name)
    elif name in tests.inputs:
        labels = _labels_of_numbers(tests.inputs[name])
    else:
        known = [*texts, *tests.inputs]
        raise InputError(
            f"by names {name!r}, which is no column of the tests; did you mean "
            f"{nearest(name, known)!r}?",
            file=study.path,
        )
    there = np.any(study.known, axis=1)
    used = [label for label, one in zip(labels, there, strict=True) if one]
    names = tuple(dict.fromkeys(used))
    if len(names) < 2:
        raise InputError(
            f"by names {name!r}, which has one value in all tests; name a column with "
            "several",
            file=study.path,
        )
    group = [
        names.index(n) if one else -1 for n, one in zip(labels, there, strict=True)
    ]
    return names, np.array(group)


def _labels_of_numbers(values: np.ndarray) -> list[str]:
    """Label numbers by their value, or by one of several ranges of equal count."""
    distinct = np.unique(values)
    if len(distinct) <= MOST_VALUES:
        return [f"{value:g}" for value in values]
    edges = np.quantile(values, np.linspace(0.0, 1.0, PARTS + 1))
    place = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, PARTS - 1)
    return [f"{edges[p]:.3g} to {edges[p + 1]:.3g}" for p in place]

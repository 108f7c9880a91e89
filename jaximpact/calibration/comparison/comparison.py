"""Comparison of laws on the same tests, by their predictions of what they have not
seen."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from ...errors import InputError, nearest
from ...progress import tell, within
from ...scene_quantities import SHAPE
from ..problem.config import Study
from ..problem.dataset import CAMPAIGN
from .contenders import Contender, Law, contenders_of
from .fitted_law import FittedLaw, LawFit, fit_law, of_targets, predicted_by_rebound
from .held_out import HeldOut, held_out
from .ranking import Ranking, ranking, stacking_weights

TEST = "test"

Groups = tuple[str, tuple[str, ...], np.ndarray]
"""Column whose groups are left out, names of the groups, and index of the group of each
test, -1 for a test without measurement."""


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

    def ranking(self, by: GroupScores | None = None) -> Ranking:
        """Rank the laws, by their predictions of single tests unless others are
        given."""
        scores = (by or self.by_test).scores
        return ranking(scores, [law.count for law in self.laws])


class OtherLaws(NamedTuple):
    """Laws beside those of a calibration."""

    simple: tuple[FittedLaw, ...] = ()
    """Simple laws fitted to the same tests; none where they predict no target, or
    cannot be fitted."""
    compared: Compared | None = None
    """Comparison of many laws, where one was asked for."""


NO_OTHERS = OtherLaws()


def check_comparison(
    study: Study, laws: Iterable[Law] | None, by: str | Sequence[str] | None
) -> None:
    """Raise InputError for laws or columns that `compare_study` would refuse."""
    contenders_of(laws, study)
    _groups_left_out(study, by)


def compare_study(
    study: Study,
    laws: Iterable[Law] | None = None,
    *,
    by: str | Sequence[str] | None = None,
    exact: bool = False,
) -> Compared:
    """Fit laws to the tests of a study and score their predictions; arguments are those
    of `compare`. Laws of rebound are always fitted to the end.

    Raises InputError for laws or columns that cannot be used, and where no law can be
    fitted.
    """
    contenders = contenders_of(laws, study)
    targets = study.targets
    if any(contender.is_rebound for contender in contenders):
        common = predicted_by_rebound(study)
        if not common and laws is not None:
            raise InputError(
                f"laws of rebound predict none of {', '.join(study.targets)}; name "
                "laws of the ground alone, or measure velocities or coefficients too"
            )
        targets = common or targets
        contenders = [c for c in contenders if common or not c.is_rebound]
    left_out = tuple(name for name in study.targets if name not in targets)
    study = of_targets(study, targets)
    groups = [_each_test(study), *_groups_left_out(study, by)]

    scored, refused = [], {}
    for number, contender in enumerate(contenders, 1):
        with within(f"law {number} of {len(contenders)}: "):
            tell(contender.name)
            try:
                fit = fit_law(study, contender)
            except InputError as error:
                refused[contender.name] = str(error)
                continue
            scored.append(_scored(contender, fit, groups, exact))
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


def _scored(
    contender: Contender, fit: LawFit, groups: list[Groups], exact: bool
) -> tuple[ScoredLaw, list[np.ndarray]]:
    """Score a law by each kind of groups left out; log densities of these."""
    predictions, densities = [], []
    for name, _, group in groups:
        one = held_out(
            fit.objective,
            fit.points,
            fit.uncertainty,
            group,
            exact=exact or contender.is_rebound or name != TEST,
        )
        inside = group >= 0
        predictions.append(one)
        densities.append(np.bincount(group[inside], one.density[inside]))
    study, points = fit.objective.study, fit.points
    measured = study.exact

    def rms(predicted: np.ndarray) -> np.ndarray:
        there = measured & np.isfinite(predicted)
        squares = np.where(there, (predicted - study.measured) ** 2, 0.0)
        return np.sqrt(np.sum(squares, axis=0) / np.maximum(np.sum(there, axis=0), 1))

    count = fit.fitted.parameters
    acts = np.any(points.jacobian[0][study.known] != 0.0, axis=0)[:count]
    law = ScoredLaw(
        contender=contender,
        fitted=fit.fitted,
        rms=rms(points.predicted[0]),
        rms_left_out=rms(predictions[0].predicted),
        left_out=predictions[0],
        acts=tuple(acts.tolist()),
        bounds_reached=tuple(fit.objective.bounds.bound_reached(points.x[0])[:count]),
    )
    return law, densities


def _each_test(study: Study) -> Groups:
    there = np.any(study.known, axis=1)
    group = np.where(there, np.cumsum(there) - 1, -1)
    names = tuple(study.tests.name(int(test)) for test in np.flatnonzero(there))
    return TEST, names, group


def _groups_left_out(study: Study, by: str | Sequence[str] | None) -> list[Groups]:
    if by is None:
        labels = {CAMPAIGN: study.tests.labels[CAMPAIGN], SHAPE: study.tests.shapes}
        by = [name for name, of_tests in labels.items() if len(set(of_tests)) > 1]
    return [_groups(study, name) for name in ([by] if isinstance(by, str) else by)]


def _groups(study: Study, name: str) -> Groups:
    """Group the tests by a column. Raises InputError for one that is not there, or has
    one value alone."""
    tests = study.tests
    texts = tests.labels | {SHAPE: tests.shapes}
    if name in texts:
        labels = texts[name]
    elif name in tests.inputs:
        labels = _labels_of_numbers(tests.inputs[name])
    else:
        raise InputError(
            f"by names {name!r}, which is no column of the tests; did you mean "
            f"{nearest(name, [*texts, *tests.inputs])!r}?",
            file=study.path,
        )
    there = np.any(study.known, axis=1)
    names = tuple(dict.fromkeys(np.array(labels)[there].tolist()))
    if len(names) < 2:
        raise InputError(
            f"by names {name!r}, which has one value in all tests; name a column with "
            "several",
            file=study.path,
        )
    group = [names.index(n) if n in names else -1 for n in labels]
    return name, names, np.where(there, group, -1)


def _labels_of_numbers(values: np.ndarray) -> list[str]:
    """Label numbers by their value; more than twelve by five ranges of equal count."""
    if len(np.unique(values)) <= 12:
        return [f"{value:g}" for value in values]
    edges = np.quantile(values, np.linspace(0.0, 1.0, 6))
    place = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, 4)
    return [f"{edges[p]:.3g} to {edges[p + 1]:.3g}" for p in place]

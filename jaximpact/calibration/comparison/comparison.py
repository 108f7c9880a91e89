"""Comparison of laws on the same tests, by their predictions of what they have not
seen."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from ..._checks import expect
from ...errors import InputError, did_you_mean
from ...progress import tell, within
from ...scene_quantities import SHAPE
from ..diagnostics.results import VariantResult
from ..problem.config import Study
from ..problem.dataset import CAMPAIGN
from .contenders import Contender, Law, contenders_of
from .fitted_law import (
    FittedLaw,
    LawFit,
    fit_law,
    law_fit,
    of_targets,
    predicted_by_rebound,
)
from .held_out import HeldOut, held_out
from .ranking import Ranking, ranking, stacking_weights

TEST = "test"

By = str | Sequence[str] | None
"""Columns whose groups are left out; None for campaign and shape."""
Groups = tuple[str, tuple[str, ...], np.ndarray]
"""Column whose groups are left out, names of the groups, and index of the group of each
test, -1 for a test without measurement."""


class ScoredLaw(NamedTuple):
    """A law with its fit, and how well it predicts what it was not fitted to."""

    contender: Contender
    named: int
    """Place among the laws as they were named."""
    fitted: FittedLaw
    rms: np.ndarray
    """Root mean square residual of the fit to all, shape (targets,)."""
    rms_left_out: np.ndarray
    """Root mean square error of predictions without the test, shape (targets,); NaN
    where there is no such prediction."""
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
    """Laws scored on the same tests and targets, the best predictor first."""

    study: Study
    """Tests with the targets that were compared."""
    targets_left_out: tuple[str, ...]
    """Targets of the study that are not compared here, since laws of rebound do not
    predict them."""
    laws: list[ScoredLaw]
    by_test: GroupScores
    by_group: list[GroupScores]
    weights: np.ndarray
    """Stacking weights, shape (laws,)."""
    refused: dict[str, str]
    """Laws that could not be fitted, with the reason."""
    with_rebound: "Compared | None" = None
    """The same grounds beside laws of rebound, on the targets that these predict; None
    where all laws are compared on the same targets."""

    @property
    def parts(self) -> tuple["Compared", ...]:
        """This comparison, and that with laws of rebound if it is another one."""
        return (self,) if self.with_rebound is None else (self, self.with_rebound)

    def ranking(self, by: GroupScores | None = None) -> Ranking:
        """Rank the laws, by their predictions of single tests unless others are
        given."""
        scores = (by or self.by_test).scores
        counts, named = zip(*((law.count, law.named) for law in self.laws), strict=True)
        return ranking(scores, counts, named)


class OtherLaws(NamedTuple):
    """Laws beside those of a calibration."""

    simple: tuple[FittedLaw, ...] = ()
    """Simple laws fitted to the same tests; none where they predict no target, or
    cannot be fitted."""
    compared: Compared | None = None
    """Comparison of many laws, where one was asked for."""


NO_OTHERS = OtherLaws()


def check_comparison(
    study: Study, laws: Iterable[Law] | None, by: By
) -> tuple[list[Contender], Study]:
    """Return the laws, and the study with the targets that laws of rebound predict if
    there are any. Raises InputError for laws or columns that cannot be used."""
    contenders = contenders_of(laws, study)
    common = predicted_by_rebound(study)
    if not common and any(contender.is_rebound for contender in contenders):
        if laws is not None:
            raise InputError(
                f"laws of rebound predict none of {', '.join(study.targets)}; name "
                "laws of the ground alone, or measure velocities or coefficients too"
            )
        contenders = [one for one in contenders if not one.is_rebound]
    of_rebound = of_targets(study, common) if common else study
    for one in (study, of_rebound):
        _groups_left_out(one, by)
    return contenders, of_rebound


def compare_study(
    study: Study,
    laws: Iterable[Law] | None = None,
    *,
    by: By = None,
    exact: bool = False,
    fits: Sequence[VariantResult] = (),
) -> Compared:
    """Fit laws to the tests of a study and score their predictions; arguments are those
    of `compare`. Laws of rebound are always fitted to the end.

    Args:
        fits: fits of variants of the study, which are not made again.

    Raises InputError for laws or columns that cannot be used, and where no law can be
    fitted.
    """
    contenders, of_rebound = check_comparison(study, laws, by)
    common = of_rebound.targets
    found, refused = [], {}
    for number, contender in enumerate(contenders, 1):
        own = of_rebound if contender.is_rebound else study
        with within(f"law {number} of {len(contenders)}: "):
            tell(contender.name)
            try:
                fit = _fit(contender, own, fits)
            except InputError as error:
                refused[contender.name] = str(error)
                continue
            found.append(_left_out(contender, fit, by, exact, common))
    if not found:
        raise InputError(f"no law could be fitted: {'; '.join(refused.values())}")
    grounds = [one for one in found if not one.contender.is_rebound]
    if common == study.targets or len(grounds) == len(found):
        return _ranked(study, found, by, refused)
    beside = _ranked(of_rebound, found, by, refused)
    beside = beside._replace(
        targets_left_out=tuple(n for n in study.targets if n not in common)
    )
    if len(grounds) < 2:
        return beside
    return _ranked(study, grounds, by, refused)._replace(with_rebound=beside)


def _fit(contender: Contender, study: Study, fits: Sequence[VariantResult]) -> LawFit:
    """Fit a law, unless it is a variant of the study as it stands."""
    own = (fit for fit in fits if contender.law is fit.variant and not contender.more)
    known = next(own, None)
    if known is None:
        return fit_law(study, contender)
    return law_fit(contender.name, known.objective, known.points)


class LawLeftOut(NamedTuple):
    """A fitted law with its predictions of what was left out."""

    contender: Contender
    fit: LawFit
    by: dict[str, HeldOut]
    """Predictions of each kind of groups; densities of all targets of the law and of
    those that laws of rebound predict."""


def _left_out(
    contender: Contender,
    fit: LawFit,
    by: By,
    exact: bool,
    common: tuple[str, ...],
) -> LawLeftOut:
    """Predict each kind of groups by fits without them."""
    study = fit.objective.study
    sets = np.array([[True] * len(study.targets), [n in common for n in study.targets]])
    predictions = {
        name: held_out(
            *(fit.objective, fit.points, fit.uncertainty, group),
            exact=exact or contender.is_rebound or name != TEST,
            sets=sets,
        )
        for name, _, group in _all_groups(study, by)
    }
    return LawLeftOut(contender, fit, predictions)


def _ranked(
    study: Study,
    found: list[LawLeftOut],
    by: By,
    refused: dict[str, str],
) -> Compared:
    """Score laws on the targets of a study, which all of them predict."""
    scores = []
    for name, names, group in _all_groups(study, by):
        inside = group >= 0
        densities = []
        for one in found:
            # All targets of the law, or those that laws of rebound predict.
            of_set = int(one.fit.objective.study.targets != study.targets)
            density = one.by[name].density[of_set]
            densities.append(np.bincount(group[inside], density[inside]))
        scores.append(GroupScores(name, names, np.stack(densities, axis=1)))
    order = np.argsort(-scores[0].totals, kind="stable")
    scores = [one._replace(scores=one.scores[:, order]) for one in scores]
    return Compared(
        study=study,
        targets_left_out=(),
        laws=[_scored(found[place], study, int(place)) for place in order],
        by_test=scores[0],
        by_group=scores[1:],
        weights=stacking_weights(scores[0].scores),
        refused=refused,
    )


def _scored(one: LawLeftOut, study: Study, named: int) -> ScoredLaw:
    """Collect a law's fit and its predictions of the targets of a study."""
    objective, points = one.fit.objective, one.fit.points
    places = [objective.study.targets.index(name) for name in study.targets]
    left_out = one.by[TEST]
    of_set = int(len(places) < len(objective.study.targets))
    left_out = left_out._replace(
        density=left_out.density[of_set],
        predicted=left_out.predicted[:, places],
        deviation=left_out.deviation[:, places],
    )

    def rms(predicted: np.ndarray) -> np.ndarray:
        there = study.exact & np.isfinite(predicted)
        squares = np.where(there, (predicted - study.measured) ** 2, 0.0)
        # By rows: NumPy adds a single column in another order than one of several.
        sums = np.sum(np.ascontiguousarray(squares.T), axis=1)
        count = np.sum(there, axis=0)
        mean = sums / np.maximum(count, 1)
        return np.where(count > 0, np.sqrt(mean), np.nan)

    count = one.fit.fitted.parameters
    known = objective.study.known
    acts = np.any(points.jacobian[0][known] != 0.0, axis=0)[:count]
    return ScoredLaw(
        contender=one.contender,
        named=named,
        fitted=one.fit.fitted,
        rms=rms(points.predicted[0][:, places]),
        rms_left_out=rms(left_out.predicted),
        left_out=left_out,
        acts=tuple(acts.tolist()),
        bounds_reached=tuple(objective.bounds.bound_reached(points.x[0])[:count]),
    )


def _all_groups(study: Study, by: By) -> list[Groups]:
    group, measured = study.each_test()
    names = tuple(study.tests.name(int(test)) for test in measured)
    return [(TEST, names, group), *_groups_left_out(study, by)]


def _groups_left_out(study: Study, by: By) -> list[Groups]:
    expect("by", by, str, Iterable, type(None))
    if by is None:
        labels = {CAMPAIGN: study.tests.labels[CAMPAIGN], SHAPE: study.tests.shapes}
        known = np.any(study.known, axis=1)
        by = [n for n, texts in labels.items() if len(set(np.array(texts)[known])) > 1]
    return [_groups(study, name) for name in ([by] if isinstance(by, str) else by)]


def _groups(study: Study, name: str) -> Groups:
    """Group the tests by a column. Raises InputError for one that is not there, or has
    one value alone."""
    expect("a column that by names", name, str)
    tests = study.tests
    texts = tests.labels | {SHAPE: tests.shapes}
    if name in texts:
        labels = texts[name]
    elif name in tests.inputs:
        # Of whatever was measured: the groups are the same for laws that predict all of
        # it, and for those that predict a part.
        known = [np.isfinite(values) for values in tests.measured.values()]
        labels = _labels_of_numbers(tests.inputs[name], np.any(known, axis=0))
    else:
        raise InputError(
            f"by names {name!r}, which is no column of the tests; "
            f"{did_you_mean(name, [*texts, *tests.inputs], repr)}",
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


def _labels_of_numbers(values: np.ndarray, measured: np.ndarray) -> list[str]:
    """Label numbers by their value; more than twelve by five ranges of equal count, as
    far as anything was measured."""
    digits = next(n for n in range(6, 18) if _apart(values, n))
    different = np.unique(values[measured])
    if len(different) <= 12:
        return [f"{value:.{digits}g}" for value in values]
    fifths = np.linspace(0.0, 1.0, 6)
    edges = np.unique(np.quantile(values[measured], fifths))
    if len(edges) == 2:  # one value in most tests
        edges = np.quantile(different, fifths)
    place = np.searchsorted(edges, values, side="right") - 1
    place = np.clip(place, 0, len(edges) - 2)
    digits = next(n for n in range(3, 18) if _apart(edges, n))
    names = [f"{edge:.{digits}g}" for edge in edges]
    return [f"{names[p]} to {names[p + 1]}" for p in place]


def _apart(values: np.ndarray, digits: int) -> bool:
    """Tell whether different numbers differ when written with so many digits."""
    different = np.unique(values)
    written = {f"{value:.{digits}g}" for value in different}
    return len(written) == len(different) or digits == 17

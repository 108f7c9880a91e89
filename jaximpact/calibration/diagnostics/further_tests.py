r"""Optimal design: further tests that would tell most about the soil.

A measurement with derivatives J and standard deviation sigma adds

$$ \Delta M = J^T J / \sigma^2 $$

to the information M, the inverse of the covariance. A D-optimal choice maximises
det(M) and so minimises the volume of the error ellipsoid; an A-optimal one minimises
the sum of the variances, trace(M^-1). Tests are chosen one after the other, each the
best after those before it; the same may be chosen again.

Candidates are impacts on a grid, of which one result or all are measured; derivatives
are those at the best fit. The present information is that of the soil's parameters
with the nuisances left free. For a parameter that is not identifiable the bounds
replace data, as a uniform distribution over its range: without them there would be no
covariance to shrink.
"""

from collections.abc import Mapping
from typing import NamedTuple

import jax
import numpy as np
from numpy.typing import ArrayLike

from ..._checks import whole_number
from ...errors import InputError
from ...quantities import CURVE_COLUMNS, InputColumn, columns_of, leaf_places
from ...reports.tables import Table
from ...scene import Scene
from ...shapes import Ellipsoid, EllipticCylinder, each_shape
from ..estimation.linear_algebra import inverse_positive
from ..estimation.sigma import relative_sigma
from ..problem.candidates import (
    COUNT,
    CRITERIA,
    MOST,
    Sigma,
    checked_axes,
    checked_measure,
)
from ..problem.forward_model import ImpactModel
from ..problem.program import ImpactRows, OwnColumn, program_of
from .results import VariantResult
from .uncertainty import regular_covariance

ALL = "all of these"
GUESSED = ("max_penetration_m", "max_normal_force_N")
"""Results assumed measurable to 10 % too, where nothing is said of what can be
measured."""
ALWAYS_POSITIVE = (
    *("max_penetration_m", "max_sinking_m", "max_normal_force_N", "duration_s"),
)
"""Results whose error is relative; others, which pass through zero, have an absolute
one."""
WORTHWHILE = 1.005
"""Gain of a test below which it is not recommended."""


class Suggestion(NamedTuple):
    """One further test."""

    scene: dict[str, float]
    """Values of the quantities in which candidates differ [units of the columns]."""
    measured: str
    """Result column that is measured, or `ALL`."""
    predicted: dict[str, float]
    """Results expected at the best fit."""
    errors: np.ndarray
    """Standard errors in x after this test and those before it, shape (parameters,)."""
    factors: np.ndarray
    """Present standard errors over these, shape (parameters,): 2 is half the error."""
    volume: float
    """Present mean axis (geometric mean) of the error ellipsoid over the new one."""


class Suggestions(NamedTuple):
    """Tests to make next, in order, and the gain of each candidate alone."""

    names: tuple[str, ...]
    """Names of the soil's parameters."""
    criterion: str
    measure: dict[str, Sigma]
    """Results that can be measured, and their errors."""
    fixed: dict[str, float]
    """Values that all candidates share and that are no defaults."""
    now: np.ndarray
    """Present standard errors in x, the bounds a weak prior, shape (parameters,)."""
    undetermined: list[str]
    """Parameters that are not identifiable at present."""
    stood_in: list[str]
    """Parameters whose present error follows from the bounds rather than the data."""
    chosen: list[Suggestion]
    candidates: dict[str, np.ndarray]
    """Scenes of the candidates, shape (candidates,)."""
    ways: tuple[str, ...]
    """What can be measured in a test: result columns, or `ALL`."""
    volumes: np.ndarray
    """Gain of each candidate and way as the next test alone, as `Suggestion.volume`,
    shape (candidates, ways); 1 for no gain."""
    columns: dict[str, InputColumn]
    """Columns of the scene."""
    left_out: int
    """Number of candidates without any result: they fail or separate."""


class Design(NamedTuple):
    """Measurements chosen one after the other."""

    chosen: list[int]
    """Indices of the candidates."""
    covariances: np.ndarray
    """Covariance before and after each choice, shape (choices + 1, parameters,
    parameters)."""


def choose(
    information: np.ndarray, gains: np.ndarray, count: int, criterion: str = "D"
) -> Design:
    """Choose measurements one after the other.

    Args:
        information: present information, positive, shape (parameters, parameters).
        gains: information of each candidate, (candidates, parameters, parameters).
    """
    covariances, chosen = [inverse_positive(information)], []
    for _ in range(count):
        best = int(np.argmax(merit(information, gains, criterion)))
        information = information + gains[best]
        chosen.append(best)
        covariances.append(inverse_positive(information))
    return Design(chosen, np.array(covariances))


def merit(information: np.ndarray, gains: np.ndarray, criterion: str) -> np.ndarray:
    """Compute the gain of each candidate, shape (candidates,).

    It is the fall of the mean logarithm of the ellipsoid's axes (D), or of half the
    logarithm of the sum of variances (A).
    """
    after = information + gains
    if criterion == "D":
        size = len(information)
        before = np.linalg.slogdet(information)[1]
        return (np.linalg.slogdet(after)[1] - before) / (2.0 * size)
    variances = np.trace(inverse_positive(after), axis1=1, axis2=2)
    return 0.5 * np.log(np.trace(inverse_positive(information)) / variances)


def suggest_tests(
    fitted: VariantResult,
    candidates: Mapping[str, ArrayLike] | None = None,
    measure: Mapping[str, float | Sigma] | None = None,
    *,
    together: bool = False,
    count: int = COUNT,
    criterion: str = CRITERIA[0],
) -> Suggestions:
    """Choose further tests that would shrink the uncertainty most.

    Args:
        fitted: a variant of a study, from `fit_study`.
        candidates: quantities of block and impact, named as in the tables, each with
            its values; every combination is a candidate. Other quantities have the
            median of the tests. Default: angles, speeds and, unless the block is a
            sphere, orientations about those of the tests.
        measure: results that can be measured, with their standard deviations. Default:
            the study's targets with the sigmas of the fit, and penetration and force to
            10 %.
        together: whether a test measures all of them, or one.
        count: number of tests.
        criterion: "D" minimises the volume of the error ellipsoid, "A" the sum of the
            variances, both in x: relative for positive parameters.

    Derivatives at the best fit tell nothing of discontinuities, and where the fit is
    far from the truth so is the advice.

    Raises InputError for an unknown quantity, a value out of range, or no sigma.
    """
    if criterion not in CRITERIA:
        raise InputError(f"criterion must be D or A, but is {criterion!r}")
    whole_number("count", count, 1, MOST)
    objective = fitted.objective
    names = tuple(parameter.name for parameter in objective.study.parameters)
    common, columns = _common(fitted), columns_of(objective.scene)
    axes = default_axes(common, objective.scene)
    if candidates:
        axes = checked_axes(candidates, names, columns)
    sigmas = checked_measure(measure) if measure else default_measure(fitted)
    grid = np.meshgrid(*axes.values(), indexing="ij")
    scenes = {n: v.ravel() for n, v in zip(axes, grid, strict=True)}
    predicted, jacobian = _derivatives(fitted, common, scenes, tuple(sigmas))
    gains = _information(sigmas, predicted, jacobian)
    ways = tuple(sigmas)
    if together and len(ways) > 1:
        gains, ways = np.sum(gains, axis=1, keepdims=True), (ALL,)
    soil = len(names)
    inflation = fitted.uncertainty.inflation
    covariance = regular_covariance(objective, fitted.points, inflation)[:soil, :soil]
    information = inverse_positive(covariance)
    flat = gains.reshape(-1, soil, soil)
    design = choose(information, flat, count, criterion)
    now = np.sqrt(np.diag(design.covariances[0]))
    of_bounds = objective.bounds_information[:soil] * now**2
    return Suggestions(
        names=names,
        criterion=criterion,
        measure=sigmas,
        fixed={n: v for n, v in common.items() if n not in scenes},
        now=now,
        undetermined=[v.name for v in fitted.verdicts if not v.determined],
        stood_in=[n for n, p in zip(names, of_bounds, strict=True) if p > 0.5],
        chosen=_chosen(design, scenes, ways, tuple(sigmas), predicted),
        candidates=scenes,
        ways=ways,
        volumes=np.exp(merit(information, flat, "D")).reshape(-1, len(ways)),
        columns=columns,
        left_out=int(np.sum(~np.any(np.isfinite(predicted), axis=1))),
    )


def _information(
    sigmas: dict[str, Sigma], predicted: np.ndarray, jacobian: np.ndarray
) -> np.ndarray:
    """Compute J^T J / sigma^2 of every candidate and result, shape (candidates,
    results, parameters, parameters)."""
    parts = np.array([(sigma.absolute, sigma.relative) for sigma in sigmas.values()])
    spread = np.hypot(parts[:, 0], parts[:, 1] * np.abs(predicted))
    useful = np.isfinite(predicted) & (spread > 0.0)
    rows = jacobian / np.where(useful, spread, 1.0)[..., None]
    rows = np.where(useful[..., None] & np.isfinite(rows), rows, 0.0)
    return rows[..., :, None] * rows[..., None, :]


def _chosen(design: Design, scenes, ways, results, predicted) -> list[Suggestion]:
    """Describe the chosen tests and how the errors shrink with them."""
    errors = np.sqrt(np.einsum("kpp->kp", design.covariances))
    soil = errors.shape[1]
    volumes = np.linalg.slogdet(design.covariances)[1] / (2.0 * soil)
    chosen = []
    for number, best in enumerate(design.chosen, 1):
        candidate, way = divmod(best, len(ways))
        values = zip(results, map(float, predicted[candidate]), strict=True)
        expected = {n: value for n, value in values if ways[way] in (n, ALL)}
        scene = {name: float(values[candidate]) for name, values in scenes.items()}
        volume = float(np.exp(volumes[0] - volumes[number]))
        shrunk = errors[number], errors[0] / errors[number], volume
        chosen.append(Suggestion(scene, ways[way], expected, *shrunk))
    return chosen


def default_axes(common: dict[str, float], scene: Scene) -> dict[str, np.ndarray]:
    """Choose candidate angles, speeds and, unless the block is round, orientations, by
    the median of each quantity of the tests."""
    speed = common.get("speed_mps", columns_of(scene)["speed_mps"].default)
    axes = {
        "angle_deg": np.arange(0.0, 90.0, 15.0),
        "speed_mps": np.array([float(f"{x * speed:.3g}") for x in (0.5, 1.0, 2.0)]),
    }
    is_elliptic = isinstance(scene.block.shape, Ellipsoid | EllipticCylinder)
    if not is_elliptic or common.get("aspect_ratio", 1.0) != 1.0:
        axes["orientation_deg"] = np.arange(0.0, 180.0, 30.0)
    return axes


def default_measure(fitted: VariantResult) -> dict[str, Sigma]:
    """Assume the study's targets with their sigmas, penetration and force to 10 %."""
    study = fitted.objective.study
    measure = {}
    scale = np.sqrt(fitted.uncertainty.inflation)
    fractions = scale * relative_sigma(study, fitted.sigma, fitted.predicted)
    least = study.least_size
    for index, name in enumerate(study.targets):
        if name in CURVE_COLUMNS:
            continue
        if study.proportional[index]:
            fraction = float(fractions[index])
            measure[name] = Sigma(fraction * float(least[index]), fraction)
            continue
        known = study.known[:, index]
        sigma = scale * fitted.sigma[known, index]
        size = np.abs(study.measured[known, index])
        if name in ALWAYS_POSITIVE and np.median(size) > 0.0:
            measure[name] = Sigma(relative=float(np.median(sigma) / np.median(size)))
        else:
            measure[name] = Sigma(absolute=float(np.median(sigma)))
    guessed = (name for name in GUESSED if name not in measure)
    return measure | {name: Sigma(relative=0.1) for name in guessed}


def _common(fitted: VariantResult) -> dict[str, float]:
    """Compute the median of each stated quantity of the tests with a measurement, a
    curve as one; nuisances as fitted."""
    study = fitted.objective.study
    known = columns_of(fitted.objective.scene)
    soil, inputs = study.soil | fitted.variant.soil, study.tests.inputs
    values = {name: value for name, value in soil.items() if name in known}
    _, measured = study.each_test()
    values |= {
        n: float(np.median(v[measured])) for n, v in inputs.items() if n in known
    }
    first = len(study.parameters)
    for nuisance in study.nuisances:
        fit = fitted.parameters[first : first + len(nuisance.groups)]
        first += len(nuisance.groups)
        if nuisance.pooled:
            continue  # the logarithm of a factor on a fitted parameter
        of_tests = nuisance.base + fit[nuisance.group]
        values[nuisance.name] = float(np.median(of_tests[measured]))
    return values


def _derivatives(fitted: VariantResult, common, scenes, targets):
    """Compute predictions (candidates, targets) and their derivatives with respect to
    the soil's x (candidates, targets, parameters)."""
    objective = fitted.objective
    study, soil = objective.study, len(objective.study.parameters)
    count, columns = len(next(iter(scenes.values()))), columns_of(objective.scene)
    alone, leaves = _most_frequent(objective.scene)
    places = leaf_places(alone)
    leaves = np.repeat(leaves[:, None], count, axis=1)
    values = {n: c.default for n, c in columns.items()} | common | scenes
    for name, place in places.items():
        leaves[place] = columns[name].factor * np.asarray(values[name], float)
    program = program_of(
        jax.tree.structure(alone),
        leaves,
        [OwnColumn(p.name, columns[p.name].factor, False) for p in study.parameters],
        [(tied, columns[tied.name].factor) for tied in study.tied],
        ImpactModel(targets),
    )
    rows = ImpactRows(
        np.tile(fitted.parameters[:soil], (count, 1)),
        leaves[program.varied].T,
        np.empty((count, 0)),
    )
    predicted, _, slopes = program.run(rows, objective.accuracy, derivatives=True)
    return predicted, slopes * objective.bounds.slope(fitted.points.x[0])[:soil]


def _most_frequent(scene: Scene) -> tuple[Scene, np.ndarray]:
    """Find the most frequent shape of the tests, as their scene with that shape alone,
    and the most frequent value of each leaf."""
    alone = max(
        (one for one, _ in each_shape(scene)), key=lambda s: len(s.impact.speed)
    )
    each = [np.unique(x, return_counts=True) for x in jax.tree.leaves(alone)]
    return alone, np.array([values[np.argmax(counts)] for values, counts in each])


def as_table(advice: Suggestions) -> Table:
    """Write the chosen tests as a table."""
    errors = (f"error of {name}" for name in advice.names)
    columns = ("test", *advice.candidates, "measured", *errors, "mean")
    now = [f"{100 * error:.3g} %" for error in advice.now]
    present = dict(zip(advice.names, now, strict=True))
    present |= dict.fromkeys(advice.undetermined, "not identifiable")
    rows = [("now", *("" for _ in advice.candidates), "", *present.values(), "")]
    for number, one in enumerate(advice.chosen, 1):
        errors = [
            f"{100 * error:.3g} % (1/{factor:.3g})"
            for error, factor in zip(one.errors, one.factors, strict=True)
        ]
        scene = [f"{value:g}" for value in one.scene.values()]
        measured = one.measured
        if measured in one.predicted:
            measured += f" (expected {one.predicted[measured]:.3g})"
        rows.append((f"+ {number}", *scene, measured, *errors, f"1/{one.volume:.3g}"))
    return Table(columns, rows)


def in_words(advice: Suggestions) -> list[str]:
    """Recommend the next test, and state the assumptions of the advice."""
    lines = []
    first = advice.chosen[0]
    where = ", ".join(f"{name} {value:g}" for name, value in first.scene.items())
    what = "everything listed" if first.measured == ALL else first.measured
    if first.volume < WORTHWHILE:
        lines.append(
            "The best of these tests would shrink the errors by less than "
            f"{100 * (WORTHWHILE - 1.0):.1g} % in the mean."
        )
    else:
        shrunk = [
            f"that of {advice.names[index]} by {first.factors[index]:.3g}"
            for index in np.argsort(-first.factors)
            if first.factors[index] >= 1.05
        ]
        effect = "It shrinks no single error by more than 5 %"
        if shrunk:
            plural = "s" * (len(shrunk) > 1)
            effect = f"It divides the standard error{plural}: {', '.join(shrunk)}"
        lines.append(f"The next test: {where}, measuring {what}. {effect}.")
    measured = ", ".join(f"{name} to {sigma}" for name, sigma in advice.measure.items())
    lines.append(f"Assumed measurable: {measured}.")
    if advice.undetermined:
        names = ", ".join(advice.undetermined)
        verb = "is" if len(advice.undetermined) == 1 else "are"
        lines.append(
            f"{names} {verb} not identifiable from these tests, and the best fit may "
            "be far from the truth along them; the advice holds for a soil like the "
            "best fit."
        )
    if advice.stood_in:
        lines.append(
            f"For {', '.join(advice.stood_in)} the bounds replace data, as a uniform "
            "distribution over the range: gains depend on how wide they are."
        )
    if advice.left_out:
        lines.append(
            f"{advice.left_out} of {len(advice.volumes)} candidates have no result and "
            "are left out."
        )
    return lines


def as_text(advice: Suggestions) -> str:
    """Write table and advice as text."""
    return "\n".join([as_table(advice).text(), "", *in_words(advice)]) + "\n"

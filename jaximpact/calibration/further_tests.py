"""Which further test would tell most about the soil.

Candidates are impacts on a grid, each measured in one way or in all; what a measurement
adds is its information at the best fit (`design`). The present information is that of
the soil's parameters, nuisances left free. Where the data do not determine a parameter
the bounds stand in for them, as a uniform distribution over their range: without them
there would be no covariance to shrink.
"""

from collections.abc import Mapping
from typing import NamedTuple

import jax
import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError
from ..fields import whole_number
from ..formats.align import align
from ..formats.columns import InputColumn, columns_of, leaf_places
from ..scene import Scene
from ..shapes import Ellipsoid, EllipticCylinder
from .candidates import COUNT, MOST, Sigma, checked_axes, checked_measure
from .design import CRITERIA, choose, merit
from .proportional import least_size
from .scatter import part_of_size
from .study import VariantResult
from .turned_ground import SIGN
from .uncertainty import bounds_information, regular_covariance

ALL = "all of these"
GUESSED = ("max_penetration_m", "max_normal_force_N")
"""Taken to be measured too, with a relative error of `GUESSED_ERROR`, where nothing is
said of what could be."""
GUESSED_ERROR = 0.1
ALWAYS_POSITIVE = (
    *("max_penetration_m", "max_sinking_m", "max_normal_force_N", "duration_s"),
)
"""Results whose error grows with them. Of others, which pass zero, it is absolute."""
SPEEDS = (0.5, 1.0, 2.0)
"""Of those candidates, in units of the tests' median."""
ANGLES = (0.0, 15.0, 30.0, 45.0, 60.0, 75.0)
ORIENTATIONS = (0.0, 30.0, 60.0, 90.0, 120.0, 150.0)
STANDS_IN = 0.5
"""Part of the variance that the bounds take away, above which they are said to stand in
for data."""


class Suggestion(NamedTuple):
    """One further test."""

    scene: dict[str, float]
    """What the candidates differ in, in the units of the columns."""
    measured: str
    """A result column, or `ALL`."""
    predicted: dict[str, float]
    """What the best fit expects to be measured."""
    errors: np.ndarray
    """Standard errors in x after it and those before it, `(parameters,)`."""
    factors: np.ndarray
    """By which each of them has shrunk since the present, likewise: 2 is half."""
    volume: float
    """Likewise of the mean axis of the ellipsoid of errors (geometric mean)."""


class Suggestions(NamedTuple):
    """The tests to make next, in order, and what each candidate would bring alone."""

    names: tuple[str, ...]
    """Of the soil's parameters."""
    criterion: str
    measure: dict[str, Sigma]
    fixed: dict[str, float]
    """What the candidates have in common and the defaults have not."""
    now: np.ndarray
    """Standard errors in x, the bounds a weak prior, `(parameters,)`."""
    undetermined: list[str]
    """Parameters that the data do not determine at present."""
    stood_in: list[str]
    """Parameters whose present error the bounds give rather than the data."""
    chosen: list[Suggestion]
    candidates: dict[str, np.ndarray]
    """Scenes, `(candidates,)`."""
    ways: tuple[str, ...]
    """To measure: result columns, or `ALL`."""
    volumes: np.ndarray
    """What each candidate, measured in each way, brings as the next test alone: factor
    by which the mean axis shrinks, `(candidates, ways)`; 1 for nothing."""
    columns: dict[str, InputColumn]
    """Of the scene."""
    left_out: int
    """Candidates without any result: they fail or separate."""


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
            its values; every combination is a candidate. All else is the tests' median.
            None for angles, speeds and, of a block that is no sphere, orientations
            about those of the tests.
        measure: results that could be measured, with their standard deviations. None
            for the study's targets, with the sigmas of the fit, and depth and force to
            10 %.
        together: whether a test measures all of them; else one.
        count: tests to be chosen, one after the other.
        criterion: "D" for the smallest ellipsoid of errors, "A" for the least sum of
            variances, both in x: relative for positive parameters.

    The derivatives are those at the best fit, all from one call of the machine code.
    They say nothing of jumps, and where the fit is far off so is the advice.

    Raises InputError for an unknown quantity, a value out of range, or no sigma.
    """
    if criterion not in CRITERIA:
        raise InputError(f"criterion must be D or A, but is {criterion!r}")
    whole_number("count", count, 1, MOST)
    objective, points = fitted.objective, fitted.points
    inflation = fitted.uncertainty.inflation
    names = tuple(parameter.name for parameter in objective.study.parameters)
    common, columns = _common(fitted), columns_of(objective.scene)
    axes = (
        checked_axes(candidates, names, columns)
        if candidates
        else default_axes(common, objective.scene)
    )
    sigmas = checked_measure(measure) if measure else default_measure(fitted)
    grid = np.meshgrid(*axes.values(), indexing="ij")
    scenes = {n: v.ravel() for n, v in zip(axes, grid, strict=True)}
    predicted, jacobian = _derivatives(fitted, common, scenes, tuple(sigmas))
    # (candidates, targets, parameters, parameters)
    spread = np.stack(
        [
            np.hypot(sigma.absolute, sigma.relative * np.abs(predicted[:, place]))
            for place, sigma in enumerate(sigmas.values())
        ],
        axis=1,
    )
    useful = np.isfinite(predicted) & (spread > 0.0)
    rows = jacobian / np.where(useful, spread, 1.0)[..., None]
    rows = np.where(useful[..., None] & np.isfinite(rows), rows, 0.0)
    gains = rows[..., :, None] * rows[..., None, :]
    ways = tuple(sigmas)
    if together and len(ways) > 1:
        gains, ways = np.sum(gains, axis=1, keepdims=True), (ALL,)
    soil = len(names)
    covariance = regular_covariance(objective, points, inflation)[:soil, :soil]
    information = np.linalg.inv(covariance)
    flat = gains.reshape(-1, soil, soil)
    design = choose(information, flat, count, criterion)
    errors = np.sqrt(np.einsum("kpp->kp", design.covariances))
    volumes = np.linalg.slogdet(design.covariances)[1] / (2.0 * soil)
    chosen = []
    for place, best in enumerate(design.chosen, 1):
        candidate, way = divmod(best, len(ways))
        chosen.append(
            Suggestion(
                {name: float(values[candidate]) for name, values in scenes.items()},
                ways[way],
                {
                    name: float(value)
                    for name, value in zip(sigmas, predicted[candidate], strict=True)
                    if ways[way] in (name, ALL)
                },
                errors[place],
                errors[0] / errors[place],
                float(np.exp(volumes[0] - volumes[place])),
            )
        )
    of_bounds = bounds_information(objective)[:soil] * errors[0] ** 2
    return Suggestions(
        names=names,
        criterion=criterion,
        measure=sigmas,
        fixed={n: v for n, v in common.items() if n not in scenes},
        now=errors[0],
        undetermined=[v.name for v in fitted.verdicts if not v.determined],
        stood_in=[n for n, p in zip(names, of_bounds, strict=True) if p > STANDS_IN],
        chosen=chosen,
        candidates=scenes,
        ways=ways,
        volumes=np.exp(merit(information, flat, "D")).reshape(-1, len(ways)),
        columns=columns,
        left_out=int(np.sum(~np.any(np.isfinite(predicted), axis=1))),
    )


def default_axes(common: dict[str, float], scene: Scene) -> dict[str, np.ndarray]:
    """Angles, speeds and, of a block that is not round, orientations about those of the
    tests.

    Args:
        common: what the tests have in common, or are about.
        scene: the tests.
    """
    speed = common.get("speed_mps", columns_of(scene)["speed_mps"].default)
    axes = {
        "angle_deg": np.array(ANGLES),
        "speed_mps": np.array([float(f"{part * speed:.3g}") for part in SPEEDS]),
    }
    is_elliptic = isinstance(scene.block.shape, Ellipsoid | EllipticCylinder)
    if not is_elliptic or common.get("aspect_ratio", 1.0) != 1.0:
        axes["orientation_deg"] = np.array(ORIENTATIONS)
    return axes


def default_measure(fitted: VariantResult) -> dict[str, Sigma]:
    """The study's targets, measured as well as they were; depth and force to 10 %."""
    study = fitted.objective.study
    measure = {}
    scale = np.sqrt(fitted.uncertainty.inflation)
    parts = scale * part_of_size(study, fitted.sigma, fitted.predicted)
    least = least_size(study.measured)
    for place, name in enumerate(study.targets):
        if study.proportional[place]:
            part = float(parts[place])
            measure[name] = Sigma(part * float(least[place]), part)
            continue
        known = study.known[:, place]
        sigma = scale * fitted.sigma[known, place]
        size = np.abs(study.measured[known, place])
        if name in ALWAYS_POSITIVE and np.median(size) > 0.0:
            measure[name] = Sigma(relative=float(np.median(sigma) / np.median(size)))
        else:
            measure[name] = Sigma(absolute=float(np.median(sigma)))
    return measure | {
        name: Sigma(relative=GUESSED_ERROR) for name in GUESSED if name not in measure
    }


def _common(fitted: VariantResult) -> dict[str, float]:
    """The tests' median of each quantity that any of them has, nuisances as fitted."""
    study = fitted.objective.study
    known = columns_of(fitted.objective.scene)
    values = {
        name: value
        for name, value in (study.soil | fitted.variant.soil).items()
        if name in known
    }
    values |= {n: float(np.median(v)) for n, v in study.tests.inputs.items()}
    first = len(study.parameters)
    for nuisance in study.nuisances:
        fit = fitted.parameters[first : first + len(nuisance.groups)]
        values[nuisance.name] = float(np.median(nuisance.base + fit[nuisance.group]))
        for name, sign in SIGN.items() if nuisance.turns_ground else ():
            stated = study.tests.inputs.get(name, known[name].default)
            turned = stated + sign * fit[nuisance.group]
            values[name] = float(np.median(turned))
        first += len(nuisance.groups)
    return values


def _derivatives(fitted: VariantResult, common, scenes, targets):
    """Predictions `(candidates, targets)` and their derivatives by the soil's x."""
    objective = fitted.objective
    study, bounds = objective.study, objective.bounds
    names = [parameter.name for parameter in study.parameters]
    count = len(next(iter(scenes.values())))
    engine = objective.engine.for_targets(targets)
    columns, places = columns_of(objective.scene), leaf_places(objective.scene)
    values = {n: c.default for n, c in columns.items()} | common
    values |= dict(zip(names, fitted.parameters, strict=False)) | scenes
    leaves = np.repeat(_commonest(objective.scene)[:, None], count, axis=1)
    for name, column in columns.items():
        leaves[places[name]] = column.factor * np.asarray(values[name], float)
    directions = np.zeros((len(leaves), len(names), count))
    for place, name in enumerate(names):
        directions[places[name], place] = columns[name].factor
    predicted, derivatives, _ = engine.run(
        np.tile(leaves, (1, len(names))),
        directions.reshape(len(leaves), -1),
        objective.accuracy,
    )
    slope = bounds.slope(fitted.points.x[0])[: len(names)]
    derivatives = derivatives.reshape(len(names), count, len(targets))
    jacobian = np.moveaxis(derivatives, 0, -1) * slope
    return predicted[:count], jacobian


def _commonest(scene: Scene) -> np.ndarray:
    """Of each leaf of the tests' scene the value that most of them have: which shape,
    where there are several, is no quantity with a median."""
    found = []
    for leaf in jax.tree.leaves(scene):
        values, counts = np.unique(np.asarray(leaf), return_counts=True)
        found.append(values[np.argmax(counts)])
    return np.array(found)


def as_rows(found: Suggestions) -> list[tuple[str, ...]]:
    """The tests chosen as a table, its head first."""
    errors = (f"error of {name}" for name in found.names)
    rows = [("test", *found.candidates, "measured", *errors, "mean")]
    present = [
        "not determined" if name in found.undetermined else f"{100 * error:.3g} %"
        for name, error in zip(found.names, found.now, strict=True)
    ]
    rows.append(("now", *("" for _ in found.candidates), "", *present, ""))
    for number, one in enumerate(found.chosen, 1):
        errors = [
            f"{100 * error:.3g} % (1/{factor:.3g})"
            for error, factor in zip(one.errors, one.factors, strict=True)
        ]
        scene = [f"{value:g}" for value in one.scene.values()]
        measured = one.measured
        if measured in one.predicted:
            measured += f" (expected {one.predicted[measured]:.3g})"
        rows.append((f"+ {number}", *scene, measured, *errors, f"1/{one.volume:.3g}"))
    return rows


def in_words(found: Suggestions) -> list[str]:
    """What to do next, and what the advice rests on."""
    lines = []
    first = found.chosen[0]
    where = ", ".join(f"{name} {value:g}" for name, value in first.scene.items())
    what = first.measured
    if what == ALL:
        what = "everything listed"
    if first.volume < 1.005:
        lines.append("No candidate would tell anything more.")
    else:
        order = np.argsort(-first.factors)
        shrunk = [
            f"that of {found.names[place]} by {first.factors[place]:.3g}"
            for place in order
            if first.factors[place] >= 1.05
        ]
        effect = (
            f"It divides the standard error{'s: ' if len(shrunk) > 1 else ': '}"
            + ", ".join(shrunk)
            if shrunk
            else "It shrinks no single error by more than 5 %"
        )
        lines.append(f"The next test: {where}, measuring {what}. {effect}.")
    measured = ", ".join(f"{name} to {sigma}" for name, sigma in found.measure.items())
    lines.append(f"Taken as measurable: {measured}.")
    if found.undetermined:
        lines.append(
            f"The data do not determine {', '.join(found.undetermined)}, and the best "
            "fit may lie far from the truth along them; the advice is that for a soil "
            "like the best fit."
        )
    if found.stood_in:
        lines.append(
            f"For {', '.join(found.stood_in)} the bounds stand in for data, as a "
            "uniform distribution over their range: gains depend on how wide they are."
        )
    if found.left_out:
        lines.append(
            f"{found.left_out} of {len(found.volumes)} candidates have no result and "
            "are left out."
        )
    return lines


def as_text(found: Suggestions) -> str:
    """Table and words."""
    return "\n".join([align(as_rows(found)), "", *in_words(found)]) + "\n"

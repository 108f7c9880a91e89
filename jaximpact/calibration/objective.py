"""What is made small: the losses of all measurements, and of the priors.

The unknowns x are the coordinates of the soil's parameters, then of the nuisances,
group by group. Many x are taken at once; each is a lane.
"""

import copy
import dataclasses
import functools
from collections.abc import Callable
from typing import NamedTuple

import jax
import numpy as np

from ..accuracy import PRESETS, Accuracy
from ..formats.columns import columns_of, leaf_places
from ..identity import described
from ..mechanics.model import PLANAR, PLANAR_DAMPED
from ..mechanics.problem import Assembly
from ..parameters import parameters_of
from ..scene import Scene
from .engine import Engine
from .losses import losses
from .nuisance import SLOPE
from .study_file import Study, Variant
from .transforms import Bounds
from .turned_ground import ANGLE, SIGN, as_stated, needed

FAILED_COST = 5e5
"""Stands, with derivative zero, for the loss of a result that could not be computed:
large, so that a fit keeps away, and finite, so that it does not spoil the rest."""
AT_ONCE = 50_000
"""Impacts between two lines of progress: bounds time and memory."""
STEEPEST = 1e100
"""Derivatives above, whose squares could overflow, tell nothing."""


class Points(NamedTuple):
    """The objective at x `(lanes, unknowns)`."""

    x: np.ndarray
    cost: np.ndarray
    """`(lanes,)`: weighted losses, with half the squares of the priors' residuals."""
    gradient: np.ndarray
    """`(lanes, unknowns)`"""
    hessian: np.ndarray
    """`(lanes, unknowns, unknowns)`, by Gauss and Newton: never negative."""
    predicted: np.ndarray
    """`(lanes, tests, targets)`, NaN where there is no prediction."""
    outcomes: np.ndarray
    """Codes, `(lanes, tests)`."""
    jacobian: np.ndarray
    """Of the predictions by x, `(lanes, tests, targets, unknowns)`; 0 where there is no
    prediction, and by what was not wanted."""

    def take(self, chosen) -> "Points":
        """Some of the lanes."""
        return Points(*(part[chosen] for part in self))

    def put(self, chosen, points: "Points") -> "Points":
        """The lanes with some of them replaced."""
        replaced = []
        for old, new in zip(self, points, strict=True):
            old = old.copy()
            old[chosen] = new
            replaced.append(old)
        return Points(*replaced)


class Objective:
    """The objective of one variant of a study.

    Args:
        study, variant: what is fitted to what.
        engine: of the study, see `engine_of`.
        accuracy: of the impacts, instead of the study's.
    """

    def __init__(
        self,
        study: Study,
        variant: Variant,
        engine: Engine,
        accuracy: Accuracy | None = None,
    ):
        self.study, self.engine = study, engine
        self.accuracy = accuracy or PRESETS[study.accuracy]
        self.sigma, self.loss = study.sigma, study.loss
        self.bounds = bounds_of(study)
        self.scene = study.scene_of(variant)
        self._places = leaf_places(self.scene)
        self._leaves = np.stack([np.asarray(x) for x in jax.tree.leaves(self.scene)])
        self.prior_mean, self.prior_sd = _priors(study)
        self._kinds = _kinds(study, self.scene)
        self.memory = None
        """Where fits of it are kept, a `Memory`, if anywhere."""

    @functools.cached_property
    def laws(self) -> tuple | None:
        """All that its values depend on of laws and shapes, but for their numbers; None
        if the source of one is not known."""
        return described(self.scene)

    def depends_on(self) -> tuple:
        """Numbers and names that its values depend on."""
        study = self.study
        arrays = self._leaves, self.sigma, study.measured, study.censored
        arrays += study.weights, self.prior_mean, self.prior_sd, *self.bounds
        arrays += tuple(part for kind in self._kinds for part in kind)
        return *arrays, study.targets, self.loss, self.accuracy, self.laws

    def at(self, accuracy: Accuracy) -> "Objective":
        """The same, with impacts of another accuracy."""
        return self._changed(accuracy=accuracy)

    def with_sigma(self, sigma: np.ndarray) -> "Objective":
        """The same, with other sigmas, `(tests, targets)`."""
        return self._changed(sigma=sigma)

    def without(self, tests: np.ndarray) -> "Objective":
        """The same, the measurements of some tests left out; they are still predicted.

        Args:
            tests: which, `(tests,)`.
        """
        left = np.where(tests[:, None], np.nan, self.study.measured)
        return self._changed(study=dataclasses.replace(self.study, measured=left))

    def of_tests(self, tests: np.ndarray) -> "Objective":
        """The same of some tests alone, to be fitted: its study holds their numbers,
        but still names all."""
        study = self.study
        nuisances = (
            dataclasses.replace(n, group=n.group[tests], base=n.base[tests])
            for n in study.nuisances
        )
        part = dataclasses.replace(
            study,
            measured=study.measured[tests],
            censored=study.censored[tests],
            sigma=study.sigma[tests],
            nuisances=tuple(nuisances),
        )
        kinds = [
            kind._replace(base=kind.base[tests], unknown=kind.unknown[tests])
            for kind in self._kinds
        ]
        leaves, sigma = self._leaves[:, tests], self.sigma[tests]
        return self._changed(study=part, sigma=sigma, _leaves=leaves, _kinds=kinds)

    def _changed(self, **changed) -> "Objective":
        other = copy.copy(self)
        vars(other).update(changed)
        return other

    def __call__(self, x: np.ndarray, free: np.ndarray | None = None) -> Points:
        """The objective at x.

        Args:
            x: `(lanes, unknowns)`, within the bounds.
            free: by which unknowns derivatives are wanted, likewise; None for all.
        """
        x = np.asarray(x, float)
        return self.weigh(x, *self._predict(x, self._wanted(x, free)))

    def values(self, x: np.ndarray) -> Points:
        """The objective at x without derivatives: they are 0."""
        x = np.asarray(x, float)
        leaves, turn = self._impacts(x)
        impacts = leaves.reshape(len(leaves), -1)
        values, outcomes = self.engine.run_values(impacts, self.accuracy)
        nothing = np.zeros_like(values)
        directions = np.zeros_like(impacts)
        values, _ = self._as_stated(values, nothing, turn.ravel(), impacts, directions)
        predicted = values.reshape(len(x), *self.study.measured.shape)
        jacobian = np.zeros((*predicted.shape, x.shape[1]))
        return self.weigh(x, predicted, outcomes.reshape(turn.shape), jacobian)

    def values_by_parts(
        self, x: np.ndarray, progress: Callable[[str], None]
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Costs, predictions and outcomes of `values`, some lanes at a time.

        Args:
            progress: called with "so many of so many" before each part.
        """
        at_once = max(1, AT_ONCE // len(self.study.measured))
        parts = []
        for first in range(0, len(x), at_once):
            progress(f"{first} of {len(x)}")
            points = self.values(x[first : first + at_once])
            parts.append((points.cost, points.predicted, points.outcomes))
        cost, predicted, outcomes = map(np.concatenate, zip(*parts, strict=True))
        return cost, predicted, outcomes

    def glance(self, x: np.ndarray, free: np.ndarray) -> Points:
        """The objective at x, with no more derivatives than come with its value: one
        run. To be made whole by `complete`."""
        wanted = self._wanted(x, free)
        first = np.cumsum(wanted, axis=0) == 1
        return self.weigh(x, *self._predict(x, wanted & first))

    def complete(self, points: Points, free: np.ndarray) -> Points:
        """Points of `glance` with all their derivatives."""
        wanted = self._wanted(points.x, free)
        rest = wanted & (np.cumsum(wanted, axis=0) > 1)
        if not np.any(rest):
            return points
        chosen = np.any(rest, axis=0)
        _, _, more = self._predict(points.x[chosen], rest[:, chosen])
        jacobian = points.jacobian.copy()
        jacobian[chosen] += more
        return self.reweigh(points._replace(jacobian=jacobian))

    def _wanted(self, x, free) -> np.ndarray:
        """Which kinds of unknowns are to be run, `(kinds, lanes)`: those of which one
        is free, and for every lane one."""
        if free is None:
            return np.ones((len(self._kinds), len(x)), bool)
        wanted = np.stack([np.any(free[:, k.unknown], axis=1) for k in self._kinds])
        wanted[0] |= ~np.any(wanted, axis=0)
        return wanted

    def weigh(self, x, predicted, outcomes, jacobian) -> Points:
        """The objective, of predictions that are there."""
        study = self.study
        known = study.known
        computed = np.isfinite(predicted)
        u = np.where(computed & known, (predicted - study.measured) / self.sigma, 0.0)
        of = losses(u, np.broadcast_to(study.censored, u.shape), self.loss)
        weights = np.where(known, study.weights, 0.0)
        used = np.where(computed, weights, 0.0)
        cost = np.sum(np.where(computed, of.value, FAILED_COST) * weights, axis=(1, 2))
        rows = jacobian / self.sigma[..., None]
        slope, curvature = used * of.slope, used * of.curvature
        gradient = np.einsum("lrt,lrtp->lp", slope, rows)
        hessian = np.einsum("lrtp,lrtq->lpq", rows * curvature[..., None], rows)
        apart = (self.bounds.parameter(x) - self.prior_mean) / self.prior_sd
        by_x = self.bounds.slope(x) / self.prior_sd
        cost = cost + 0.5 * np.sum(apart**2, axis=1)
        gradient = gradient + apart * by_x
        places = np.arange(x.shape[1])
        hessian[:, places, places] += by_x**2
        return Points(x, cost, gradient, hessian, predicted, outcomes, jacobian)

    def reweigh(self, points: Points) -> Points:
        """Points of an objective that differs in its sigmas."""
        return self.weigh(points.x, points.predicted, points.outcomes, points.jacobian)

    def failed(self, predicted: np.ndarray) -> np.ndarray:
        """Where a measurement has no prediction."""
        return self.study.known & ~np.isfinite(predicted)

    def variance(self, cost) -> np.ndarray:
        """s^2, twice the cost over the degrees of freedom."""
        study = self.study
        freedom = np.sum(study.known & (study.censored == 0)) - len(study.parameters)
        return 2.0 * np.asarray(cost) / max(int(freedom), 1)

    def unit(self, cost) -> np.ndarray:
        """s^2 and at least 1: in which differences of costs are told."""
        return np.maximum(1.0, self.variance(cost))

    def prior_information(self, x: np.ndarray) -> np.ndarray:
        """What the priors say about each unknown, `(unknowns,)`, at one x."""
        return (self.bounds.slope(x) / self.prior_sd) ** 2

    def _impacts(self, x) -> tuple[np.ndarray, np.ndarray]:
        """Leaves of the scenes `(leaves, lanes, tests)`, and by how much the ground of
        each test is turned [rad]."""
        p = self.bounds.parameter(x)
        leaves = np.repeat(self._leaves[:, None], len(x), axis=1)
        turn = np.zeros(leaves.shape[1:])
        for kind in self._kinds:
            leaves[kind.leaf] = kind.factor * (kind.base + p[:, kind.unknown])
            if kind.turns_ground:
                turn += kind.factor * p[:, kind.unknown]
        for name, sign in SIGN.items():
            leaves[self._places[name]] += sign * turn
        return leaves, turn

    def _predict(self, x, wanted):
        """Predictions, outcomes and the Jacobian."""
        study = self.study
        lanes, tests, targets = len(x), *study.measured.shape
        leaves, turn = self._impacts(x)
        by_x = self.bounds.slope(x)
        runs, of_lane = np.nonzero(wanted)
        impacts = leaves[:, of_lane].reshape(len(leaves), -1)
        directions = np.zeros((len(leaves), len(runs), tests))
        for run, kind in enumerate(self._kinds):
            directions[kind.leaf, runs == run] = kind.factor
            for name, sign in SIGN.items() if kind.turns_ground else ():
                directions[self._places[name], runs == run] = sign * kind.factor
        directions = directions.reshape(len(leaves), -1)
        values, derivatives, outcomes = self.engine.run(
            impacts, directions, self.accuracy
        )
        values, derivatives = self._as_stated(
            values, derivatives, turn[of_lane].ravel(), impacts, directions
        )
        values = values.reshape(len(runs), tests, targets)
        derivatives = derivatives.reshape(len(runs), tests, targets)
        # Where an outcome changes a derivative may have no bound; its square is worse.
        told = np.isfinite(values) & (np.abs(derivatives) < STEEPEST)
        derivatives = np.where(told, derivatives, 0.0)
        predicted = np.empty((lanes, tests, targets))
        predicted[of_lane] = values
        codes = np.empty((lanes, tests))
        codes[of_lane] = outcomes.reshape(len(runs), tests)
        jacobian = np.zeros((lanes, tests, targets, x.shape[1]))
        each = np.arange(tests)
        for run, kind in enumerate(self._kinds):
            here = of_lane[runs == run]
            column = derivatives[runs == run] * by_x[here][:, kind.unknown][..., None]
            # Each test knows one group alone.
            jacobian[here[:, None], each, :, kind.unknown] = column
        return predicted, codes, jacobian

    def _as_stated(self, values, derivatives, turn, impacts, directions):
        """Results and their derivatives along the axes that the tests are stated in.

        Args:
            turn: of the ground, `(impacts,)`.
            impacts, directions: leaves of the scenes and their derivatives, `(leaves,
                impacts)`.
        """
        if not any(kind.turns_ground for kind in self._kinds):
            return values, derivatives
        speed, angle, slope = (self._places[n] for n in ("speed_mps", ANGLE, SLOPE))
        # No two nuisances change the slope.
        return as_stated(
            self.study.targets,
            values,
            derivatives,
            (turn, directions[slope]),
            (impacts[speed], directions[speed]),
            impacts[angle] - turn,
        )


class _Kind(NamedTuple):
    """Unknowns that stand for one column of the scene."""

    leaf: int
    factor: float
    base: np.ndarray
    unknown: np.ndarray
    """Place of each test's unknown, `(tests,)`."""
    turns_ground: bool = False


def _kinds(study: Study, scene: Scene) -> list[_Kind]:
    tests, columns, places = len(study.tests), columns_of(scene), leaf_places(scene)
    kinds = [
        _Kind(
            places[parameter.name],
            columns[parameter.name].factor,
            np.zeros(tests),
            np.full(tests, place),
        )
        for place, parameter in enumerate(study.parameters)
    ]
    first = len(kinds)
    for nuisance in study.nuisances:
        factor, leaf = columns[nuisance.name].factor, places[nuisance.name]
        unknown, turns = first + nuisance.group, nuisance.turns_ground
        kinds.append(_Kind(leaf, factor, nuisance.base, unknown, turns))
        first += len(nuisance.groups)
    return kinds


def _priors(study: Study) -> tuple[np.ndarray, np.ndarray]:
    """Means and standard deviations of the priors, the latter infinite for none."""
    mean = [p.prior.mean if p.prior else 0.0 for p in study.parameters]
    sd = [p.prior.sd if p.prior else np.inf for p in study.parameters]
    for nuisance in study.nuisances:
        mean += [nuisance.prior.mean] * len(nuisance.groups)
        sd += [nuisance.prior.sd] * len(nuisance.groups)
    return np.array(mean), np.array(sd)


def bounds_of(study: Study) -> Bounds:
    """Ranges of a study's unknowns."""
    soil, nuisances = study.parameters, study.nuisances
    lower = [p.lower for p in soil], *(n.lower for n in nuisances)
    upper = [p.upper for p in soil], *(n.upper for n in nuisances)
    groups = sum(len(nuisance.groups) for nuisance in nuisances)
    logarithmic = [p.logarithmic for p in soil] + [False] * groups
    return Bounds(
        np.concatenate(lower), np.concatenate(upper), np.array(logarithmic, bool)
    )


def start_of(study: Study) -> np.ndarray:
    """The x that a study gives to start from."""
    means = [[n.prior.mean] * len(n.groups) for n in study.nuisances]
    given = np.concatenate([[p.start for p in study.parameters], *means])
    return bounds_of(study).coordinate(given)


def names_of(study: Study) -> list[str]:
    """What the unknowns are called."""
    names = [parameter.name for parameter in study.parameters]
    for nuisance in study.nuisances:
        names += [nuisance.label(place) for place in range(len(nuisance.groups))]
    return names


def engine_of(study: Study) -> Engine:
    """The engine for the first variant of a study, and all that have its laws."""
    return engines_of(study)[0]


def engines_of(study: Study) -> list[Engine]:
    """The engine for each variant of a study; those with the same laws share one."""
    scenes = [study.scene_of(variant) for variant in study.variants]
    soils = [scene.soil for scene in scenes]
    columns = [p.name for p in study.parameters] + [n.name for n in study.nuisances]
    # A dashpot may act as well where what it hangs on is fitted.
    damped = any(np.any(soil.damping.acts()[1]) for soil in soils)
    damping = {said.column for s in soils for said in parameters_of(s.damping).values()}
    damped |= bool(damping & {*columns})
    model = PLANAR_DAMPED if damped else PLANAR
    turned = any(nuisance.turns_ground for nuisance in study.nuisances)
    targets = needed(study.targets) if turned else study.targets
    structures = [jax.tree.structure(scene) for scene in scenes]
    engines = {
        structure: Engine(Assembly(structure, model, ledger=False), targets)
        for structure in dict.fromkeys(structures)
    }
    return [engines[structure] for structure in structures]

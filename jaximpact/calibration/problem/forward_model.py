"""The forward model: predictions of all tests for many soils, with derivatives."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import jax
import numpy as np

from ...accuracy import Accuracy
from ...impact.problem import Assembly
from ...impact.reduced_models import PLANAR, PLANAR_DAMPED
from ...parameters import parameters_of
from ...progress import Progress, listening, telling
from ...quantities import CURVE_COLUMNS, columns_of, leaf_places
from ...scene import Scene
from ...tasks import Item, Result, run_in_threads
from .bounds import Bounds
from .config import Study, Variant
from .engine import Engine

STEEPEST = 1e100
"""Derivatives above, whose squares could overflow, are set to 0."""


def bounds_of(study: Study) -> Bounds:
    """Collect the ranges of a study's unknowns."""
    soil, nuisances = study.parameters, study.nuisances
    lower = [p.lower for p in soil], *(n.lower for n in nuisances)
    upper = [p.upper for p in soil], *(n.upper for n in nuisances)
    groups = sum(len(nuisance.groups) for nuisance in nuisances)
    logarithmic = [p.logarithmic for p in soil] + [False] * groups
    return Bounds(
        np.concatenate(lower), np.concatenate(upper), np.array(logarithmic, bool)
    )


class UnknownColumn(NamedTuple):
    """Unknowns that set one column of the scene."""

    leaf: int
    """Index of the column's leaf in the scene."""
    factor: float
    """SI value of one unit of the column."""
    base: np.ndarray
    """Value to which the unknown is added [unit of the column], shape (tests,)."""
    unknown: np.ndarray
    """Index of the unknown of each test, shape (tests,)."""
    pooled: bool = False
    """Whether it is the logarithm of a factor on the fitted parameter of its leaf."""


def unknown_columns(study: Study, scene: Scene) -> list[UnknownColumn]:
    """List the columns of the scene that are fitted: parameters, then nuisances."""
    tests, columns, leaves = len(study.tests), columns_of(scene), leaf_places(scene)
    found = [
        UnknownColumn(
            leaves[parameter.name],
            columns[parameter.name].factor,
            np.zeros(tests),
            np.full(tests, index),
        )
        for index, parameter in enumerate(study.parameters)
    ]
    first = len(found)
    for nuisance in study.nuisances:
        factor, leaf = columns[nuisance.name].factor, leaves[nuisance.name]
        unknown = first + nuisance.group
        found.append(
            UnknownColumn(leaf, factor, nuisance.base, unknown, nuisance.pooled)
        )
        first += len(nuisance.groups)
    return found


class ForwardModel:
    """Predictions of a study's tests, on the ground of a variant, as a function of the
    unknowns x."""

    def __init__(
        self, study: Study, variant: Variant, engine: Engine, accuracy: Accuracy
    ):
        self.study, self.engine, self.accuracy = study, engine, accuracy
        self.bounds = bounds_of(study)
        self.scene = study.scene_of(variant)
        leaf_of = leaf_places(self.scene)
        leaves = [np.asarray(x) for x in jax.tree.leaves(self.scene)]
        if {*study.targets} & {*CURVE_COLUMNS}:
            leaves.append(study.tests.times)
        self._leaves = np.stack(leaves)
        self._columns = unknown_columns(study, self.scene)
        columns = columns_of(self.scene)
        # Leaf, SI value of one unit, and expression of each column that is tied.
        self._tied = [
            (leaf_of[tied.name], columns[tied.name].factor, tied) for tied in study.tied
        ]

    def _impacts(self, x) -> np.ndarray:
        """Build the leaves of the scenes, shape (leaves, lanes, tests)."""
        p = self.bounds.parameter(x)
        leaves = np.repeat(self._leaves[:, None], len(x), axis=1)
        for column in self._columns:
            own = p[:, column.unknown]
            if column.pooled:
                leaves[column.leaf] *= np.exp(own)
                continue
            leaves[column.leaf] = column.factor * (column.base + own)
        for leaf, value, _ in self._tied_values(p):
            leaves[leaf] = value[:, None]
        return leaves

    def _tied_values(self, p):
        """Compute the tied leaves and their derivatives with respect to the parameters
        p, in SI."""
        names = tuple(parameter.name for parameter in self.study.parameters)
        for leaf, factor, tied in self._tied:
            value, slopes = tied.evaluate(names, p[:, : len(names)])
            yield leaf, factor * value, factor * slopes

    def _predict(self, x, wanted):
        """Compute predictions, outcomes and the Jacobian at x, shape (lanes, unknowns),
        with a mask of the columns whose derivatives are wanted, (columns, lanes)."""
        study = self.study
        lanes, tests, targets = len(x), *study.measured.shape
        leaves = self._impacts(x)
        by_x = self.bounds.slope(x)
        runs, of_lane = np.nonzero(wanted)
        impacts = leaves[:, of_lane].reshape(len(leaves), -1)
        directions = np.zeros((len(leaves), len(runs), tests))
        p = self.bounds.parameter(x)
        for run, column in enumerate(self._columns):
            here = of_lane[runs == run]
            factor = column.factor
            if column.pooled:
                factor = leaves[column.leaf, here]
            for other in self._columns:
                if other.pooled and other.leaf == column.leaf and not column.pooled:
                    factor = factor * np.exp(p[here][:, other.unknown])
            directions[column.leaf, runs == run] = factor
        for leaf, _, slopes in self._tied_values(p):
            for index in range(slopes.shape[1]):
                here = runs == index
                directions[leaf, here] = slopes[of_lane[here], index][:, None]
        directions = directions.reshape(len(leaves), -1)
        values, derivatives, outcomes = self.engine.run(
            impacts, directions, self.accuracy
        )
        values, derivatives = (
            part.reshape(len(runs), tests, targets) for part in (values, derivatives)
        )
        # Where an outcome changes a derivative may be huge, and its square overflow.
        finite = np.isfinite(values) & (np.abs(derivatives) < STEEPEST)
        derivatives = np.where(finite, derivatives, 0.0)
        predicted = np.empty((lanes, tests, targets))
        predicted[of_lane] = values
        codes = np.empty((lanes, tests))
        codes[of_lane] = outcomes.reshape(len(runs), tests)
        jacobian = np.zeros((lanes, tests, targets, x.shape[1]))
        each = np.arange(tests)
        for run, column in enumerate(self._columns):
            here = of_lane[runs == run]
            slope = by_x[here][:, column.unknown][..., None]
            # Each test depends on one group alone.
            jacobian[here[:, None], each, :, column.unknown] = (
                derivatives[runs == run] * slope
            )
        return predicted, codes, jacobian


def engine_of(study: Study) -> Engine:
    """Return the engine for the first variant of a study, and all with its laws."""
    return engines_of(study)[0]


def engines_of(study: Study) -> list[Engine]:
    """Return the engine for each variant of a study; those of equal laws share one."""
    scenes = [study.scene_of(variant) for variant in study.variants]
    soils = [scene.soil for scene in scenes]
    columns = [p.name for p in study.parameters] + [n.name for n in study.nuisances]
    # A dashpot may come to act where a parameter of its law is fitted.
    damped = any(np.any(soil.damping.acts()[1]) for soil in soils)
    damping = {said.column for s in soils for said in parameters_of(s.damping).values()}
    damped |= bool(damping & {*columns})
    model = PLANAR_DAMPED if damped else PLANAR
    structures = [jax.tree.structure(scene) for scene in scenes]
    engines = {
        structure: Engine(Assembly(structure, model, ledger=False), study.targets)
        for structure in dict.fromkeys(structures)
    }
    return [engines[structure] for structure in structures]


def for_each_variant(
    engines: Sequence[Engine],
    function: Callable[[Item, Progress], Result],
    variants: Sequence[Item],
    progress: Progress,
) -> list[Result]:
    """Call a function of every variant, in threads where all have machine code.

    Machine code runs outside Python's lock, so that the Python arithmetic of one
    variant overlaps the impacts of another; XLA would compile for each. The numbers are
    those of one call after the other.
    """
    in_xla = any(engine.kernel is None for engine in engines)
    if in_xla or len(variants) == 1:
        return [function(variant, progress) for variant in variants]
    with telling(progress):
        return run_in_threads(lambda item: function(item, listening()), variants)

"""The forward model: predictions of all tests as a function of the unknowns, by JAX."""

import copy
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from ..._jax_internals import namespace_of
from ..._types import Structure
from ...accuracy import PRESETS, Accuracy
from ...backend import MACHINE_CODE, XLA
from ...backend.rows import prepare
from ...quantities import (
    CURVE_COLUMNS,
    DERIVED_COLUMNS,
    TARGET_COLUMNS,
    InputColumn,
    columns_of,
    leaf_places,
)
from ...scene import Scene
from ...shapes import each_shape
from ...simulation import simulate
from ...tasks import Item, Result, run_in_threads
from ...units import DEGREE
from .bounds import Bounds
from .config import Study
from .dataset import Measurements
from .program import ImpactProgram, ImpactRows, OwnColumn, Response, program_of


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

    name: str
    base: np.ndarray
    """Value to which the unknown is added [unit of the column], shape (tests,)."""
    unknown: np.ndarray
    """Index of the unknown of each test, shape (tests,)."""
    pooled: bool = False
    """Whether it is the logarithm of a factor on the fitted parameter of its name."""


def unknown_columns(study: Study) -> list[UnknownColumn]:
    """List the columns of the scene that are fitted: parameters, then nuisances."""
    tests, first = len(study.tests), len(study.parameters)
    columns = [
        UnknownColumn(parameter.name, np.zeros(tests), np.full(tests, index))
        for index, parameter in enumerate(study.parameters)
    ]
    for nuisance in study.nuisances:
        unknown = first + nuisance.group
        columns.append(
            UnknownColumn(nuisance.name, nuisance.base, unknown, nuisance.pooled)
        )
        first += len(nuisance.groups)
    return columns


class Impacts(NamedTuple):
    """Impacts of one shape among all of a study."""

    program: ImpactProgram
    places: np.ndarray
    """Indices among all impacts, shape (impacts,)."""
    leaves: np.ndarray
    """Leaves that are no constants, shape (impacts, leaves)."""


class ForwardModel:
    """Predictions of a study's tests as a function of the unknowns, in the units of
    their columns.

    Points of one curve are tests of one impact, which is computed once.
    """

    def __init__(
        self,
        tests: Measurements,
        targets: tuple[str, ...],
        columns: Sequence[UnknownColumn],
        impacts: list[Impacts],
    ):
        first, self.impact = np.unique(tests.first_of_row, return_inverse=True)
        self.unknown = np.stack([column.unknown[first] for column in columns], axis=1)
        """Index of the unknown of each impact and column, (impacts, columns)."""
        self.base = np.stack([column.base[first] for column in columns], axis=1)
        self.impacts = impacts
        is_curve = np.isin(targets, [*CURVE_COLUMNS])
        others, curves = np.sum(~is_curve), np.sum(is_curve)
        timed = tests.at_times(targets)
        slot = np.zeros(len(tests), int)
        for test in np.flatnonzero(timed):
            before = self.impact[:test][timed[:test]]
            slot[test] = np.sum(before == self.impact[test])
        most = int(np.max(slot[timed], initial=-1)) + 1
        self.times = np.full((len(first), most), np.inf)
        self.times[self.impact[timed], slot[timed]] = tests.times[timed]
        self.cell = np.full((len(tests), len(targets)), -1)
        """Index of each test's target among the results of its impact; -1 where a test
        cannot have one."""
        self.cell[np.ix_(~timed, ~is_curve)] = np.arange(others)
        of_curves = others + most * np.arange(curves) + slot[timed, None]
        self.cell[np.ix_(timed, is_curve)] = of_curves

    @property
    def engine(self) -> str:
        """Name of what computes the impacts."""
        in_xla = any(impacts.program.in_xla for impacts in self.impacts)
        return XLA if in_xla else MACHINE_CODE

    def predict(self, p: Array, accuracy: Accuracy) -> Array:
        """Predict all tests, shape (tests, targets), as a function of JAX of the
        unknowns, shape (unknowns,); NaN where there is no prediction."""
        unknowns, results = jnp.asarray(self.base) + p[self.unknown], []
        for program, places, leaves in self.impacts:
            rows = (
                unknowns[places],
                jnp.asarray(leaves),
                jnp.asarray(self.times[places]),
            )
            results.append(program.results(*rows, accuracy)[0])
        return self._of_tests(jnp.concatenate(results))

    def _of_tests(self, results: Any) -> Any:
        """Collect predictions from the results of impacts, shape (..., impacts,
        results), shape after shape."""
        predicted = results[..., self._row[:, None], self.cell]
        return namespace_of(predicted).where(self.cell >= 0, predicted, np.nan)

    @property
    def _row(self) -> np.ndarray:
        """Index of each test's impact where those of one shape follow those of
        another."""
        places = np.concatenate([impacts.places for impacts in self.impacts])
        return np.argsort(places)[self.impact]

    def evaluate(
        self, p: np.ndarray, accuracy: Accuracy, *, derivatives: bool
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
        """Predict all tests for many unknowns.

        Args:
            p: unknowns, shape (lanes, unknowns).

        Returns:
            Predictions, shape (lanes, tests, targets); codes of the outcomes, shape
            (lanes, tests); and, if wanted, derivatives with respect to the unknowns of
            each test (`unknown`), shape (lanes, tests, targets, columns).
        """
        unknowns = self.base + p[:, self.unknown]
        lanes, _, columns = unknowns.shape
        of_shapes = []
        for program, places, leaves in self.impacts:
            rows = ImpactRows(
                unknowns[:, places].reshape(-1, columns),
                np.tile(leaves, (lanes, 1)),
                np.tile(self.times[places], (lanes, 1)),
            )
            of_shape = program.run(rows, accuracy, derivatives=derivatives)
            of_shapes.append([x.reshape(lanes, -1, *x.shape[1:]) for x in of_shape])
        results, outcomes, *slopes = (
            np.concatenate(parts, axis=1) for parts in zip(*of_shapes, strict=True)
        )
        row = self._row
        by_own = slopes[0][:, row[:, None], self.cell] if derivatives else None
        return self._of_tests(results), outcomes[:, row], by_own

    def of_tests(self, tests: np.ndarray) -> "ForwardModel":
        """Return the model of the tests at some places alone."""
        part = copy.copy(self)
        kept, part.impact = np.unique(self.impact[tests], return_inverse=True)
        part.cell = self.cell[tests]
        part.unknown, part.base = self.unknown[kept], self.base[kept]
        part.times = self.times[kept]
        part.impacts = []
        for program, places, leaves in self.impacts:
            here = np.isin(places, kept)
            if np.any(here):
                new = np.searchsorted(kept, places[here])
                part.impacts.append(Impacts(program, new, leaves[here]))
        return part


def forward_models(
    study: Study,
    grounds: Sequence[Any],
    known: Mapping[str, InputColumn],
    response: Response,
) -> list[ForwardModel]:
    """Make the model on each of several grounds, with common programs.

    Args:
        grounds: tree of all tests on each ground, leaves (tests,).
        known: all columns of the trees.
    """
    first, columns = np.unique(study.tests.first_of_row), unknown_columns(study)
    leaves_of: dict[Structure, list[np.ndarray]] = {}
    split = []
    for ground in grounds:
        split.append([])
        impacts = jax.tree.map(lambda leaf: np.asarray(leaf)[first], ground)
        for tree, chosen in each_shape(impacts):
            structure = jax.tree.structure(tree)
            leaves = np.stack([np.asarray(x) for x in jax.tree.leaves(tree)])
            leaves_of.setdefault(structure, []).append(leaves)
            split[-1].append((structure, np.arange(len(first))[chosen], leaves))
    set_columns = [OwnColumn(c.name, known[c.name].factor, c.pooled) for c in columns]
    tied = [(one, known[one.name].factor) for one in study.tied]
    programs = {
        structure: program_of(
            structure, np.concatenate(leaves, axis=1), set_columns, tied, response
        )
        for structure, leaves in leaves_of.items()
    }
    return [
        ForwardModel(
            study.tests,
            study.targets,
            columns,
            [
                Impacts(programs[structure], here, leaves[programs[structure].varied].T)
                for structure, here, leaves in shapes
            ],
        )
        for shapes in split
    ]


class ImpactModel(NamedTuple):
    """The model of impacts."""

    targets: tuple[str, ...]

    def places(self, tree: Scene) -> dict[str, int]:
        """Find the leaf of each column of a scene."""
        return leaf_places(tree)

    def in_xla(self, structure: Structure, leaves: Sequence) -> bool:
        """Tell whether the laws have no machine code."""
        return prepare(structure, leaves, PRESETS["fast"]) == XLA

    def __call__(self, tree: Scene, times: Array, accuracy: Accuracy):
        """Simulate impacts."""
        save_at = times if times.shape[-1] else None
        simulated = simulate(tree, accuracy=accuracy, save_at=save_at)

        def value(name: str) -> Array:
            return getattr(simulated, TARGET_COLUMNS[name].field)

        results = [results_in_order(self.targets, tree, value)]
        if simulated.history is not None:
            results += [
                getattr(simulated.history, CURVE_COLUMNS[name].field)
                for name in self.targets
                if name in CURVE_COLUMNS
            ]
        return results, simulated.outcome_code


def results_in_order(
    targets: tuple[str, ...], scene: Scene, value: Callable[[str], Array]
) -> Array:
    """Collect the targets that are no forces at times, some of which follow from
    others, shape (impacts, targets)."""
    each = [
        derived(name, scene, value("v_n_mps"), value("v_t_mps"))
        if name in DERIVED_COLUMNS
        else value(name)
        for name in targets
        if name not in CURVE_COLUMNS
    ]
    count = len(scene.impact.speed)
    return jnp.stack(each, axis=1) if each else jnp.empty((count, 0))


def derived(name: str, scene: Scene, v_n: Array, v_t: Array) -> Array:
    r"""Compute a target of impacts that follows from their velocities $v_n, v_t$ after
    and from speed $v$, angle $\theta$ and mass $m$ before:

    $$ \frac{v_n^2 + v_t^2}{v^2}, \qquad \arctan\frac{v_t}{-v_n}, \qquad
       m (v \cos\theta - v_n), \qquad m (v \sin\theta - v_t) , $$

    the ratio of translational energies, the angle of the rebound from the ground's
    normal, and the impulses of the ground, less those of gravity.
    """
    block, impact = scene.block, scene.impact
    if name == "translational_ratio":
        return (v_n**2 + v_t**2) / impact.speed**2
    if name == "rebound_angle_deg":
        # At rest the angle is 0, and so is its derivative.
        at_rest = (v_n == 0.0) & (v_t == 0.0)
        return jnp.arctan2(v_t, jnp.where(at_rest, 1.0, -v_n)) / DEGREE
    normal = name == "normal_impulse_Ns"
    along = jnp.cos(impact.angle) if normal else jnp.sin(impact.angle)
    return block.mass * (impact.speed * along - (v_n if normal else v_t))


def models_of(study: Study) -> list[ForwardModel]:
    """Make the model of impacts for each variant of a study."""
    scenes = [study.scene_of(variant) for variant in study.variants]
    known = {name: c for scene in scenes for name, c in columns_of(scene).items()}
    response = ImpactModel(study.targets)
    return forward_models(study, scenes, known, response)


def for_each_variant(
    models: Sequence[ForwardModel],
    function: Callable[[Item], Result],
    variants: Sequence[Item],
) -> list[Result]:
    """Call a function of every variant, in threads where all have machine code.

    Machine code runs outside Python's lock, so that the Python arithmetic of one
    variant overlaps the impacts of another; XLA would compile for each. The numbers are
    those of one call after the other.
    """
    in_xla = any(model.engine == XLA for model in models)
    if in_xla or len(variants) == 1:
        return [function(variant) for variant in variants]
    return run_in_threads(function, variants)

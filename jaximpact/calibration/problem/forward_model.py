"""The forward model: predictions of all tests for many soils, with derivatives.

On a CPU impacts are computed in machine code (`compile_native_along`): one directional
derivative a run, and as many runs as derivatives are wanted. Laws without machine code,
and other devices, are computed by XLA in programs for a fixed number of impacts.
"""

import concurrent.futures
import contextvars
import copy
import functools
import threading
from collections.abc import Callable, Sequence
from typing import NamedTuple, TypeVar

import jax
import jax.numpy as jnp
import numpy as np

from ...accuracy import Accuracy
from ...backend.native_backend import (
    compile_native,
    compile_native_along,
    computes_on_cpu,
    solve_rows,
    with_setting,
)
from ...backend.threads import thread_count
from ...backend.xla_compilation import unfused_jit
from ...impact.problem import Assembly
from ...impact.reduced_models import PLANAR, PLANAR_DAMPED
from ...parameters import parameters_of
from ...progress import Progress
from ...quantities import (
    CURVE_COLUMNS,
    TARGET_COLUMNS,
    TIME_COLUMN,
    columns_of,
    leaf_places,
)
from ...scene import Scene
from ...tasks import Stopped, stopped_by
from .bounds import Bounds
from .config import Study, Variant
from .derived_targets import WithRate, base_columns, derive
from .expressions import Tied
from .force_curves import forces_at
from .nuisance import SLOPE
from .slope_correction import ANGLE, SIGN, as_stated, needed

AT_ONCE = 512
"""Impacts of one call of the machine code by a thread."""
MANY = 20_000
"""Impacts from which code without derivatives pays the second of its compilation."""
XLA_AT_ONCE = 256
"""Impacts in a program of XLA: fewer waste time on dispatch, more on waiting for the
slowest impact."""
OUTCOME = "outcome_code"
STEEPEST = 1e100
"""Derivatives above, whose squares could overflow, are set to 0."""

Item = TypeVar("Item")
Result = TypeVar("Result")


class Engine:
    """Compiled model that computes impacts and their directional derivatives.

    Args:
        assembly: the model that is compiled.
        targets: result columns that are wanted.
    """

    def __init__(self, assembly: Assembly, targets: tuple[str, ...]):
        self.assembly = assembly
        self._set_targets(targets)
        self.name = "XLA" if self.kernel is None else "machine code"
        self.valued = 0
        """Impacts computed without derivatives so far, or announced."""

    @functools.cached_property
    def kernel(self):
        """Machine code of the model; None where there is none."""
        if not computes_on_cpu():
            return None
        return compile_native_along(self.assembly)

    def __getstate__(self) -> dict:
        # Machine code belongs to a process; another one compiles its own.
        state = {name: v for name, v in vars(self).items() if name != "kernel"}
        structure = self.assembly.structure
        # A class made at run time, as for several shapes, is pickled with its owner,
        # not with a tree structure.
        state["template"] = jax.tree.unflatten(structure, [0.0] * structure.num_leaves)
        return state | {"assembly": self.assembly._replace(structure=None)}

    def __setstate__(self, state: dict) -> None:
        structure = jax.tree.structure(state.pop("template"))
        vars(self).update(state)
        self.assembly = self.assembly._replace(structure=structure)

    def for_targets(self, targets: tuple[str, ...]) -> "Engine":
        """Return the same code for other result columns."""
        other = copy.copy(self)
        other._set_targets(targets)
        return other

    def _set_targets(self, targets: tuple[str, ...]) -> None:
        self.targets = targets
        self.curves = [name for name in targets if name in CURVE_COLUMNS]
        self.others = tuple(name for name in targets if name not in CURVE_COLUMNS)
        self.fields = _fields_of(self.others)

    def run(
        self, leaves: np.ndarray, directions: np.ndarray, accuracy: Accuracy
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Compute targets of impacts and their derivatives along a direction.

        Args:
            leaves: leaves of the scenes, shape (leaves, impacts); with forces at times
                among the targets a row of these times last, NaN for the others.
            directions: derivatives of the leaves along the direction, the same shape.
            accuracy: accuracy of the integration.

        Returns:
            Targets and their derivatives, shape (impacts, targets), NaN where there is
            no result, and codes of the outcomes, shape (impacts,).
        """
        if not self.curves:
            return self._run_others(leaves, directions, accuracy)
        leaves, directions, times = leaves[:-1], directions[:-1], leaves[-1]
        timed = np.isfinite(times)
        is_curve = np.isin(self.targets, self.curves)
        values = np.full((len(times), len(self.targets)), np.nan)
        derivatives, outcomes = np.zeros_like(values), np.empty(len(times))
        parts = [(~timed, ~is_curve), (timed, is_curve)]
        for tests, targets in parts:
            if not np.any(tests):
                continue
            cells = np.ix_(tests, targets)
            chosen = leaves[:, tests], directions[:, tests]
            if targets is is_curve:
                structure = self.assembly.structure
                given = times[tests], self.curves, accuracy
                found = forces_at(structure, *chosen, *given)
            else:
                found = self._run_others(*chosen, accuracy)
            values[cells], derivatives[cells], outcomes[tests] = found
        return values, derivatives, outcomes

    def _run_others(
        self, leaves: np.ndarray, directions: np.ndarray, accuracy: Accuracy
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Compute what `run` does of targets that are not at times."""
        count = leaves.shape[1]
        if self.kernel is None:
            size = XLA_AT_ONCE
            parts = [np.arange(i, min(i + size, count)) for i in range(0, count, size)]
            found = np.concatenate(
                [self._in_xla(leaves, directions, p, accuracy) for p in parts], axis=-1
            )
        else:
            rows = with_setting(leaves, accuracy)
            rows = np.concatenate([rows, directions])
            order = self._longest_first(leaves)
            found = _on_all_cores(self._with_derivatives, rows, order)
        values, derivatives = found
        outcomes, base = values[-1], (values[:-1].T, derivatives[:-1].T)
        return *self._derived(*base, leaves, directions), outcomes

    @functools.cached_property
    def places(self) -> dict[str, int]:
        """Index of the leaf of each column of the scene."""
        structure = self.assembly.structure
        template = [0.0] * structure.num_leaves
        return leaf_places(jax.tree.unflatten(structure, template))

    def _derived(self, values, derivatives, leaves, directions):
        """Compute the targets from the results that `base_columns` names."""
        inputs = {
            name: WithRate(leaves[self.places[name]], directions[self.places[name]])
            for name in ("speed_mps", ANGLE, "mass_kg")
        }
        return derive(self.others, values, derivatives, inputs)

    def _longest_first(self, leaves: np.ndarray) -> np.ndarray:
        """Order impacts by the expected length of the contact: one that begins late
        would go on alone."""
        speed, angle, mass = (
            leaves[self.places[name]] for name in ("speed_mps", ANGLE, "mass_kg")
        )
        return np.argsort(speed * np.cos(angle) / mass ** (1 / 6), kind="stable")

    def _with_derivatives(self, part: np.ndarray) -> np.ndarray:
        assert self.kernel is not None
        numbers, (along,) = solve_rows(self.kernel, part)
        return np.stack([self._chosen(numbers), self._chosen(along)])

    def run_values(
        self, leaves: np.ndarray, accuracy: Accuracy, of: int = 0
    ) -> tuple[np.ndarray, np.ndarray]:
        """Compute results of impacts without derivatives.

        In machine code the numbers are those of `run` bit for bit, and many impacts
        take half the time.

        Args:
            of: number of impacts of all calls to come, if it is known.

        Returns:
            Targets, shape (impacts, targets), and codes of the outcomes (impacts,).
        """
        self.valued = max(of, self.valued + leaves.shape[1])
        if self.kernel is None or self.curves or self.valued < MANY:
            values, _, outcomes = self.run(leaves, np.zeros_like(leaves), accuracy)
            return values, outcomes
        kernel = compile_native(self.assembly)
        found = _on_all_cores(
            lambda part: self._chosen(solve_rows(kernel, part)),
            with_setting(leaves, accuracy),
            self._longest_first(leaves),
        )
        outcomes, values = found[-1], found[:-1].T
        nothing, still = np.zeros_like(values), np.zeros_like(leaves)
        return self._derived(values, nothing, leaves, still)[0], outcomes

    def _in_xla(self, leaves, directions, places, accuracy):
        filled = np.resize(places, XLA_AT_ONCE)  # repeats impacts to fill the program
        numbers, derivatives = _in_xla(
            self.assembly,
            jnp.asarray(leaves[:, filled]),
            jnp.asarray(directions[:, filled]),
            jnp.asarray(accuracy.tolerance),
            jnp.asarray(accuracy.floor),
        )
        count = len(places)
        chosen = self._chosen(numbers), self._chosen(derivatives)
        return np.stack(chosen)[..., :count]

    def _chosen(self, numbers) -> np.ndarray:
        """Select the wanted results, a row each."""
        return np.stack([np.asarray(getattr(numbers, name)) for name in self.fields])


def _on_all_cores(work: Callable, rows: np.ndarray, order: np.ndarray) -> np.ndarray:
    """Call a function of blocks of columns on all cores, in an order that is given;
    results, along the last axis, stand in the order of the columns."""
    rows, count = rows[:, order], rows.shape[1]
    size = max(1, min(AT_ONCE, -(-count // thread_count())))
    parts = [rows[:, first : first + size] for first in range(0, count, size)]
    if len(parts) == 1:
        found = work(parts[0])
    else:
        with concurrent.futures.ThreadPoolExecutor(thread_count()) as pool:
            found = np.concatenate(list(pool.map(work, parts)), axis=-1)
    return found[..., np.argsort(order)]


def _fields_of(targets: tuple[str, ...]) -> tuple[str, ...]:
    base = base_columns(targets)
    return (*(TARGET_COLUMNS[name].field for name in base), OUTCOME)


def _along(assembly, leaves, directions, tolerance, floor):
    from ...backend.xla_backend import compute_lanes  # loads diffrax

    structure = assembly.structure

    def of_leaves(rows):
        scene = jax.tree.unflatten(structure, list(rows))
        return compute_lanes(assembly, scene, tolerance, floor)

    return jax.jvp(of_leaves, (leaves,), (directions,))


_in_xla = unfused_jit(_along, static_argnums=(0,))


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
    turns_ground: bool = False
    """Whether angle and orientation change with it."""
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
        unknown, turns = first + nuisance.group, nuisance.turns_ground
        found.append(
            UnknownColumn(leaf, factor, nuisance.base, unknown, turns, nuisance.pooled)
        )
        first += len(nuisance.groups)
    return found


class TiedColumn(NamedTuple):
    """Column of the scene that follows from the fitted parameters."""

    leaf: int
    """Index of the column's leaf in the scene."""
    factor: float
    """SI value of one unit of the column."""
    tied: Tied


def tied_columns(study: Study, scene: Scene) -> list[TiedColumn]:
    """List the columns of the scene that are tied to fitted parameters."""
    columns, leaves = columns_of(scene), leaf_places(scene)
    return [
        TiedColumn(leaves[tied.name], columns[tied.name].factor, tied)
        for tied in study.tied
    ]


class ForwardModel:
    """Predictions of a study's tests as a function of the unknowns x.

    Args:
        study, variant: the tests, and the ground of a variant.
        engine: computes the impacts, see `engine_of`.
        accuracy: accuracy of the impacts.
    """

    def __init__(
        self, study: Study, variant: Variant, engine: Engine, accuracy: Accuracy
    ):
        self.study, self.engine, self.accuracy = study, engine, accuracy
        self.bounds = bounds_of(study)
        self.scene = study.scene_of(variant)
        self._leaf_of = leaf_places(self.scene)
        leaves = [np.asarray(x) for x in jax.tree.leaves(self.scene)]
        if {*study.targets} & {*CURVE_COLUMNS}:
            nothing = np.full(len(study.tests), np.nan)
            leaves.append(study.tests.inputs.get(TIME_COLUMN, nothing))
        self._leaves = np.stack(leaves)
        self._columns = unknown_columns(study, self.scene)
        self._tied = tied_columns(study, self.scene)

    def _impacts(self, x) -> tuple[np.ndarray, np.ndarray]:
        """Build the leaves of the scenes, shape (leaves, lanes, tests), and the turn of
        the ground of each test [rad], shape (lanes, tests)."""
        p = self.bounds.parameter(x)
        leaves = np.repeat(self._leaves[:, None], len(x), axis=1)
        turn = np.zeros(leaves.shape[1:])
        for column in self._columns:
            own = p[:, column.unknown]
            if column.pooled:
                leaves[column.leaf] *= np.exp(own)
                continue
            leaves[column.leaf] = column.factor * (column.base + own)
            if column.turns_ground:
                turn += column.factor * p[:, column.unknown]
        for name, sign in SIGN.items():
            leaves[self._leaf_of[name]] += sign * turn
        for column, value, _ in self._tied_values(p):
            leaves[column.leaf] = column.factor * value[:, None]
        return leaves, turn

    def _tied_values(self, p):
        """Compute the tied columns and their derivatives with respect to the
        parameters p."""
        names = tuple(parameter.name for parameter in self.study.parameters)
        for column in self._tied:
            yield column, *column.tied.evaluate(names, p[:, : len(names)])

    def _predict(self, x, wanted):
        """Compute predictions, outcomes and the Jacobian.

        Args:
            x: shape (lanes, unknowns).
            wanted: which columns' derivatives are computed, shape (columns, lanes).
        """
        study = self.study
        lanes, tests, targets = len(x), *study.measured.shape
        leaves, turn = self._impacts(x)
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
            for name, sign in SIGN.items() if column.turns_ground else ():
                directions[self._leaf_of[name], runs == run] = sign * column.factor
        for column, _, slopes in self._tied_values(p):
            for index in range(slopes.shape[1]):
                here = runs == index
                slope = column.factor * slopes[of_lane[here], index]
                directions[column.leaf, here] = slope[:, None]
        directions = directions.reshape(len(leaves), -1)
        values, derivatives, outcomes = self.engine.run(
            impacts, directions, self.accuracy
        )
        values, derivatives = self._as_stated(
            values, derivatives, turn[of_lane].ravel(), impacts, directions
        )
        values = values.reshape(len(runs), tests, targets)
        derivatives = derivatives.reshape(len(runs), tests, targets)
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

    def _as_stated(self, values, derivatives, turn, impacts, directions):
        """Turn results and their derivatives to the axes that the tests are stated in.

        Args:
            turn: turn of the ground [rad], shape (impacts,).
            impacts, directions: leaves of the scenes and their derivatives, shape
                (leaves, impacts).
        """
        if not any(column.turns_ground for column in self._columns):
            return values, derivatives
        speed, angle, slope = (self._leaf_of[n] for n in ("speed_mps", ANGLE, SLOPE))
        # No two nuisances change the slope.
        return as_stated(
            self.study.targets,
            values,
            derivatives,
            (turn, directions[slope]),
            (impacts[speed], directions[speed]),
            impacts[angle] - turn,
        )


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
    turned = any(nuisance.turns_ground for nuisance in study.nuisances)
    targets = needed(study.targets) if turned else study.targets
    structures = [jax.tree.structure(scene) for scene in scenes]
    engines = {
        structure: Engine(Assembly(structure, model, ledger=False), targets)
        for structure in dict.fromkeys(structures)
    }
    return [engines[structure] for structure in structures]


def run_in_threads(
    function: Callable[[Item, Progress], Result],
    items: Sequence[Item],
    progress: Progress,
) -> list[Result]:
    """Call a function of every item in threads of their own; results in their order.

    Args:
        function: called with an item and with its progress; once one call has failed
            the others end the next time that they tell their progress, or while they
            wait for an executor.
        items: one thread each.
        progress: called by one thread at a time.
    """
    stop, speaking = threading.Event(), threading.Lock()

    class Shared(Progress):
        def __call__(self, what, done=None, total=None):
            with speaking:
                if stop.is_set():
                    raise Stopped
                progress(what, done, total) if total is not None else progress(what)

    def call(item: Item) -> Result:
        with stopped_by(stop):
            return function(item, Shared())

    with concurrent.futures.ThreadPoolExecutor(len(items)) as pool:
        running = [
            pool.submit(contextvars.copy_context().run, call, item) for item in items
        ]
        try:
            for ended in concurrent.futures.as_completed(running):
                ended.result()
        except BaseException:
            stop.set()
            pool.shutdown(wait=False, cancel_futures=True)
            raise
        return [ended.result() for ended in running]


def for_each(
    function: Callable[[Item, Progress], Result],
    items: Sequence[Item],
    progress: Progress,
    executor: concurrent.futures.Executor | None,
) -> list[Result]:
    """Call a function of every item: one after another, or in threads that wait side by
    side where an executor does most of the work."""
    if executor is None:
        return [function(item, progress) for item in items]
    return run_in_threads(function, items, progress)


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
    return run_in_threads(function, variants, progress)

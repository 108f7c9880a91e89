"""Elasticities: by how many per cent an output changes when a parameter does by one."""

import enum
from collections.abc import Callable, Iterable, Sequence

import jax
import numpy as np
import xarray as xr
from jaxtyping import Float

from .._precision import require_float64
from .._settings import numpy_settings
from ..accuracy import Accuracy, get_accuracy
from ..backend.rows import compute_rows, in_parts
from ..batch import broadcast_scene, simulate_batch
from ..errors import InputError
from ..impact.events import Outcome
from ..impact.results import ImpactSummary, empty_summary
from ..io.checks import check_scene
from ..io.datasets import SCENE_DIMENSION, provenance, scene_coordinates
from ..io.result_table import outcomes_in_words
from ..progress import Progress, ProgressFunction, as_progress
from ..quantities import (
    OUTCOME_COLUMN,
    OUTCOME_MEANING,
    InputColumn,
    ResultColumn,
    leaf_places,
)
from ..scene import GRAVITY, Scene, SceneLike, as_scene
from ..scene_quantities import scene_with, value_of
from ..shapes import each_shape
from ..sweeping import Axes, check_axes, coordinates_of, spread
from ..units import variable_attributes
from .ranges import (
    DEFAULT_OUTPUTS,
    axes_of_names,
    default_parameters,
    output_columns,
    parameter_columns,
)

DEFAULT_ACCURACY = "reference"
ZERO_WITHIN = 0.1
"""Fraction of the accuracy's tolerance below which an output over its natural size
cannot be told from zero; 95 of 100 errors of e_n are below 0.2 of the tolerance."""
AGREES_WITHIN = 1e-3
"""Fraction of the larger of output and relative derivative by which derivative and
differences may differ."""
STEPS = (1e-3, 3e-5)
"""Steps of the differences over the parameter. The second, which noise spoils sooner
and kinks later, is for what the first does not confirm."""

POINTS = 5
STENCILS = {
    -2: np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12.0,
    0: np.array([-25.0, 48.0, -36.0, 16.0, -3.0]) / 12.0,
    -4: np.array([3.0, -16.0, 36.0, -48.0, 25.0]) / 12.0,
}
"""Offset of the first of five equidistant points from the parameter, in steps, and
weights of a slope of fourth order: central, and one-sided at the edge of a range."""


class State(enum.IntEnum):
    """Whether an output has an elasticity with respect to a parameter, or why not."""

    defined = 0
    """The elasticity is defined."""
    parameter_is_zero = 1
    """The parameter is zero and has no relative change; the derivative is given."""
    output_is_zero = 2
    """The output is zero, to the integration's error, and has no relative change; the
    derivative is given."""
    output_has_no_value = 3
    """The output is NaN, as e_t is at vertical incidence."""
    impact_failed = 4
    """The integration did not finish."""
    derivative_is_not_finite = 5
    """The impact has a value, but its derivative was lost."""

    def __str__(self) -> str:
        return self.name.replace("_", " ")

    @property
    def short(self) -> str:
        """Text for a cell of a table, x being the parameter and y the output."""
        return ("defined", "x=0", "y=0", "none", "failed", "lost")[self]


class Check(enum.IntEnum):
    """Verdict of differences of neighbouring impacts on a derivative."""

    agrees = 0
    """The two differ by `AGREES_WITHIN` at most."""
    differs = 1
    """The differences are smooth and give something else: do not trust the
    derivative."""
    undecided = 2
    """The output has a jump or a kink so near that differences straddle it."""
    unchecked = 3
    """Not checked: no check was asked for, or a neighbour has no value."""

    def __str__(self) -> str:
        return self.name


@numpy_settings()
def elasticities(
    scene: SceneLike,
    parameters: Iterable[str] | None = None,
    outputs: Iterable[str] = DEFAULT_OUTPUTS,
    *,
    axes: Axes | None = None,
    accuracy: str | Accuracy = DEFAULT_ACCURACY,
    check: bool = True,
    progress: Progress | ProgressFunction | None = None,
) -> xr.Dataset:
    r"""Compute elasticities of impacts by automatic differentiation, and check them.

    $$ E = \frac{\partial \ln |y|}{\partial \ln |x|}
         = \frac{x}{y} \frac{\partial y}{\partial x} $$

    of an output y with respect to a parameter x: 1 % more of x is E % more of y, away
    from zero for either sign; angles count from their own zero. The elasticity is that
    of the branch taken: where an outcome changes, outputs jump, and no derivative says
    by how much.

    Args:
        scene: one impact, as for `simulate`; or many, with fields that broadcast to
            `(n,)`.
        parameters: input columns, such as `"c_v"` or `"angle_deg"`, those of the
            scene's own laws and shapes included; by default those of c_v, gamma_v and
            k_E that the laws have.
        outputs: result columns, such as `"e_n"`; by default all of a table of results.
        axes: quantities that vary, as for `sweep`; then `scene` is one impact.
        accuracy: of the derivatives, as for `simulate`.
        check: compare with finite differences at the accuracy "reference". They take 5
            impacts per scene and parameter, and 10 where 5 do not decide.
        progress: called as `progress(done, n)` as impacts are computed.

    Returns:
        A dataset over `parameter` and `output`, preceded by the dimensions of the axes,
        or by `scene` for many scenes, whose quantities that differ are coordinates.

        * `elasticity`; NaN where it has no meaning, and `state` says why (`State`): a
          parameter or an output that is zero or has no value, a failed impact.
        * `derivative`, in the unit of the output per unit of the parameter, wherever
          the output has a value.
        * `derivative_by_differences`, the `disagreement` of both as a fraction of the
          larger of output and relative derivative, and `check` (`Check`): whether that
          is within `AGREES_WITHIN`. A parameter that is zero is measured by its
          default, or by one SI unit if that is zero too; an output that is zero by its
          natural size (`natural_size`). On 500 random impacts 998 of 1000 derivatives
          agree, to 8e-8 in the median; at "balanced" 976 do, at "fast" 802.
        * `parameter_value`, `output_value` and `outcome`.

    The first use compiles for some 10 s, for vertical impacts less.

    Raises:
        InputError: an unknown name, with the nearest known; axes as `sweep` refuses, or
            with the name of a dimension or variable of the result.
        ValueError: a value out of its range.
    """
    require_float64()
    base = as_scene(scene)
    if parameters is None:
        parameters = default_parameters(base)
    results, setting = output_columns(outputs), get_accuracy(accuracy)
    scenes, shape, dimensions, coordinates = _laid_out(base, axes)
    inputs = parameter_columns(scenes, parameters)
    scenes, count = broadcast_scene(scenes)
    impacts = count * len(inputs) * (1 + POINTS * bool(check))
    tell, done = as_progress(progress), 0

    def count_more(more: int) -> None:
        nonlocal done
        # Impacts of the second step are not in the total.
        done = min(done + more, impacts)
        tell("impacts", done, impacts)

    numbers, slopes = derivatives(scenes, inputs, setting, count_more)
    of_parameters = [
        _one_parameter(scenes, c, results, setting, check, count_more, numbers, by)
        for c, by in zip(inputs, slopes, strict=True)
    ]
    if done < impacts:  # what had no neighbours
        count_more(impacts)
    values = {
        name: np.stack([one[name] for one in of_parameters], axis=1)
        for name in of_parameters[0]
    }
    values |= {
        "parameter_value": np.stack([value_of(scenes, c) for c in inputs], axis=1),
        "output_value": _outputs(numbers, results),
        OUTCOME_COLUMN: outcomes_in_words(numbers.outcome_code),
    }
    over = {
        "parameter_value": ("parameter",),
        "output_value": ("output",),
        OUTCOME_COLUMN: (),
    }
    return xr.Dataset(
        {
            name: (
                (*dimensions, *over.get(name, ("parameter", "output"))),
                values[name].reshape((*shape, *values[name].shape[1:])),
                attributes,
            )
            for name, attributes in _ATTRIBUTES.items()
        },
        coordinates | axes_of_names(inputs, results),
        attrs={
            "title": "jaximpact: elasticities of impacts",
            **provenance(base, setting, agrees_within=AGREES_WITHIN),
        },
    )


def _laid_out(
    base: Scene, axes: Axes | None
) -> tuple[Scene, tuple[int, ...], tuple[str, ...], dict]:
    """Check the scenes, and return them with shape, dimensions and coordinates of the
    dataset before those of parameters and outputs."""
    if axes is not None:
        check_scene(base)
        grid = check_axes(axes, base)
        shape = tuple(axis.length for axis in grid)
        scenes = spread(base, grid, shape)
        dimensions = tuple(axis.name for axis in grid)
        for name in dimensions:
            if name in (*axes_of_names((), ()), *_ATTRIBUTES):
                raise InputError(
                    f"axis {name} needs another name, as elasticities have {name} of "
                    "their own"
                )
        return scenes, shape, dimensions, coordinates_of(grid, scenes)
    check_scene(base, batched=True)
    if not any(np.ndim(leaf) for leaf in jax.tree.leaves(base)):
        return base, (), (), {}
    scenes, count = broadcast_scene(base)
    dimensions = (SCENE_DIMENSION,)
    return scenes, (count,), dimensions, scene_coordinates(scenes, (count,), dimensions)


def _flags(kind: type[enum.IntEnum]) -> dict:
    """Return attributes that say what codes mean, as the CF conventions write it."""
    return {
        "flag_values": [int(member) for member in kind],
        "flag_meanings": " ".join(member.name for member in kind),
    }


_ATTRIBUTES = {
    "elasticity": variable_attributes("elasticity: d ln output / d ln parameter", "-"),
    "derivative": {"long_name": "derivative", "comment": "in the units of both"},
    "derivative_by_differences": {"long_name": "derivative by differences"},
    "disagreement": {
        "units": "-",
        "long_name": "disagreement of the two",
        "comment": "over the larger of output and relative derivative",
    },
    "state": {"long_name": "state"} | _flags(State),
    "check": {"long_name": "check by differences"} | _flags(Check),
    "parameter_value": {
        "long_name": "value of the parameter",
        "comment": "in parameter_unit",
    },
    "output_value": {"long_name": "value of the output", "comment": "in output_unit"},
    OUTCOME_COLUMN: variable_attributes(OUTCOME_MEANING),
}
"""Variables of the dataset, in their order."""


def derivatives(
    scene: Scene,
    columns: Sequence[InputColumn],
    accuracy: Accuracy,
    done: Callable[[int], None],
) -> tuple[ImpactSummary, list[ImpactSummary]]:
    """Compute results, and their derivatives with respect to parameters in SI units.

    Args:
        scene: fields `(n,)`.
        done: called with the number of impacts that were computed since the last call,
            one for each parameter.

    Returns:
        Numbers with fields `(n,)`, and for each parameter the derivatives of each; NaN
        where the integration failed.
    """
    count = len(np.asarray(scene.impact.speed))
    of_numbers = jax.tree.structure(empty_summary(ledger=False))
    values = np.empty((of_numbers.num_leaves, count))
    slopes = np.zeros((len(columns), *values.shape))
    for alone, lanes in each_shape(scene):
        leaves, structure = jax.tree.flatten(alone)
        places = leaf_places(alone)
        # A parameter that the shape does not have changes nothing.
        known = [k for k, column in enumerate(columns) if column.name in places]
        varied = [places[columns[k].name] for k in known]
        places_of = np.arange(count)[lanes]
        for part in in_parts(np.arange(len(places_of))):
            of_part = [np.asarray(leaf)[part] for leaf in leaves]
            rows, along = compute_rows(structure, of_part, accuracy, varied=varied)
            values[:, places_of[part]] = rows
            for k, column in zip(known, along, strict=True):
                slopes[k][:, places_of[part]] = column
            done(len(part) * len(columns))
    numbers, *of_columns = (
        jax.tree.unflatten(of_numbers, list(rows)) for rows in (values, *slopes)
    )
    return numbers, of_columns


def differences(
    scene: Scene,
    column: InputColumn,
    outputs: tuple[ResultColumn, ...],
    step: float,
    done: Callable[[int], None],
) -> tuple[np.ndarray, np.ndarray]:
    """Compute slopes with respect to a parameter by differences over five points.

    Args:
        scene, done: as for `derivatives`.
        outputs: columns of the results whose slopes are wanted.
        step: distance of the points, as a fraction of the parameter's size.

    Returns:
        Slopes [unit of the output per unit of the parameter], `(scenes, outputs)`; NaN
        where a neighbour has no value or would be out of range. And their roughness:
        the largest third or fourth difference over the step. With the step it tends to
        zero where the output is smooth, and to a jump's height or a kink's change of
        slope where one lies among the points.
    """
    center = value_of(scene, column)
    width = step * size_of(column, center)
    first = _first_points(column, center, width)
    known = ~np.isnan(first)
    slope = np.full((len(center), len(outputs)), np.nan)
    roughness = np.full_like(slope, np.nan)
    if not known.any():
        return slope, roughness
    offsets = first[known, None] + np.arange(POINTS)
    points = center[known, None] + offsets * width[known, None]
    base = jax.tree.map(lambda x: np.repeat(np.asarray(x)[known], POINTS), scene)
    result = simulate_batch(
        scene_with(base, {column.name: points.ravel()}),
        # Errors of 1e-9 leave a slope over steps of 1e-3 some six digits.
        accuracy="reference",
    )
    weights = np.stack([STENCILS[int(offset)] for offset in first[known]])
    for number, output in enumerate(outputs):
        values = np.asarray(getattr(result, output.field)).reshape(-1, POINTS)
        slope[known, number] = np.sum(weights * values, axis=1) / width[known]
        higher = [np.abs(np.diff(values, n=order)).max(axis=1) for order in (3, 4)]
        roughness[known, number] = np.maximum(*higher) / width[known]
    done(points.size)
    return slope, roughness


def size_of(column: InputColumn, values: np.ndarray) -> np.ndarray:
    """Return the size by which changes of a parameter are measured: its absolute value;
    where that is zero its default, or one SI unit if that is zero too."""
    typical = abs(column.default) or 1.0 / column.factor
    return np.where(values == 0.0, typical, np.abs(values))


def _first_points(column: InputColumn, center, width) -> np.ndarray:
    """Return the offset of the first point, in steps; NaN where no five points are in
    the parameter's range."""
    first = np.full(len(center), np.nan)
    for offset in reversed(STENCILS):
        ends = [
            column.is_allowed(center + (offset + end) * width)
            for end in (0, POINTS - 1)
        ]
        first[np.logical_and(*ends)] = offset
    return first


def natural_size(scene: Scene, column: ResultColumn) -> np.ndarray:
    """Return the size beside which a result counts as zero, in its unit.

    Made of the block's radius, speed and weight; 1 for what has no dimension. Results
    may be many times larger.
    """
    radius = np.asarray(scene.block.semi_axes.minor)
    speed = np.asarray(scene.impact.speed)
    weight = GRAVITY * np.asarray(scene.block.mass)
    sizes = {
        "-": np.ones_like(speed),
        "rad": np.ones_like(speed),
        "m": radius,
        "m/s": speed,
        "rad/s": speed / radius,
        "s": radius / speed,
        "N": weight,
        "N m": weight * radius,
    }
    return sizes[column.unit]


def _outputs(
    summary: ImpactSummary, results: tuple[ResultColumn, ...]
) -> Float[np.ndarray, "scenes outputs"]:
    return np.stack([getattr(summary, c.field) for c in results], axis=1)


def _one_parameter(
    scene: Scene,
    column: InputColumn,
    results: tuple[ResultColumn, ...],
    setting: Accuracy,
    check: bool,
    done: Callable[[int], None],
    numbers: ImpactSummary,
    slopes: ImpactSummary,
) -> dict[str, np.ndarray]:
    """Return the variables of one parameter, shape (scenes, outputs)."""
    parameter = value_of(scene, column)[:, None]
    values = _outputs(numbers, results)
    derivative = column.factor * _outputs(slopes, results)
    derivative[np.isnan(values)] = np.nan
    sizes = np.stack([natural_size(scene, c) for c in results], axis=1)
    zero = np.abs(values) <= ZERO_WITHIN * setting.tolerance * sizes
    failed = np.asarray(numbers.outcome_code)[:, None] == Outcome.failed
    # The first that holds.
    reasons = {
        State.impact_failed: np.broadcast_to(failed, values.shape),
        State.output_has_no_value: np.isnan(values),
        State.derivative_is_not_finite: ~np.isfinite(derivative),
        State.output_is_zero: zero,
        State.parameter_is_zero: np.broadcast_to(parameter == 0.0, values.shape),
    }
    state = np.select([*reasons.values()], [*reasons], State.defined).astype(np.int8)
    defined = state == State.defined
    elasticity = np.where(
        defined, parameter * derivative / np.where(defined, values, 1.0), np.nan
    )
    variables = {"elasticity": elasticity, "derivative": derivative, "state": state}
    if check:
        size = np.where(zero, sizes, np.abs(values))
        return variables | _check(scene, column, results, derivative, size, done)
    return variables | {
        "derivative_by_differences": np.full_like(values, np.nan),
        "disagreement": np.full_like(values, np.nan),
        "check": np.full(values.shape, Check.unchecked, np.int8),
    }


def _check(scene, column, results, derivative, size, done) -> dict[str, np.ndarray]:
    """Compare with differences at the first step, then at the second where the first
    does not confirm."""
    places = np.arange(len(derivative))
    kept: dict[str, np.ndarray] = {}
    for step in STEPS:
        part = jax.tree.map(lambda x, places=places: np.asarray(x)[places], scene)
        judged = _judge(
            *differences(part, column, results, step, done),
            derivative[places],
            size[places],
            size_of(column, value_of(part, column))[:, None],
        )
        if not kept:
            kept = judged
        else:
            # Either step confirms; of those that do not, a smooth one decides.
            before, now = kept["check"][places], judged["check"]
            better = (now == Check.agrees) & (before != Check.agrees)
            better |= (now == Check.differs) & (before == Check.undecided)
            for name, whole in kept.items():
                whole[places] = np.where(better, judged[name], whole[places])
        doubtful = np.isin(kept["check"], (Check.differs, Check.undecided))
        places = np.flatnonzero(doubtful.any(axis=1))
        if not len(places):
            break
    return kept


def _judge(slope, roughness, derivative, size, parameter_size) -> dict[str, np.ndarray]:
    """Compare, as a fraction of the larger of output and relative derivative."""
    larger = np.maximum(size, np.abs(derivative) * parameter_size)
    disagreement = np.abs(slope - derivative) * parameter_size / larger
    rough = roughness * parameter_size / larger
    verdicts = {
        Check.unchecked: np.isnan(disagreement),
        Check.agrees: disagreement <= AGREES_WITHIN,
        Check.undecided: rough > AGREES_WITHIN,
    }
    check = np.select([*verdicts.values()], [*verdicts], Check.differs)
    return {
        "derivative_by_differences": slope,
        "disagreement": disagreement,
        "check": check.astype(np.int8),
    }

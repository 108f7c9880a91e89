"""Elasticities: how many per cent an output changes when a parameter does by one."""

import dataclasses
import json
import threading
from collections.abc import Callable, Iterable
from typing import NamedTuple

import jax
import numpy as np
import xarray as xr

from ..accuracy import Accuracy, get_accuracy
from ..batch import broadcast_scene
from ..block import Block
from ..formats.checks import check_scene
from ..formats.columns import (
    OUTCOME_COLUMN,
    OUTCOME_MEANING,
    InputColumn,
    ResultColumn,
)
from ..formats.datasets import SCENE_DIMENSION, scene_coordinates
from ..formats.provenance import versions
from ..formats.results import outcomes_in_words
from ..formats.scenes import scene_values, value_of
from ..identity import part_names
from ..mechanics.outcomes import Outcome
from ..numbers import Numbers
from ..precision import require_float64
from ..scene import Impact, Scene, as_scene
from ..soil import Soil
from ..sweeping import Axes, check_axes, coordinates_of, spread
from .derivatives import derivatives
from .differences import POINTS, differences, size_of
from .names import (
    DEFAULT_OUTPUTS,
    default_parameters,
    output_columns,
    parameter_columns,
)
from .sizes import is_zero, natural_size
from .verdicts import AGREES_WITHIN, Check, State, flags

DEFAULT_ACCURACY = "reference"
STEPS = (1e-3, 3e-5)
"""Steps of the differences, by the parameter. The second, which noise reaches sooner
and kinks later, is for what the first does not confirm."""


class _Checked(NamedTuple):
    """What differences give, `(scenes, outputs)`."""

    slope: np.ndarray
    disagreement: np.ndarray
    check: np.ndarray


def elasticities(
    scene: Scene | Block | tuple[Block, Soil, Impact],
    parameters: Iterable[str] | None = None,
    outputs: Iterable[str] = DEFAULT_OUTPUTS,
    *,
    axes: Axes | None = None,
    accuracy: str | Accuracy = DEFAULT_ACCURACY,
    check: bool = True,
    progress: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    r"""Elasticities of impacts, by automatic differentiation, checked by differences.

    $$ E = \frac{\partial \ln |y|}{\partial \ln |x|}
         = \frac{x}{y} \frac{\partial y}{\partial x} $$

    of an output y by a parameter x: 1 % more of x is E % more of y, away from zero for
    either sign; angles count from their own zero. It is that of the branch taken: where
    an outcome changes, outputs jump, and no derivative says by how much.

    Args:
        scene: one impact, as for `simulate`; or many, with fields that broadcast to
            `(n,)`.
        parameters: input columns, such as `"c_v"` or `"angle_deg"`, those of the
            scene's own laws and shapes among them; if not given, those of c_v, gamma_v
            and k_E that the laws have.
        outputs: result columns, such as `"e_n"`; all of a table of results if not said.
        axes: quantities that vary, as for `sweep`; then `scene` is one impact.
        accuracy: of the derivatives, as for `simulate`.
        check: compare with differences, at the accuracy "reference". They take 5
            impacts for a scene and parameter, and 10 where 5 do not decide.
        progress: called as `progress(done, n)` as impacts are computed.

    Returns:
        A dataset over `parameter` and `output`, preceded by the dimensions of the axes,
        or by `scene` for many scenes; there quantities that differ are coordinates.

        * `elasticity`; NaN where it has no meaning, and `state` says why (`State`): a
          parameter or an output that is zero or has no value, a failed impact.
        * `derivative`, in the unit of the output by that of the parameter, wherever the
          output has a value.
        * `derivative_by_differences`, `disagreement` between the two as part of the
          larger of output and relative derivative, and `check` (`Check`): whether that
          is within `AGREES_WITHIN`. A parameter that is zero counts by its default, or
          by one SI unit if that is zero too; an output that is zero by its natural
          size (`natural_size`). On 500 random impacts 998 of 1000 agree, to 8e-8 in the
          median; of derivatives at "balanced" 976, at "fast" 802.
        * `parameter_value`, `output_value` and `outcome`.

    The first use of a parameter compiles for some 4 s, for vertical impacts 2 s; see
    `derivatives`.

    Raises:
        InputError: an unknown name, with the nearest known; axes as `sweep` refuses.
        ValueError: a value out of its range.
    """
    require_float64()
    scene = as_scene(scene)
    if parameters is None:
        parameters = default_parameters(scene)
    results = output_columns(outputs)
    setting = get_accuracy(accuracy)
    shape, dimensions, coordinates, base = (), (), {}, scene
    if axes is not None:
        check_scene(scene)
        grid = check_axes(axes, scene)
        shape = tuple(axis.length for axis in grid)
        dimensions = tuple(axis.name for axis in grid)
        scene = spread(scene, grid, shape)
        coordinates = coordinates_of(grid, scene)
    else:
        check_scene(scene, batched=True)
        if any(np.ndim(leaf) for leaf in jax.tree.leaves(scene)):
            scene, count = broadcast_scene(scene)
            shape, dimensions = (count,), (SCENE_DIMENSION,)
            coordinates = scene_coordinates(scene, shape, dimensions)
    inputs = parameter_columns(scene, parameters)
    scene, count = broadcast_scene(scene)
    counter = _Counter(progress, count * len(inputs) * (1 + POINTS * bool(check)))
    found = [
        _by_parameter(scene, column, results, setting, check, counter)
        for column in inputs
    ]
    counter.end()
    variables = {
        name: (
            (*dimensions, "parameter", "output"),
            np.stack([entry[name] for entry in found], axis=1).reshape(
                *shape, len(inputs), len(results)
            ),
            attributes,
        )
        for name, attributes in _VARIABLES.items()
    }
    numbers: Numbers = found[0]["numbers"]
    variables |= {
        "parameter_value": (
            (*dimensions, "parameter"),
            np.stack([value_of(scene, c) for c in inputs], axis=-1).reshape(
                *shape, len(inputs)
            ),
            {"long_name": "value, in parameter_unit"},
        ),
        "output_value": (
            (*dimensions, "output"),
            np.stack([getattr(numbers, c.field) for c in results], axis=-1).reshape(
                *shape, len(results)
            ),
            {"long_name": "value, in output_unit"},
        ),
        OUTCOME_COLUMN: (
            dimensions,
            outcomes_in_words(numbers.outcome_code).reshape(shape),
            {"long_name": OUTCOME_MEANING},
        ),
    }
    return xr.Dataset(
        variables,
        coordinates | axes_of_names(inputs, results),
        attrs={
            "title": "jaximpact: elasticities of impacts",
            "base": json.dumps(scene_values(base)),
            "laws": json.dumps(part_names(base.soil, base.block)),
            "accuracy": json.dumps(dataclasses.asdict(setting)),
            "agrees_within": AGREES_WITHIN,
            "versions": json.dumps(versions()),
        },
    )


_VARIABLES = {
    "elasticity": {"units": "-", "long_name": "d ln output / d ln parameter"},
    "derivative": {"long_name": "d output / d parameter, in their units"},
    "derivative_by_differences": {"long_name": "the same by differences"},
    "disagreement": {
        "units": "-",
        "long_name": "of the two, by the larger of output and relative derivative",
    },
    "state": {"long_name": "whether there is an elasticity"} | flags(State),
    "check": {"long_name": "what differences say"} | flags(Check),
}


def axes_of_names(
    inputs: tuple[InputColumn, ...], results: tuple[ResultColumn, ...]
) -> dict:
    """Coordinates of parameters and outputs: names and units."""
    return {
        "parameter": [column.name for column in inputs],
        "output": [column.name for column in results],
        "parameter_unit": ("parameter", [column.unit for column in inputs]),
        "output_unit": ("output", [column.unit for column in results]),
    }


class _Counter:
    """Adds up the impacts that several threads have done."""

    def __init__(self, progress: Callable[[int, int], None] | None, total: int):
        self.progress, self.total, self.done = progress, total, 0
        self.lock = threading.Lock()

    def __call__(self, more: int) -> None:
        with self.lock:
            # What is checked twice was not counted in.
            self.done = min(self.done + more, self.total)
            if self.progress is not None:
                self.progress(self.done, self.total)

    def end(self) -> None:
        """Say that all is done; what has no neighbours was counted in."""
        if self.done < self.total:
            self(self.total - self.done)


def _by_parameter(
    scene: Scene,
    column: InputColumn,
    results: tuple[ResultColumn, ...],
    setting: Accuracy,
    check: bool,
    counter: _Counter,
) -> dict:
    """The variables of one parameter, `(scenes, outputs)`, and the numbers."""
    numbers, slopes = derivatives(scene, column, setting, counter)
    parameter = value_of(scene, column)[:, None]
    values = _columns_of(numbers, results)
    derivative = column.factor * _columns_of(slopes, results)
    derivative[np.isnan(values)] = np.nan
    zero = np.stack(
        [is_zero(values[:, i], scene, c, setting) for i, c in enumerate(results)],
        axis=1,
    )
    failed = np.asarray(numbers.outcome_code)[:, None] == Outcome.failed
    state = np.select(
        [
            np.broadcast_to(failed, values.shape),
            np.isnan(values),
            ~np.isfinite(derivative),
            zero,
            np.broadcast_to(parameter == 0.0, values.shape),
        ],
        [
            State.impact_failed,
            State.output_has_no_value,
            State.derivative_is_not_finite,
            State.output_is_zero,
            State.parameter_is_zero,
        ],
        State.defined,
    ).astype(np.int8)
    defined = state == State.defined
    elasticity = np.where(
        defined, parameter * derivative / np.where(defined, values, 1.0), np.nan
    )
    sizes = np.stack([natural_size(scene, c) for c in results], axis=1)
    checked = _Checked(
        np.full_like(values, np.nan),
        np.full_like(values, np.nan),
        np.full(values.shape, Check.unchecked, np.int8),
    )
    if check:
        size = np.where(zero, sizes, np.abs(values))
        checked = _check(scene, column, results, derivative, size, counter)
    return {
        "elasticity": elasticity,
        "derivative": derivative,
        "derivative_by_differences": checked.slope,
        "disagreement": checked.disagreement,
        "state": state,
        "check": checked.check,
        "numbers": numbers,
    }


def _columns_of(numbers: Numbers, results: tuple[ResultColumn, ...]) -> np.ndarray:
    return np.stack([getattr(numbers, column.field) for column in results], axis=1)


def _check(scene, column, results, derivative, size, counter) -> _Checked:
    """Differences at the first step, then at the second where the first does not
    confirm."""
    kept = None
    places = np.arange(len(derivative))
    for step in STEPS:
        part = jax.tree.map(lambda x, places=places: np.asarray(x)[places], scene)
        found = differences(part, column, results, step, counter)
        judged = _judge(
            found,
            derivative[places],
            size[places],
            size_of(column, value_of(part, column))[:, None],
        )
        if kept is None:
            kept = judged
        else:
            # Either step confirms; of those that do not, a smooth one decides.
            before = kept.check[places]
            better = (judged.check == Check.agrees) & (before != Check.agrees)
            better |= (judged.check == Check.differs) & (before == Check.undecided)
            for whole, new in zip(kept, judged, strict=True):
                whole[places] = np.where(better, new, whole[places])
        doubtful = (kept.check == Check.differs) | (kept.check == Check.undecided)
        places = np.flatnonzero(doubtful.any(axis=1))
        if not len(places):
            break
    return kept


def _judge(found, derivative, size, parameter_size) -> _Checked:
    """Compare, relative to the larger of output and relative derivative."""
    larger = np.maximum(size, np.abs(derivative) * parameter_size)
    disagreement = np.abs(found.slope - derivative) * parameter_size / larger
    rough = found.roughness * parameter_size / larger
    check = np.select(
        [
            np.isnan(disagreement),
            disagreement <= AGREES_WITHIN,
            rough > AGREES_WITHIN,
        ],
        [Check.unchecked, Check.agrees, Check.undecided],
        Check.differs,
    )
    return _Checked(found.slope, disagreement, check.astype(np.int8))

"""Sobol indices and Morris's elementary effects: which parameters matter over ranges.

An estimator compares impacts that belong together: a block of Saltelli's sample, a
trajectory of Morris's. A group with an impact that has no value is left out whole, and
counted. A mean in the place of that value would bias the indices towards zero, and the
other impacts of the group alone would compare what does not belong together.

The groups that are left sample the region where the model has values. If failures
gather in a corner of the ranges, the estimates hold for the rest of them.
"""

import dataclasses
import json
import math
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from jaxtyping import Float

from .._checks import whole_number
from .._packages import version_of, versions
from .._precision import require_float64
from .._settings import numpy_settings
from ..accuracy import DEFAULT_ACCURACY, Accuracy, get_accuracy
from ..batch import simulate_batch
from ..errors import InputError
from ..io.checks import NUMBERS_PER_IMPACT, check_memory, check_scene
from ..io.datasets import provenance
from ..io.result_table import count_outcomes
from ..progress import Progress, ProgressFunction
from ..quantities import ResultColumn
from ..scene import Scene, SceneLike, as_scene
from ..scene_quantities import scene_with
from ..units import variable_attributes
from .ranges import (
    DEFAULT_OUTPUTS,
    Range,
    axes_of_names,
    check_ranges,
    output_columns,
    parameter_columns,
)

LEVELS = 4
"""Levels of the grid on which the trajectories run; the usual number."""
BOOTSTRAP = {"num_resamples": 200, "conf_level": 0.95}
"""Resamples, and probability of the confidence intervals."""


@numpy_settings()
def sobol(
    base: SceneLike,
    ranges: Mapping[str, Range | tuple[float, float]],
    outputs: Iterable[str] = DEFAULT_OUTPUTS,
    *,
    blocks: int = 4096,
    second_order: bool = False,
    seed: int = 0,
    accuracy: str | Accuracy = DEFAULT_ACCURACY,
    journal: Path | None = None,
    progress: Progress | ProgressFunction | None = None,
) -> xr.Dataset:
    r"""Compute Sobol indices of impacts over ranges of parameters.

    $$ S_i = \frac{V[E(y | x_i)]}{V[y]}, \qquad
       S_{Ti} = 1 - \frac{V[E(y | x_{\sim i})]}{V[y]} $$

    The first-order index is the fraction of the variance that vanishes if a parameter
    becomes known, the total index the fraction that remains if all others do. Their
    difference is the part of interactions with other parameters.

    Args:
        base: one impact, as for `simulate`; the values of what does not vary.
        ranges: input column -> `Range`, or a pair (lower, upper), uniform, in the unit
            of the column; at least two. Parameters are independent.
        outputs: result columns; by default all of a table of results.
        blocks: number of blocks of Saltelli's sample, a power of two; each takes an
            impact for every parameter and two more. Confidence intervals narrow with
            its square root.
        second_order: whether to compute the indices of pairs too, for which each block
            takes nearly twice the impacts.
        seed: of the sample and of the bootstrap, below 2**31.
        accuracy, journal, progress: as for `simulate_batch`.

    Returns:
        A dataset over `output` and `parameter`: `first_order`, `total_order`, and
        `..._interval`, the half width of the 95 % confidence interval (bootstrap). For
        each output its `mean` and `standard_deviation` over the ranges, and
        `groups_kept`, `groups_dropped`: a block with an impact that has no value is
        left out whole; see `sensitivity.global_methods`. With `second_order` also
        `second_order` and its interval over `parameter` and `with`: the fraction of the
        variance that two parameters account for only together. Indices are NaN where
        fewer than half of the blocks, or than two, are left, or the output does not
        change; `reason` says so.
        Outcomes (attribute `outcomes`) that are no failure count as they are: a
        separating block has an e_n of -1.

    Source: Saltelli et al. (2010), doi 10.1016/j.cpc.2009.09.018, through SALib.

    Raises:
        InputError: unknown names, ranges that are none, blocks that are no power of
            two, a journal of something else.
        ValueError: a base that is no single scene.
    """
    blocks = whole_number("blocks", blocks, 2)
    if blocks & (blocks - 1):  # Sobol's sequence needs it for its balance.
        raise InputError(
            f"blocks must be a power of two, but is {blocks}; take "
            f"{2 ** round(math.log2(blocks))}"
        )
    study = _Study.of(base, ranges, outputs, seed, accuracy)
    count = len(study.ranges)
    study.check_size(blocks, "blocks", blocks * (count * (1 + second_order) + 2))
    from SALib.sample import sobol as salib  # a second, for pandas and SciPy

    fractions = salib.sample(
        problem_of(study.ranges), blocks, calc_second_order=second_order, seed=seed
    )
    values, attributes = study.simulate(fractions, blocks, journal, progress)
    estimates = [sobol_of(of_output, seed, second_order) for of_output in values]
    dataset = study.dataset("Sobol indices", estimates, SOBOL | PAIRS, attributes)
    if second_order:
        dataset = dataset.assign_coords({"with": dataset.parameter.values})
    return dataset


@numpy_settings()
def morris(
    base: SceneLike,
    ranges: Mapping[str, Range | tuple[float, float]],
    outputs: Iterable[str] = DEFAULT_OUTPUTS,
    *,
    trajectories: int = 256,
    seed: int = 0,
    accuracy: str | Accuracy = DEFAULT_ACCURACY,
    journal: Path | None = None,
    progress: Progress | ProgressFunction | None = None,
) -> xr.Dataset:
    r"""Compute elementary effects of parameters over their ranges.

    A trajectory changes one parameter after another by two thirds of its range; the
    change of the output, divided by that fraction, is an elementary effect. The mean
    absolute effect, mu*, says how much a parameter matters. Their standard deviation,
    sigma, says how far that depends on the point: nonlinearity and interactions.

    Args:
        base, ranges, outputs, seed, accuracy, journal, progress: as for `sobol`.
        trajectories: their number; each takes an impact for every parameter and one
            more.

    Returns:
        A dataset over `output` and `parameter`: `mean_effect` (mu),
        `mean_absolute_effect` (mu*), the half width of its 95 % confidence interval
        (`mean_absolute_effect_interval`, bootstrap) and `effect_deviation` (sigma), in
        the unit of the output over the whole range of the parameter. For each output
        `groups_kept`, `groups_dropped`: a trajectory with an impact that has no value
        is left out whole; effects are NaN, and `reason` says why, as for `sobol`.

    Source: Morris (1991), doi 10.1080/00401706.1991.10484804, through SALib.

    Raises as `sobol` does.
    """
    whole_number("trajectories", trajectories, 2)
    study = _Study.of(base, ranges, outputs, seed, accuracy)
    count = len(study.ranges)
    study.check_size(trajectories, "trajectories", trajectories * (count + 1))
    from SALib.sample import morris as salib  # a second, for pandas and SciPy

    fractions = salib.sample(
        problem_of(study.ranges), trajectories, num_levels=LEVELS, seed=seed
    )
    values, attributes = study.simulate(fractions, trajectories, journal, progress)
    fractions = fractions.reshape(trajectories, -1, count)
    estimates = [morris_of(fractions, of_output, seed) for of_output in values]
    return study.dataset("Morris's elementary effects", estimates, MORRIS, attributes)


class _Study(NamedTuple):
    base: Scene
    ranges: dict[str, Range]
    outputs: tuple[ResultColumn, ...]
    seed: int
    accuracy: Accuracy

    @classmethod
    def of(cls, base: SceneLike, ranges, outputs, seed: int, accuracy) -> "_Study":
        """Check what the user gave; raises InputError and ValueError as `sobol`."""
        require_float64()
        base = as_scene(base)
        check_scene(base)
        checked, columns = check_ranges(base, ranges), output_columns(outputs)
        # The dataset holds it, and NetCDF 3 no larger numbers; SALib's limit is higher.
        whole_number("seed", seed, 0, 2**31 - 1)
        return cls(base, checked, columns, seed, get_accuracy(accuracy))

    def check_size(self, groups: int, name: str, impacts: int) -> None:
        """Raise InputError for more groups than fit into memory."""
        what = f"{groups} {name}, {impacts} impacts,"
        check_memory(impacts * NUMBERS_PER_IMPACT, what)

    def simulate(
        self,
        fractions: np.ndarray,
        groups: int,
        journal: Path | None,
        progress: Progress | ProgressFunction | None,
    ) -> tuple[list[np.ndarray], dict]:
        """Simulate impacts at fractions of the ranges, `(impacts, parameters)`.

        Returns each output, `(groups, impacts of a group)`, and attributes of a dataset
        that say how they were computed.
        """
        sampled = {
            name: of_name.values(along)
            for (name, of_name), along in zip(
                self.ranges.items(), fractions.T, strict=True
            )
        }
        computed = simulate_batch(
            scene_with(self.base, sampled),
            accuracy=self.accuracy,
            journal=journal,
            progress=progress,
        )
        fields = [getattr(computed, column.field) for column in self.outputs]
        return [values.reshape(groups, -1) for values in fields], {
            **provenance(self.base, self.accuracy),
            "outcomes": json.dumps(count_outcomes(computed)),
        }

    def dataset(
        self,
        title: str,
        estimates: list[dict[str, Any]],
        of_method: Mapping[str, tuple[str, str, str]],
        attributes: dict,
    ) -> xr.Dataset:
        """Make the dataset of the estimates for each output."""
        ranges = {name: dataclasses.asdict(each) for name, each in self.ranges.items()}
        meanings = {
            name: variable_attributes(meaning, unit)
            for name, (_, unit, meaning) in of_method.items()
        }
        for name in ("mean", "standard_deviation"):
            words = f"{name.replace('_', ' ')} over the ranges"
            meanings[name] = variable_attributes(words, "output_unit")
        columns = {}
        for name in estimates[0]:
            values = np.array([of_output[name] for of_output in estimates])
            dimensions = ("output", "parameter", "with")[: values.ndim]
            columns[name] = dimensions, values, meanings.get(name, {})
        return xr.Dataset(
            columns,
            axes_of_names(parameter_columns(self.base, self.ranges), self.outputs),
            attributes
            | {
                "title": f"jaximpact: {title} of impacts",
                "ranges": json.dumps(ranges),
                "seed": self.seed,
                "versions": json.dumps(versions() | {"SALib": version_of("SALib")}),
            },
        )


def problem_of(names: Iterable[str]) -> dict:
    """Describe parameters between 0 and 1 to SALib. SALib writes into the description,
    so it is made anew each time."""
    names = list(names)
    bounds = [[0.0, 1.0]] * len(names)
    return {"num_vars": len(names), "names": names, "bounds": bounds}


HALF_WIDTH = "half width of its 95 % interval"
SOBOL = {
    "first_order": ("S1", "-", "first-order index"),
    "first_order_interval": ("S1_conf", "-", HALF_WIDTH),
    "total_order": ("ST", "-", "total index"),
    "total_order_interval": ("ST_conf", "-", HALF_WIDTH),
}
PAIRS = {
    "second_order": ("S2", "-", "second-order index"),
    "second_order_interval": ("S2_conf", "-", HALF_WIDTH),
}
MORRIS = {
    "mean_effect": ("mu", "output_unit", "mean effect of the whole range, mu"),
    "mean_absolute_effect": (
        "mu_star",
        "output_unit",
        "mean absolute effect of the whole range, mu*",
    ),
    "mean_absolute_effect_interval": ("mu_star_conf", "output_unit", HALF_WIDTH),
    "effect_deviation": (
        "sigma",
        "output_unit",
        "standard deviation of the effect, sigma",
    ),
}
"""Variable of each method -> SALib's name of it, unit and meaning."""


def _estimate(
    values: np.ndarray,
    parameters: int,
    of_method: Mapping[str, tuple[str, str, str]],
    analyze: Callable[[Any], Mapping],
) -> tuple[dict[str, Any], np.ndarray]:
    """Estimate the variables of a method for one output; NaN, with the reason, where
    the groups that have all their values do not suffice.

    Args:
        values: shape (groups, impacts).
        analyze: gives SALib's results of the groups that are complete.

    Returns the variables, and the values of the complete groups.
    """
    complete = np.isfinite(values).all(axis=1)
    whole = values[complete]
    reason = ""
    if len(whole) < max(2, 0.5 * len(values)):
        few = ("no group", "one group alone")
        words = few[len(whole)] if len(whole) < 2 else "less than half of the groups"
        reason = f"{words} has all its values"
    elif np.ptp(whole) <= 1e-12 * np.abs(whole).max():
        reason = "the output does not change"
    analysis = {} if reason else analyze(complete)
    shapes = {name: (parameters,) * (1 + (name in PAIRS)) for name in of_method}
    return {
        name: np.asarray(analysis.get(of_salib, np.full(shapes[name], np.nan)), float)
        for name, (of_salib, _, _) in of_method.items()
    } | {
        "groups_kept": np.int32(len(whole)),
        "groups_dropped": np.int32(len(values) - len(whole)),
        "reason": reason,
    }, whole


def sobol_of(
    values: Float[np.ndarray, "blocks rows"], seed: int, second_order: bool = False
) -> dict[str, Any]:
    """Estimate first-order and total indices from blocks of Saltelli's sample.

    Args:
        values: a row for each block, in SALib's order: A, then A with each parameter
            from B, for the second order B with each from A, then B; NaN where there is
            none.
        seed: of the bootstrap.
        second_order: whether to estimate indices of pairs too.

    Returns the variables of `sobol` for one output.

    Source: Saltelli et al. (2010), doi 10.1016/j.cpc.2009.09.018, as SALib computes it.
    """
    from SALib.analyze import sobol as salib  # a second, for pandas and SciPy

    parameters = (values.shape[1] - 2) // (1 + second_order)
    estimates, whole = _estimate(
        values,
        parameters,
        SOBOL | PAIRS if second_order else SOBOL,
        lambda complete: salib.analyze(
            problem_of(map(str, range(parameters))),
            values[complete].ravel(),
            calc_second_order=second_order,
            seed=seed + 1,  # SALib takes 0 for none
            **BOOTSTRAP,
        ),
    )
    for name in PAIRS.keys() & estimates.keys():  # of which SALib fills one half
        pairs = estimates[name]
        estimates[name] = np.where(np.isnan(pairs), pairs.T, pairs)
    ends = np.full(1, np.nan) if estimates["reason"] else whole[:, [0, -1]]
    return estimates | {"mean": ends.mean(), "standard_deviation": ends.std()}


def morris_of(
    fractions: Float[np.ndarray, "trajectories rows parameters"],
    values: Float[np.ndarray, "trajectories rows"],
    seed: int,
) -> dict[str, Any]:
    """Estimate elementary effects from trajectories.

    Args:
        fractions: of the ranges, 0 to 1, from SALib's sample.
        values: outputs; NaN where there is none.
        seed: of the bootstrap.

    Returns the variables of `morris` for one output.

    Source: Morris (1991), doi 10.1080/00401706.1991.10484804, and Campolongo et al.
    (2007), doi 10.1016/j.envsoft.2006.10.004, as SALib computes it.
    """
    from SALib.analyze import morris as salib  # a second, for pandas and SciPy

    parameters = fractions.shape[2]
    return _estimate(
        values,
        parameters,
        MORRIS,
        lambda complete: salib.analyze(
            problem_of(map(str, range(parameters))),
            fractions[complete].reshape(-1, parameters),
            values[complete].ravel(),
            num_levels=LEVELS,
            seed=seed,
            **BOOTSTRAP,
        ),
    )[0]

"""Morris's elementary effects: which parameters matter at all, at little cost."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr
from jaxtyping import Float

from .._checks import whole_number
from ..accuracy import DEFAULT_ACCURACY, Accuracy
from ..io.checks import NUMBERS_PER_IMPACT, check_memory
from ..progress import Progress, ProgressFunction
from ..scene import Block, Impact, Scene
from ..soil import Soil
from .ranges import DEFAULT_OUTPUTS, Range
from .samples import (
    CONFIDENCE,
    RESAMPLES,
    Groups,
    Method,
    complete_groups,
    estimate_over_ranges,
    problem_of,
)

DEFAULT_TRAJECTORIES = 256
LEVELS = 4
"""Levels of the grid on which the trajectories run; the usual number."""


def morris(
    base: Scene | Block | tuple[Block, Soil, Impact],
    ranges: Mapping[str, Range | tuple[float, float]],
    outputs: Iterable[str] = DEFAULT_OUTPUTS,
    *,
    trajectories: int = DEFAULT_TRAJECTORIES,
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
    return estimate_over_ranges(
        _METHOD,
        base,
        ranges,
        outputs,
        size=trajectories,
        seed=seed,
        accuracy=accuracy,
        journal=journal,
        progress=progress,
    )


class Morris(NamedTuple):
    """Elementary effects on one output, in its unit over a parameter's whole range."""

    mean_effect: Float[np.ndarray, " parameters"]
    mean_absolute_effect: Float[np.ndarray, " parameters"]
    mean_absolute_effect_interval: Float[np.ndarray, " parameters"]
    effect_deviation: Float[np.ndarray, " parameters"]
    groups: Groups


def morris_of(
    fractions: Float[np.ndarray, "trajectories rows parameters"],
    values: Float[np.ndarray, "trajectories rows"],
    seed: int,
) -> Morris:
    """Estimate elementary effects from trajectories.

    Args:
        fractions: of the ranges, 0 to 1, from SALib's sample.
        values: outputs; NaN where there is none.
        seed: of the bootstrap.

    Source: Morris (1991), doi 10.1080/00401706.1991.10484804, and Campolongo et al.
    (2007), doi 10.1016/j.envsoft.2006.10.004, as SALib computes it.
    """
    from SALib.analyze import morris as salib  # a second, for pandas and SciPy

    parameters = fractions.shape[2]
    whole, groups = complete_groups(values)
    if groups.reason:
        return Morris._make([*[np.full(parameters, np.nan)] * 4, groups])
    found = salib.analyze(
        problem_of(map(str, range(parameters))),
        fractions[np.isfinite(values).all(axis=1)].reshape(-1, parameters),
        whole.ravel(),
        num_resamples=RESAMPLES,
        conf_level=CONFIDENCE,
        num_levels=LEVELS,
        seed=seed,
    )
    names = ("mu", "mu_star", "mu_star_conf", "sigma")
    return Morris._make([*(np.asarray(found[n], float) for n in names), groups])


def check_trajectories(trajectories: int, parameters: int) -> None:
    """Raise InputError for too few trajectories to have a standard deviation, and for
    more than fit into memory."""
    whole_number("trajectories", trajectories, 2)
    impacts = trajectories * (parameters + 1)
    check_memory(
        impacts * NUMBERS_PER_IMPACT, f"{trajectories} trajectories, {impacts} impacts,"
    )


def _sample(problem: dict, trajectories: int, seed: int) -> np.ndarray:
    from SALib.sample import morris as salib  # a second, for pandas and SciPy

    return salib.sample(problem, trajectories, num_levels=LEVELS, seed=seed)


_METHOD = Method(
    title="Morris's elementary effects",
    check_size=check_trajectories,
    sample=_sample,
    estimate=morris_of,
    variables={
        name: {"units": "output_unit", "long_name": meaning}
        for name, meaning in (
            ("mean_effect", "mu, mean effect of the whole range"),
            ("mean_absolute_effect", "mu*, mean absolute effect of the whole range"),
            ("mean_absolute_effect_interval", "half width of its 95 % interval"),
            ("effect_deviation", "sigma, standard deviation of the effect"),
        )
    },
    totals={},
)

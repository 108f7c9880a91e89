"""Morris's elementary effects: which parameters matter at all, at little cost."""

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

import xarray as xr

from ..accuracy import DEFAULT_ACCURACY, Accuracy, get_accuracy
from ..block import Block
from ..fields import whole_number
from ..formats.checks import NUMBERS_PER_IMPACT, check_memory, check_scene
from ..precision import require_float64
from ..scene import Impact, Scene, as_scene
from ..soil import Soil
from .estimators import LEVELS, morris_of, problem_of
from .global_result import global_dataset
from .names import DEFAULT_OUTPUTS, output_columns
from .ranges import Range, check_ranges
from .sampling import check_seed, sampled_outputs

DEFAULT_TRAJECTORIES = 256


def morris(
    base: Scene | Block | tuple[Block, Soil, Impact],
    ranges: Mapping[str, Range | tuple[float, float]],
    outputs: Iterable[str] = DEFAULT_OUTPUTS,
    *,
    trajectories: int = DEFAULT_TRAJECTORIES,
    seed: int = 0,
    accuracy: str | Accuracy = DEFAULT_ACCURACY,
    journal: Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    r"""Elementary effects of parameters over their ranges.

    A trajectory changes one parameter after another by two thirds of its range; the
    change of the output, over that part, is an elementary effect. Their mean absolute
    value, mu*, says how much a parameter matters, their deviation, sigma, how much that
    depends on where one is: on curvature and on the other parameters.

    Args:
        base, ranges, outputs, seed, accuracy, journal, progress: as for `sobol`.
        trajectories: each is an impact for every parameter and one more.

    Returns:
        A dataset over `output` and `parameter`: `mean_effect` (mu),
        `mean_absolute_effect` (mu*), the half width of its 95 % interval
        (`mean_absolute_effect_interval`, bootstrap) and `effect_deviation` (sigma), in
        the unit of the output over the whole range of the parameter. For each output
        `groups_kept`, `groups_dropped`: a trajectory with an impact that has no value
        is left out whole; effects are NaN, and `reason` says why, as for `sobol`.

    Source: Morris (1991), doi 10.1080/00401706.1991.10484804, through SALib.

    Raises as `sobol` does.
    """
    require_float64()
    base = as_scene(base)
    check_scene(base)
    checked, columns = check_ranges(base, ranges), output_columns(outputs)
    check_seed(seed)
    check_trajectories(trajectories, len(checked))
    setting = get_accuracy(accuracy)
    from SALib.sample import morris as salib  # a second, for pandas and SciPy

    shares = salib.sample(
        problem_of(checked), trajectories, num_levels=LEVELS, seed=seed
    )
    values, outcomes = sampled_outputs(
        base, checked, shares, columns, setting, journal, progress
    )
    rows = len(checked) + 1
    of_shares = shares.reshape(trajectories, rows, len(checked))
    of_values = values.reshape(trajectories, rows, len(columns))
    found = [
        morris_of(of_shares, of_values[:, :, i], seed) for i in range(len(columns))
    ]
    unit = "output_unit"
    by_parameter = {
        "mean_effect": (unit, "mu, mean effect of the whole range"),
        "mean_absolute_effect": (unit, "mu*, mean absolute effect of the whole range"),
        "mean_absolute_effect_interval": (unit, "half width of its 95 % interval"),
        "effect_deviation": (unit, "sigma, standard deviation of the effect"),
    }
    return global_dataset(
        "Morris's elementary effects",
        found,
        by_parameter,
        (checked, columns),
        base=base,
        accuracy=setting,
        seed=seed,
        outcomes=outcomes,
    )


def check_trajectories(trajectories: int, parameters: int) -> None:
    """Raise InputError for too few to have a deviation, and for more than fit into
    memory."""
    whole_number("trajectories", trajectories, 2)
    impacts = trajectories * (parameters + 1)
    check_memory(
        impacts * NUMBERS_PER_IMPACT, f"{trajectories} trajectories, {impacts} impacts,"
    )

"""Sobol indices: which parameters the spread of an output comes from."""

import math
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

import xarray as xr

from ..accuracy import DEFAULT_ACCURACY, Accuracy, get_accuracy
from ..block import Block
from ..errors import InputError
from ..formats.checks import NUMBERS_PER_IMPACT, check_memory, check_scene
from ..precision import require_float64
from ..scene import Impact, Scene, as_scene
from ..soil import Soil
from .estimators import problem_of, sobol_of
from .global_result import global_dataset
from .names import DEFAULT_OUTPUTS, output_columns
from .ranges import Range, check_ranges
from .sampling import check_seed, sampled_outputs

DEFAULT_BLOCKS = 4096


def sobol(
    base: Scene | Block | tuple[Block, Soil, Impact],
    ranges: Mapping[str, Range | tuple[float, float]],
    outputs: Iterable[str] = DEFAULT_OUTPUTS,
    *,
    blocks: int = DEFAULT_BLOCKS,
    seed: int = 0,
    accuracy: str | Accuracy = DEFAULT_ACCURACY,
    journal: Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    r"""Sobol indices of impacts over ranges of parameters.

    $$ S_i = \frac{V[E(y | x_i)]}{V[y]}, \qquad
       S_{Ti} = 1 - \frac{V[E(y | x_{\sim i})]}{V[y]} $$

    The first-order index is the part of the variance that goes if a parameter gets
    known; the total index the part that stays if all others do. What the total has
    more is in combinations with others.

    Args:
        base: one impact, as for `simulate`; what does not vary is as here.
        ranges: input column -> `Range`, or a pair (lower, upper), uniform, in the unit
            of the column; at least two. Parameters are independent.
        outputs: result columns; all of a table of results if not said.
        blocks: of Saltelli's sample, a power of two; each is an impact for every
            parameter and two more. Intervals narrow with its root.
        seed: of the sample and of the intervals.
        accuracy, journal, progress: as for `simulate_batch`.

    Returns:
        A dataset over `output` and `parameter`: `first_order`, `total_order`, and
        `..._interval`, the half width of the 95 % interval (bootstrap). For each
        output its `mean` and `standard_deviation` over the ranges, and
        `groups_kept`, `groups_dropped`: a block with an impact that has no value is
        left out whole; see `estimators`. Indices are NaN where fewer than half of the
        blocks are left, or the output does not change; `reason` says so. Outcomes
        (attribute `outcomes`) that are no failure count as they are: a separating
        block has an e_n of -1.

    Source: Saltelli et al. (2010), doi 10.1016/j.cpc.2009.09.018, through SALib.

    Raises:
        InputError: unknown names, ranges that are none, blocks that are no power of
            two, a journal of something else.
        ValueError: a base that is no single scene.
    """
    require_float64()
    base = as_scene(base)
    check_scene(base)
    checked, columns = check_ranges(base, ranges), output_columns(outputs)
    check_seed(seed)
    check_blocks(blocks, len(checked))
    setting = get_accuracy(accuracy)
    from SALib.sample import sobol as salib  # a second, for pandas and SciPy

    shares = salib.sample(
        problem_of(checked), blocks, calc_second_order=False, seed=seed
    )
    values, outcomes = sampled_outputs(
        base, checked, shares, columns, setting, journal, progress
    )
    of_blocks = values.reshape(blocks, len(checked) + 2, len(columns))
    found = [sobol_of(of_blocks[:, :, i], seed) for i in range(len(columns))]
    by_parameter = {
        "first_order": ("-", "first-order index"),
        "first_order_interval": ("-", "half width of its 95 % interval"),
        "total_order": ("-", "total index"),
        "total_order_interval": ("-", "half width of its 95 % interval"),
    }
    dataset = global_dataset(
        "Sobol indices",
        found,
        by_parameter,
        (checked, columns),
        base=base,
        accuracy=setting,
        seed=seed,
        outcomes=outcomes,
    )
    dataset["mean"] = ("output", [x.mean for x in found])
    dataset["standard_deviation"] = ("output", [x.standard_deviation for x in found])
    for name in ("mean", "standard_deviation"):
        dataset[name].attrs["long_name"] = f"{name} over the ranges, in output_unit"
    return dataset


def check_blocks(blocks: int, parameters: int) -> None:
    """Raise InputError unless it is a power of two, which Sobol's sequence needs for
    its balance, and the sample fits into memory."""
    if not isinstance(blocks, int) or blocks < 2 or blocks & (blocks - 1):
        near = 1024
        if isinstance(blocks, int) and blocks >= 1:
            near = 2 ** max(1, round(math.log2(blocks)))
        raise InputError(
            f"blocks must be a power of two, but is {blocks!r}; take {near}"
        )
    impacts = blocks * (parameters + 2)
    check_memory(impacts * NUMBERS_PER_IMPACT, f"{blocks} blocks, {impacts} impacts,")

"""Sobol indices: which parameters the variance of an output comes from."""

import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr
from jaxtyping import Float

from ..accuracy import DEFAULT_ACCURACY, Accuracy
from ..errors import InputError
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
        seed: of the sample and of the bootstrap.
        accuracy, journal, progress: as for `simulate_batch`.

    Returns:
        A dataset over `output` and `parameter`: `first_order`, `total_order`, and
        `..._interval`, the half width of the 95 % confidence interval (bootstrap). For
        each output its `mean` and `standard_deviation` over the ranges, and
        `groups_kept`, `groups_dropped`: a block with an impact that has no value is
        left out whole; see `sensitivity.samples`. Indices are NaN where fewer than half
        of the blocks are left, or the output does not change; `reason` says so.
        Outcomes (attribute `outcomes`) that are no failure count as they are: a
        separating block has an e_n of -1.

    Source: Saltelli et al. (2010), doi 10.1016/j.cpc.2009.09.018, through SALib.

    Raises:
        InputError: unknown names, ranges that are none, blocks that are no power of
            two, a journal of something else.
        ValueError: a base that is no single scene.
    """
    return estimate_over_ranges(
        _METHOD,
        base,
        ranges,
        outputs,
        size=blocks,
        seed=seed,
        accuracy=accuracy,
        journal=journal,
        progress=progress,
    )


class Sobol(NamedTuple):
    """Sobol indices of one output, with half widths of 95 % confidence intervals."""

    first_order: Float[np.ndarray, " parameters"]
    first_order_interval: Float[np.ndarray, " parameters"]
    total_order: Float[np.ndarray, " parameters"]
    total_order_interval: Float[np.ndarray, " parameters"]
    mean: float
    standard_deviation: float
    groups: Groups


def sobol_of(values: Float[np.ndarray, "blocks rows"], seed: int) -> Sobol:
    """Estimate first-order and total indices from blocks of Saltelli's sample.

    Args:
        values: a row for each block, in SALib's order: A, then A with each parameter
            from B, then B; NaN where there is none.
        seed: of the bootstrap.

    Source: Saltelli et al. (2010), doi 10.1016/j.cpc.2009.09.018, as SALib computes it.
    """
    from SALib.analyze import sobol as salib  # a second, for pandas and SciPy

    parameters = values.shape[1] - 2
    whole, groups = complete_groups(values)
    if groups.reason:
        nothing = np.full(parameters, np.nan)
        return Sobol._make([*[nothing] * 4, np.nan, np.nan, groups])
    found = salib.analyze(
        problem_of(map(str, range(parameters))),
        whole.ravel(),
        calc_second_order=False,
        num_resamples=RESAMPLES,
        conf_level=CONFIDENCE,
        seed=seed + 1,  # SALib takes 0 for none
    )
    indices = (found[name] for name in ("S1", "S1_conf", "ST", "ST_conf"))
    ends = whole[:, [0, -1]]
    return Sobol._make([*indices, float(ends.mean()), float(ends.std()), groups])


def check_blocks(blocks: int, parameters: int) -> None:
    """Raise InputError unless the number of blocks is a power of two, which Sobol's
    sequence needs for its balance, and the sample fits into memory."""
    if not isinstance(blocks, int) or blocks < 2 or blocks & (blocks - 1):
        near = 1024
        if isinstance(blocks, int) and blocks >= 1:
            near = 2 ** max(1, round(math.log2(blocks)))
        raise InputError(
            f"blocks must be a power of two, but is {blocks!r}; take {near}"
        )
    impacts = blocks * (parameters + 2)
    check_memory(impacts * NUMBERS_PER_IMPACT, f"{blocks} blocks, {impacts} impacts,")


def _sample(problem: dict, blocks: int, seed: int) -> np.ndarray:
    from SALib.sample import sobol as salib  # a second, for pandas and SciPy

    return salib.sample(problem, blocks, calc_second_order=False, seed=seed)


_INTERVAL = {"units": "-", "long_name": "half width of its 95 % interval"}
_METHOD = Method(
    title="Sobol indices",
    check_size=check_blocks,
    sample=_sample,
    estimate=lambda fractions, values, seed: sobol_of(values, seed),
    variables={
        "first_order": {"units": "-", "long_name": "first-order index"},
        "first_order_interval": _INTERVAL,
        "total_order": {"units": "-", "long_name": "total index"},
        "total_order_interval": _INTERVAL,
    },
    totals={
        name: {"long_name": f"{name} over the ranges, in output_unit"}
        for name in ("mean", "standard_deviation")
    },
)

"""Estimates over ranges of parameters, from samples of impacts some of which failed.

An estimator compares impacts that belong together: a block of Saltelli's sample, a
trajectory of Morris's. A group with an impact that has no value is left out whole, and
counted. A mean in the place of that value would bias the indices towards zero, and the
other impacts of the group alone would compare what does not belong together.

The groups that are left sample the region where the model has values. If failures
gather in a corner of the ranges, the estimates hold for the rest of them.
"""

import dataclasses
import json
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from .._checks import whole_number
from .._precision import require_float64
from .._versions import version_of, versions
from ..accuracy import Accuracy, get_accuracy
from ..batch import simulate_batch
from ..identity import part_names
from ..io.checks import check_scene
from ..io.result_table import count_outcomes
from ..progress import Progress, ProgressFunction
from ..quantities import columns_of
from ..scene import Block, Impact, Scene, as_scene
from ..scene_quantities import scene_values, scene_with
from ..soil import Soil
from .ranges import Range, axes_of_names, check_ranges, output_columns

LARGEST_SEED = 2**32 - 2
"""SALib's own limit, less the one that is added."""
RESAMPLES = 200
"""Resamples of the bootstrap."""
CONFIDENCE = 0.95
"""Probability of the confidence intervals."""
LEAST_KEPT = 0.5
"""Fraction of the groups that must be complete."""
CONSTANT_WITHIN = 1e-12
"""Range over size of an output below which it counts as constant."""


class Groups(NamedTuple):
    """Groups of impacts that an estimate was made from."""

    kept: int
    """Number of complete groups."""
    dropped: int
    """Number of groups left out."""
    reason: str
    """Why there is no estimate; empty where there is one."""


class Method(NamedTuple):
    """A method of global sensitivity analysis."""

    title: str
    check_size: Callable[[int, int], None]
    """Raises InputError for a number of groups, and of parameters, that is unfit."""
    sample: Callable[[dict, int, int], np.ndarray]
    """Of a problem for SALib, the number of groups and a seed: fractions of the ranges,
    shape (impacts, parameters)."""
    estimate: Callable[[np.ndarray, np.ndarray, int], Any]
    """Of the fractions (groups, impacts, parameters), values of an output (groups,
    impacts) and a seed: a named tuple of the variables, and `groups`."""
    variables: Mapping[str, dict[str, str]]
    """Fields of the estimate over the parameters -> attributes in the dataset."""
    totals: Mapping[str, dict[str, str]]
    """Fields of the estimate that are one number for each output -> attributes."""


def estimate_over_ranges(
    method: Method,
    base: Scene | Block | tuple[Block, Soil, Impact],
    ranges: Mapping[str, Range | tuple[float, float]],
    outputs: Iterable[str],
    *,
    size: int,
    seed: int,
    accuracy: str | Accuracy,
    journal: Path | None,
    progress: Progress | ProgressFunction | None,
) -> xr.Dataset:
    """Sample the ranges, compute the impacts and estimate each output's indices.

    Args:
        size: number of groups.
        base, ranges, outputs, seed, accuracy, journal, progress: as for `sobol`.
    """
    require_float64()
    base = as_scene(base)
    check_scene(base)
    checked, columns = check_ranges(base, ranges), output_columns(outputs)
    check_seed(seed)
    method.check_size(size, len(checked))
    setting = get_accuracy(accuracy)
    fractions = method.sample(problem_of(checked), size, seed)
    sampled = {
        name: given.values(fractions[:, i])
        for i, (name, given) in enumerate(checked.items())
    }
    result = simulate_batch(
        scene_with(base, sampled), accuracy=setting, journal=journal, progress=progress
    )
    fractions = fractions.reshape(size, -1, len(checked))
    found = [
        method.estimate(
            fractions, np.asarray(getattr(result, column.field)).reshape(size, -1), seed
        )
        for column in columns
    ]

    def variables(fields: Mapping[str, dict[str, str]], *dimensions: str) -> dict:
        return {
            name: (dimensions, np.array([getattr(one, name) for one in found]), about)
            for name, about in fields.items()
        }

    groups = [estimate.groups for estimate in found]
    counts = {
        "groups_kept": ("output", np.array([g.kept for g in groups], np.int32)),
        "groups_dropped": ("output", np.array([g.dropped for g in groups], np.int32)),
        "reason": ("output", [g.reason for g in groups]),
    }
    inputs = tuple(columns_of(base)[name] for name in checked)
    return xr.Dataset(
        variables(method.variables, "output", "parameter")
        | counts
        | variables(method.totals, "output"),
        axes_of_names(inputs, columns),
        attrs={
            "title": f"jaximpact: {method.title} of impacts",
            "base": json.dumps(scene_values(base)),
            "laws": json.dumps(part_names(base.soil, base.block)),
            "ranges": json.dumps(
                {name: dataclasses.asdict(given) for name, given in checked.items()}
            ),
            "seed": seed,
            "accuracy": json.dumps(dataclasses.asdict(setting)),
            "outcomes": json.dumps(count_outcomes(result)),
            "versions": json.dumps(versions() | {"SALib": version_of("SALib")}),
        },
    )


def check_seed(seed: int) -> None:
    """Raise InputError for what is no seed."""
    whole_number("seed", seed, 0, LARGEST_SEED)


def problem_of(names: Iterable[str]) -> dict:
    """Describe parameters between 0 and 1 to SALib. SALib writes into the description,
    so it is made anew each time."""
    names = list(names)
    bounds = [[0.0, 1.0]] * len(names)
    return {"num_vars": len(names), "names": names, "bounds": bounds}


def complete_groups(values: np.ndarray) -> tuple[np.ndarray, Groups]:
    """Select the groups that have all their values, shape (groups, impacts), and say
    whether they suffice."""
    complete = np.isfinite(values).all(axis=1)
    whole = values[complete]
    kept, dropped = int(complete.sum()), int((~complete).sum())
    reason = ""
    if kept < max(2, LEAST_KEPT * len(values)):
        words = "no group" if kept == 0 else "less than half of the groups"
        reason = f"{words} has all its values"
    elif np.ptp(whole) <= CONSTANT_WITHIN * np.abs(whole).max():
        reason = "the output does not change"
    return whole, Groups(kept, dropped, reason)

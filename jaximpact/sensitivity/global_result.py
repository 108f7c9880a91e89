"""The dataset of a study over ranges."""

import dataclasses
import json
from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from ..accuracy import Accuracy
from ..formats.columns import ResultColumn, columns_of
from ..formats.provenance import version_of, versions
from ..formats.scenes import scene_values
from ..identity import part_names
from ..scene import Scene
from .elasticity import axes_of_names
from .estimators import Morris, Sobol
from .ranges import Range


def global_dataset(
    title: str,
    found: Sequence[Sobol | Morris],
    by_parameter: Mapping[str, tuple[str, str]],
    names: tuple[Mapping[str, Range], tuple[ResultColumn, ...]],
    *,
    base: Scene,
    accuracy: Accuracy,
    seed: int,
    outcomes: dict[str, int],
) -> xr.Dataset:
    """Estimates of each output as a dataset that says what it was computed from.

    Args:
        title: what is estimated.
        found: an estimate for each output.
        by_parameter: fields of the estimates -> unit and meaning.
        names: ranges of the parameters, and columns of the outputs.
        base, accuracy, seed, outcomes: for the attributes.
    """
    ranges, columns = names
    variables = {
        name: (
            ("output", "parameter"),
            np.stack([getattr(estimate, name) for estimate in found]),
            {"units": unit, "long_name": meaning},
        )
        for name, (unit, meaning) in by_parameter.items()
    }
    groups = [estimate.groups for estimate in found]
    variables |= {
        "groups_kept": ("output", np.array([g.kept for g in groups], np.int32)),
        "groups_dropped": ("output", np.array([g.dropped for g in groups], np.int32)),
        "reason": ("output", [g.reason for g in groups]),
    }
    inputs = tuple(columns_of(base)[name] for name in ranges)
    return xr.Dataset(
        variables,
        axes_of_names(inputs, columns),
        attrs={
            "title": f"jaximpact: {title} of impacts",
            "base": json.dumps(scene_values(base)),
            "laws": json.dumps(part_names(base.soil, base.block)),
            "ranges": json.dumps(
                {name: dataclasses.asdict(given) for name, given in ranges.items()}
            ),
            "seed": seed,
            "accuracy": json.dumps(dataclasses.asdict(accuracy)),
            "outcomes": json.dumps(outcomes),
            "versions": json.dumps(versions() | {"SALib": version_of("SALib")}),
        },
    )

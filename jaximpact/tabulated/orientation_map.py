"""Restitution over speed and angle, averaged over the orientation of the block.

What rockfall programs take as input, with the spread that one number hides.
"""

import json
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from ..accuracy import Accuracy
from ..block import Block
from ..formats.columns import INPUT_COLUMNS, OUTCOME_COLUMN, RESULT_COLUMNS
from ..formats.files import replacing
from ..formats.outputs import manifest_path
from ..mechanics.outcomes import Outcome
from ..scene import Impact, Scene
from ..soil import Soil
from ..sweeping import sweep
from ..units import DEGREE

COEFFICIENTS = ("e_n", "e_t", "e_bar")
DIMENSIONS = ("speed_mps", "angle_deg", "angular_velocity_degps")
SHOWN = (5, 95)
"""Percentiles of the cells between which colours of a map change."""
STATISTICS = {
    "mean": "mean",
    "sd": "standard deviation",
    "p5": "not reached by 5 %",
    "p95": "not exceeded by 95 %",
}


class MapAxes(NamedTuple):
    """Where a map is computed, each axis ascending."""

    speeds_mps: tuple[float, ...] = (1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0, 40.0)
    angles_deg: tuple[float, ...] = (0.0, *np.arange(5.0, 86.0, 5.0).tolist())
    """From the ground's normal, negative up-slope."""
    angular_velocities_degps: tuple[float, ...] = (0.0,)
    slope_deg: float = 0.0
    orientations: int = 180
    """Over half a turn, in the middles of equal intervals; all alike likely. 1 for a
    round block, whatever is asked for."""


def orientation_map(
    block: Block,
    soil: Soil,
    axes: MapAxes | None = None,
    *,
    accuracy: str | Accuracy = "fast",
    journal: Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    """Restitution coefficients over all orientations, by the full model.

    Args:
        block, soil: scalars.
        accuracy, journal, progress: as for `sweep`.

    Returns:
        A dataset over speed, angle and spin: of each coefficient mean, standard
        deviation, and the values that 5 and 95 % of the orientations do not exceed, all
        over the impacts that took place. Beside them stand how many those are
        (`impacts`), how many were none, as the block's deepest point moved away
        (`separating`), how many failed, and shares of the outcomes of the impacts.
    """
    axes = axes or MapAxes()
    count = 1 if block.shape.is_round() else axes.orientations
    orientations = (np.arange(count) + 0.5) * 180.0 / count
    found = sweep(
        Scene(block, soil, Impact(slope=axes.slope_deg * DEGREE)),
        {**dict(zip(DIMENSIONS, axes, strict=False)), "orientation_deg": orientations},
        accuracy=accuracy,
        journal=journal,
        progress=progress,
    )
    outcome = found[OUTCOME_COLUMN].values
    failed = outcome == str(Outcome.failed)
    separating = outcome == str(Outcome.separating)
    struck = ~failed & ~separating
    variables = {
        "impacts": (DIMENSIONS, struck.sum(-1), _about("orientations that strike")),
        "separating": (DIMENSIONS, separating.sum(-1), _about("that move away")),
        "failed": (DIMENSIONS, failed.sum(-1), _about("that could not be integrated")),
    }
    for name in COEFFICIENTS:
        numbers = _statistics(np.where(struck, found[name].values, np.nan))
        for key, values in zip(STATISTICS, numbers, strict=True):
            meaning = f"{RESULT_COLUMNS[name].meaning}: {STATISTICS[key]}"
            variables[f"{name}_{key}"] = (DIMENSIONS, values, _about(meaning))
    impacts = struck.sum(-1)
    for kind in Outcome:
        if kind not in (Outcome.failed, Outcome.separating):
            with np.errstate(invalid="ignore"):
                share = np.sum(outcome == str(kind), axis=-1) / impacts
            name = f"share_{kind}".replace(" ", "_")
            variables[name] = (DIMENSIONS, share, _about(f"of the impacts, {kind}"))
    coordinates = {
        name: (name, np.asarray(values, float), {"units": INPUT_COLUMNS[name].unit})
        for name, values in zip(DIMENSIONS, axes, strict=False)
    }
    attributes = {
        "title": "jaximpact: restitution over all orientations",
        "orientations": count,
    }
    kept = ("base", "accuracy", "model_tolerance", "laws", "versions")
    attributes |= {name: found.attrs[name] for name in kept}
    return xr.Dataset(variables, coordinates, attributes)


def _statistics(values: np.ndarray) -> list[np.ndarray]:
    """Along the last axis, of what is a number; NaN where nothing is."""
    shape = values.shape[:-1]
    found = np.full((len(STATISTICS), *shape), np.nan)
    for place in np.ndindex(shape):
        some = values[place][np.isfinite(values[place])]
        if len(some):
            ends = np.percentile(some, (5, 95))
            found[(slice(None), *place)] = np.mean(some), np.std(some), *ends
    return list(found)


def _about(meaning: str) -> dict[str, str]:
    return {"units": "-", "long_name": meaning}


def write_map(path: Path, dataset: xr.Dataset) -> None:
    """Write a map as CSV, a row for each speed, angle and spin, with a manifest and a
    drawing beside it, each whole or not at all.

    Raises OSError where the file system refuses.
    """
    path = Path(path)
    decoded = ("base", "accuracy", "laws", "versions")
    manifest = {
        key: json.loads(value) if key in decoded else value
        for key, value in dataset.attrs.items()
    }
    # The manifest takes its name first: by it a later run knows the drawing.
    with (
        replacing(path.with_suffix(".png")) as drawing_temporary,
        replacing(path) as temporary,
        replacing(manifest_path(path)) as manifest_temporary,
    ):
        plot_map(dataset, drawing_temporary)
        manifest_temporary.write_text(json.dumps(manifest, indent=2) + "\n")
        dataset.to_dataframe().to_csv(temporary, na_rep="nan", lineterminator="\n")


def plot_map(dataset: xr.Dataset, path: Path) -> None:
    """Mean and standard deviation of each coefficient over speed and angle, a row of
    maps for each spin."""
    spins = dataset.angular_velocity_degps.values
    figure = Figure(figsize=(16.0, 1.0 + 3.2 * len(spins)), layout="constrained")
    panels = figure.subplots(
        len(spins), 2 * len(COEFFICIENTS), sharex=True, sharey=True, squeeze=False
    )
    speeds, angles = _edges(dataset.speed_mps.values), _edges(dataset.angle_deg.values)
    for column, (name, key) in enumerate(
        (name, key) for name in COEFFICIENTS for key in ("mean", "sd")
    ):
        values = dataset[f"{name}_{key}"].transpose(*DIMENSIONS).values
        finite = values[np.isfinite(values)]
        # At grazing incidence coefficients grow without bounds.
        low, high = np.percentile(finite, SHOWN) if len(finite) else (0.0, 1.0)
        for row, spin in enumerate(spins):
            axes = panels[row, column]
            image = axes.pcolormesh(
                angles,
                speeds,
                np.ma.masked_invalid(values[..., row]),
                cmap="viridis" if key == "mean" else "cividis",
                vmin=low,
                vmax=high,
            )
            axes.set_facecolor("0.85")
            axes.set_yscale("log")
            if row == len(spins) - 1:
                axes.set_xlabel("impact angle [deg]")
            if column == 0:
                axes.set_ylabel(f"{spin:g} deg/s\nspeed [m/s]")
        panels[0, column].set_title(f"{name}, {STATISTICS[key]} [-]", fontsize="medium")
        figure.colorbar(
            image,
            ax=panels[:, column],
            location="bottom",
            shrink=0.9,
            extend="both",
        )
    figure.suptitle(
        f"restitution over {dataset.attrs['orientations']} orientations, all alike "
        "likely"
    )
    figure.savefig(path, dpi=150)


def _edges(centres: np.ndarray) -> np.ndarray:
    """Of cells around values that ascend."""
    if len(centres) == 1:
        return centres[0] + np.array([-0.5, 0.5]) * max(abs(centres[0]), 1.0)
    middles = 0.5 * (centres[1:] + centres[:-1])
    first = max(centres[0] - (middles[0] - centres[0]), 0.5 * min(centres[0], 0.0))
    first = first if centres[0] <= 0.0 else max(first, 0.5 * centres[0])
    last = centres[-1] + (centres[-1] - middles[-1])
    return np.concatenate([[first], middles, [last]])

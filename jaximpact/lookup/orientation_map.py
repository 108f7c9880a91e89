"""Restitution over speed and angle, averaged over the orientation of the block.

Rockfall programs take such coefficients as input; the map adds the spread that one
number hides.
"""

import json
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import xarray as xr

from ..accuracy import Accuracy
from ..impact.events import Outcome
from ..io.files import replacing
from ..io.output_files import replacing_with_manifest
from ..progress import Progress, ProgressFunction
from ..quantities import INPUT_COLUMNS, OUTCOME_COLUMN, RESULT_COLUMNS
from ..scene import Block, Impact, Scene, Soil
from ..sweeping import sweep
from ..units import DEGREE

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COEFFICIENTS = ("e_n", "e_t", "e_bar")
DIMENSIONS = ("speed_mps", "angle_deg", "angular_velocity_degps")
STATISTICS = {
    "mean": "mean",
    "sd": "standard deviation",
    "p5": "not reached by 5 %",
    "p95": "not exceeded by 95 %",
}
SHOWN = (5, 95)
"""Percentiles of a map's values between which its colours change."""
DRAWN = (("mean", "mean", "viridis"), ("sd", "standard deviation", "cividis"))
"""Statistics that are drawn: suffix of their variables, words, and colours."""


class MapAxes(NamedTuple):
    """Axes of a map, each ascending."""

    speeds_mps: tuple[float, ...] = (1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0, 40.0)
    angles_deg: tuple[float, ...] = (0.0, *np.arange(5.0, 86.0, 5.0).tolist())
    """Impact angles from the normal of the ground [deg], negative up-slope."""
    angular_velocities_degps: tuple[float, ...] = (0.0,)
    slope_deg: float = 0.0
    orientations: int = 180
    """Number of orientations over half a turn, at the middles of equal intervals, all
    equally likely. A round block has 1, whatever is asked for."""


def orientation_map(
    block: Block,
    soil: Soil,
    axes: MapAxes | None = None,
    *,
    accuracy: str | Accuracy = "fast",
    journal: Path | None = None,
    progress: Progress | ProgressFunction | None = None,
) -> xr.Dataset:
    """Compute restitution coefficients over all orientations by the full model.

    Args:
        block, soil: scalars.
        axes: speeds, angles, spins, slope and number of orientations.
        accuracy, journal, progress: as for `sweep`.

    Returns:
        A dataset over speed, angle and spin: of each coefficient the mean, standard
        deviation, 5 and 95 % quantile over the orientations that strike; their number
        (`impacts`); the number of orientations whose lowest point moves away
        (`separating`) and of those that could not be integrated (`failed`); and the
        fraction of the impacts with each outcome.
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
    impacts = struck.sum(-1)
    variables = {
        "impacts": (DIMENSIONS, impacts, _about("orientations that strike")),
        "separating": (DIMENSIONS, separating.sum(-1), _about("that move away")),
        "failed": (DIMENSIONS, failed.sum(-1), _about("that could not be integrated")),
    }
    for name in COEFFICIENTS:
        numbers = _statistics(np.where(struck, found[name].values, np.nan))
        for key, values in zip(STATISTICS, numbers, strict=True):
            meaning = f"{RESULT_COLUMNS[name].meaning}: {STATISTICS[key]}"
            variables[f"{name}_{key}"] = (DIMENSIONS, values, _about(meaning))
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
    kept = ("base", "accuracy", "model_tolerance", "laws", "versions")
    attributes = {
        "title": "jaximpact: restitution over all orientations",
        "orientations": count,
        **{name: found.attrs[name] for name in kept},
    }
    return xr.Dataset(variables, coordinates, attributes)


def _statistics(values: np.ndarray) -> list[np.ndarray]:
    """Compute statistics along the last axis, of finite values; NaN where there are
    none."""
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
    """Write a map as CSV, with a manifest and a drawing beside it.

    A row for each speed, angle and spin; each file appears whole or not at all.

    Raises OSError where the file system refuses.
    """
    # Late imports of Matplotlib: run-outs with tables draw no map.
    from ..plotting.style import in_style, png_bytes

    path = Path(path)
    decoded = ("base", "accuracy", "laws", "versions")
    manifest = {
        key: json.loads(value) if key in decoded else value
        for key, value in dataset.attrs.items()
    }
    # The manifest takes its name first: by it a later run knows the drawing.
    with (
        replacing(path.with_suffix(".png")) as drawing,
        replacing_with_manifest(path, manifest) as temporary,
    ):
        drawing.write_bytes(png_bytes(in_style(_draw_map)(dataset)))
        dataset.to_dataframe().to_csv(temporary, na_rep="nan", lineterminator="\n")


def _draw_map(dataset: xr.Dataset) -> "Figure":
    """Draw mean and standard deviation of each coefficient over speed and angle, a row
    of panels for each spin and coefficient."""
    from ..plotting.style import log_scale, panels

    spins = dataset.angular_velocity_degps.values
    of_mean = [str(name) for name in dataset if str(name).endswith("_mean")]
    names = [name.removesuffix("_mean") for name in of_mean]
    shown = [(n, spin, name) for n, spin in enumerate(spins) for name in names]
    figure, axes = panels(
        len(shown),
        2,
        height=2.3,
        sharex=True,
        sharey=True,
        title=f"Restitution over {dataset.attrs['orientations']} orientations, all "
        "equally likely",
    )
    speeds, angles = _edges(dataset.speed_mps.values), _edges(dataset.angle_deg.values)
    for row, (place, spin, name) in enumerate(shown):
        both = zip(axes[2 * row : 2 * row + 2], DRAWN, strict=True)
        for panel, (key, words, colours) in both:
            variable = dataset[f"{name}_{key}"]
            values = variable.isel(angular_velocity_degps=place)
            finite = variable.values[np.isfinite(variable.values)]
            # At grazing incidence coefficients grow without bounds.
            low, high = np.percentile(finite, SHOWN) if finite.size else (0.0, 1.0)
            image = panel.pcolormesh(
                angles,
                speeds,
                np.ma.masked_invalid(values.transpose("speed_mps", "angle_deg")),
                cmap=colours,
                vmin=low,
                vmax=high,
            )
            panel.set_facecolor("0.85")
            panel.grid(visible=False)
            of_spin = f", {spin:g} deg/s" if len(spins) > 1 or spin else ""
            panel.set_title(f"{name}, {words}{of_spin}")
            figure.colorbar(image, ax=panel, label=f"{name} [-]", extend="both")
        axes[2 * row].set_ylabel("speed [m/s]")
    log_scale(axes[0], "y")
    for panel in axes[-2:]:
        panel.set_xlabel("impact angle [deg]")
    return figure


def _edges(centres: np.ndarray) -> np.ndarray:
    """Return the edges of cells around values that ascend."""
    if len(centres) == 1:
        return centres[0] + np.array([-0.5, 0.5]) * max(abs(centres[0]), 1.0)
    middles = 0.5 * (centres[1:] + centres[:-1])
    first = max(centres[0] - (middles[0] - centres[0]), 0.5 * min(centres[0], 0.0))
    first = first if centres[0] <= 0.0 else max(first, 0.5 * centres[0])
    last = centres[-1] + (centres[-1] - middles[-1])
    return np.concatenate([[first], middles, [last]])


def map_in_words(dataset: xr.Dataset) -> str:
    """Say how much a map holds, and what it leaves out."""
    impacts, separating, failed = (
        int(dataset[name].sum()) for name in ("impacts", "separating", "failed")
    )
    spread = dataset.e_n_sd.median()
    return (
        f"map of {dataset.impacts.size} speeds, angles and spins: {impacts} impacts; "
        f"left out {separating} that move away and {failed} that failed; standard "
        f"deviation of e_n over orientations, median of the map: {float(spread):.3g}"
    )

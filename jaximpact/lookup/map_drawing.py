"""Drawing of a map of restitution over speed and angle."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from ..plotting.style import in_style, log_scale, panels

SHOWN = (5, 95)
"""Percentiles of a map's values between which its colours change."""
DRAWN = (("mean", "mean", "viridis"), ("sd", "standard deviation", "cividis"))
"""Statistics that are drawn: suffix of their variables, words, and colours."""


@in_style
def draw_map(dataset: xr.Dataset) -> Figure:
    """Draw mean and standard deviation of each coefficient over speed and angle, a row
    of panels for each spin and coefficient."""
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

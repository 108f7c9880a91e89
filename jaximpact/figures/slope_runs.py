"""What the figures of the runs down a slope share."""

import dataclasses

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from ..distributions import Fit
from ..formats.columns import columns_of_part
from ..runout import Ending, Runs
from ..runout.biplanar import (
    ASPECT_RATIOS,
    FLAT_LENGTH,
    HEIGHT,
    SLOPE_LENGTH,
    SPEED,
    SPINS_DEGPS,
    BiplanarCase,
)
from ..units import DEGREE
from .drawing import ASPECT_RATIO
from .study import Study

SPIN = "angular_velocity_degps"
ENDING_COLUMN = "ending"
FEWEST = 0.5
"""Where the axis of counts begins: below one."""


def blocks_table(runs: Runs, trajectory: np.ndarray) -> pd.DataFrame:
    """Aspect ratio, the sphere's spin and the ending of some trajectories, a row for
    each place."""
    shapes = np.repeat(ASPECT_RATIOS, len(SPINS_DEGPS))
    spins = np.tile(SPINS_DEGPS, len(ASPECT_RATIOS))
    endings = np.array([str(Ending(code)) for code in runs.ending])
    of = np.asarray(trajectory).astype(int)
    return pd.DataFrame(
        {ASPECT_RATIO: shapes[of], SPIN: spins[of], ENDING_COLUMN: endings[of]}
    )


def case_values(study: Study) -> dict:
    """What the runs were computed from, for the manifest."""
    case = BiplanarCase()
    scene = study.parametric_set("I")[0]
    soil = {
        column.name: float(getattr(scene.soil, column.field)) / column.factor
        for column in columns_of_part("soil", scene.soil).values()
    }
    angles = {
        f"{name}_deg": getattr(case, name) / DEGREE
        for name in ("direction", "orientation", "rolling_friction_angle")
    }
    others = {
        field.name: getattr(case, field.name)
        for field in dataclasses.fields(case)
        if f"{field.name}_deg" not in angles and field.name != "height"
    }
    return {
        "slope_height_m": HEIGHT,
        "slope_length_m": SLOPE_LENGTH,
        "flat_length_m": FLAT_LENGTH,
        "speed_mps": SPEED,
        "height_above_the_crest_m": case.height,
        **angles,
        **others,
        "mass_kg": float(scene.block.mass),
        "density_kgm3": float(scene.block.density),
        "aspect_ratios": list(ASPECT_RATIOS),
        "spins_of_the_sphere_degps": list(SPINS_DEGPS),
        **soil,
    }


def draw_histogram(
    axes: Axes, values, edges: np.ndarray, fit: Fit, density, **style
) -> None:
    """Counts, and what the fitted density expects of them."""
    axes.hist(values, edges, histtype="stepfilled", color=style["color"], alpha=0.35)
    if np.isfinite(fit.scale):
        x = np.linspace(edges[0], edges[-1], 400)
        expected = fit.count * (edges[1] - edges[0]) * density(x, fit)
        axes.plot(x, expected, lw=1.4, **style)


def scale_counts(axes: Axes, values, edges: np.ndarray) -> None:
    """A logarithmic axis for counts of up to those of the values, and of a curve that
    passes above them."""
    axes.set_yscale("log")
    axes.set_ylim(FEWEST, 10.0 * max(1, *np.histogram(values, edges)[0]))


def distance_in_words(fit: Fit) -> str:
    """The distance, and in brackets what it exceeds by chance in 5 of 100 cases."""
    return f"{fit.distance:.2f} ({fit.distance_by_chance:.2f})"


def exponential(x: np.ndarray, fit: Fit) -> np.ndarray:
    """Its density, NaN before it begins."""
    beyond = np.where(x >= fit.start, x - fit.start, np.nan)
    return np.exp(-beyond / fit.scale) / fit.scale


def normal(x: np.ndarray, fit: Fit) -> np.ndarray:
    """Its density."""
    return np.exp(-0.5 * ((x - fit.start) / fit.scale) ** 2) / (
        np.sqrt(2.0 * np.pi) * fit.scale
    )

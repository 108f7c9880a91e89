"""Figs. 11, 12 and 14: slope run-out on two planes."""

import numpy as np
import xarray as xr

from jaximpact.parametric_sets import GROUNDS

from ..biplanar import COEFFICIENTS
from ..criteria import Judgement, between, condition, conditions, elongated, judge
from ..goodness_of_fit import Fit, fit_exponential, fit_normal
from ..study import SLOPE, Study

ON_THE_PARABOLA = 1e-6
"""[m]"""
SUPERIMPOSED = 2.3
"""Distance between paths that superimpose in a plot of the slope, 1 % of its height
[m]."""
A_FEW = (2, 4)
"""Bounces that count as three."""
SMALL = 0.1
"""Part of the first flight's height up to which a bounce is small."""
NEAR = 0.10
"""Distance between distributions that are near each other."""
ENOUGH = 20
"""Jumps that a distribution needs at the least."""
MEANS = {"e_n": 0.67, "e_t": 0.92}
"""Means in the paper."""
MEAN_WITHIN = 0.1
WELL_ABOVE, SHARE_ABOVE = 1.2, 0.01


def same_path(study: Study) -> Judgement:
    """Without spin all fly the same parabola, and their paths superimpose to 250 m."""
    still = _without_spin(study)
    off, apart = still.off_the_parabola_m, still.paths_apart_m
    long = elongated(apart)
    return judge(
        f"first impact at x {between(still.first_impact_x_m, 'm')}, within "
        f"{float(off.max()):.0e} m of the parabola; as far as x 250 m off the sphere's "
        f"path by up to {float(long.max()):.2g} m",
        conditions(off <= ON_THE_PARABOLA, "on the parabola"),
        conditions(long <= SUPERIMPOSED, "superimposed"),
    )


def elongated_blocks_roll(study: Study) -> Judgement:
    """Elongated blocks roll after the first impact, the sphere after three bounces."""
    still = _without_spin(study)
    sphere = still.sel(aspect_ratio=1.0)
    long = elongated(still)
    count, highest = int(sphere.bounces), float(sphere.highest_bounce_m)
    small = highest <= SMALL * float(sphere.first_flight_m)
    few = A_FEW[0] <= count <= A_FEW[1]
    return judge(
        f"bounces between first impact and rolling: sphere {count}, up to "
        f"{highest:.2g} m high; others {between(long.bounces)}, up to "
        f"{float(long.highest_bounce_m.max()):.2g} m high, but of a median rise of "
        f"{between(long.middle_bounce_m, 'm')}",
        conditions(long.rolls & (long.bounces == 0), "roll after the first impact"),
        condition(bool(sphere.rolls) and few and small),
    )


def _without_spin(study: Study) -> xr.Dataset:
    return study[SLOPE].sel(angular_velocity_degps=0.0, drop=True)


def heights_are_exponential(study: Study) -> Judgement:
    """Heights of jumps are near an exponential distribution on all grounds."""
    parts, words = [], []
    for ground in GROUNDS:
        fits = exponential_fits(study.on(ground)[SLOPE])
        _, _, distance, _, count = np.array([*fits.values()]).T
        distance = xr.DataArray(distance, coords={"aspect_ratio": list(fits)})
        part = conditions((distance <= NEAR) & (count >= ENOUGH), "near")
        parts += part.parts
        words.append(
            f"{ground}: distance {_listed(distance)} at A_r {_listed(list(fits))}, "
            f"mean height {_listed([fit.mean for fit in fits.values()])} m, "
            f"{count.min():.0f} to {count.max():.0f} jumps"
        )
    near = sum(part.met for part in parts)
    words.append(f"near at {near} of {len(parts)} places")
    return judge("; ".join(words), *parts)


def exponential_fits(data: xr.Dataset) -> dict[float, Fit]:
    """Return the fit to the heights of the jumps of each aspect ratio."""
    heights, of_block = data.jump_height_m.values, data.jump_aspect_ratio.values
    return {
        float(shape): fit_exponential(heights[of_block == shape])
        for shape in data.aspect_ratio.values
    }


def coefficients_are_normal(study: Study) -> Judgement:
    """e_n and e_t of all impacts are near normal, with the paper's means.

    Impacts after which a block hops are not among them. Means pooled over shapes rest
    on how many impacts each shape has, so those of each stand beside them.
    """
    data = study[SLOPE]
    parts, words = [], []
    for name, mean in MEANS.items():
        values = _in_window(data[name])
        outside = 1.0 - len(values) / data[name].count()
        fit = fit_normal(values)
        above = float(np.mean(values > WELL_ABOVE))
        parts += [
            condition(abs(fit.start - mean) <= MEAN_WITHIN),
            condition(fit.distance <= NEAR),
            condition(above >= SHARE_ABOVE),
        ]
        words.append(
            f"{name} mean {fit.start:.2f} (paper {mean}), standard deviation "
            f"{fit.scale:.2f}, median {np.median(values):.2f}, distance "
            f"{fit.distance:.2f}, {100.0 * above:.1f} % above {WELL_ABOVE}, "
            f"{100.0 * float(outside):.1f} % outside of {COEFFICIENTS[0]:g} to "
            f"{COEFFICIENTS[1]:g}, mean at A_r {_means_by_shape(data, name)}"
        )
    others = []
    for ground in GROUNDS[1:]:
        other = study.on(ground)[SLOPE]
        means = [np.mean(_in_window(other[name])) for name in MEANS]
        others.append(f"{ground} {means[0]:.2f} and {means[1]:.2f}")
    spheres = int((data.impact_aspect_ratio == 1.0).sum())
    words += [
        f"{data.e_n.size} impacts, {spheres} of them of spheres, and "
        f"{data.e_n_before_hops.size} before hops, of mean e_n "
        f"{float(data.e_n_before_hops.mean()):.2f}",
        "means elsewhere: " + ", ".join(others),
    ]
    return judge("; ".join(words), *parts)


def _means_by_shape(data: xr.Dataset, name: str) -> str:
    means = (
        (shape, _in_window(data[name][data.impact_aspect_ratio == shape]).mean())
        for shape in np.unique(data.impact_aspect_ratio)
    )
    return ", ".join(f"{shape:g}: {mean:.2f}" for shape, mean in means)


def _in_window(values: xr.DataArray) -> np.ndarray:
    low, high = COEFFICIENTS
    return values.values[(values >= low) & (values <= high)]


def _listed(values) -> str:
    return ", ".join(f"{float(value):.2g}" for value in values)


CLAIMS = {
    "C34": same_path,
    "C35": elongated_blocks_roll,
    "C36": heights_are_exponential,
    "C37": coefficients_are_normal,
}

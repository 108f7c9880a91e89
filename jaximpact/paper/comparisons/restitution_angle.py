"""Normal restitution against the impact angle, by the model and by a field law."""

from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from ...impact.events import Outcome
from ...plotting.style import in_style, legend_outside, panels, points
from ...scene import Block, Impact, Soil
from .comparison import Comparison, changes_of, strike, variants_of
from .published_laws import wyllie_normal_restitution

MASS, SPEED = 500.0, 15.0
ASPECT_RATIOS = (1.0, 1.5, 2.0, 3.0)
ANGLES = (15.0, 30.0, 45.0, 60.0, 75.0, 90.0)
"""Compared at these, from the surface [deg]."""
ORIENTATIONS = 36
"""Orientations over half a turn, at the middles of equal parts: the mean is within 0.01
of that over ten times as many. A sphere takes one."""
DRAWN_ANGLES = np.arange(10.0, 90.1, 4.0)
SOURCE = "attributed to Wyllie (2014), a fit to field tests"


class Average(NamedTuple):
    """e_n over orientations, (soils, angles)."""

    mean: np.ndarray
    """NaN where any impact failed."""
    spread: np.ndarray
    """Standard deviation."""
    outcomes: dict[str, int]
    """Outcomes of the impacts on the first soil: word to count."""


def average_restitution(soils: Soil, aspect_ratio: float, angles_deg) -> Average:
    """Average e_n of blocks without spin over every orientation."""
    count = 1 if aspect_ratio == 1.0 else ORIENTATIONS
    turns = (np.arange(count) + 0.5) * (np.pi / count)
    angles = np.radians(90.0 - np.asarray(angles_deg))
    found = strike(
        soils,
        Block(mass=MASS, aspect_ratio=aspect_ratio),
        Impact(
            speed=SPEED,
            angle=np.repeat(angles, count),
            orientation=np.tile(turns, len(angles)),
        ),
    )
    e_n = np.reshape(found.e_n, (-1, len(angles), count))
    codes = found.outcome_code[0]
    outcomes = {
        str(outcome): int(np.sum(codes == outcome))
        for outcome in Outcome
        if np.any(codes == outcome)
    }
    return Average(e_n.mean(axis=-1), e_n.std(axis=-1), outcomes)


def compare_restitution_angle() -> list[Comparison]:
    """Compare e_n at six angles, for a sphere and for ellipsoids of every
    orientation."""
    soil = Soil()
    variants = variants_of(soil)
    law = np.asarray(wyllie_normal_restitution(np.array(ANGLES)))
    rows = []
    for ratio in ASPECT_RATIOS:
        average = average_restitution(variants, ratio, ANGLES)
        count = sum(average.outcomes.values()) // len(ANGLES)
        ends = ", ".join(f"{n} {name}" for name, n in average.outcomes.items())
        who = "sphere" if ratio == 1.0 else f"ellipsoid of A_r {ratio:g}"
        turned = f"mean over {count} orientations of half a turn"
        rows.append(
            Comparison(
                name=f"e_n against angle, {who}",
                quantity="e_n [-]",
                places=tuple(f"{angle:g} deg" for angle in ANGLES),
                law=tuple(float(x) for x in law),
                model=tuple(float(x) for x in average.mean[0]),
                over=f"15 to 90 deg from the surface, {MASS:g} kg at {SPEED:g} m/s "
                "without spin, " + ("one orientation" if count == 1 else turned),
                source=SOURCE,
                note=f"Every impact counts, as it ended: {ends}. Of a toppled block "
                "e_n is that of the moment it topples. The field's blocks came with "
                "spin, on uneven ground.",
                changes=changes_of(soil, average.mean, law),
                figure_name="laws_restitution_angle",
                draw=draw_restitution_angle,
            )
        )
    return rows


@in_style
def draw_restitution_angle() -> Figure:
    """Draw e_n over the angle, without and with dilatancy."""
    title = (
        f"{MASS:g} kg at {SPEED:g} m/s without spin: mean over orientations, bands of "
        "one standard deviation"
    )
    figure, both = panels(1, 2, height=3.8, title=title, sharey=True)
    law = wyllie_normal_restitution(DRAWN_ANGLES)
    soils = Soil(dilatancy=[0.0, 1.0])
    averages = [average_restitution(soils, r, DRAWN_ANGLES) for r in ASPECT_RATIOS]
    titles = ("Table 1: no dilatancy", "Table 1 with dilatancy 1")
    for place, (axes, title) in enumerate(zip(both, titles, strict=True)):
        axes.plot(DRAWN_ANGLES, law, "k--", label=r"19.5 $\theta^{-1.03}$")
        for number, average in enumerate(averages):
            mean, spread = average.mean[place], average.spread[place]
            ratio = ASPECT_RATIOS[number]
            label = "sphere" if ratio == 1.0 else f"$A_r$ = {ratio:g}"
            style = points(number)
            axes.plot(DRAWN_ANGLES, mean, markersize=4, label=label, **style)
            band = {"color": style["color"], "alpha": 0.12, "lw": 0.0}
            axes.fill_between(DRAWN_ANGLES, mean - spread, mean + spread, **band)
        axes.axhline(0.0, color="black", lw=0.7)
        axes.set(title=title, xlabel="impact angle from the surface [°]")
    both[0].set_ylabel("normal restitution $e_n$ [-]")
    legend_outside(figure)
    return figure

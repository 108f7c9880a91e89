"""How deep a steel sphere falls into glass beads, by the model and as measured."""

import functools
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...plotting.style import BLUE, GREY, ORANGE, VERMILION, in_style, panels
from ...scene import GRAVITY, Block, Impact
from ...soil import Soil
from .comparison import HOLDS_WITHIN, PARTLY_WITHIN, Change, Comparison, log_slope
from .one_at_a_time import changes_of, strike, variants_of
from .published_laws import KatsuragiDurian

DIAMETER = 0.0254
SPEEDS = np.array([1.0, 2.0, 3.0, 4.0])
BULK_DENSITY = 1520.0
FRICTION_ANGLE_DEG = 24.0
"""Friction angle of glass beads, assumed: the authors give none in what we have."""
DRAWN_SPEEDS = np.linspace(0.5, 4.0, 29)
SOURCE = "Katsuragi and Durian (2007)"
PLACES = tuple(f"{speed:g} m/s" for speed in SPEEDS)
OVER = "1 to 4 m/s, vertical, a steel sphere of 69.2 g and 25.4 mm"
DRAG_LENGTH_ERROR = 0.007


def steel_sphere() -> Block:
    """The sphere, with the density that follows from mass and diameter."""
    mass = KatsuragiDurian().mass
    return Block(mass=mass, density=mass / (np.pi / 6.0 * DIAMETER**3))


def beads() -> Soil:
    """Table 1 with the beads' unit weight and an assumed friction angle. Everything
    else, density included, stays that of a very dense sand."""
    return Soil(
        unit_weight=BULK_DENSITY * GRAVITY,
        friction_angle=np.radians(FRICTION_ANGLE_DEG),
    )


def depths(soils: Soil, speeds: np.ndarray) -> np.ndarray:
    """Largest penetration [m], (soils, speeds)."""
    found = strike(soils, steel_sphere(), Impact(speed=speeds))
    return np.asarray(found.max_penetration)


def compare_stopping_depth() -> list[Comparison]:
    """Depths at four speeds on two soils, and how they grow with speed."""
    law = np.asarray(KatsuragiDurian().stopping_depth(SPEEDS))
    exponent = float(log_slope(SPEEDS, law))
    on_table_1, on_beads = (
        depths(variants_of(soil), SPEEDS) for soil in (Soil(), beads())
    )
    of_beads = changes_of(beads(), on_beads, law)
    draw = functools.partial(draw_stopping_depth, of_beads)
    shared: dict[str, Any] = dict(
        over=OVER, source=SOURCE, figure_name="laws_stopping_depth", draw=draw
    )

    def depth_row(name, model, changes, note):
        return Comparison(
            name=f"stopping depth, {name}",
            quantity="depth [cm]",
            places=PLACES,
            law=tuple(100.0 * law),
            model=tuple(100.0 * model[0]),
            note=note,
            changes=tuple(
                change._replace(model=tuple(100.0 * x for x in change.model))
                for change in changes
            ),
            **shared,
        )

    exponents = log_slope(SPEEDS, on_beads)
    return [
        depth_row(
            "Table 1 as it is",
            on_table_1,
            changes_of(Soil(), on_table_1, law),
            "Table 1 is a very dense sand, not glass beads.",
        ),
        depth_row(
            "beads",
            on_beads,
            of_beads,
            f"Table 1 with the beads' unit weight ({BULK_DENSITY / 1e3:g} g/cm3) and a "
            f"friction angle of {FRICTION_ANGLE_DEG:g} deg, which is an assumption.",
        ),
        Comparison(
            name="stopping depth against speed, beads",
            quantity="exponent [-]",
            places=("",),
            law=(exponent,),
            model=(float(exponents[0]),),
            note="The soil is that of the row before; the law is no power, its "
            "exponent is the slope over the range.",
            changes=changes_of(beads(), exponents[:, None], np.array([exponent])),
            **shared,
        ),
    ]


@in_style
def draw_stopping_depth(changes: tuple[Change, ...]) -> Figure:
    """Depth over speed, and what each parameter alone would do."""
    figure, (upper, lower) = panels(
        2, 1, height=3.3, title="A steel sphere of 25.4 mm on glass beads"
    )
    _draw_depths(upper)
    _draw_changes(lower, changes)
    return figure


def _draw_depths(axes: Axes) -> None:
    law = KatsuragiDurian()
    low, high = (
        law._replace(drag_length=law.drag_length + error).stopping_depth(DRAWN_SPEEDS)
        for error in (-DRAG_LENGTH_ERROR, DRAG_LENGTH_ERROR)
    )
    axes.fill_between(
        DRAWN_SPEEDS,
        100.0 * low,
        100.0 * high,
        color=GREY,
        alpha=0.3,
        label="its $d_1$ ± 0.7 cm",
    )
    depth = 100.0 * law.stopping_depth(DRAWN_SPEEDS)
    axes.plot(DRAWN_SPEEDS, depth, "k--", label="Katsuragi and Durian (2007)")
    soils = (
        (Soil(), "model, Table 1 as it is", BLUE),
        (beads(), f"model, beads' weight, {FRICTION_ANGLE_DEG:g}°", VERMILION),
    )
    for soil, label, colour in soils:
        model = depths(soil, DRAWN_SPEEDS)[0]
        axes.plot(DRAWN_SPEEDS, 100.0 * model, color=colour, lw=2.5, label=label)
    axes.set(
        xlabel="impact speed [m/s]", ylabel="stopping depth [cm]", ylim=(0.0, None)
    )
    axes.legend()


def _draw_changes(axes: Axes, changes: tuple[Change, ...]) -> None:
    """A bar for each parameter: the deviation that is left at its best value."""
    names = [
        f"{change.parameter}  {change.present:.3g} → {change.nearest:.3g}"
        + (" (edge)" if change.at_the_edge else "")
        for change in changes
    ]
    axes.barh(names, [100.0 * change.deviation for change in changes], color=ORANGE)
    axes.invert_yaxis()
    top = axes.get_xaxis_transform()
    for limit, name in ((HOLDS_WITHIN, "holds"), (PARTLY_WITHIN, "partly")):
        axes.axvline(100.0 * limit, color="black", lw=0.8, ls=":")
        axes.text(100.0 * limit, 1.01, f"← {name}", ha="right", transform=top)
    axes.set_title("beads: one parameter alone at its best value", pad=20.0)
    axes.set_xlabel("deviation from the law [%]")

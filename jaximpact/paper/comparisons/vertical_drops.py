"""Vertical drops: how the largest force and the penetration grow with speed, mass and
stiffness, by the model and by the laws of practice; and how deep a steel sphere falls
into glass beads, by the model and as measured."""

import functools
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...plotting.style import (
    BLUE,
    GREY,
    ORANGE,
    VERMILION,
    in_style,
    log_scale,
    panels,
)
from ...scene import GRAVITY, Block, Impact, Soil
from .comparison import (
    HOLDS_WITHIN,
    PARTLY_WITHIN,
    Change,
    Comparison,
    changes_of,
    log_slope,
    strike,
    variants_of,
)
from .published_laws import (
    KatsuragiDurian,
    gerber_penetration_m,
    labiouse_max_force_kN,
)

MASS, SPEED = 500.0, 15.0
"""Mass and speed where the other is varied [kg, m/s]."""
POINTS = 25
STAND_INS = {
    "k_E": "k_E stands in for M_E, which plate loading measures and which includes "
    "yield; k_E is the elastic modulus alone.",
    "c_v": "c_v stands in for M_E, which plate loading measures; of a slow load on the "
    "model, c_v sets how steeply it rises once the ground yields.",
}
"""The model has no M_E: what is moved in its place."""


class Result(NamedTuple):
    """A result that a law gives."""

    field: str
    """The model's."""
    unit: str
    """Unit in the drawing."""
    size: float
    """Size of the unit in SI."""
    source: str
    power: float
    """1 over the exponent of M_E in the law."""


RESULTS = {
    "largest force": Result(
        field="max_normal_force",
        unit="kN",
        size=1e3,
        source="Labiouse, Descoeudres and Montani (1996)",
        power=2.5,
    ),
    "penetration": Result(
        field="max_penetration",
        unit="cm",
        size=1e-2,
        source="Gerber (2019), in Lu et al. (2019), eq. 11",
        power=-2.5,
    ),
}

DIAMETER = 0.0254
SPEEDS = np.array([1.0, 2.0, 3.0, 4.0])
BULK_DENSITY = 1520.0
FRICTION_ANGLE_DEG = 24.0
"""Friction angle of glass beads, assumed: the authors give none in what we have."""
DRAWN_SPEEDS = np.linspace(0.5, 4.0, 29)
KATSURAGI = "Katsuragi and Durian (2007)"
PLACES = tuple(f"{speed:g} m/s" for speed in SPEEDS)
OVER = "1 to 4 m/s, vertical, a steel sphere of 69.2 g and 25.4 mm"
DRAG_LENGTH_ERROR = 0.007
"""[m]"""


# --- Exponents.


class Sweep(NamedTuple):
    """One quantity moved over its range, the others kept."""

    quantity: str
    label: str
    values: np.ndarray
    over: str
    note: str
    mass: np.ndarray | float = MASS
    speed: np.ndarray | float = SPEED
    stand_in: str | None = None
    """Field of the soil that is moved in place of M_E."""


def _sweeps() -> list[Sweep]:
    speed = np.geomspace(5.0, 30.0, POINTS)
    mass = np.geomspace(50.0, 5000.0, POINTS)
    # A decade about Table 1
    decade = np.geomspace(0.1**0.5, 10.0**0.5, POINTS)
    labels = {
        "k_E": "modulus number $k_E$ [-], for $M_E$",
        "c_v": "hardening rate $c_v$ [-], for $M_E$",
    }
    return [
        Sweep(
            quantity="speed",
            label="impact speed [m/s]",
            values=speed,
            over=f"5 to 30 m/s, a sphere of {MASS:g} kg",
            note="H is the height v^2/2g of the drop.",
            speed=speed,
        ),
        Sweep(
            quantity="mass",
            label="mass [kg]",
            values=mass,
            over=f"50 to 5000 kg at {SPEED:g} m/s, spheres of one density",
            note="R grows with the cube root of the mass.",
            mass=mass,
        ),
        *(
            Sweep(
                quantity=f"{name} for M_E",
                label=label,
                values=getattr(Soil(), name) * decade,
                over=f"{name} over a decade about Table 1, a sphere of {MASS:g} kg at "
                f"{SPEED:g} m/s",
                note=STAND_INS[name],
                stand_in=name,
            )
            for name, label in labels.items()
        ),
    ]


def _laws(mass, speed, modulus) -> dict[str, np.ndarray]:
    """Force [N] and penetration [m] by the laws, for an M_E [kN/m2]."""
    radius = np.asarray(Block(mass=mass).semi_axes.minor)
    weight_kN, height = mass * GRAVITY / 1e3, speed**2 / (2.0 * GRAVITY)
    force = 1e3 * labiouse_max_force_kN(modulus, radius, weight_kN, height)
    depth = gerber_penetration_m(mass, modulus, speed)
    return {"largest force": np.asarray(force), "penetration": np.asarray(depth)}


def implied_modulus_kPa() -> dict[str, float]:
    """Compute the M_E at which each law gives what the model gives on Table 1 [kN/m2],
    by result; for a sphere of `MASS` at `SPEED`."""
    found = strike(Soil(), Block(mass=MASS), Impact(speed=SPEED))
    laws = _laws(MASS, SPEED, 1.0)
    return {
        name: float((getattr(found, result.field)[0, 0] / laws[name]) ** result.power)
        for name, result in RESULTS.items()
    }


class Curve(NamedTuple):
    """A result over a sweep: by the model, on Table 1, and by the law."""

    sweep: Sweep
    result: str
    model: np.ndarray
    law: np.ndarray
    """Raised or lowered to meet the model in the middle of the range: the modulus that
    the law wants was not measured on any soil of the model's."""
    exponents: tuple[float, float]
    """Exponents of model and law."""


def compare_scaling() -> list[Comparison]:
    """Compare exponents of force and penetration, by model and laws."""
    soil = Soil()
    variants = variants_of(soil)
    implied = implied_modulus_kPa()
    curves, rows = [], []
    draw = functools.partial(draw_scaling, curves)
    for sweep in _sweeps():
        # Without a stand-in M_E is 1 kN/m2; with one, as many as that has.
        moved, modulus = {}, 1.0
        if sweep.stand_in is not None:
            moved, modulus = {sweep.stand_in: sweep.values}, sweep.values
        laws = _laws(sweep.mass, sweep.speed, modulus)
        found = strike(
            variants, Block(mass=sweep.mass), Impact(speed=sweep.speed), **moved
        )
        for name, result in RESULTS.items():
            model, law = getattr(found, result.field), laws[name]
            exponents = log_slope(sweep.values, model)
            of_model, of_law = float(exponents[0]), float(log_slope(sweep.values, law))
            middle = POINTS // 2
            raised = law * (model[0, middle] / law[middle])
            curves.append(Curve(sweep, name, model[0], raised, (of_model, of_law)))
            rows.append(
                Comparison(
                    name=f"{name} against {sweep.quantity}",
                    quantity="exponent [-]",
                    places=("",),
                    law=(of_law,),
                    model=(of_model,),
                    over=sweep.over,
                    source=result.source,
                    note=f"{sweep.note} The law gives the model's {name} at {MASS:g} "
                    f"kg and {SPEED:g} m/s for an M_E of {implied[name]:.0f} kN/m2.",
                    changes=changes_of(soil, exponents[:, None], np.array([of_law])),
                    figure_name="laws_scaling",
                    draw=draw,
                )
            )
    return rows


@in_style
def draw_scaling(curves: list[Curve]) -> Figure:
    """Draw force and penetration over each range, on logarithmic axes."""
    title = "Vertical drops: model on Table 1, and slopes of the laws"
    figure, axes = panels(4, 2, title=title)
    for each, curve in zip(axes, curves, strict=True):
        _draw_curve(each, curve)
    return figure


def _draw_curve(axes: Axes, curve: Curve) -> None:
    sweep, (of_model, of_law) = curve.sweep, curve.exponents
    result = RESULTS[curve.result]
    model, law = curve.model / result.size, curve.law / result.size
    author = result.source.split()[0].strip(",")
    axes.plot(sweep.values, model, color=BLUE, lw=2.5, label=f"model: {of_model:.2f}")
    label = f"{author}: {of_law:.2f}"
    axes.plot(sweep.values, law, color=VERMILION, ls="--", label=label)
    log_scale(axes)
    axes.set(xlabel=sweep.label, ylabel=f"{curve.result} [{result.unit}]")
    low, high = axes.get_ylim()
    middle, half = np.sqrt(low * high), max(np.sqrt(high / low), 10.0**0.5)
    axes.set_ylim(middle / half, middle * half)
    axes.legend(title="exponent")


# --- Stopping depth.


def steel_sphere() -> Block:
    """Return the sphere, with the density that follows from mass and diameter."""
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
    """Compare depths at four speeds on two soils, and how they grow with speed."""
    law = np.asarray(KatsuragiDurian().stopping_depth(SPEEDS))
    exponent = float(log_slope(SPEEDS, law))
    on_table_1, on_beads = (
        depths(variants_of(soil), SPEEDS) for soil in (Soil(), beads())
    )
    of_beads = changes_of(beads(), on_beads, law)
    draw = functools.partial(draw_stopping_depth, of_beads)
    shared: dict[str, Any] = dict(
        over=OVER, source=KATSURAGI, figure_name="laws_stopping_depth", draw=draw
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
    """Draw depth over speed, and what each parameter alone would do."""
    title = "A steel sphere of 25.4 mm on glass beads"
    figure, (upper, lower) = panels(2, 1, height=3.3, title=title)
    _draw_depths(upper)
    _draw_changes(lower, changes)
    return figure


def _draw_depths(axes: Axes) -> None:
    law = KatsuragiDurian()
    low, high = (
        law._replace(drag_length=law.drag_length + error).stopping_depth(DRAWN_SPEEDS)
        for error in (-DRAG_LENGTH_ERROR, DRAG_LENGTH_ERROR)
    )
    band = {"color": GREY, "alpha": 0.3, "label": "its $d_1$ ± 0.7 cm"}
    axes.fill_between(DRAWN_SPEEDS, 100.0 * low, 100.0 * high, **band)
    depth = 100.0 * law.stopping_depth(DRAWN_SPEEDS)
    axes.plot(DRAWN_SPEEDS, depth, "k--", label=KATSURAGI)
    soils = (
        (Soil(), "model, Table 1 as it is", BLUE),
        (beads(), f"model, beads' weight, {FRICTION_ANGLE_DEG:g}°", VERMILION),
    )
    for soil, label, colour in soils:
        model = depths(soil, DRAWN_SPEEDS)[0]
        axes.plot(DRAWN_SPEEDS, 100.0 * model, color=colour, lw=2.5, label=label)
    axes.set(xlabel="impact speed [m/s]", ylabel="stopping depth [cm]")
    axes.set_ylim(bottom=0.0)
    axes.legend()


def _draw_changes(axes: Axes, changes: tuple[Change, ...]) -> None:
    """Draw a bar for each parameter: the deviation that is left at its best value."""
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

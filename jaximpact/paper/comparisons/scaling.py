"""Largest force and penetration of vertical drops: how they grow with speed, mass and
stiffness, by the model and by the laws of practice."""

import functools
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...plotting.style import BLUE, VERMILION, in_style, log_scale, panels
from ...scene import GRAVITY, Block, Impact
from ...soil import Soil
from .comparison import Comparison, log_slope
from .one_at_a_time import changes_of, strike, variants_of
from .published_laws import gerber_penetration_m, labiouse_max_force_kN

MASS, SPEED = 500.0, 15.0
"""What stays where the other is moved [kg, m/s]."""
POINTS = 25
LABIOUSE = "Labiouse, Descoeudres and Montani (1996)"
GERBER = "Gerber (2019), in Lu et al. (2019), eq. 11"
STAND_INS = {
    "k_E": "k_E stands in for M_E, which plate loading measures and which includes "
    "yield; k_E is the elastic modulus alone.",
    "c_v": "c_v stands in for M_E, which plate loading measures; of a slow load on the "
    "model, c_v sets how steeply it rises once the ground yields.",
}
"""The model has no M_E: what is moved in its place."""


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


def _sweeps() -> tuple[Sweep, ...]:
    speed = np.geomspace(5.0, 30.0, POINTS)
    mass = np.geomspace(50.0, 5000.0, POINTS)
    # A decade about Table 1
    decade = np.geomspace(0.1**0.5, 10.0**0.5, POINTS)
    soil = Soil()
    return (
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
                values=getattr(soil, name) * decade,
                over=f"{name} over a decade about Table 1, a sphere of {MASS:g} kg at "
                f"{SPEED:g} m/s",
                note=STAND_INS[name],
                stand_in=name,
            )
            for name, label in (
                ("k_E", "modulus number $k_E$ [-], for $M_E$"),
                ("c_v", "hardening rate $c_v$ [-], for $M_E$"),
            )
        ),
    )


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


def _laws(sweep: Sweep) -> dict[str, np.ndarray]:
    """Force [N] and penetration [m] by the laws, for an M_E of 1 kN/m2, or of as many
    as the stand-in has."""
    radius = np.asarray(Block(mass=sweep.mass).semi_axes.minor)
    modulus = 1.0 if sweep.stand_in is None else sweep.values
    weight_kN, height = sweep.mass * GRAVITY / 1e3, sweep.speed**2 / (2.0 * GRAVITY)
    force = 1e3 * labiouse_max_force_kN(modulus, radius, weight_kN, height)
    depth = gerber_penetration_m(sweep.mass, modulus, sweep.speed)
    return {"largest force": np.asarray(force), "penetration": np.asarray(depth)}


UNITS = {"largest force": (1e3, "kN"), "penetration": (1e-2, "cm")}
SOURCES = {"largest force": LABIOUSE, "penetration": GERBER}


def implied_modulus_kPa() -> dict[str, float]:
    """The M_E at which each law gives what the model gives on Table 1 [kN/m2], by
    result; for a sphere of `MASS` at `SPEED`."""
    found = strike(Soil(), Block(mass=MASS), Impact(speed=SPEED))
    model = _results(found)
    alone = Sweep("", "", np.array([1.0]), "", "")
    laws = _laws(alone)
    # The force goes with M_E^0.4, the penetration with M_E^-0.4.
    powers = {"largest force": 2.5, "penetration": -2.5}
    return {
        result: float(np.squeeze(model[result] / laws[result]) ** powers[result])
        for result in model
    }


def _results(found) -> dict[str, np.ndarray]:
    return {
        "largest force": found.max_normal_force,
        "penetration": found.max_penetration,
    }


def compare_scaling() -> list[Comparison]:
    """Exponents of force and penetration, by model and laws."""
    soil = Soil()
    variants = variants_of(soil)
    implied = implied_modulus_kPa()
    curves, rows = [], []
    for sweep in _sweeps():
        moved = {} if sweep.stand_in is None else {sweep.stand_in: sweep.values}
        block, impact = Block(mass=sweep.mass), Impact(speed=sweep.speed)
        found = strike(variants, block, impact, **moved)
        laws = _laws(sweep)
        for result, model in _results(found).items():
            law = laws[result]
            exponents = log_slope(sweep.values, model)
            of_law = float(log_slope(sweep.values, law))
            middle = POINTS // 2
            raised = law * (model[0, middle] / law[middle])
            exponent = float(exponents[0])
            curves.append(Curve(sweep, result, model[0], raised, (exponent, of_law)))
            changes = changes_of(soil, exponents[:, None], np.array([of_law]))
            rows.append((sweep, result, exponent, of_law, changes))
    draw = functools.partial(draw_scaling, tuple(curves))
    return [
        Comparison(
            name=f"{result} against {sweep.quantity}",
            quantity="exponent [-]",
            places=("",),
            law=(of_law,),
            model=(exponent,),
            over=sweep.over,
            source=SOURCES[result],
            note=f"{sweep.note} The law gives the model's {result} at {MASS:g} kg and "
            f"{SPEED:g} m/s for an M_E of {implied[result]:.0f} kN/m2.",
            changes=changes,
            figure_name="laws_scaling",
            draw=draw,
        )
        for sweep, result, exponent, of_law, changes in rows
    ]


@in_style
def draw_scaling(curves: tuple[Curve, ...]) -> Figure:
    """Force and penetration over each range, on logarithmic axes."""
    figure, axes = panels(
        4, 2, title="Vertical drops: model on Table 1, and slopes of the laws"
    )
    for each, curve in zip(axes, curves, strict=True):
        _draw_curve(each, curve)
    return figure


def _draw_curve(axes: Axes, curve: Curve) -> None:
    sweep, (model, law) = curve.sweep, curve.exponents
    unit, name = UNITS[curve.result]
    axes.plot(
        sweep.values,
        curve.model / unit,
        color=BLUE,
        lw=2.5,
        label=f"model: {model:.2f}",
    )
    author = SOURCES[curve.result].split()[0].strip(",")
    axes.plot(
        sweep.values,
        curve.law / unit,
        color=VERMILION,
        ls="--",
        label=f"{author}: {law:.2f}",
    )
    log_scale(axes)
    axes.set_xlabel(sweep.label)
    axes.set_ylabel(f"{curve.result} [{name}]")
    low, high = axes.get_ylim()
    middle, half = np.sqrt(low * high), max(np.sqrt(high / low), 10.0**0.5)
    axes.set_ylim(middle / half, middle * half)
    axes.legend(title="exponent")

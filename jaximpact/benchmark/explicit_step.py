"""The largest step at which an explicit method is still right."""

import numpy as np
from matplotlib.figure import Figure

from ..plotting import BLUE, GREEN, ORANGE, VERMILION
from .methods import Method, exact_e_n
from .scenes import choose, spread
from .section import Bench, Row, Section
from .settings import decades
from .stability import base, verdict
from .style import log_axes

FLUIDITIES = (0.0087, 0.87, 8.7, 870.0)
"""gamma_v [m/s]"""
COARSEST = 1e-3
"""First step that is tried [s]; the next ones are each 3 times smaller."""
COLOURS = (BLUE, GREEN, ORANGE, VERMILION)


def largest_step(
    bench: Bench, method: Method, scenes, exact: np.ndarray
) -> tuple[np.ndarray, list[str]]:
    """Largest step at which e_n is right [s], NaN if no step is, and the verdict one
    step above; from the coarsest down, so that luck between may pass for skill."""
    found = np.full(len(exact), np.nan)
    above = ["-"] * len(exact)
    step = COARSEST
    while step >= bench.settings.finest_explicit_step and np.any(np.isnan(found)):
        bench.say(f"step {step:.1e} s")
        open_places = np.flatnonzero(np.isnan(found))
        answer = method.solve(choose(scenes, open_places), step, batch=True)
        for place, e_n in zip(open_places, answer.e_n, strict=True):
            said = verdict(e_n, exact[place])
            if said == "right":
                found[place] = step
            else:
                above[place] = said
        step /= 3.0
    return found, above


def measure(bench: Bench) -> list[Row]:
    """Rows over k_E for several gamma_v, and over tau_s; none without the method."""
    method = next((m for m in bench.methods if m.family == "explicit"), None)
    if method is None:
        return []
    points = bench.settings.explicit_points
    k_E, gamma_v = (
        x.ravel() for x in np.meshgrid(decades(1.0, 1e6, points), FLUIDITIES)
    )
    scenes = spread(base({"k_E": k_E, "gamma_v": gamma_v}), len(k_E))
    steps, above = largest_step(bench, method, scenes, exact_e_n(scenes))
    rows = [
        {
            "sweep": "k_E",
            "x": float(x),
            "gamma_v": float(y),
            "largest_step_s": float(step),
            "above": text,
        }
        for x, y, step, text in zip(k_E, gamma_v, steps, above, strict=True)
    ]
    for slider_time in sorted({1e-6, *bench.settings.slider_times}):
        slides = spread(base(angle=np.radians(np.array([70.0]))), 1)
        step, above = largest_step(
            bench,
            method.with_slider_time(slider_time),
            slides,
            exact_e_n(slides, slider_time),
        )
        rows.append(
            {
                "sweep": "tau_s",
                "x": slider_time,
                "gamma_v": 8.7,
                "largest_step_s": float(step[0]),
                "above": above[0],
            }
        )
    return rows


def draw(rows: list[Row]) -> Figure:
    """Over k_E, and over tau_s."""
    figure = Figure(figsize=(11.0, 5.0), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    log_axes(left, "modulus number $k_E$ [-]", "largest step that is right [s]")
    log_axes(right, r"relaxation time of the slider $\tau_s$ [s]", "")
    own = [row for row in rows if row["sweep"] == "k_E"]
    for gamma_v, colour in zip(FLUIDITIES, COLOURS, strict=True):
        line = [row for row in own if np.isclose(row["gamma_v"], gamma_v)]
        left.plot(
            [row["x"] for row in line],
            [row["largest_step_s"] for row in line],
            "o-",
            color=colour,
            label=f"{gamma_v:g} m/s",
        )
    left.legend(title=r"fluidity $\gamma_v$", frameon=False)
    line = [row for row in rows if row["sweep"] == "tau_s"]
    x = np.array([row["x"] for row in line])
    right.plot(x, [row["largest_step_s"] for row in line], "o-", color=ORANGE)
    right.plot(x, 2.785 * x, "k:", lw=1.0)
    right.annotate(
        r"$2.785\,\tau_s$, limit of RK4",
        (x[-2], 2.785 * x[-2]),
        ha="right",
        va="bottom",
    )
    left.set_title("40° from the normal")
    right.set_title("70° from the normal")
    return figure


def table(rows: list[Row]) -> list[tuple[str, ...]]:
    """Every point."""
    lines = [("sweep", "value", "gamma_v, m/s", "largest step, s", "3 times that")]
    lines += [
        (
            row["sweep"],
            f"{row['x']:.1e}",
            f"{row['gamma_v']:g}",
            f"{row['largest_step_s']:.1e}",
            str(row["above"]),
        )
        for row in rows
    ]
    return lines


EXPLICIT_STEP = Section("explicit-step", measure, draw, table)

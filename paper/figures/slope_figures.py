"""Figures 10 to 12 and 14: slope run-out on two planes."""

import dataclasses
import itertools
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from scipy.stats import expon, norm

from jaximpact.impact.events import Outcome
from jaximpact.plotting.style import (
    BLUE,
    SOIL,
    VERMILION,
    in_style,
    legend_outside,
    log_scale,
)
from jaximpact.quantities import OUTCOME_COLUMN
from jaximpact.runout import Ending, MotionMode, Pieces, Runs
from jaximpact.scene import GRAVITY
from jaximpact.units import DEGREE

from ..biplanar import (
    ASPECT_RATIOS,
    COEFFICIENTS,
    FLAT_LENGTH,
    HEIGHT,
    SLOPE,
    SLOPE_LENGTH,
    SPEED,
    SPINS_DEGPS,
    BiplanarCase,
    jumps,
    restitutions,
)
from ..goodness_of_fit import Fit, fit_exponential, fit_normal
from ..study import Study
from .drawing import (
    ASPECT_RATIO,
    aspect_ratio_legend,
    colours_of,
    draw_curves,
    label_axes,
    lettered_panels,
)
from .tables import PaperFigure, Table

SPIN = "angular_velocity_degps"
ENDING_COLUMN = "ending"
FEWEST = 0.5
"""Count at which the axis begins: below one."""
LINE = "line"
PROFILE, FLIGHT = "profile", "parabola of the release"
DRAWN = 241
"""Points of the parabola."""
SPACING = 0.05
"""Largest time between rows [s]; the ends of all pieces of a trajectory are rows."""
SERIES = ("y_m", "height_m", "velocity_mps", "spin_degps")
JUMP_BINS, IMPACT_BINS = 50, 80
HOP = "hop"
"""Column: 1 for an impact after which the block hops along the ground."""
IMPACTS: dict[str, Any] = {"color": "black"}
BEFORE_HOPS: dict[str, Any] = {"color": VERMILION, "ls": "--"}


def blocks_table(runs: Runs, trajectory: np.ndarray) -> Table:
    """Aspect ratio, the sphere's spin and the ending of trajectories, a row for
    each place."""
    shapes = np.repeat(ASPECT_RATIOS, len(SPINS_DEGPS))
    spins = np.tile(SPINS_DEGPS, len(ASPECT_RATIOS))
    endings = np.array([str(Ending(code)) for code in runs.ending])
    of = np.asarray(trajectory).astype(int)
    return pd.DataFrame(
        {ASPECT_RATIO: shapes[of], SPIN: spins[of], ENDING_COLUMN: endings[of]}
    )


def compute_10(study: Study) -> Table:
    """Points of the profile, and of the parabola up to where it comes down to it."""
    case = study.reading.slope.case
    profile = case.profile(study.parametric_set("I")[0].soil)
    v_x, v_y = SPEED * np.cos(case.direction), SPEED * np.sin(case.direction)
    rising = v_y + v_x * np.tan(SLOPE)
    end = (rising + np.sqrt(rising**2 + 2.0 * GRAVITY * case.height)) / GRAVITY
    time = np.linspace(0.0, end, DRAWN)
    y = HEIGHT + case.height + (v_y - 0.5 * GRAVITY * time) * time
    lines = [
        pd.DataFrame({LINE: PROFILE, "x_m": profile.x, "y_m": profile.y}),
        pd.DataFrame({LINE: FLIGHT, "x_m": v_x * time, "y_m": y}),
    ]
    return pd.concat(lines, ignore_index=True)


@in_style
def draw_10(table: Table) -> Figure:
    """Draw the profile with its lengths, and the parabola."""
    figure, (axes,) = lettered_panels(1, 1, height=3.2)
    profile, flight = (table[table[LINE] == name] for name in (PROFILE, FLIGHT))
    x, y = profile["x_m"].to_numpy(), profile["y_m"].to_numpy()
    axes.fill_between(x, y, -60.0, color=SOIL)
    axes.plot(x, y, color="black", lw=2.5, label=PROFILE)
    axes.plot(flight["x_m"], flight["y_m"], color=BLUE, lw=1.4, label=FLIGHT)
    measure = {"arrowstyle": "<->", "color": "0.3", "shrinkA": 0, "shrinkB": 0}
    for number, (left, right) in enumerate(itertools.pairwise(x), start=1):
        axes.annotate("", (right, -25.0), (left, -25.0), arrowprops=measure)
        text = f"$L_{{s{number}}}$ = {right - left:g} m"
        axes.text(0.5 * (left + right), -30.0, text, ha="center", va="top")
    foot = x[1] + 80.0
    axes.annotate("", (foot, y[0]), (foot, 0.0), arrowprops=measure)
    axes.text(foot + 10.0, 0.5 * y[0], f"$H_s$ = {HEIGHT:g} m", va="center")
    axes.text(x[1] - 210.0, 12.0, rf"$\omega$ = {SLOPE / DEGREE:.1f}°")
    angle = BiplanarCase().direction
    start = flight[["x_m", "y_m"]].to_numpy()[0]
    tip = start + 90.0 * np.array([np.cos(angle), np.sin(angle)])
    velocity = {"arrowstyle": "-|>", "color": BLUE, "lw": 1.4}
    axes.annotate("", tip, start, arrowprops=velocity)
    text = f"{SPEED:g} m/s, {angle / DEGREE:g}° up"
    axes.text(tip[0] + 6.0, tip[1], text, va="center")
    label_axes(axes, "x_m", "y_m")
    axes.set(xlim=(x[0] - 20.0, x[-1]), ylim=(-60.0, 290.0))
    axes.set_aspect("equal")
    legend_outside(figure, place="upper center")
    return figure


def compute_11(study: Study) -> Table:
    """Return the trajectory of each shape, a row a moment: the height is that of the
    centre above the ground. Contacts are left out, which last too short to be seen."""
    runs = study.runs
    free = runs.pieces.motion != MotionMode.contact
    pieces = Pieces(*(column[free] for column in runs.pieces))
    runs = dataclasses.replace(runs, pieces=pieces)
    parts = []
    for block in range(0, runs.release.count, len(SPINS_DEGPS)):
        path = runs.path(block, SPACING)
        part = blocks_table(runs, np.full(len(path["x"]), block)).assign(
            time_s=path["time"],
            x_m=path["x"],
            y_m=path["y"],
            height_m=path["y"] - runs.profile.height(path["x"]),
            velocity_mps=np.hypot(path["v_x"], path["v_y"]),
            spin_degps=path["angular_velocity"] / DEGREE,
        )
        parts.append(part)
    return pd.concat(parts, ignore_index=True)


@in_style
def draw_11(table: Table) -> Figure:
    """Against x: a: trajectory, with the profile; b: height of the centre above the
    ground; c: translational velocity; d: rotational velocity."""
    figure, axes = lettered_panels(2, 2)
    x = [0.0, SLOPE_LENGTH, SLOPE_LENGTH + FLAT_LENGTH]
    axes[0].plot(x, [HEIGHT, 0.0, 0.0], color="black", lw=3.0, zorder=1)
    for each, series in zip(axes, SERIES, strict=True):
        draw_curves(each, table, "x_m", series, lw=0.8)
        each.set_xlim(0.0, 1.02 * table["x_m"].max())
    aspect_ratio_legend(figure, table)
    return figure


def compute_12(study: Study) -> Table:
    """Return a row for each flight that begins at a contact: the highest point of the
    centre above the ground, and by how much that is above its start."""
    runs = study.runs
    flights = jumps(runs)
    chosen = np.flatnonzero(flights.after_contact)
    table = blocks_table(runs, flights.trajectory[chosen])
    return table.assign(
        start_x_m=runs.pieces.x[flights.piece[chosen]],
        height_m=flights.height[chosen],
        rise_m=flights.rise[chosen],
    )


@in_style
def draw_12(table: Table) -> Figure:
    """a to e: histograms for each aspect ratio, all spins, with exponential fits, and
    the distances of the fits; f: fractions that are higher."""
    figure, axes = lettered_panels(3, 2, sharex=True)
    edges = np.linspace(0.0, 1.02 * table["height_m"].max(), JUMP_BINS + 1)
    fraction = axes[-1]
    colours = colours_of(table[ASPECT_RATIO])
    for each, (shape, rows) in zip(axes[:-1], table.groupby(ASPECT_RATIO), strict=True):
        heights = rows["height_m"]
        fit = fit_exponential(heights)
        draw_histogram(each, heights, edges, fit, expon, IMPACTS)
        label_counts(each, "height_m", "jumps [-]", heights, edges)
        distance = f"distance of the fit {distance_in_words(fit)}"
        each.set_title(f"$A_r$ = {shape:g}: {len(heights)} jumps,\n{distance}")
        ordered = np.sort(heights)
        fraction.step(
            ordered,
            1.0 - np.arange(len(ordered)) / len(ordered),
            color=colours[shape],
            lw=1.2,
            label=f"{shape:g}",
        )
    label_axes(fraction, "height_m", "height_m", "fraction that is higher [-]")
    log_scale(fraction, "y")
    # Above the panel, where it covers no line.
    above: dict[str, Any] = dict(loc="lower center", bbox_to_anchor=(0.5, 1.0))
    fraction.legend(title="$A_r$", ncols=5, columnspacing=1.0, **above)
    axes[0].set_xlim(edges[0], edges[-1])
    fit = Line2D([], [], label="exponential fit", **IMPACTS)
    legend_outside(figure, [fit], "upper center")
    say_what_distances_are(figure)
    return figure


def compute_14(study: Study) -> Table:
    """Return a row for each impact; coefficients are NaN where the centre does not come
    down."""
    runs = study.runs
    contacts, coefficients = runs.contacts, restitutions(runs)
    chosen = np.flatnonzero(contacts.outcome >= 0)
    table = blocks_table(runs, contacts.trajectory[chosen])
    columns = {
        "x_m": contacts.x[chosen],
        "e_n": coefficients.e_n[chosen],
        "e_t": coefficients.e_t[chosen],
        HOP: contacts.hop[chosen].astype(int),
        OUTCOME_COLUMN: [str(Outcome(code)) for code in contacts.outcome[chosen]],
    }
    return table.drop(columns=ENDING_COLUMN).assign(**columns)


@in_style
def draw_14(table: Table) -> Figure:
    """a: e_n; b: e_t; with normal fits to impacts after which blocks fly, or roll from
    rest on the ground, and to those before hops: mean and standard deviation, and
    distance."""
    figure, axes = lettered_panels(1, 2)
    edges = np.linspace(*COEFFICIENTS, IMPACT_BINS + 1)
    for each, name in zip(axes, ("e_n", "e_t"), strict=True):
        inside = table[table[name].between(*COEFFICIENTS)]
        words = []
        for hops, who, style in (
            (0, "impacts", IMPACTS),
            (1, "hops", BEFORE_HOPS),
        ):
            chosen = inside[inside[HOP] == hops]
            fit = fit_normal(chosen[name])
            draw_histogram(each, chosen[name], edges, fit, norm, style)
            words.append(
                f"{who} {fit.start:.2f} ± {fit.scale:.2f}, "
                f"distance {distance_in_words(fit)}"
            )
        label_counts(each, name, "impacts [-]", inside[name], edges)
        each.set_title("\n".join(words))
    entries = (
        ("impacts, normal fit", IMPACTS),
        ("impacts after which the block hops along the ground", BEFORE_HOPS),
    )
    handles = [Line2D([], [], label=label, **style) for label, style in entries]
    legend_outside(figure, handles, "upper center")
    say_what_distances_are(figure)
    return figure


def say_what_distances_are(figure: Figure) -> None:
    """Explain the numbers in brackets."""
    figure.supxlabel(
        "distance: Kolmogorov's; in brackets what it exceeds by chance in 5 % of cases",
        fontsize=9,
    )


def draw_histogram(axes: Axes, values, edges, fit: Fit, kind, style) -> None:
    """Draw counts, and what a fitted distribution, one of SciPy's, expects of them."""
    filled = {"histtype": "stepfilled", "color": style["color"], "alpha": 0.35}
    axes.hist(values, edges.tolist(), **filled)
    if np.isfinite(fit.scale):
        x = np.linspace(edges[0], edges[-1], 400)
        density = kind.pdf(x, fit.start, fit.scale)
        density[density == 0.0] = np.nan  # no line where an exponential has not begun
        expected = fit.count * (edges[1] - edges[0]) * density
        axes.plot(x, expected, lw=1.4, **style)


def label_counts(axes: Axes, x: str, counted: str, values, edges: np.ndarray) -> None:
    """Labels, and a logarithmic axis for counts of up to those of the values, and of a
    curve that passes above them."""
    label_axes(axes, x, x, counted)
    log_scale(axes, "y")
    axes.set_ylim(FEWEST, 10.0 * max(1, *np.histogram(values, edges)[0]))


def distance_in_words(fit: Fit) -> str:
    return f"{fit.distance:.2f} ({fit.distance_by_chance:.2f})"


SLOPE_FIGURES = (
    PaperFigure("10", "the slope of two planes", (), compute_10, draw_10),
    PaperFigure("11", "runs without initial spin", (), compute_11, draw_11),
    PaperFigure("12", "heights of jumps", (), compute_12, draw_12),
    PaperFigure(
        "14", "restitution in all impacts of the runs", (), compute_14, draw_14
    ),
)

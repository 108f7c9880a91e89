"""One impact drawn: forces, depth, rotation and energy over time, and a side view.

Matplotlib's object-oriented interface only: nothing is shown, no global state changes,
and it works without a display.
"""

import re

import jax
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import ScaledTranslation

from ..impact.events import Outcome
from ..impact.results import History, ImpactSummary
from ..parameters import parameters_of
from ..scene import Scene
from ..shapes import Ellipsoid
from .style import (
    BLUE,
    GREEN,
    GREY,
    LINE,
    ORANGE,
    PURPLE,
    SKY,
    SOIL,
    VERMILION,
    WIDTH,
    On,
    empty_panel,
    few_ticks,
    given_axes,
    in_style,
    plain,
)

FORCE_UNITS = ((1e6, "MN"), (1e3, "kN"), (1.0, "N"))
LENGTH_UNITS = ((1e-2, "cm"), (1e-3, "mm"))
ENERGY_UNITS = ((1e6, "MJ"), (1e3, "kJ"), (1.0, "J"))
ARROW, ROOM = 32.0, 80.0
"""Length of the arrow of gravity, and the width that it takes with its word at the
tail, on any slope [points]."""
NARROWEST = 0.75
"""Least width over height of the side view: the numbers of three ticks have room."""


@in_style
def plot_impact(
    summary: ImpactSummary,
    scene: Scene,
    history: History,
    on: On = None,
) -> Figure:
    """Draw one impact, as `ImpactResult.plot` does.

    Args:
        history: its start and every step, as `simulate` gives it with `history=True`.
        on: an empty figure, or five axes.

    A block that separates, or an impact that failed, gives panels that show what there
    is and say so.
    """
    if on is None or isinstance(on, Figure):
        title = f"{scene_in_words(scene)}\n{outcome_in_words(summary)}"
        figure, panels = _five_panels(on or Figure(), title)
    else:
        figure, panels = given_axes(on, 5)
    history = _finite_part(history)
    if summary.outcome_code == Outcome.separating:
        history = _first_rows(history, 1)
    draw_forces(panels[0], summary, history)
    draw_depth(panels[1], summary, history)
    draw_rotation(panels[2], history)
    draw_energy(panels[3], history)
    draw_side_view(panels[4], scene, history)
    return figure


def _five_panels(figure: Figure, title: str) -> tuple[Figure, list[Axes]]:
    # Further lines of the title take nothing from the panels.
    figure.set_size_inches(WIDTH, 9.0 + 0.17 * (title.count("\n") - 1))
    figure.suptitle(title)
    grid = figure.add_gridspec(3, 2, height_ratios=(1.0, 1.0, 1.3))
    places = grid[0, 0], grid[0, 1], grid[1, 0], grid[1, 1], grid[2, :]
    panels = [figure.add_subplot(place) for place in places]
    for axes in panels[:-1]:  # how wide the side view is says what it shows
        few_ticks(axes, 3.0, 2.0)
    return figure, panels


def _finite_part(history: History) -> History:
    """Return the rows before the first that is not finite: a failed impact may have
    some."""
    finite = np.all(np.isfinite(np.stack(jax.tree.leaves(history))), axis=0)
    return _first_rows(history, len(finite) if finite.all() else int(np.argmin(finite)))


def _first_rows(history: History, count: int) -> History:
    return jax.tree.map(lambda series: series[:count], history)


def scene_in_words(scene: Scene) -> str:
    """Block and impact in one line, or each in its own where that is too long; shapes
    but the ellipsoid are named, with their own parameters; spin, slope and width only
    where they matter."""
    block, impact = scene.block, scene.impact
    of_block = [f"{float(block.mass):.4g} kg"]
    if type(block.shape) is not Ellipsoid:
        of_block.append(_in_words(type(block.shape).__name__))
    of_block.append(f"$A_r$ = {float(block.aspect_ratio):.3g}")
    if block.out_of_plane_ratio != 1.0:
        of_block.append(f"W/R = {float(block.out_of_plane_ratio):.3g}")
    for name, said in parameters_of(block.shape).items():
        if name not in ("aspect_ratio", "out_of_plane_ratio"):
            value = float(getattr(block.shape, name)) / said.factor
            unit = "" if said.unit == "-" else f" {said.unit}"
            of_block.append(plain(f"{name.replace('_', ' ')} {value:.3g}{unit}"))
    of_impact = [
        f"{float(impact.speed):.3g} m/s at {np.degrees(float(impact.angle)):.3g}°",
        f"orientation {np.degrees(float(impact.orientation)):.4g}°",
    ]
    if impact.angular_velocity != 0.0:
        of_impact.append(f"spin {np.degrees(float(impact.angular_velocity)):.4g}°/s")
    if impact.slope != 0.0:
        of_impact.append(f"slope {np.degrees(float(impact.slope)):.3g}°")
    whole = _in_lines(of_block + of_impact)
    if "\n" not in whole:
        return whole
    return f"{_in_lines(of_block)},\n{_in_lines(of_impact)}"


def _in_lines(words: list[str]) -> str:
    lines = words[:1]
    for word in words[1:]:
        longer = f"{lines[-1]},  {word}"
        lines = [*lines[:-1], longer] if len(longer) <= LINE else [*lines, word]
    return ",\n".join(lines)


def _in_words(name: str) -> str:
    """Write the name of a class in words: "RectangularPrism" is "rectangular prism"."""
    return plain(re.sub(r"(?<=[a-z0-9])(?=[A-Z])|_", " ", name).strip().lower())


def outcome_in_words(summary: ImpactSummary) -> str:
    """Outcome and coefficients in one line; those without meaning are left out."""
    outcome = Outcome(int(summary.outcome_code))
    if outcome is Outcome.failed:
        return "FAILED: the integration did not finish"
    if outcome is Outcome.separating:
        return "separating: the block moves away from the ground, no impact"
    coefficients = (
        ("e_n", summary.e_n),
        ("e_t", summary.e_t),
        (r"\bar{e}", summary.e_bar),
        ("R_r", summary.R_r),
    )
    numbers = ",  ".join(
        f"${name}$ = {float(value):.3f}"
        for name, value in coefficients
        if np.isfinite(value)
    )
    return f"{outcome} after {1e3 * float(summary.duration):.4g} ms:  {numbers}"


def _unit(largest: float, units) -> tuple[float, str]:
    """Choose the largest unit in which a value is at least 1; the smallest for less."""
    return next((unit for unit in units if largest >= unit[0]), units[-1])


def _time_axis(axes: Axes, history: History) -> np.ndarray:
    time = 1e3 * np.asarray(history.time)
    axes.set_xlabel("time [ms]")
    if len(time) > 1:
        axes.set_xlim(float(time[0]), float(time[-1]))
    else:
        empty_panel(axes, "no time series to draw")
    return time


def _mark_peak(axes: Axes, time, value, colour: str, *, above) -> None:
    left, right = axes.get_xlim()
    at_the_end = time > left + 0.9 * (right - left)
    axes.plot(time, value, "o", color=colour, markersize=5, clip_on=False, zorder=4)
    axes.annotate(
        f"{value:.3g}",
        (time, value),
        # At the end, clear of the frame and the ticks beyond it
        xytext=(-6 if at_the_end else 0, 7 if above else -7),
        textcoords="offset points",
        ha="right" if at_the_end else "center",
        va="bottom" if above else "top",
        color=colour,
        fontweight="bold",
        zorder=5,
    )


def _leave_room(axes: Axes, low: float, span: float, below: bool) -> None:
    """Set the limits of the vertical axis: above the values, from `low` over `span`, a
    legend has room over the number of a peak; so has, where asked for, the number of a
    low below them. Of the 135 points of a panel's height a legend takes 18 and a number
    17."""
    under, over = (0.22, 0.45) if below else (0.1, 0.4)
    axes.set_ylim(low - under * span, low + (1.0 + over) * span)


def draw_forces(axes: Axes, summary: ImpactSummary, history: History) -> None:
    """Draw N and T over time, their largest values marked."""
    axes.set_title("contact force")
    time = _time_axis(axes, history)
    normal, tangential = history.normal_force, history.tangential_force
    both = normal, tangential
    low, high = np.min(both, initial=0.0), np.max(both, initial=0.0)
    largest = max(high, -low, 1e-300)
    unit, name = _unit(largest, FORCE_UNITS)
    axes.plot(time, normal / unit, color=BLUE, label="N, normal")
    axes.plot(time, tangential / unit, color=VERMILION, label="T, tangential")
    axes.set_ylabel(f"force [{name}]")
    span = max(high - low, largest)
    _leave_room(axes, low / unit, span / unit, below=low < -1e-6 * largest)
    if len(time) > 1 and summary.max_normal_force > 0.0:
        when = 1e3 * float(summary.time_of_max_normal_force)
        peak = float(summary.max_normal_force) / unit
        _mark_peak(axes, when, peak, BLUE, above=True)
        if summary.max_tangential_force > 1e-6 * largest:  # no rounding
            when = 1e3 * float(summary.time_of_max_tangential_force)
            sign = np.sign(np.interp(when, time, tangential))
            peak = sign * float(summary.max_tangential_force)
            _mark_peak(axes, when, peak / unit, VERMILION, above=sign > 0.0)
    axes.legend(loc="upper center", ncols=2)


def draw_depth(axes: Axes, summary: ImpactSummary, history: History) -> None:
    """Draw the penetration of the centre and of the lowest point, downwards."""
    axes.set_title("penetration")
    time = _time_axis(axes, history)
    penetration, sinking = history.penetration, history.sinking
    largest = np.max(np.abs([penetration, sinking]), initial=0.0)
    unit, name = _unit(largest, LENGTH_UNITS)
    # Where both are one the dashes show it.
    axes.plot(time, sinking / unit, color=ORANGE, lw=3, label="$u_D$, lowest point")
    axes.plot(time, penetration / unit, color=BLUE, ls="--", label="$u_n$, centre")
    axes.set_ylabel(f"penetration [{name}]")
    axes.margins(y=0.2)  # room for the number of the largest
    axes.invert_yaxis()
    if len(time) > 1 and summary.max_sinking > 0.0:
        peaks = [
            (summary.time_of_max_sinking, summary.max_sinking, ORANGE),
            (summary.time_of_max_penetration, summary.max_penetration, BLUE),
        ]
        depths = [float(depth) for _, depth, _ in peaks]
        # One number for both where they read the same, as without rotation.
        same = len({f"{depth / unit:.3g}" for depth in depths}) == 1
        for when, depth, colour in peaks[:1] if same else peaks:
            shallower = not same and depth == min(depths)
            depth = float(depth) / unit
            _mark_peak(axes, 1e3 * float(when), depth, colour, above=shallower)
    axes.legend(loc="best")


def draw_rotation(axes: Axes, history: History) -> None:
    """Draw rotation, and the fraction of the kinetic energy that is rotational."""
    axes.set_title("rotation")
    time = _time_axis(axes, history)
    rotation = np.degrees(history.rotation)
    (turn,) = axes.plot(time, rotation, color=BLUE, label="rotation")
    axes.set_ylabel("rotation, clockwise [°]", color=BLUE)
    low, high = np.min(rotation, initial=0.0), np.max(rotation, initial=0.0)
    below = low < -1e-3
    # A block that does not turn shows a flat line, not the rounding of its angle.
    _leave_room(axes, low, max(high - low, 1.0), below)
    if len(time) > 1 and np.any(np.abs(rotation) > 1e-3):
        place = int(np.argmax(np.abs(rotation)))
        value = rotation[place]
        _mark_peak(axes, time[place], value, BLUE, above=value > 0.0)
    other = axes.twinx()
    ratios = history.rotational_ratio
    (ratio,) = other.plot(time, ratios, color=PURPLE, ls="--", label="ratio $R_r$")
    _leave_room(other, 0.0, max(np.max(ratios, initial=0.0), 0.1), below)
    other.set_ylabel("energy ratio $R_r$ [-]", color=PURPLE)
    other.grid(False)
    axes.legend(handles=[turn, ratio], loc="upper center", ncols=2)


def draw_energy(axes: Axes, history: History) -> None:
    """Draw the parts of the energy, stacked, under the line of the energy
    available."""
    axes.set_title("energy")
    time = _time_axis(axes, history)
    available = (
        np.sum(history.kinetic[:1]) + history.gravity + history.arm + history.stiffness
    )
    largest = np.max(available, initial=0.0)
    unit, name = _unit(largest, ENERGY_UNITS)
    parts = [
        ("kinetic", history.kinetic, SKY),
        ("elastic", history.elastic, GREEN),
        ("visco-plastic", history.viscoplastic, ORANGE),
        ("slider", history.slider, VERMILION),
        ("dashpot", history.dashpot, PURPLE),
    ]
    axes.stackplot(
        time,
        [values / unit for _, values, _ in parts],
        labels=[label for label, _, _ in parts],
        colors=[colour for _, _, colour in parts],
        alpha=0.85,
    )
    axes.plot(time, available / unit, "k--", lw=1.3, label="available")
    axes.set_ylabel(f"energy [{name}]")
    # The legend has the upper part for itself.
    axes.set_ylim(bottom=0.0, top=1.42 * max(largest / unit, 1e-9))
    axes.legend(loc="upper center", ncols=3, handlelength=1.2, columnspacing=0.8)


def outline(scene: Scene, penetration, rotation, shift) -> np.ndarray:
    """Compute the block's outline in the plane of motion [m]: rows of t and height,
    once around, and two more: the centre, and the end of the major axis that points
    down at orientation 0.

    `shift` is how far the centre has moved down-slope [m].
    """
    block, start = scene.block, float(scene.impact.orientation)
    axes = block.semi_axes
    support = float(block.shape.support(axes, np.sin(start), np.cos(start)))
    sin, cos = np.sin(start + rotation), np.cos(start + rotation)
    marks = [(0.0, 0.0), (0.0, float(axes.major))]
    across, along = np.concatenate([block.shape.outline(axes), marks]).T
    tangential = shift - along * sin + across * cos
    height = support - penetration - along * cos - across * sin
    return np.column_stack([tangential, height])


def draw_side_view(axes: Axes, scene: Scene, history: History) -> None:
    """Draw the block at impact, at its deepest and at the end, over the ground."""
    axes.set_title("side view, to scale", pad=26.0)
    time = history.time
    if not len(time):
        return
    moments = [("at impact", 0, GREY, "-")]
    if len(time) > 1:
        moments += [
            ("deepest", int(np.argmax(history.sinking)), VERMILION, "-"),
            ("at the end", len(time) - 1, BLUE, "--"),
        ]
    velocity = history.tangential_velocity
    steps = 0.5 * np.diff(time) * (velocity[1:] + velocity[:-1])
    shift = np.concatenate([[0.0], np.cumsum(steps)])
    axes.axhline(0.0, color="black", lw=1.0)
    for label, row, colour, style in moments:
        line = outline(
            scene, history.penetration[row], history.rotation[row], shift[row]
        )
        line, centre, tip = line[:-2], *line[-2:]
        axes.plot(*line.T, color=colour, ls=style, label=label)
        # The half-axis lets the eye follow the rotation, of a sphere too.
        axes.plot(*np.transpose([centre, tip]), color=colour, lw=0.8, ls=style)
        axes.plot(*centre, "o", color=colour, markersize=3)
    axes.margins(0.15)
    axes.autoscale_view()
    low, high = axes.get_ylim()
    axes.axhspan(low, 0.0, color=SOIL, zorder=0)
    axes.set_ylim(low, high)
    axes.set_aspect("equal", adjustable="box")
    slope = float(scene.impact.slope)
    if slope != 0.0:
        _draw_gravity(axes, slope)
    left, right = axes.get_xlim()
    narrow = max(NARROWEST * (high - low) - (right - left), 0.0)
    axes.set_xlim(left - 0.5 * narrow, right + 0.5 * narrow)
    axes.apply_aspect()
    inches = axes.figure.dpi_scale_trans.inverted()
    panel = axes.get_window_extent().transformed(inches)
    few_ticks(axes, panel.width, panel.height)
    axes.set_xlabel("along the ground, down-slope [m]")
    axes.set_ylabel("height over the ground [m]")
    axes.legend(
        loc="lower center",
        bbox_to_anchor=(0.5, 1.0),
        ncols=3,
        handlelength=1.2,
        columnspacing=1.0,
    )


def _draw_gravity(axes: Axes, slope: float) -> None:
    """Draw the direction of gravity beside the block: the view is widened for it."""
    panel, points = axes.get_window_extent(), axes.figure.dpi / 72.0
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    # The lesser of the scales to which the panel's width and its height lead.
    part = min(ROOM * points / panel.width, 0.5)
    by_width = part / (1.0 - part) * (right - left)
    by_height = ROOM * points / panel.height * (high - low)
    axes.set_xlim(left, right + max(by_width, by_height))
    across, down = ARROW * np.sin(slope), ARROW * np.cos(slope)
    tip = 0.5 * (across - ROOM) / 72.0, -(18.0 + down) / 72.0
    from_corner = ScaledTranslation(*tip, axes.figure.dpi_scale_trans)
    axes.annotate(
        "gravity",
        xy=(1.0, 1.0),
        xycoords=axes.transAxes + from_corner,
        xytext=(-across, down),
        textcoords="offset points",
        ha="center",
        arrowprops=dict(arrowstyle="->"),
    )

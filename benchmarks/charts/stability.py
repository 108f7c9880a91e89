"""Where methods fail: a map over stiffness and fluidity, and sweeps to the extremes."""

import itertools
from typing import NamedTuple

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from jaximpact.accuracy import PRESETS
from jaximpact.laws.slider import RELAXATION_TIME
from jaximpact.plotting.style import (
    GREY,
    ORANGE,
    SKY,
    VERMILION,
    WIDTH,
    in_style,
    legend_outside,
    log_scale,
)
from jaximpact.scene import Block, Impact, Scene, Soil

from ..impacts import spread
from .methods import Method, Ours, exact_e_n
from .section import Bench, Row, Section, Settings, Table, decades

RIGHT_WITHIN = 1e-2
"""e_n that is said to be finished and is further off than this is a lie."""
DOUBT = 1e-3
"""Where two solvers at their finest differ by more than this, neither is believed."""
SECOND_OPINION = "CVODE"
"""Family whose finest setting is asked beside ours."""
VERDICTS = ("right", "wrong, but says it finished", "does not finish", "not known")
COLOURS = (SKY, VERMILION, ORANGE, GREY)
TOLERANCE_OF_PEERS = 1e-4


class Case(NamedTuple):
    """Impacts of one map or sweep."""

    name: str
    x: np.ndarray
    y: np.ndarray
    """NaN in a sweep."""
    scenes: Scene
    slider_time: float | None = None


def base(soil: dict | None = None, block: dict | None = None, **impact) -> Scene:
    """100 kg, A_r 2, 14 m/s at 40 degrees, but for what is given."""
    return Scene(
        Block(**({"aspect_ratio": 2.0} | (block or {}))),
        Soil(**(soil or {})),
        Impact(**({"angle": np.radians(40.0)} | impact)),
    )


def cases(settings: Settings) -> list[Case]:
    """The map, then the sweeps."""
    count = settings.map_points
    k_E, gamma_v = (
        x.ravel()
        for x in np.meshgrid(decades(1.0, 1e6, count), decades(1e-3, 1e3, count))
    )
    scenes = spread(base({"k_E": k_E, "gamma_v": gamma_v}), count**2)
    found = [Case("k_E [-], gamma_v [m/s]", k_E, gamma_v, scenes)]
    points = settings.sweep_points
    sweeps = (
        ("mass [kg]", 1e-3, 1e5, lambda v: base(block={"mass": v})),
        ("speed [m/s]", 0.1, 60.0, lambda v: base(speed=v)),
        ("90° - impact angle [°]", 30.0, 0.1, lambda v: base(angle=np.radians(90 - v))),
        ("spin [°/s]", 20.0, 2e4, lambda v: base(angular_velocity=np.radians(v))),
        ("aspect ratio [-]", 0.2, 6.0, lambda v: base(block={"aspect_ratio": v})),
    )
    for name, low, high, scene in sweeps:
        values = np.array(decades(low, high, points))
        nothing = np.full(points, np.nan)
        found.append(Case(name, values, nothing, spread(scene(values), points)))
    oblique = spread(base(angle=np.radians(70.0)), 1)
    for slider_time in sorted({1e-6, *settings.slider_times}):
        x, nothing = np.array([slider_time]), np.array([np.nan])
        found.append(Case("tau_s [s]", x, nothing, oblique, slider_time))
    return found


def measured_ways(methods: list[Method]) -> list[tuple[str, Method, float]]:
    """Label, method and tolerance: our presets, and each peer at about 1e-4."""
    ways = []
    for method in methods:
        if isinstance(method, Ours):
            ways += [
                (f"{method.name}, {preset.name}", method, preset.tolerance)
                for preset in PRESETS.values()
            ]
        elif method.family not in ("explicit", Ours.family):
            tolerance = min(
                method.tolerances, key=lambda t: abs(np.log(t / TOLERANCE_OF_PEERS))
            )
            ways.append((f"{method.name}, {tolerance:g}", method, tolerance))
    return ways


def believed(first: np.ndarray, second: np.ndarray | None) -> np.ndarray:
    """e_n on which two solvers agree, or that one alone knows; else NaN."""
    if second is None:
        return first
    either = np.where(np.isfinite(first), first, second)
    return np.where(np.abs(first - second) > DOUBT, np.nan, either)


def verdict(e_n: float, exact: float) -> str:
    """One of `VERDICTS`."""
    if not np.isfinite(e_n):
        return VERDICTS[2]
    if not np.isfinite(exact):
        return VERDICTS[3]
    return VERDICTS[0] if abs(e_n - exact) <= RIGHT_WITHIN else VERDICTS[1]


def measure(bench: Bench) -> list[Row]:
    """A row for each method and impact."""
    ways = measured_ways(bench.methods)
    other = next((m for m in bench.methods if m.family == SECOND_OPINION), None)
    rows = []
    for case in cases(bench.settings):
        bench.say(f"{case.name}, exact")
        own = exact_e_n(case.scenes, case.slider_time or RELAXATION_TIME)
        second = None
        if other is not None:
            there = _at_slider_time(other, case)
            second = there.solve(case.scenes, min(other.tolerances), batch=True).e_n
        exact = believed(own, second)
        for label, method, tolerance in ways:
            here = _at_slider_time(method, case)
            if here is None:
                continue
            bench.say(f"{case.name}, {label}")
            e_n = here.solve(case.scenes, tolerance, batch=True).e_n
            for x, y, value, truth in zip(case.x, case.y, e_n, exact, strict=True):
                rows.append(
                    {
                        "method": label,
                        "family": method.family,
                        "case": case.name,
                        "x": float(x),
                        "y": float(y),
                        "e_n": float(value),
                        "exact": float(truth),
                        "verdict": verdict(value, truth),
                    }
                )
    return rows


def _at_slider_time(method: Method, case: Case) -> Method | None:
    """The method for a case; None if its slider cannot be changed."""
    if case.slider_time is None:
        return method
    change = getattr(method, "with_slider_time", None)
    return None if change is None else change(case.slider_time)


def _split(rows: Table) -> tuple[Table, dict[str, Table]]:
    """Rows of the map, and those of each sweep."""
    on_map = np.isfinite(rows["y"])
    return rows[on_map], dict(iter(rows[~on_map].groupby("case", sort=False)))


@in_style
def draw(rows: Table) -> Figure:
    """A small map for each method, and under them a panel for each sweep."""
    on_map, sweeps = _split(rows)
    labels = list(rows["method"].unique())
    across = 4
    lines = -(-len(labels) // across)
    heights = 1.7 * lines + 0.4, 2 * (0.7 + 0.17 * len(labels))
    figure = Figure(figsize=(WIDTH, sum(heights) + 0.6))
    top, bottom = figure.subfigures(2, 1, height_ratios=heights)
    maps = top.subplots(lines, across, sharex=True, sharey=True, squeeze=False).flat
    for axes, label in itertools.zip_longest(maps, labels):
        if label is None:
            axes.remove()
            continue
        own = on_map[on_map["method"] == label]
        _paint(axes, own.pivot(index="y", columns="x", values="verdict"))
        log_scale(axes)
        axes.set_title(label.replace(", ", ",\n"), fontsize=9)
    top.supxlabel("modulus number $k_E$ [-]", fontsize=10)
    top.supylabel(r"fluidity $\gamma_v$ [m/s]", fontsize=10)

    panels = bottom.subplots(2, 3, sharey=True, squeeze=False).flat
    for axes, (name, own) in zip(panels, sweeps.items(), strict=False):
        grid = own.pivot(index="method", columns="x", values="verdict")
        _paint(axes, grid.reindex(labels).set_axis(range(len(labels))), log_y=False)
        axes.set(xlabel=name.replace("tau_s", r"$\tau_s$"))
        axes.set_yticks(range(len(labels)), labels, fontsize=9)
        log_scale(axes, "x")
    bottom.axes[0].invert_yaxis()  # and the others, which share the axis
    entries = zip(COLOURS, VERDICTS, strict=True)
    patches = [Patch(color=colour, label=text) for colour, text in entries]
    legend_outside(figure, patches, "upper center")
    return figure


def _paint(axes, grid: Table, *, log_y: bool = True) -> None:
    """Paint verdicts, over y down and x across."""
    colours = dict(zip(VERDICTS, range(len(VERDICTS)), strict=True))
    axes.pcolormesh(
        _edges(grid.columns.to_numpy(), log=True),
        _edges(grid.index.to_numpy(), log=log_y),
        grid.map(colours.get, na_action="ignore").to_numpy(float),
        cmap=ListedColormap(COLOURS),
        vmin=-0.5,
        vmax=len(VERDICTS) - 0.5,
        edgecolors="white",
        linewidth=0.5,
    )


def _edges(centres: np.ndarray, *, log: bool) -> np.ndarray:
    """Edges of cells around their centres."""
    values = np.log(centres) if log else np.asarray(centres, float)
    if len(values) == 1:
        edges = values[0] + np.array([-0.5, 0.5])
    else:
        middle = 0.5 * (values[1:] + values[:-1])
        first, last = 2 * values[0] - middle[0], 2 * values[-1] - middle[-1]
        edges = np.array([first, *middle, last])
    return np.exp(edges) if log else edges


def table(rows: Table) -> list[tuple[str, ...]]:
    """Impacts by verdict: on the map, and in all sweeps."""
    part = np.where(np.isfinite(rows["y"]), "map", "sweeps")
    counts = rows.groupby(["method", part, "verdict"]).size()
    heads = [(name, verdict) for name in ("map", "sweeps") for verdict in VERDICTS]
    lines = [("method", *(f"{name}: {verdict}" for name, verdict in heads))]
    for label in rows["method"].unique():
        lines.append((label, *(str(counts.get((label, *head), 0)) for head in heads)))
    return lines


STABILITY = Section("stability", measure, draw, table)

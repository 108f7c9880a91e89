"""Vertical and inclined impacts: Fig. 4 (set I, along the major axis), Fig. 5 and the
abstract (also set II, along the minor axis), Figs. 6 and 7 (set III, inclined), Fig. 8
(set IV, all orientations), and Eq. 17 (force and sphericity, S_p = A_r^(-2/3))."""

import numpy as np
import xarray as xr

from ..claim_data import (
    SERIES,
    Study,
    along_dimension,
    along_major_axis,
    along_minor_axis,
    asymmetry,
    elongated,
)
from ..criteria import (
    FALLS,
    MARGIN,
    NOTHING,
    RISES,
    Judgement,
    Part,
    Parts,
    Verdict,
    between,
    condition,
    conditions,
    extremes,
    from_to,
    judge,
    steps,
    trend,
    trend_in_words,
    trends,
)

STOPPED = 0.01
"""e_n below which a block counts as stopped."""
DEPTH_EXCESS = (3.3, 50.0)
"""Percent, as in the abstract."""
FORCE_EXCESS = (0.3, 60.0)
"""Percent, as in the abstract."""
ABOUT_HALF = (40.0, 60.0)
"""Percent that counts as "about 50 %"."""
WING = 0.05
"""Part of the range of e_n by which it rises from its minimum to either side."""
PEAK_NEAR = (2.0, 3.0)
"""A_r between which a peak counts as one at 2.5."""
ANGLE_DEG = 20.0
BACK_RAD = 1e-6
"""Rotation back that counts as none."""
DIP = 0.01
"""Part of the maximum of R_r by which it may dip, or end below it, and count as not
falling."""
SLIGHT = 0.20
"""Part of the maximum of R_r up to which a fall is slight."""


# --- Claims of one kind, each made by a function of what differs.


def _trend_with_length(name, quantity, unit, divisor, direction, *others):
    """Make the judge of a largest value of a set that rises or falls with A_r.

    Args:
        divisor: what counts as one `unit`.
        others: further directions whose steps are told.
    """

    def judge_trend(sets: Study) -> Judgement:
        values = sets[name][quantity].values / divisor
        return judge(
            trend_in_words(values, unit, direction, *others),
            [trend(values, direction)],
            _ends(values, unit),
        )

    return judge_trend


def _ends(values: np.ndarray, name: str) -> dict[str, float]:
    return {f"sphere_{name}": values[0], f"longest_{name}": values[-1]}


def trends_along_the_major_axis(quantity: str, unit: str, *asked):
    """Make the judge of a quantity of set III along the major axis.

    Args:
        asked: the dimension, the direction and the words of each trend.
    """

    def judge_trends(sets: Study) -> Judgement:
        values = along_major_axis(sets)[quantity]
        parts = [trends(values, *each) for each in asked]
        return judge(between(values, unit), parts, extremes(values, unit))

    return judge_trends


def excess_percent(sets: Study, name: str) -> xr.DataArray:
    """Compute the excess of a quantity along the major axis over that along the minor
    one, in percent, for A_r above 1."""
    return elongated(100.0 * (sets["I"][name] / sets["II"][name] - 1.0))


def _excess_within(name: str, low: float, high: float):
    """Make the judge of an excess along the major axis between two percentages."""

    def judge_excess(sets: Study) -> Judgement:
        excess = excess_percent(sets, name)
        return judge(
            f"{from_to(excess, '%')} at A_r {from_to(excess.aspect_ratio)}",
            [conditions((excess >= low) & (excess <= high), "within")],
            {"at_least_A_r_percent": excess[0], "at_largest_A_r_percent": excess[-1]},
        )

    return judge_excess


def _symmetry_of(name: str, unit: str, factor: float = 1.0):
    """Make the judge of a largest value of set IV that is symmetric about 90°."""

    def judge_symmetry(sets: Study) -> Judgement:
        values = factor * sets["IV"][name]
        apart = _asymmetry(values).max()
        return judge(
            f"{between(values, unit)}, mirrored to {float(apart):.0e}",
            [_symmetric(values)],
            {"asymmetry": apart},
        )

    return judge_symmetry


def _symmetric(values: xr.DataArray, sign: float = 1.0) -> Parts:
    """Judge whether values over the orientation are symmetric, at each A_r."""
    what = "symmetric" if sign > 0.0 else "antisymmetric"
    return conditions(_asymmetry(values, sign) <= MARGIN, what)


def _asymmetry(values: xr.DataArray, sign: float = 1.0) -> xr.DataArray:
    """Compute the asymmetry as `asymmetry` does, 0 for a sphere, whose zeros are
    symmetric either way."""
    return asymmetry(values.where(abs(values) > NOTHING, 0.0), sign).fillna(0.0)


# --- Vertical impacts.


def peaks_come_later(sets: Study) -> Judgement:
    """The times of the largest u_n and N of set I rise with A_r."""
    depth = 1e3 * sets["I"].time_of_max_penetration_s.values
    force = 1e3 * sets["I"].time_of_max_normal_force_s.values
    return judge(
        f"of u_n {trend_in_words(depth, 'ms', RISES)}; "
        f"of N {trend_in_words(force, 'ms', RISES)}",
        [trend(depth, RISES), trend(force, RISES)],
        _ends(depth, "u_n_ms") | _ends(force, "N_ms"),
    )


def short_blocks_stop(sets: Study) -> Judgement:
    """Blocks of low A_r stop, those of high A_r detach."""
    data = sets["I"]
    e_n = data.e_n.values
    detaches = (data.outcome.values == "detached") & (e_n > STOPPED)
    stops = data.outcome.isin(["arrested", "in contact"]).values | (abs(e_n) < STOPPED)
    mixed = stops.any() and detaches.any()
    first = int(detaches.argmax()) if mixed else 0
    divided = int(stops[:first].sum() + detaches[first:].sum()) if mixed else 0
    if not mixed:
        verdict = Verdict.fails
    elif first > 0 and divided == len(e_n):
        verdict = Verdict.holds
    else:
        verdict = Verdict.partly
    return Judgement(
        verdict,
        f"{stops.sum()} stop and {detaches.sum()} detach of {len(e_n)}, "
        f"e_n {between(e_n)}",
        {"stop": float(stops.sum()), "detach": float(detaches.sum())},
        divided,
        len(e_n),
    )


def penetrates_more_along_the_major_axis(sets: Study) -> Judgement:
    """The largest u_n of set I is above that of set II."""
    excess = excess_percent(sets, "max_penetration_m")
    return judge(
        f"by {between(excess, '%')}",
        [conditions(excess > 100.0 * MARGIN, "deeper")],
        extremes(excess, "percent"),
    )


def half_as_long_along_the_major_axis(sets: Study) -> Judgement:
    """Contacts of set I last about half as long as those of set II."""
    longer = excess_percent(sets, "duration_s")
    shorter = -longer
    low, high = ABOUT_HALF

    def part_of(percent: float) -> Part:
        if low <= percent <= high:
            return condition(True)
        is_shorter = percent > 100.0 * MARGIN
        return Part(Verdict.partly if is_shorter else Verdict.fails, 0, 1)

    places = shorter.aspect_ratio
    parts = [part_of(float(percent)) for percent in shorter]
    major, minor = (1e3 * sets[name].duration_s.values for name in ("I", "II"))
    return judge(
        f"longer by {from_to(longer, '%')} at A_r {from_to(places)}: "
        f"{from_to(major[1:], 'ms')} against {from_to(minor[1:], 'ms')}"
        if np.all(longer > 0.0)
        else f"shorter by {from_to(shorter, '%')} at A_r {from_to(places)}",
        [Parts("about half as long", "aspect_ratio", places.values, parts)],
        {
            "shorter_at_least_A_r_percent": shorter[0],
            "shorter_at_largest_A_r_percent": shorter[-1],
        },
    )


def e_n_along_the_axes(sets: Study) -> Judgement:
    """e_n rises with A_r along the major axis and falls along the minor one."""
    major, minor = sets["I"].e_n, sets["II"].e_n
    sphere = major.sel(aspect_ratio=1.0, drop=True)
    between_them = elongated((minor < sphere) & (sphere < major))
    return judge(
        f"major {trend_in_words(major, '', RISES)}; "
        f"minor {trend_in_words(minor, '', FALLS)}",
        [
            trend(major, RISES),
            trend(minor, FALLS),
            conditions(between_them, "sphere in between"),
        ],
        {
            "sphere": sphere,
            "longest_along_the_major_axis": major[-1],
            "longest_along_the_minor_axis": minor[-1],
        },
    )


def swallow_wings(sets: Study) -> Judgement:
    """e_n over the orientation: symmetric, with a minimum on either side of 90°."""
    e_n = sets["IV"].e_n
    ranges = e_n.max("orientation_deg") - e_n.min("orientation_deg")
    half = e_n.sel(orientation_deg=e_n.orientation_deg <= 90.0)
    lowest = half.min("orientation_deg")
    ends = half.sel(orientation_deg=[0.0, 90.0])
    wings = elongated((ends - lowest > WING * ranges).all("orientation_deg"))
    minima = elongated(half.idxmin("orientation_deg"))
    return judge(
        f"range {trend_in_words(ranges, '', RISES)}; minimum at "
        f"{between(minima, '°')}, {between(elongated(lowest))}",
        [_symmetric(e_n), conditions(wings, "wings"), trend(ranges, RISES)],
        {"largest_range": ranges.max(), "least_e_n": lowest.min()},
    )


def rotation_against_orientation(sets: Study) -> Judgement:
    """The rotation is antisymmetric, and largest at an A_r near 2.5."""
    turn = np.degrees(sets["IV"].rotation_rad)
    inside = (turn.orientation_deg > 0.0) & (turn.orientation_deg < 90.0)
    size = abs(turn.sel(orientation_deg=inside))
    peaks = size.idxmax("aspect_ratio")
    low, high = PEAK_NEAR
    near = (peaks >= low) & (peaks <= high)
    single = along_dimension(_rises_then_falls, size, "aspect_ratio")
    top = size.max("orientation_deg")
    return judge(
        f"peak at A_r {between(peaks)}, median {float(peaks.median()):g}; largest over "
        f"all orientations {float(top.max()):.3g}° at A_r {float(top.idxmax()):g}, "
        f"{float(top[-1]):.3g}° at A_r 4",
        [
            _symmetric(turn, -1.0),
            conditions(near & single, "rises to a peak near A_r 2.5 and falls"),
        ],
        {"median_A_r_of_peak": peaks.median(), "largest_deg": top.max()},
    )


def _rises_then_falls(values: np.ndarray) -> bool:
    peak = int(np.argmax(values))
    taken = steps(values)
    return bool(np.all(taken[:peak] > 0) and np.all(taken[peak:] < 0))


def force_falls_with_sphericity(sets: Study) -> Judgement:
    """The largest N falls with A_r, thus with falling S_p."""
    axes = {"major": ("I", along_major_axis), "minor": ("II", along_minor_axis)}
    words, vertical, inclined, numbers = [], [], [], {}
    for axis, (name, along_axis) in axes.items():
        force = sets[name].max_normal_force_N.values / 1e3
        told = trend_in_words(force, "kN", FALLS)
        words.append(f"vertical along the {axis} axis {told}")
        vertical.append(trend(force, FALLS))
        what = f"inclined, {axis} axis: falls"
        slanted = along_axis(sets).max_normal_force_N
        inclined.append(trends(slanted, "aspect_ratio", FALLS, what))
        numbers |= {f"{axis}_axis_sphere_kN": force[0]}
        numbers |= {f"{axis}_axis_longest_kN": force[-1]}
    return judge("; ".join(words), [*vertical, *inclined], numbers)


# --- Inclined impacts.


def rotation_grows(sets: Study) -> Judgement:
    """The rotation never goes back."""
    rotation = sets[SERIES].rotation_rad.sel(angle_deg=ANGLE_DEG)
    back = (-rotation.diff("step").min("step")).clip(min=0.0)
    last = np.degrees(rotation.max("step"))
    return judge(
        f"to {between(last, '°')}, back by {float(back.max()):.2g} rad at most",
        [conditions(back <= BACK_RAD, "grows")],
        {"largest_step_back_rad": back.max()},
    )


def rotational_ratio_peaks(sets: Study) -> Judgement:
    """R_r rises to a maximum, after which that of low A_r falls slightly."""
    ratio = sets[SERIES].R_r.sel(angle_deg=ANGLE_DEG)
    largest = ratio.max("step")
    fall = (largest - ratio.isel(step=-1)) / largest
    dip = along_dimension(_deepest_dip, ratio, "step")
    sphere, longest = float(fall[0]), float(fall[-1])
    percent = 100.0 * fall
    return judge(
        f"largest {between(largest)}; falls by {float(percent[0]):.2g} % at A_r 1, "
        f"{float(percent[1]):.2g} % at {float(fall.aspect_ratio[1]):g}, "
        f"{float(percent[-1]):.2g} % at 4",
        [
            conditions(dip <= DIP, "rises to its maximum"),
            condition(DIP <= sphere <= SLIGHT),
            condition(longest < DIP),
        ],
        {
            "fall_of_sphere_percent": percent[0],
            "fall_of_longest_percent": percent[-1],
            "deepest_dip_percent": 100.0 * dip.max(),
        },
    )


def _deepest_dip(ratio: np.ndarray) -> float:
    """How far the ratio falls below what it had reached, before its maximum, as a part
    of that."""
    rise = ratio[: int(np.argmax(ratio)) + 1]
    return float(np.max(np.maximum.accumulate(rise) - rise) / rise[-1])


def _peaks_inside(values: xr.DataArray) -> Parts:
    """Judge whether lines over the angle have a maximum beyond both of their ends."""

    def of_line(line):
        top = line[np.argmax(line)]
        return steps([line[0], top])[0] > 0 and steps([line[-1], top])[0] > 0

    return conditions(along_dimension(of_line, values, "angle_deg"), "peaks inside")


def _place_of_peak(values: xr.DataArray) -> str:
    return f"peak at {between(values.idxmax('angle_deg'), '°')}"


def force(sets: Study) -> Judgement:
    """The largest N falls with A_r and with the angle."""
    force = along_major_axis(sets).max_normal_force_N / 1e3
    first, top = force.isel(angle_deg=0), force.max("angle_deg")
    rise = 100.0 * (top / first - 1.0)
    return judge(
        f"{between(force, 'kN')}, {_place_of_peak(force)}, above that "
        f"at {float(force.angle_deg[0]):g}° by up to {float(rise.max()):.2g} %",
        [
            trends(force, "aspect_ratio", FALLS, "falls with A_r"),
            trends(force, "angle_deg", FALLS, "falls with the angle"),
        ],
        {"rise_before_the_peak_percent": rise.max()},
    )


def rotation(sets: Study) -> Judgement:
    """The rotation has a peak over the angle and falls with A_r, but for the sphere."""
    turn = np.degrees(along_major_axis(sets).rotation_rad)
    sphere, others = turn.sel(aspect_ratio=1.0), elongated(turn)
    low, high = others.min("aspect_ratio"), others.max("aspect_ratio")
    return judge(
        f"{_place_of_peak(turn)}; sphere {between(sphere, '°')}, "
        f"others {between(others, '°')}",
        [
            _peaks_inside(turn),
            trends(others, "aspect_ratio", FALLS, "falls with A_r from 1.5"),
            conditions((sphere > low) & (sphere < high), "sphere in between"),
        ],
        {"largest_of_sphere_deg": sphere.max(), **extremes(others, "of_others_deg")},
    )


def rotational_ratio(sets: Study) -> Judgement:
    """The largest R_r of an impact has a peak over the angle and rises with A_r."""
    ratio = sets[SERIES].R_r.max("step")
    return judge(
        f"{between(ratio)}, {_place_of_peak(ratio)}",
        [_peaks_inside(ratio), trends(ratio, "aspect_ratio", RISES, "grows with A_r")],
        extremes(ratio),
    )


CLAIMS = {
    "C01": _trend_with_length("I", "max_penetration_m", "m", 1.0, RISES),
    "C02": _trend_with_length("I", "max_normal_force_N", "kN", 1e3, FALLS),
    "C03": peaks_come_later,
    "C04": short_blocks_stop,
    "C05": _trend_with_length("II", "max_penetration_m", "m", 1.0, RISES, FALLS),
    "C06": _trend_with_length("II", "max_normal_force_N", "kN", 1e3, FALLS, RISES),
    "C07": penetrates_more_along_the_major_axis,
    "C08": _excess_within("max_penetration_m", *DEPTH_EXCESS),
    "C09": half_as_long_along_the_major_axis,
    "C10": _excess_within("max_normal_force_N", *FORCE_EXCESS),
    "C11": rotation_grows,
    "C12": rotational_ratio_peaks,
    "C13": trends_along_the_major_axis(
        "max_penetration_m",
        "m",
        ("angle_deg", FALLS, "falls with the angle"),
        ("aspect_ratio", RISES, "grows with A_r"),
    ),
    "C14": force,
    "C15": rotation,
    "C16": rotational_ratio,
    "C17": e_n_along_the_axes,
    "C18": swallow_wings,
    "C19": _symmetry_of("max_penetration_m", "m"),
    "C20": rotation_against_orientation,
    "C21": _symmetry_of("max_normal_force_N", "kN", 1e-3),
    "C22": _symmetry_of("max_moment_Nm", "kN m", 1e-3),
}
"""Judges of the claims on sets I to IV, but for those on restitution."""
SPHERICITY_CLAIMS = {"C33": force_falls_with_sphericity}

"""Vertical and inclined impacts: Fig. 4 (set I, along the major axis), Fig. 5 and the
abstract (also set II, along the minor axis), Figs. 6 and 7 (set III, inclined), Fig. 8
(set IV, all orientations), and Eq. 17 (force and sphericity, S_p = A_r^(-2/3))."""

import numpy as np
import xarray as xr

from ..criteria import (
    FALLS,
    MARGIN,
    NOTHING,
    RISES,
    Judgement,
    Part,
    Parts,
    Verdict,
    along_dimension,
    asymmetry,
    between,
    condition,
    conditions,
    elongated,
    from_to,
    judge,
    steps,
    trend,
    trend_in_words,
    trends,
)
from ..study import SERIES, Study

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
MAJOR, MINOR = 0.0, 90.0
"""Orientations at which a block strikes along an axis [deg]."""


def inclined(study: Study, axis: float) -> xr.Dataset:
    """Set III along an axis: over the angle and A_r."""
    return study["III"].sel(orientation_deg=axis, drop=True)


# --- Claims of one kind, each made by a function of what differs.


def trend_with_length(name, quantity, unit, divisor, direction, *others):
    """Make the judge of a largest value of a set that rises or falls with A_r.

    Args:
        divisor: what counts as one `unit`.
        others: further directions whose steps the evidence counts.
    """

    def judge_trend(study: Study) -> Judgement:
        values = study[name][quantity].values / divisor
        words = trend_in_words(values, unit, direction, *others)
        return judge(words, trend(values, direction))

    return judge_trend


def trends_along_the_major_axis(quantity: str, unit: str, *asked):
    """Make the judge of a quantity of set III along the major axis.

    Args:
        asked: the dimension, the direction and the words of each trend.
    """

    def judge_trends(study: Study) -> Judgement:
        values = inclined(study, MAJOR)[quantity]
        return judge(between(values, unit), *(trends(values, *each) for each in asked))

    return judge_trends


def excess_percent(study: Study, name: str) -> xr.DataArray:
    """Compute the excess of a quantity along the major axis over that along the minor
    one, in percent, for A_r above 1."""
    return elongated(100.0 * (study["I"][name] / study["II"][name] - 1.0))


def excess_within(name: str, low: float, high: float):
    """Make the judge of an excess along the major axis between two percentages."""

    def judge_excess(study: Study) -> Judgement:
        excess = excess_percent(study, name)
        return judge(
            f"{from_to(excess, '%')} at A_r {from_to(excess.aspect_ratio)}",
            conditions((excess >= low) & (excess <= high), "within"),
        )

    return judge_excess


def symmetry_of(name: str, unit: str, factor: float = 1.0):
    """Make the judge of a largest value of set IV that is symmetric about 90°."""

    def judge_symmetry(study: Study) -> Judgement:
        values = factor * study["IV"][name]
        apart = float(_asymmetry(values).max())
        words = f"{between(values, unit)}, mirrored to {apart:.0e}"
        return judge(words, _symmetric(values))

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


def peaks_come_later(study: Study) -> Judgement:
    """The times of the largest u_n and N of set I rise with A_r."""
    depth = 1e3 * study["I"].time_of_max_penetration_s.values
    force = 1e3 * study["I"].time_of_max_normal_force_s.values
    return judge(
        f"of u_n {trend_in_words(depth, 'ms', RISES)}; "
        f"of N {trend_in_words(force, 'ms', RISES)}",
        trend(depth, RISES),
        trend(force, RISES),
    )


def short_blocks_stop(study: Study) -> Judgement:
    """Blocks of low A_r stop, those of high A_r detach."""
    data = study["I"]
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
        divided,
        len(e_n),
    )


def penetrates_more_along_the_major_axis(study: Study) -> Judgement:
    """The largest u_n of set I is above that of set II."""
    excess = excess_percent(study, "max_penetration_m")
    deeper = conditions(excess > 100.0 * MARGIN, "deeper")
    return judge(f"by {between(excess, '%')}", deeper)


def half_as_long_along_the_major_axis(study: Study) -> Judgement:
    """Contacts of set I last about half as long as those of set II."""
    longer = excess_percent(study, "duration_s")
    low, high = ABOUT_HALF

    def part_of(shorter: float) -> Part:
        if low <= shorter <= high:
            return condition(True)
        is_shorter = shorter > 100.0 * MARGIN
        return Part(Verdict.partly if is_shorter else Verdict.fails, 0, 1)

    places = longer.aspect_ratio
    parts = [part_of(-float(percent)) for percent in longer]
    major, minor = (1e3 * study[name].duration_s.values for name in ("I", "II"))
    return judge(
        f"longer by {from_to(longer, '%')} at A_r {from_to(places)}: "
        f"{from_to(major[1:], 'ms')} against {from_to(minor[1:], 'ms')}"
        if np.all(longer > 0.0)
        else f"shorter by {from_to(-longer, '%')} at A_r {from_to(places)}",
        Parts("about half as long", "aspect_ratio", places.values, parts),
    )


def e_n_along_the_axes(study: Study) -> Judgement:
    """e_n rises with A_r along the major axis and falls along the minor one."""
    major, minor = study["I"].e_n, study["II"].e_n
    sphere = major.sel(aspect_ratio=1.0, drop=True)
    between_them = elongated((minor < sphere) & (sphere < major))
    return judge(
        f"major {trend_in_words(major, '', RISES)}; "
        f"minor {trend_in_words(minor, '', FALLS)}",
        trend(major, RISES),
        trend(minor, FALLS),
        conditions(between_them, "sphere in between"),
    )


def swallow_wings(study: Study) -> Judgement:
    """e_n over the orientation: symmetric, with a minimum on either side of 90°."""
    e_n = study["IV"].e_n
    ranges = e_n.max("orientation_deg") - e_n.min("orientation_deg")
    half = e_n.sel(orientation_deg=e_n.orientation_deg <= 90.0)
    lowest = half.min("orientation_deg")
    ends = half.sel(orientation_deg=[0.0, 90.0])
    wings = elongated((ends - lowest > WING * ranges).all("orientation_deg"))
    minima = elongated(half.idxmin("orientation_deg"))
    return judge(
        f"range {trend_in_words(ranges, '', RISES)}; minimum at "
        f"{between(minima, '°')}, {between(elongated(lowest))}",
        _symmetric(e_n),
        conditions(wings, "wings"),
        trend(ranges, RISES),
    )


def rotation_against_orientation(study: Study) -> Judgement:
    """The rotation is antisymmetric, and largest at an A_r near 2.5."""
    turn = np.degrees(study["IV"].rotation_rad)
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
        _symmetric(turn, -1.0),
        conditions(near & single, "rises to a peak near A_r 2.5 and falls"),
    )


def _rises_then_falls(values: np.ndarray) -> bool:
    peak = int(np.argmax(values))
    signs = steps(values)
    return bool(np.all(signs[:peak] > 0) and np.all(signs[peak:] < 0))


def force_falls_with_sphericity(study: Study) -> Judgement:
    """The largest N falls with A_r, thus with falling S_p."""
    words, vertical, slanted = [], [], []
    for name, set_name, axis in (("major", "I", MAJOR), ("minor", "II", MINOR)):
        force = study[set_name].max_normal_force_N.values / 1e3
        fall = trend_in_words(force, "kN", FALLS)
        words.append(f"vertical along the {name} axis {fall}")
        vertical.append(trend(force, FALLS))
        force = inclined(study, axis).max_normal_force_N
        what = f"inclined, {name} axis: falls"
        slanted.append(trends(force, "aspect_ratio", FALLS, what))
    return judge("; ".join(words), *vertical, *slanted)


# --- Inclined impacts.


def rotation_grows(study: Study) -> Judgement:
    """The rotation never goes back."""
    rotation = study[SERIES].rotation_rad.sel(angle_deg=ANGLE_DEG)
    back = (-rotation.diff("step").min("step")).clip(min=0.0)
    last = np.degrees(rotation.max("step"))
    return judge(
        f"to {between(last, '°')}, back by {float(back.max()):.2g} rad at most",
        conditions(back <= BACK_RAD, "grows"),
    )


def rotational_ratio_peaks(study: Study) -> Judgement:
    """R_r rises to a maximum, after which that of low A_r falls slightly."""
    ratio = study[SERIES].R_r.sel(angle_deg=ANGLE_DEG)
    largest = ratio.max("step")
    fall = (largest - ratio.isel(step=-1)) / largest
    dip = along_dimension(_deepest_dip, ratio, "step")
    percent = 100.0 * fall
    return judge(
        f"largest {between(largest)}; falls by {float(percent[0]):.2g} % at A_r 1, "
        f"{float(percent[1]):.2g} % at {float(fall.aspect_ratio[1]):g}, "
        f"{float(percent[-1]):.2g} % at 4",
        conditions(dip <= DIP, "rises to its maximum"),
        condition(DIP <= float(fall[0]) <= SLIGHT),
        condition(float(fall[-1]) < DIP),
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


def force(study: Study) -> Judgement:
    """The largest N falls with A_r and with the angle."""
    force = inclined(study, MAJOR).max_normal_force_N / 1e3
    first, top = force.isel(angle_deg=0), force.max("angle_deg")
    rise = 100.0 * (top / first - 1.0)
    return judge(
        f"{between(force, 'kN')}, {_place_of_peak(force)}, above that "
        f"at {float(force.angle_deg[0]):g}° by up to {float(rise.max()):.2g} %",
        trends(force, "aspect_ratio", FALLS, "falls with A_r"),
        trends(force, "angle_deg", FALLS, "falls with the angle"),
    )


def rotation(study: Study) -> Judgement:
    """The rotation has a peak over the angle and falls with A_r, but for the sphere."""
    turn = np.degrees(inclined(study, MAJOR).rotation_rad)
    sphere, others = turn.sel(aspect_ratio=1.0), elongated(turn)
    low, high = others.min("aspect_ratio"), others.max("aspect_ratio")
    return judge(
        f"{_place_of_peak(turn)}; sphere {between(sphere, '°')}, "
        f"others {between(others, '°')}",
        _peaks_inside(turn),
        trends(others, "aspect_ratio", FALLS, "falls with A_r from 1.5"),
        conditions((sphere > low) & (sphere < high), "sphere in between"),
    )


def rotational_ratio(study: Study) -> Judgement:
    """The largest R_r of an impact has a peak over the angle and rises with A_r."""
    ratio = study[SERIES].R_r.max("step")
    return judge(
        f"{between(ratio)}, {_place_of_peak(ratio)}",
        _peaks_inside(ratio),
        trends(ratio, "aspect_ratio", RISES, "grows with A_r"),
    )


CLAIMS = {
    "C01": trend_with_length("I", "max_penetration_m", "m", 1.0, RISES),
    "C02": trend_with_length("I", "max_normal_force_N", "kN", 1e3, FALLS),
    "C03": peaks_come_later,
    "C04": short_blocks_stop,
    "C05": trend_with_length("II", "max_penetration_m", "m", 1.0, RISES, FALLS),
    "C06": trend_with_length("II", "max_normal_force_N", "kN", 1e3, FALLS, RISES),
    "C07": penetrates_more_along_the_major_axis,
    "C08": excess_within("max_penetration_m", *DEPTH_EXCESS),
    "C09": half_as_long_along_the_major_axis,
    "C10": excess_within("max_normal_force_N", *FORCE_EXCESS),
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
    "C19": symmetry_of("max_penetration_m", "m"),
    "C20": rotation_against_orientation,
    "C21": symmetry_of("max_normal_force_N", "kN", 1e-3),
    "C22": symmetry_of("max_moment_Nm", "kN m", 1e-3),
}
"""Judges of the claims on sets I to IV, but for those on restitution."""
SPHERICITY_CLAIMS = {"C33": force_falls_with_sphericity}

"""Vertical and inclined impacts: Fig. 4 (set I, along the major axis), Fig. 5 and the
abstract (also set II, along the minor axis), Figs. 6 and 7 (set III, inclined), Fig. 8
(set IV, all orientations), and Eq. 17 (force and sphericity, S_p = A_r^(-2/3))."""

import numpy as np
import xarray as xr

from ..claim_data import (
    Datasets,
    along_dimension,
    along_major_axis,
    along_minor_axis,
    asymmetry,
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
    from_to,
    judge,
    steps,
    steps_that_go,
    trend,
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


def _trend_with_length(
    name: str, quantity: str, direction: int, unit: str, divisor=1.0, others=()
):
    """The judge of a largest value of a set that rises or falls with A_r.

    Args:
        divisor: what counts as one `unit`.
        others: further directions whose steps are told.
    """

    def judge_trend(sets: Datasets) -> Judgement:
        values = sets[name][quantity].values / divisor
        told = ", ".join(steps_that_go(values, each) for each in (direction, *others))
        return judge(
            f"{from_to(values, unit)}, {told}",
            [trend(values, direction)],
            {f"sphere_{unit}": values[0], f"longest_{unit}": values[-1]},
        )

    return judge_trend


def peaks_come_later(sets: Datasets) -> Judgement:
    """The times of the largest u_n and N of set I rise with A_r."""
    depth = 1e3 * sets["I"].time_of_max_penetration_s.values
    force = 1e3 * sets["I"].time_of_max_normal_force_s.values
    return judge(
        f"of u_n {from_to(depth, 'ms')}, {steps_that_go(depth, RISES)}; "
        f"of N {from_to(force, 'ms')}, {steps_that_go(force, RISES)}",
        [trend(depth, RISES), trend(force, RISES)],
        {
            "sphere_u_n_ms": depth[0],
            "longest_u_n_ms": depth[-1],
            "sphere_N_ms": force[0],
            "longest_N_ms": force[-1],
        },
    )


def short_blocks_stop(sets: Datasets) -> Judgement:
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


def excess_percent(sets: Datasets, name: str) -> xr.DataArray:
    """The excess of a quantity along the major axis over that along the minor one,
    in percent, for A_r above 1."""
    major, minor = sets["I"][name], sets["II"][name]
    percent = 100.0 * (major / minor - 1.0)
    return percent.sel(aspect_ratio=percent.aspect_ratio > 1.0)


def penetrates_more_along_the_major_axis(sets: Datasets) -> Judgement:
    """The largest u_n of set I is above that of set II."""
    excess = excess_percent(sets, "max_penetration_m")
    return judge(
        f"by {between(excess, '%')}",
        [conditions(excess > 100.0 * MARGIN, "deeper")],
        {"least_percent": excess.min(), "largest_percent": excess.max()},
    )


def _excess_within(name: str, low: float, high: float):
    """The judge of an excess along the major axis between two percentages."""

    def judge_excess(sets: Datasets) -> Judgement:
        excess = excess_percent(sets, name)
        return judge(
            f"{from_to(excess, '%')} at A_r {from_to(excess.aspect_ratio)}",
            [conditions((excess >= low) & (excess <= high), "within")],
            {"at_least_A_r_percent": excess[0], "at_largest_A_r_percent": excess[-1]},
        )

    return judge_excess


def half_as_long_along_the_major_axis(sets: Datasets) -> Judgement:
    """Contacts of set I last about half as long as those of set II."""
    shorter = -excess_percent(sets, "duration_s")
    low, high = ABOUT_HALF

    def part_of(percent: float) -> Part:
        if low <= percent <= high:
            return condition(True)
        is_shorter = percent > 100.0 * MARGIN
        return Part(Verdict.partly if is_shorter else Verdict.fails, 0, 1)

    longer = -shorter
    major, minor = (1e3 * sets[name].duration_s.values for name in ("I", "II"))
    return judge(
        f"longer by {from_to(longer, '%')} at A_r {from_to(longer.aspect_ratio)}: "
        f"{from_to(major[1:], 'ms')} against {from_to(minor[1:], 'ms')}"
        if np.all(longer > 0.0)
        else f"shorter by {from_to(shorter, '%')} at A_r "
        f"{from_to(shorter.aspect_ratio)}",
        [
            Parts(
                "about half as long",
                "aspect_ratio",
                shorter.aspect_ratio.values,
                [part_of(float(percent)) for percent in shorter],
            )
        ],
        {
            "shorter_at_least_A_r_percent": shorter[0],
            "shorter_at_largest_A_r_percent": shorter[-1],
        },
    )


def e_n_along_the_axes(sets: Datasets) -> Judgement:
    """e_n rises with A_r along the major axis and falls along the minor one."""
    major, minor = sets["I"].e_n, sets["II"].e_n
    sphere = major.sel(aspect_ratio=1.0, drop=True)
    long = major.aspect_ratio > 1.0
    between_them = ((minor < sphere) & (sphere < major)).sel(aspect_ratio=long)
    return judge(
        f"major {from_to(major)}, {steps_that_go(major, RISES)}; "
        f"minor {from_to(minor)}, {steps_that_go(minor, FALLS)}",
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


def swallow_wings(sets: Datasets) -> Judgement:
    """e_n over the orientation: symmetric, with a minimum on either side of 90°."""
    e_n = sets["IV"].e_n
    ranges = e_n.max("orientation_deg") - e_n.min("orientation_deg")
    half = e_n.sel(orientation_deg=e_n.orientation_deg <= 90.0)
    lowest = half.min("orientation_deg")
    rises = [
        half.sel(orientation_deg=end) - lowest > WING * ranges for end in (0.0, 90.0)
    ]
    long = e_n.aspect_ratio > 1.0
    wings = (rises[0] & rises[1]).sel(aspect_ratio=long)
    minima = half.idxmin("orientation_deg").sel(aspect_ratio=long)
    return judge(
        f"range {from_to(ranges)}, {steps_that_go(ranges, RISES)}; minimum at "
        f"{between(minima, '°')}, {between(lowest.sel(aspect_ratio=long))}",
        [
            symmetric(e_n),
            conditions(wings, "wings"),
            trend(ranges, RISES),
        ],
        {"largest_range": ranges.max(), "least_e_n": lowest.min()},
    )


def symmetric(values: xr.DataArray, sign: float = 1.0):
    """Whether values over the orientation are symmetric, at each A_r."""
    what = "symmetric" if sign > 0.0 else "antisymmetric"
    # What a sphere does not do is symmetric either way.
    values = values.where(abs(values) > NOTHING, 0.0)
    return conditions(asymmetry(values, sign).fillna(0.0) <= MARGIN, what)


def _symmetry_of(name: str, unit: str, factor: float = 1.0):
    """The judge of a largest value of set IV that is symmetric about 90°."""

    def judge_symmetry(sets: Datasets) -> Judgement:
        values = factor * sets["IV"][name]
        apart = asymmetry(values.where(abs(values) > NOTHING, 0.0)).fillna(0.0)
        return judge(
            f"{between(values, unit)}, mirrored to {float(apart.max()):.0e}",
            [symmetric(values)],
            {"asymmetry": apart.max()},
        )

    return judge_symmetry


def rotation_against_orientation(sets: Datasets) -> Judgement:
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
            symmetric(turn, -1.0),
            conditions(near & single, "rises to a peak near A_r 2.5 and falls"),
        ],
        {"median_A_r_of_peak": peaks.median(), "largest_deg": top.max()},
    )


def _rises_then_falls(values: np.ndarray) -> bool:
    peak = int(np.argmax(values))
    taken = steps(values)
    return bool(np.all(taken[:peak] > 0) and np.all(taken[peak:] < 0))


def force_falls_with_sphericity(sets: Datasets) -> Judgement:
    """The largest N falls with A_r, thus with falling S_p."""
    vertical = {
        axis: sets[name].max_normal_force_N.values / 1e3
        for axis, name in (("major", "I"), ("minor", "II"))
    }
    inclined = {
        "major": along_major_axis(sets).max_normal_force_N,
        "minor": along_minor_axis(sets).max_normal_force_N,
    }
    return judge(
        "; ".join(
            f"vertical along the {axis} axis {from_to(force, 'kN')}, "
            f"{steps_that_go(force, FALLS)}"
            for axis, force in vertical.items()
        ),
        [
            *(trend(force, FALLS) for force in vertical.values()),
            *(
                trends(force, "aspect_ratio", FALLS, f"inclined, {axis} axis: falls")
                for axis, force in inclined.items()
            ),
        ],
        {
            f"{axis}_axis_{which}_kN": force[place]
            for axis, force in vertical.items()
            for which, place in (("sphere", 0), ("longest", -1))
        },
    )


def rotation_grows(sets: Datasets) -> Judgement:
    """The rotation never goes back."""
    rotation = sets["courses"].rotation_rad.sel(angle_deg=ANGLE_DEG)
    back = (-rotation.diff("step").min("step")).clip(min=0.0)
    last = np.degrees(rotation.max("step"))
    return judge(
        f"to {between(last, '°')}, back by {float(back.max()):.2g} rad at most",
        [conditions(back <= BACK_RAD, "grows")],
        {"largest_step_back_rad": back.max()},
    )


def rotational_ratio_peaks(sets: Datasets) -> Judgement:
    """R_r rises to a maximum, after which that of low A_r falls slightly."""
    ratio = sets["courses"].R_r.sel(angle_deg=ANGLE_DEG)
    largest = ratio.max("step")
    last = ratio.isel(step=-1)
    fall = (largest - last) / largest
    dip = along_dimension(_deepest_dip, ratio, "step")
    short, long = fall.isel(aspect_ratio=[0]), fall.isel(aspect_ratio=[-1])
    percent = 100.0 * fall
    return judge(
        f"largest {between(largest)}; falls by {float(percent[0]):.2g} % at A_r 1, "
        f"{float(percent[1]):.2g} % at {float(fall.aspect_ratio[1]):g}, "
        f"{float(percent[-1]):.2g} % at 4",
        [
            conditions(dip <= DIP, "rises to its maximum"),
            *conditions((short >= DIP) & (short <= SLIGHT), "").parts,
            *conditions(long < DIP, "").parts,
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


def peaks_inside(values: xr.DataArray, dimension: str) -> xr.DataArray:
    """Whether lines along a dimension have a maximum beyond both of their ends."""

    def of_line(line):
        top = line[np.argmax(line)]
        return steps([line[0], top])[0] > 0 and steps([line[-1], top])[0] > 0

    return along_dimension(of_line, values, dimension)


def place_of_peak(values: xr.DataArray, dimension: str, unit: str) -> str:
    """Places of the maxima of lines along a dimension, in words."""
    return f"peak at {between(values.idxmax(dimension), unit)}"


def penetration(sets: Datasets) -> Judgement:
    """The largest u_n falls with the angle and rises with A_r."""
    depth = along_major_axis(sets).max_penetration_m
    return judge(
        between(depth, "m"),
        [
            trends(depth, "angle_deg", FALLS, "falls with the angle"),
            trends(depth, "aspect_ratio", RISES, "grows with A_r"),
        ],
        {"least_m": depth.min(), "largest_m": depth.max()},
    )


def force(sets: Datasets) -> Judgement:
    """The largest N falls with A_r and with the angle."""
    force = along_major_axis(sets).max_normal_force_N / 1e3
    first, top = force.isel(angle_deg=0), force.max("angle_deg")
    rise = 100.0 * (top / first - 1.0)
    return judge(
        f"{between(force, 'kN')}, {place_of_peak(force, 'angle_deg', '°')}, above that "
        f"at {float(force.angle_deg[0]):g}° by up to {float(rise.max()):.2g} %",
        [
            trends(force, "aspect_ratio", FALLS, "falls with A_r"),
            trends(force, "angle_deg", FALLS, "falls with the angle"),
        ],
        {"rise_before_the_peak_percent": rise.max()},
    )


def rotation(sets: Datasets) -> Judgement:
    """The rotation has a peak over the angle and falls with A_r, but for the sphere."""
    turn = np.degrees(along_major_axis(sets).rotation_rad)
    sphere = turn.sel(aspect_ratio=1.0)
    others = turn.sel(aspect_ratio=turn.aspect_ratio > 1.0)
    low, high = others.min("aspect_ratio"), others.max("aspect_ratio")
    return judge(
        f"{place_of_peak(turn, 'angle_deg', '°')}; sphere {between(sphere, '°')}, "
        f"others {between(others, '°')}",
        [
            conditions(peaks_inside(turn, "angle_deg"), "peaks inside"),
            trends(others, "aspect_ratio", FALLS, "falls with A_r from 1.5"),
            conditions((sphere > low) & (sphere < high), "sphere in between"),
        ],
        {
            "largest_of_sphere_deg": sphere.max(),
            "least_of_others_deg": others.min(),
            "largest_of_others_deg": others.max(),
        },
    )


def rotational_ratio(sets: Datasets) -> Judgement:
    """The largest R_r of an impact has a peak over the angle and rises with A_r."""
    ratio = sets["courses"].R_r.max("step")
    return judge(
        f"{between(ratio)}, {place_of_peak(ratio, 'angle_deg', '°')}",
        [
            conditions(peaks_inside(ratio, "angle_deg"), "peaks inside"),
            trends(ratio, "aspect_ratio", RISES, "grows with A_r"),
        ],
        {"least": ratio.min(), "largest": ratio.max()},
    )


CLAIMS = {
    "C01": _trend_with_length("I", "max_penetration_m", RISES, "m"),
    "C02": _trend_with_length("I", "max_normal_force_N", FALLS, "kN", 1e3),
    "C03": peaks_come_later,
    "C04": short_blocks_stop,
    "C05": _trend_with_length("II", "max_penetration_m", RISES, "m", 1.0, [FALLS]),
    "C06": _trend_with_length("II", "max_normal_force_N", FALLS, "kN", 1e3, [RISES]),
    "C07": penetrates_more_along_the_major_axis,
    "C08": _excess_within("max_penetration_m", *DEPTH_EXCESS),
    "C09": half_as_long_along_the_major_axis,
    "C10": _excess_within("max_normal_force_N", *FORCE_EXCESS),
    "C11": rotation_grows,
    "C12": rotational_ratio_peaks,
    "C13": penetration,
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

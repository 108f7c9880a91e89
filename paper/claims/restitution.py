"""Coefficients of restitution: Fig. 9 and the abstract (inclined impacts, set III),
Eq. 5 (the energetic coefficient) and Fig. 13 (A_r 2 over the orientation, with spin).
"""

import numpy as np
import xarray as xr

from jaximpact.parametric_sets import PARAMETRIC_SETS

from ..criteria import (
    FALLS,
    MARGIN,
    RISES,
    Judgement,
    Verdict,
    along_dimension,
    asymmetry,
    between,
    condition,
    conditions,
    elongated,
    from_to,
    judge,
    less_mirrored,
    steps,
    trend,
    trends,
)
from ..study import RANDOM_SETS, Study
from .impacts import MAJOR, MINOR, inclined, trends_along_the_major_axis

NEGATIVE_TO_DEG = 50.0
RISES_FROM_DEG = 65.0
RISES_BY = 0.1
TWO_ORDERS = 100.0
ABOVE = 1e-6
"""Excess over 1 that errors of the integration may bring."""
COEFFICIENTS = {
    "e_n": "apparent",
    "e_contact": "contact",
    "e_bar": "energetic",
    "e_n_vijayakumar": "rigid-body",
}
WIDE = 1.0 / 3.0
"""Part of the orientations that counts as a wide range."""
COINCIDE = 1e-3
_SPIN = "angular_velocity_degps"


def e_n_is_negative(study: Study) -> Judgement:
    """Along the major axis e_n is not monotonic, and negative up to 50°."""
    e_n = elongated(inclined(study, MAJOR).e_n)
    turns = along_dimension(
        lambda line: {RISES, FALLS} <= set(steps(line)), e_n, "angle_deg"
    )
    low = e_n.sel(angle_deg=e_n.angle_deg <= NEGATIVE_TO_DEG)
    negative = ", ".join(
        f"A_r {float(line.aspect_ratio):g} from {float(line.angle_deg[line < 0][0]):g}°"
        for line in e_n.transpose("aspect_ratio", "angle_deg")
        if (line < 0.0).any()
    )
    return judge(
        f"{between(low)} up to {NEGATIVE_TO_DEG:g}°; negative {negative or 'nowhere'}",
        conditions(turns, "not monotonic"),
        conditions((low < 0.0).all("angle_deg"), "negative up to 50°"),
    )


def e_n_rises_at_large_angles(study: Study) -> Judgement:
    """Along the major axis e_n rises from 65 to 80°, by more than 0.1."""

    def steep(axis: float) -> xr.DataArray:
        e_n = inclined(study, axis).e_n
        return e_n.sel(angle_deg=e_n.angle_deg >= RISES_FROM_DEG)

    major, minor = steep(MAJOR), steep(MINOR)
    change, change_minor = (
        e_n.isel(angle_deg=-1) - e_n.isel(angle_deg=0) for e_n in (major, minor)
    )
    up = along_dimension(
        lambda line: bool(np.all(steps(line) == RISES)), major, "angle_deg"
    )
    return judge(
        f"change from 65 to 80°: {between(change)} "
        f"(minor axis {between(change_minor)})",
        conditions(up & (change > RISES_BY), "rises fast"),
    )


def both_fall_along_the_minor_axis(study: Study) -> Judgement:
    """Along the minor axis e_n and e_t fall with A_r."""
    data = inclined(study, MINOR)
    return judge(
        f"e_n {between(data.e_n)}, e_t {between(data.e_t)}",
        trends(data.e_n, "aspect_ratio", FALLS, "e_n falls with A_r"),
        trends(data.e_t, "aspect_ratio", FALLS, "e_t falls with A_r"),
    )


def two_orders_of_magnitude(study: Study) -> Judgement:
    """Along the major axis |e_n| varies over the angle by more than 100 times."""
    e_n = inclined(study, MAJOR).e_n
    size = abs(e_n)
    ratio = size.max("angle_deg") / size.min("angle_deg")
    crosses = (e_n.min("angle_deg") < 0.0) & (e_n.max("angle_deg") > 0.0)
    where = ", ".join(f"{float(a_r):g}" for a_r in e_n.aspect_ratio[crosses])
    return judge(
        f"largest over least |e_n| {from_to(ratio)} at A_r "
        f"{from_to(e_n.aspect_ratio)}; its sign changes "
        + (f"at A_r {where}" if where else "nowhere"),
        conditions((ratio > TWO_ORDERS) | crosses, "more than 100"),
    )


def never_exceeds_one(study: Study) -> Judgement:
    """The energetic coefficient is at most 1, in the sets and in random impacts."""
    in_sets = [_impacts(study[name]).e_bar for name in PARAMETRIC_SETS]
    groups = {"sets": np.concatenate(in_sets)}
    failed = beyond_gravity = 0
    for name in RANDOM_SETS:
        impacts = _impacts(study[name])
        finished = np.isfinite(impacts.e_bar)
        failed += int((~finished).sum())
        groups[name] = impacts.e_bar.values[finished]
        left = impacts.e_bar**2 - impacts.gravity_share
        beyond_gravity += int((left > (1.0 + ABOVE) ** 2).sum())
    above = {name: int(np.sum(x > 1.0 + ABOVE)) for name, x in groups.items()}
    if above["sets"]:
        verdict = Verdict.fails
    else:
        verdict = Verdict.partly if any(above.values()) else Verdict.holds
    words = [
        f"{name} {above[name]} of {len(values)}, largest {values.max():.4g}"
        for name, values in groups.items()
    ]
    words.append(f"with gravity's work taken off {beyond_gravity}")
    if failed:
        words.append(f"{failed} random impacts failed")
    within = sum(count == 0 for count in above.values())
    return Judgement(verdict, f"above 1: {'; '.join(words)}", within, len(above))


def _impacts(data: xr.Dataset) -> xr.Dataset:
    """Impacts in a row, but for blocks that separate from the ground as they touch."""
    flat = data[[n for n in ("e_bar", "gravity_share", "outcome") if n in data]]
    flat = flat.stack(point=data.outcome.dims, create_index=False)
    return flat.isel(point=flat.outcome.values != "separating")


def apparent_is_negative(study: Study) -> Judgement:
    """e_n is negative over a wide range, the contact and energetic ones are not."""
    data = study["fig13"]
    share = (data.e_n < 0.0).mean("orientation_deg")
    contact = data.e_contact.min("orientation_deg")
    energetic = data.e_bar.min("orientation_deg")
    below = int((data.e_contact <= 0.0).sum())
    return judge(
        f"e_n negative at {between(100.0 * share, '%')} of orientations, down to "
        f"{float(data.e_n.min()):.3g}; contact one down to {float(contact.min()):.3g}, "
        f"not above zero at {below} of {data.e_contact.size} points; energetic one "
        f"down to {float(energetic.min()):.3g}",
        conditions(share >= WIDE, "apparent one negative over a third"),
        conditions(contact > 0.0, "contact one positive"),
        conditions(energetic > 0.0, "energetic one positive"),
    )


def asymmetry_grows_with_spin(study: Study) -> Judgement:
    """Symmetric without spin, ever less so with it."""
    data = study["fig13"]
    parts, words = [], []
    for name, kind in COEFFICIENTS.items():
        apart = np.sqrt((less_mirrored(data[name]) ** 2).mean("orientation_deg"))
        still = asymmetry(data[name].sel({_SPIN: 0.0}))
        parts += [condition(float(still) <= MARGIN), trend(apart, RISES)]
        words.append(f"{kind} {', '.join(f'{float(x):.2g}' for x in apart)}")
    spins = ", ".join(f"{float(x):g}" for x in data[_SPIN])
    return judge(
        f"root mean square of value less mirrored value at {spins} °/s: "
        + "; ".join(words),
        *parts,
    )


def coefficients_coincide(study: Study) -> Judgement:
    """Along an axis and without spin the four coefficients are one."""
    still = study["fig13"].sel({_SPIN: 0.0}, drop=True)
    along_axes = still.sel(orientation_deg=[0.0, 90.0, 180.0])
    four = xr.concat([along_axes[name] for name in COEFFICIENTS], "coefficient")
    apart = four.max("coefficient") - four.min("coefficient")
    return judge(
        f"e_n {from_to(along_axes.e_n[:2])} at 0 and 90°, the four within "
        f"{float(apart.max()):.1g}",
        conditions(apart <= COINCIDE, "coincide"),
    )


CLAIMS = {
    "C23": trends_along_the_major_axis(
        "e_n", "", ("aspect_ratio", FALLS, "falls with A_r")
    ),
    "C24": trends_along_the_major_axis(
        "e_t", "", ("aspect_ratio", RISES, "grows with A_r")
    ),
    "C25": e_n_is_negative,
    "C26": e_n_rises_at_large_angles,
    "C27": both_fall_along_the_minor_axis,
    "C28": two_orders_of_magnitude,
}
"""Judges of the claims on restitution in set III."""
FURTHER_CLAIMS = {
    "C29": never_exceeds_one,
    "C30": apparent_is_negative,
    "C31": asymmetry_grows_with_spin,
    "C32": coefficients_coincide,
}

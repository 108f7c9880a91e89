"""Fig. 13: coefficients at A_r 2 over the orientation, with initial spin."""

import numpy as np
import xarray as xr

from ..parts import MARGIN, RISES, between, condition, conditions, from_to, judge, trend
from ..study import Datasets
from ..symmetry import asymmetry, less_mirrored
from ..verdict import Judgement

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


def apparent_is_negative(sets: Datasets) -> Judgement:
    """e_n is negative over a wide range, the contact and energetic ones are not."""
    data = sets["fig13"]
    share = (data.e_n < 0.0).mean("orientation_deg")
    contact = data.e_contact.min("orientation_deg")
    energetic = data.e_bar.min("orientation_deg")
    below = int((data.e_contact <= 0.0).sum())
    return judge(
        f"e_n negative at {between(100.0 * share, '%')} of orientations, down to "
        f"{float(data.e_n.min()):.3g}; contact one down to {float(contact.min()):.3g}, "
        f"not above zero at {below} of {data.e_contact.size} points; energetic one "
        f"down to {float(energetic.min()):.3g}",
        [
            conditions(share >= WIDE, "apparent one negative over a third"),
            conditions(contact > 0.0, "contact one positive"),
            conditions(energetic > 0.0, "energetic one positive"),
        ],
        {
            "least_share_percent": 100.0 * share.min(),
            "least_contact": contact.min(),
            "least_energetic": energetic.min(),
        },
    )


def asymmetry_grows_with_spin(sets: Datasets) -> Judgement:
    """Symmetric without spin, ever less so with it."""
    data = sets["fig13"]
    parts, words, numbers = [], [], {}
    for name, kind in COEFFICIENTS.items():
        apart = np.sqrt((less_mirrored(data[name]) ** 2).mean("orientation_deg"))
        still = asymmetry(data[name].sel({_SPIN: 0.0}))
        parts.append(condition(float(still) <= MARGIN))
        parts.append(trend(apart, RISES))
        words.append(f"{kind} {', '.join(f'{float(x):.2g}' for x in apart)}")
        numbers[f"{name}_at_largest_spin"] = apart[-1]
    spins = ", ".join(f"{float(x):g}" for x in data[_SPIN])
    return judge(
        f"root mean square of value less mirrored value at {spins} °/s: "
        + "; ".join(words),
        parts,
        numbers,
    )


def coefficients_coincide(sets: Datasets) -> Judgement:
    """Along an axis and without spin the four coefficients are one."""
    still = sets["fig13"].sel({_SPIN: 0.0}, drop=True)
    along_axes = still.sel(orientation_deg=[0.0, 90.0, 180.0])
    four = xr.concat([along_axes[name] for name in COEFFICIENTS], "coefficient")
    apart = four.max("coefficient") - four.min("coefficient")
    return judge(
        f"e_n {from_to(along_axes.e_n[:2])} at 0 and 90°, the four within "
        f"{float(apart.max()):.1g}",
        [conditions(apart <= COINCIDE, "coincide")],
        {"apart": apart.max()},
    )


CLAIMS = {
    "C30": apparent_is_negative,
    "C31": asymmetry_grows_with_spin,
    "C32": coefficients_coincide,
}

"""Datasets on which every claim of the paper holds, made up."""

import copy

import numpy as np
import xarray as xr
from scipy.special import ndtri

from paper.biplanar import ASPECT_RATIOS, SPINS_DEGPS
from paper.study import RANDOM_SETS, SERIES, SLOPE

A_R = xr.DataArray(
    np.linspace(1.0, 4.0, 7), coords={"aspect_ratio": np.linspace(1.0, 4.0, 7)}
)
LONG = A_R > 1.0


def _axis(name, values):
    return xr.DataArray(values, dims=name, coords={name: values})


ANGLE = _axis("angle_deg", np.arange(10.0, 81.0, 5.0))
ORIENTATION = _axis("orientation_deg", np.arange(0.0, 171.0, 5.0))
SPIN = _axis("angular_velocity_degps", np.array([0.0, 500.0, 1500.0, 2000.0]))


class MadeUp(dict):
    """Datasets by name, the same or others on other grounds."""

    def __init__(self, sets):
        super().__init__(sets)
        self.others = {}

    def on(self, ground):
        return self.others.get(ground, self)

    def with_other(self, ground, sets):
        """The same with other sets on a ground."""
        copied = copy.copy(self)
        copied.others = self.others | {ground: sets}
        return copied

    def changed(self, name, **variables):
        """The same with other variables of a set."""
        return MadeUp(self | {name: self[name].assign(variables)})


def ideal() -> MadeUp:
    """Sets as the paper's claims have them."""
    minor = xr.Dataset(
        {
            "max_penetration_m": 0.2 + 0.005 * (A_R - 1.0),
            "max_normal_force_N": 1e5 * (1.0 - 0.05 * (A_R - 1.0)),
            "duration_s": 0.04 + 0.0 * A_R,
            "e_n": 0.002 - 0.01 * (A_R - 1.0),
        }
    )
    major = xr.Dataset(
        {
            "max_penetration_m": minor.max_penetration_m
            * (1.0 + LONG * (0.05 + 0.1 * (A_R - 1.0))),
            "max_normal_force_N": minor.max_normal_force_N * (1.0 + 0.01 * LONG),
            "duration_s": 0.02 + 0.0 * A_R,
            "time_of_max_penetration_s": 0.01 * A_R,
            "time_of_max_normal_force_s": 0.005 * A_R,
            "e_n": 0.002 + 0.02 * (A_R - 1.0) ** 2,
        }
    )
    sets = {"I": _ended(major), "II": _ended(minor)}
    sets["I"]["outcome"] = xr.where(A_R < 2.0, "arrested", "detached")
    sets["III"] = _ended(xr.concat([_inclined(), _inclined_minor()], _axes_of_block()))
    turn = np.radians(ORIENTATION)
    size = xr.where(LONG, 3.0 - abs(A_R - 2.5), 0.0)
    sets["IV"] = _ended(
        xr.Dataset(
            {
                "e_n": 0.1 - 0.1 * (A_R - 1.0) * np.sin(2.0 * turn) ** 2,
                "max_penetration_m": 0.2 + 0.05 * (A_R - 1.0) * np.cos(turn) ** 2,
                "max_normal_force_N": 1e5 - 1e4 * (A_R - 1.0) * np.cos(turn) ** 2,
                "max_moment_Nm": 1e3 * (A_R - 1.0) * np.sin(2.0 * turn) ** 2,
                "rotation_rad": 0.1 * size * np.sin(2.0 * turn),
            }
        )
    )
    sets["fig13"] = _ended(_spinning(), e_bar=False)
    sets[SERIES] = _courses()
    impacts = xr.Dataset(
        {
            "e_bar": ("impact", np.linspace(0.1, 0.9, 5)),
            "gravity_share": ("impact", np.full(5, 0.01)),
            "outcome": ("impact", np.full(5, "toppled", "<U10")),
        }
    )
    sets[SLOPE] = _slope()
    return MadeUp(sets | dict.fromkeys(RANDOM_SETS, impacts))


def _ended(dataset, e_bar=True):
    whole = dataset.e_n
    added = {"outcome": xr.full_like(whole, 0.0).astype(str)}
    added["outcome"][:] = "detached"
    if e_bar:
        added["e_bar"] = xr.full_like(whole, 0.5)
    return dataset.assign(added)


def _axes_of_block():
    return xr.DataArray(
        [0.0, 90.0], dims="orientation_deg", name="orientation_deg"
    ).assign_coords(orientation_deg=[0.0, 90.0])


def _inclined():
    slant = np.radians(ANGLE)
    size = xr.where(LONG, 2.0 - 0.2 * A_R, 1.5)
    low = -0.1 * np.sin(np.pi * (ANGLE - 5.0) / 50.0)
    return xr.Dataset(
        {
            "max_penetration_m": (0.1 + 0.01 * A_R) * np.cos(slant),
            "max_normal_force_N": 1e5 * np.cos(slant) / (1.0 + 0.1 * A_R),
            "rotation_rad": 0.1 * size * np.sin(2.0 * slant),
            "e_n": xr.where(ANGLE < 55.0, low, 0.02 * (ANGLE - 54.3))
            - 0.01 * (A_R - 1.0),
            "e_t": 0.5 + 0.05 * A_R + 0.001 * ANGLE,
        }
    )


def _inclined_minor():
    falling = 0.9 - 0.1 * A_R + 0.001 * ANGLE
    return _inclined().assign(
        e_n=falling, e_t=falling, max_normal_force_N=1e5 * falling
    )


def _spinning():
    turn = np.radians(_axis("orientation_deg", np.arange(0.0, 181.0, 5.0)))
    double = np.sin(2.0 * turn)
    tilt = 1e-5 * SPIN * double
    return xr.Dataset(
        {
            "e_n": 0.1 - 0.5 * double**2 + tilt,
            "e_contact": 0.1 + 0.2 * double**2 + tilt,
            "e_bar": 0.1 + 0.1 * double**2 + tilt,
            "e_n_vijayakumar": 0.1 - 0.3 * double**2 + tilt,
        }
    )


def _courses():
    angle = _axis("angle_deg", np.arange(10.0, 81.0, 10.0))
    step = xr.DataArray(np.arange(5.0), dims="step")
    # A_r 1 falls by 5 % in the last step
    rise = xr.where((step == 4.0) & (A_R == 1.0), 0.95 * 3.0, np.minimum(step, 3.0))
    top = np.sin(np.radians(2.0 * angle)) * A_R
    return xr.Dataset({"rotation_rad": 0.01 * step * A_R * angle, "R_r": rise * top})


def _slope():
    shape = _axis("aspect_ratio", np.array(ASPECT_RATIOS))
    spin = _axis("angular_velocity_degps", np.array(SPINS_DEGPS))
    everywhere = 0.0 * shape + 0.0 * spin
    shares = (np.arange(200) + 0.5) / 200
    heights = np.concatenate([-a * np.log(shares) for a in ASPECT_RATIOS])
    spread = ndtri(shares)
    return xr.Dataset(
        {
            "first_impact_x_m": 60.0 + everywhere,
            "off_the_parabola_m": everywhere,
            "first_flight_m": 12.0 + everywhere,
            "bounces": xr.where(shape == 1.0, 3.0, 0.0) + everywhere,
            "highest_bounce_m": xr.where(shape == 1.0, 1.0, 0.0) + everywhere,
            "middle_bounce_m": everywhere,
            "rolls": everywhere == 0.0,
            "paths_apart_m": 0.1 * (shape - 1.0),
            "jump_height_m": ("jump", heights),
            "jump_aspect_ratio": ("jump", np.repeat(ASPECT_RATIOS, len(shares))),
            "e_n": ("impact", 0.67 + 0.3 * spread),
            "e_t": ("impact", 0.92 + 0.2 * spread),
            "impact_aspect_ratio": ("impact", np.resize(ASPECT_RATIOS, len(spread))),
            "e_n_before_hops": ("hop", -0.7 + 0.1 * spread),
        }
    )

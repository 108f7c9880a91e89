"""The history of impacts as a dataset."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from ..errors import InputError
from .datasets import dimension_names

if TYPE_CHECKING:
    from ..history import History

SERIES = {
    "time": ("s", "time since touch"),
    "penetration": ("m", "u_n, penetration of the centre"),
    "sinking": ("m", "u_D, penetration of the lowest point"),
    "rotation": ("rad", "rotation since touch"),
    "normal_velocity": ("m/s", "v_n, into the ground"),
    "tangential_velocity": ("m/s", "v_t, down-slope"),
    "angular_velocity": ("rad/s", "spin"),
    "normal_force": ("N", "N"),
    "tangential_force": ("N", "T"),
    "moment": ("N m", "M"),
    "hardening": ("-", "rho_c, hardening variable"),
    "foundation_length": ("m", "length of the equivalent foundation"),
    "foundation_width": ("m", "width of the equivalent foundation"),
    "rotational_ratio": ("-", "rotational over total kinetic energy"),
    "kinetic": ("J", "kinetic energy"),
    "elastic": ("J", "elastic energy"),
    "gravity": ("J", "work of gravity"),
    "viscoplastic": ("J", "dissipated by yielding"),
    "slider": ("J", "dissipated by sliding"),
    "dashpot": ("J", "dissipated by damping"),
    "arm": ("J", "work of the arm between centre and deepest point"),
    "stiffness": ("J", "work of the change of stiffness"),
    "in_contact": ("", "whether the block is in contact"),
}
"""Field of a history -> unit and meaning."""


def dataset_of_history(
    history: "History", dims: Sequence[str] | None = None
) -> xr.Dataset:
    """The dataset that `History.to_xarray` gives."""
    lanes = np.shape(history.time)[:-1]
    names = dimension_names(len(lanes)) if dims is None else tuple(dims)
    if len(names) != len(lanes):
        raise InputError(
            f"dims must be {len(lanes)} names, one for each axis of the shape {lanes}, "
            f"but is {dims!r}"
        )
    time = np.asarray(history.time)
    base = time[(0,) * len(lanes)] if time.size else time.reshape(-1)
    if not np.array_equal(np.broadcast_to(base, time.shape), time):
        raise InputError(
            "a dataset needs one time base, but the impacts of the history have times "
            "of their own; make one dataset of each"
        )

    def attributes(name: str) -> dict[str, str]:
        unit, meaning = SERIES[name]
        return ({"units": unit} if unit else {}) | {"long_name": meaning}

    variables = {
        name: ((*names, "time"), np.asarray(series), attributes(name))
        for name, series in history._asdict().items()
        if name != "time" and series is not None
    }
    return xr.Dataset(variables, {"time": ("time", base, attributes("time"))})

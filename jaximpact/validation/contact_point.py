"""Where the contact coefficient takes the normal velocity at the end."""

import enum

import numpy as np
import xarray as xr

from ..restitution import vijayakumar_coefficient
from ..scene import Scene
from ..shapes import AbstractShape


class ContactPoint(enum.Enum):
    """The point of the block whose velocity counts when the contact ends."""

    foundation = "centre of the foundation"
    """As the package has it."""
    deepest = "deepest point of the block"
    first = "point as far to the side as the one that touched first"


def with_contact_at(
    dataset: xr.Dataset, base: Scene, point: ContactPoint
) -> xr.Dataset:
    """Impacts over the orientation and the spin with the contact coefficient taken
    elsewhere, and the rigid-body coefficient that follows from it."""
    if point is ContactPoint.foundation:
        return dataset
    axes = base.block.semi_axes
    start = np.radians(dataset.orientation_deg)
    touch = _arm(base.block.shape, axes, start)
    arm = touch
    if point is ContactPoint.deepest:
        arm = _arm(base.block.shape, axes, start + dataset.rotation_rad)
    spin = np.radians(dataset.angular_velocity_degps)
    normal = float(base.impact.normal_velocity)
    e_contact = -(dataset.v_n_mps + arm * dataset.omega_radps) / (normal + touch * spin)
    rigid = xr.apply_ufunc(
        lambda *varied: np.asarray(
            vijayakumar_coefficient(base.block, varied[0], varied[1], normal, varied[2])
        ),
        *xr.broadcast(start, e_contact, spin),
    )
    return dataset.assign(e_contact=e_contact, e_n_vijayakumar=rigid)


def _arm(shape: AbstractShape, axes, orientation: xr.DataArray) -> xr.DataArray:
    return xr.apply_ufunc(
        lambda turn: np.asarray(shape.tangency_arm(axes, np.sin(turn), np.cos(turn))),
        orientation,
    )

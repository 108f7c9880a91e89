"""How far models that leave something out are from the planar one, as measured.

The error is the largest of those in `e_n`, in `e_bar` and, relative, in the largest
normal force. Measured against the planar model on 1500 random scenes for each kind and
size of departure, within `MEASURED`; 99 of 100 scenes lie below the lines given
here. Nothing is known outside, where any other quantity is not at its default, or with
other laws or another shape than the usual ones.
"""

import dataclasses
import functools

import jax
import numpy as np

from ..formats.columns import columns_of
from ..scene import Scene

MEASURED = {
    "mass": (10.0, 1e4),
    "aspect_ratio": (1.0, 4.0),
    "gamma_v": (0.85, 8.7),
    "c_v": (0.5, 1.0),
    "k_E": (100.0, 2000.0),
    "speed": (5.0, 30.0),
    "angle": (-0.7, 0.7),
    "slope": (-0.3, 0.3),
    "orientation": (-np.inf, np.inf),
    "angular_velocity": (-np.inf, np.inf),
}
"""Ranges of the fields of block, soil and impact; what is not named has its default."""
LARGEST_SPIN = 0.2
"""Of Omega_0 R / v."""
LARGEST_TILT = 0.03
"""Of |sin(2 theta_0)| / 2: the angle from the ground's normal, or from its plane."""


@dataclasses.dataclass(frozen=True)
class Departures:
    """What takes a scene out of the symmetry; arrays that broadcast, not negative."""

    angle: np.ndarray
    slope: np.ndarray
    spin: np.ndarray
    """Omega_0 H / v."""
    tilt: np.ndarray
    """|sin(2 theta_0)| / 2; 0 for a sphere."""
    measured: np.ndarray
    """True within what was measured."""


def departures(scene: Scene) -> Departures:
    """The departures of each scene; fields are arrays that broadcast."""
    usual = _usual()
    if jax.tree.structure(scene) != jax.tree.structure(usual):
        return Departures(*np.zeros(4), measured=np.asarray(False))
    block, impact = scene.block, scene.impact
    number = np.asarray
    sphere = number(block.aspect_ratio) == 1.0
    tilt = np.where(sphere, 0.0, 0.5 * np.abs(np.sin(2.0 * number(impact.orientation))))
    axes = block.semi_axes
    turning = np.abs(number(impact.angular_velocity)) / number(impact.speed)
    spin = turning * number(axes.major)
    measured = turning * number(axes.minor) <= LARGEST_SPIN
    measured = measured & (tilt <= LARGEST_TILT)
    for column in columns_of(scene).values():
        value, default = (
            number(getattr(getattr(of, column.part), column.field))
            for of in (scene, usual)
        )
        low, high = MEASURED.get(column.field, (default, default))
        measured = measured & (low <= value) & (value <= high)
    angle, slope = np.abs(number(impact.angle)), np.abs(number(impact.slope))
    return Departures(angle, slope, spin, tilt, measured)


@functools.cache
def _usual() -> Scene:
    return Scene()


def vertical_error(scene: Scene) -> np.ndarray:
    """Error of normal motion alone: in proportion to each departure, since the soil
    that shear and rocking harden takes their magnitude. inf where it is not known."""
    d = departures(scene)
    error = 1.4 * d.angle + 0.1 * d.slope + 0.9 * d.spin + 1.0 * d.tilt
    return np.where(d.measured, error, np.inf)


def translational_error(scene: Scene) -> np.ndarray:
    """Error of a sphere that does not turn and comes in without spin. inf for other
    blocks, and where it is not known."""
    d = departures(scene)
    sphere = np.asarray(scene.block.aspect_ratio) == 1.0
    error = d.angle * (0.06 + 0.11 * d.angle) + 0.1 * d.slope
    return np.where(d.measured & sphere & (d.spin == 0.0), error, np.inf)

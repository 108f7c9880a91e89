"""Reduced models: fewer unknowns where symmetry or a tolerance allows it.

A model is a choice of unknowns. The equations and laws are the same for all; what is
not an unknown is zero, and stays so. That is exact where symmetry keeps it at zero.

Elsewhere a reduced model has an error: the largest of those in `e_n`, in `e_bar` and,
relative, in the largest normal force. It was measured against the planar model on 1500
random scenes for each kind and size of departure from the symmetry, within `MEASURED`;
99 of 100 scenes lie below the lines given here. Nothing is known outside, where any
other quantity is not at its default, or with other laws or another shape than the usual
ones.
"""

import functools
from collections.abc import Callable
from typing import NamedTuple

import jax
import numpy as np
from jax.errors import (
    ConcretizationTypeError,
    TracerArrayConversionError,
    TracerIntegerConversionError,
)

from .._jax_internals import Tracer, namespace_of
from ..quantities import columns_of
from ..scene import Block, Impact, Scene, Soil
from .dynamics import Motion

FORCES = ("normal_force", "tangential_force", "moment")
"""The forces as unknowns, in the order of `Forces`."""


class Model(NamedTuple):
    """A choice of the unknowns of an impact."""

    name: str
    unknowns: tuple[str, ...]
    """Fields of `Motion`, then with dashpots those of `FORCES`."""

    @property
    def damped(self) -> bool:
        """Whether forces are unknowns."""
        return any(name in FORCES for name in self.unknowns)


_NORMAL = ("penetration", "normal_velocity", "elastic_normal", "hardening")
VERTICAL = Model("vertical", _NORMAL)
"""Normal motion alone."""
VERTICAL_DAMPED = Model("vertical, with dashpot", (*_NORMAL, FORCES[0]))
_TRANSLATIONAL = (
    "penetration",
    "normal_velocity",
    "tangential_velocity",
    "elastic_normal",
    "elastic_tangential",
    "hardening",
)
TRANSLATIONAL = Model("translational", _TRANSLATIONAL)
"""Sinking and sliding; the block does not turn, as in di Prisco and Vecchiotti (2006).
Never exact: taken only where a tolerance allows it."""
PLANAR = Model("planar", Motion._fields)
"""Sinking, sliding and turning."""
PLANAR_DAMPED = Model("planar, with dashpots", (*Motion._fields, *FORCES))
MODELS = (VERTICAL, VERTICAL_DAMPED, TRANSLATIONAL, PLANAR, PLANAR_DAMPED)
"""Models from the cheapest to the most expensive."""


def select_model(
    block: Block, soil: Soil, impact: Impact, tolerance: float = 0.0
) -> Model:
    """Select the cheapest model that is exact for an impact, or is within a tolerance.

    Vertical where nothing pushes the block aside or turns it: `angle`,
    `angular_velocity` and `slope` zero, and a sphere or an axis that points down.
    Without dashpots where those that would work have damping ratios of zero.

    With a tolerance also one that is not exact, if it was measured to be within it: by
    the error that 99 of 100 scenes do not exceed, in `e_n`, in `e_bar` and, relative,
    in the largest normal force. What such a model leaves out is zero in
    its results, and `e_t` NaN where it leaves out sliding.

    Laws must keep the symmetry: no shear or rocking without shear force and moment.

    A value that is not known yet, because it is being differentiated or batched, counts
    as one that rules the cheaper model out: derivatives leave the symmetry.
    """
    scene = Scene(block, soil, impact)
    known = jax.tree.map(
        lambda x: np.nan if isinstance(x, Tracer) else np.asarray(x), scene
    )
    return MODELS[int(np.max(model_places(known, tolerance)))]


def model_places(scene: Scene, tolerance: float = 0.0) -> np.ndarray:
    """Find the place in `MODELS` of the cheapest model that is exact, or within a
    tolerance, for each scene.

    Fields are arrays that broadcast; NaN stands for what is not known.
    """
    exact, _ = exact_models(scene)
    exact = np.asarray(exact)
    if tolerance == 0.0:
        return exact
    vertical, translational = reduction_errors(scene)
    allowed = np.where(translational <= tolerance, MODELS.index(TRANSLATIONAL), exact)
    allowed = np.where(vertical <= tolerance, 0, allowed)
    return np.minimum(exact, allowed)


def exact_models(scene: Scene):
    """Find the place in `MODELS` of the cheapest model that is exact for each scene,
    and all places that there may be.

    Fields are arrays that broadcast, of JAX while it traces: then the place is one too.
    NaN stands for what is not known.
    """
    impact = scene.impact
    vertical = (
        (impact.angle == 0.0)
        & (impact.angular_velocity == 0.0)
        & (impact.slope == 0.0)
        & _unless_numpy_only(
            lambda: scene.block.shape.is_upright(impact.orientation), False
        )
    )
    by_normal, by_any = _unless_numpy_only(scene.soil.damping.acts, (True, True))
    where = namespace_of(vertical, by_normal, by_any).where
    place = where(vertical, 0, MODELS.index(PLANAR)) + where(
        vertical, by_normal, by_any
    )
    if not isinstance(place, Tracer):
        return place, np.unique(place).tolist()
    possible = {
        (0 if upright else MODELS.index(PLANAR)) + acts
        for upright in _values(vertical)
        for acts in _values(by_normal if upright else by_any)
    }
    return place, sorted(possible)


def _unless_numpy_only(function: Callable, otherwise):
    """Call a function of a user's law or shape, which may work for NumPy alone: while
    JAX traces, `otherwise` stands for its result, and rules the cheaper models out."""
    try:
        return function()
    except (
        ConcretizationTypeError,
        TracerArrayConversionError,
        TracerIntegerConversionError,
    ):
        return otherwise


def _values(truths) -> list[bool]:
    """List the values that truths have, or may have where they are not known."""
    if isinstance(truths, Tracer):
        return [False, True]
    return [bool(value) for value in np.unique(np.asarray(truths))]


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
"""Largest measured Omega_0 R / v [-]."""
LARGEST_TILT = 0.03
"""Largest measured |sin(2 theta_0)| / 2 [-], for small angles the angle from the
ground's normal or from its plane."""


_usual = functools.cache(Scene)


def reduction_errors(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Compute the errors of the vertical and of the translational model for each scene.

    They are sums over departures from the symmetry: angle, slope, spin Omega_0 H / v,
    and tilt |sin(2 theta_0)| / 2. The error of normal motion alone grows in proportion
    to each departure, since the soil that shear and rocking harden takes their
    magnitude. The translational model is for spheres that come in without spin.

    Args:
        scene: fields are arrays that broadcast.

    Returns:
        The errors, inf where they are not known.
    """
    usual = _usual()
    if jax.tree.structure(scene) != jax.tree.structure(usual):
        return np.asarray(np.inf), np.asarray(np.inf)
    block, impact = scene.block, scene.impact
    number = np.asarray
    sphere = number(block.aspect_ratio) == 1.0
    tilt = np.where(sphere, 0.0, 0.5 * np.abs(np.sin(2.0 * number(impact.orientation))))
    axes = block.semi_axes
    turning = np.abs(number(impact.angular_velocity)) / number(impact.speed)
    spin = turning * number(axes.major)
    angle, slope = np.abs(number(impact.angle)), np.abs(number(impact.slope))
    measured = turning * number(axes.minor) <= LARGEST_SPIN
    measured = measured & (tilt <= LARGEST_TILT)
    for column in columns_of(scene).values():
        value, default = (
            number(getattr(getattr(of, column.part), column.field))
            for of in (scene, usual)
        )
        low, high = MEASURED.get(column.field, (default, default))
        measured = measured & (low <= value) & (value <= high)
    vertical = 1.4 * angle + 0.1 * slope + 0.9 * spin + 1.0 * tilt
    translational = angle * (0.06 + 0.11 * angle) + 0.1 * slope
    moves_so = measured & sphere & (spin == 0.0)
    return (
        np.where(measured, vertical, np.inf),
        np.where(moves_so, translational, np.inf),
    )

"""How much model a scene needs: the ladder of models.

A model is a choice of unknowns. The equations and laws are the same for all; what is
not an unknown is zero, and stays so. That is exact where symmetry keeps it at zero.
"""

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
from ..block import Block
from ..scene import Impact, Scene
from ..soil import Soil
from .dynamics import Motion
from .model_error import translational_error, vertical_error

FORCES = ("normal_force", "tangential_force", "moment")
"""The forces as unknowns, in the order of `Forces`."""


class Model(NamedTuple):
    """Which unknowns an impact is computed with."""

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
"""From the cheapest to the dearest."""


def select_model(
    block: Block, soil: Soil, impact: Impact, tolerance: float = 0.0
) -> Model:
    """The cheapest model that is exact for an impact, or is within a tolerance.

    Vertical where nothing pushes the block aside or turns it: `angle`,
    `angular_velocity` and `slope` zero, and a sphere or an axis that points down.
    Without dashpots where those that would work have damping ratios of zero.

    With a tolerance also one that is not exact, if it was measured to be within it: by
    the error that 99 of 100 scenes do not exceed, in `e_n`, in `e_bar` and, relative,
    in the largest normal force (`model_error`). What such a model leaves out is zero in
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
    """Place in `MODELS` of the cheapest model that is exact, or within a tolerance, for
    each scene.

    Fields are arrays that broadcast; NaN stands for what is not known.
    """
    exact, _ = exact_models(scene)
    exact = np.asarray(exact)
    if tolerance == 0.0:
        return exact
    allowed = np.where(
        translational_error(scene) <= tolerance, MODELS.index(TRANSLATIONAL), exact
    )
    allowed = np.where(vertical_error(scene) <= tolerance, 0, allowed)
    return np.minimum(exact, allowed)


def exact_models(scene: Scene):
    """Place in `MODELS` of the cheapest model that is exact for each scene, and all
    places that there may be.

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
    """What a function gives. Laws and shapes of users may know numbers and NumPy's
    arrays alone: while JAX traces they say nothing, and the cheaper models are ruled
    out."""
    try:
        return function()
    except (
        ConcretizationTypeError,
        TracerArrayConversionError,
        TracerIntegerConversionError,
    ):
        return otherwise


def _values(truths) -> list[bool]:
    """The values that truths have, or may have where they are not known."""
    if isinstance(truths, Tracer):
        return [False, True]
    return [bool(value) for value in np.unique(np.asarray(truths))]

"""Reduced models: fewer unknowns where symmetry or a tolerance allows it.

A model is a choice of unknowns, and of the geometry where a block is round. The
equations and laws are the same for all; what is not an unknown is zero, and stays so.
That is exact where symmetry keeps it at zero.
"""

import itertools
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
from ..scene import Block, Impact, Scene, Soil
from .dynamics import Motion

FORCES = ("normal_force", "tangential_force", "moment")
"""The forces as unknowns, in the order of `Forces`."""


class Model(NamedTuple):
    """A choice of the unknowns of an impact."""

    name: str
    unknowns: tuple[str, ...]
    """Fields of `Motion`, then with dashpots those of `FORCES`."""
    is_round: bool = False
    """Whether the block's section in the plane of motion is a circle: nothing depends
    on its orientation, and all arms but that of the tangential force are zero."""

    @property
    def damped(self) -> bool:
        """Whether forces are unknowns."""
        return any(name in FORCES for name in self.unknowns)


_NORMAL = ("penetration", "normal_velocity", "elastic_normal", "hardening")
VERTICAL = Model("vertical", _NORMAL)
"""Normal motion alone."""
VERTICAL_DAMPED = Model("vertical, with dashpot", (*_NORMAL, FORCES[0]))
ROUND = Model("round", Motion._fields, is_round=True)
"""Sinking, sliding and turning of a block that is round."""
ROUND_DAMPED = Model("round, with dashpots", (*Motion._fields, *FORCES), is_round=True)
PLANAR = Model("planar", Motion._fields)
"""Sinking, sliding and turning."""
PLANAR_DAMPED = Model("planar, with dashpots", (*Motion._fields, *FORCES))
MODELS = (VERTICAL, VERTICAL_DAMPED, ROUND, ROUND_DAMPED, PLANAR, PLANAR_DAMPED)
"""Models from the cheapest to the most expensive: of each kind the one without dashpots
and that with them."""


def select_model(block: Block, soil: Soil, impact: Impact) -> Model:
    """Select the cheapest model that is exact for an impact.

    Vertical where nothing pushes the block aside or turns it: `angle`,
    `angular_velocity` and `slope` zero, and a sphere or an axis that points down.
    Round where the section is a circle. Without dashpots where those that would work
    have damping ratios of zero.

    Laws must keep the symmetry: no shear or rocking without shear force and moment.

    A value that is not known yet, because it is being differentiated or batched, counts
    as one that rules the cheaper model out: derivatives leave the symmetry.
    """
    scene = Scene(block, soil, impact)
    known = jax.tree.map(
        lambda x: np.nan if isinstance(x, Tracer) else np.asarray(x), scene
    )
    return exact_for_all(exact_models(known)[1])


def exact_for_all(places: list[int]) -> Model:
    """Select the cheapest model that is exact for impacts of several models, given by
    their places in `MODELS`: the most general kind, with dashpots if one has them."""
    kinds, damped = zip(*(divmod(place, 2) for place in places), strict=True)
    return MODELS[2 * max(kinds) + max(damped)]


def exact_models(scene: Scene):
    """Find the place in `MODELS` of the cheapest model that is exact for each scene,
    and all places that there may be.

    Fields are arrays that broadcast, of JAX while it traces: then the place is one too.
    NaN stands for what is not known. An empty array gets the planar model.
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
    is_round = _unless_numpy_only(scene.block.shape.is_round, False)
    by_normal, by_any = _unless_numpy_only(scene.soil.damping.acts, (True, True))
    deciding = vertical, is_round, by_normal, by_any
    place = _place_of(*deciding)
    if not isinstance(place, Tracer):
        places = np.unique(place).tolist()
    else:
        possible = itertools.product(*map(_values, deciding))
        places = sorted({int(_place_of(*values)) for values in possible})
    return place, places or [MODELS.index(PLANAR)]


def _place_of(vertical, is_round, by_normal, by_any):
    """Find places in `MODELS` from what decides: two truths of symmetry, and whether
    dashpots act in a vertical impact and in any other."""
    where = namespace_of(vertical, is_round, by_normal, by_any).where
    otherwise = where(is_round, MODELS.index(ROUND), MODELS.index(PLANAR))
    return where(vertical, 0, otherwise) + where(vertical, by_normal, by_any)


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

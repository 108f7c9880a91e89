"""The constitutive laws, one to a file, and the set of them that a simulation uses."""

import dataclasses
from collections.abc import Callable

from .bearing_capacity import (
    BearingFactors,
    bearing_capacity,
    bearing_factors,
    peak_friction_angle,
)
from .branch import Branch
from .damping import Damping, dashpots
from .elasticity import Stiffness, elastic_stiffness
from .flow import FlowRate, flow_direction, flow_rate, overstress
from .hardening import hardening_rate
from .loading_surface import Load, loading_surface
from .slider import slider_friction, slip_rate

__all__ = [
    "BearingFactors",
    "Branch",
    "Damping",
    "FlowRate",
    "Laws",
    "Load",
    "Stiffness",
    "bearing_capacity",
    "bearing_factors",
    "dashpots",
    "elastic_stiffness",
    "flow_direction",
    "flow_rate",
    "hardening_rate",
    "loading_surface",
    "overstress",
    "peak_friction_angle",
    "slider_friction",
    "slip_rate",
]


@dataclasses.dataclass(frozen=True)
class Laws:
    """The constitutive functions of one simulation; each can be replaced by another.

    A replacement takes and returns what the function that it replaces does, is written
    in `jax.numpy`, and is finite for every finite input:
    `dataclasses.replace(Laws(), bearing_capacity=mine)`. One that takes a `branch` and
    does not heed it stays right; steps across its own kinks are then left to the error
    control.
    """

    elastic_stiffness: Callable = elastic_stiffness
    dashpots: Callable = dashpots
    peak_friction_angle: Callable = peak_friction_angle
    bearing_factors: Callable = bearing_factors
    bearing_capacity: Callable = bearing_capacity
    loading_surface: Callable = loading_surface
    flow_rate: Callable = flow_rate
    hardening_rate: Callable = hardening_rate
    slider_friction: Callable = slider_friction
    slip_rate: Callable = slip_rate

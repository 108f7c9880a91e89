"""Readings of the model, to measure what a claim depends on.

Each changes one thing that the paper does not print, or prints without saying how it
enters: a quantity, a law, the point of whose velocity the contact coefficient is, or a
detail of the slope run-out.
"""

import dataclasses
import enum
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from jaximpact.restitution import vijayakumar_coefficient
from jaximpact.runout.state import HOP_THRESHOLD
from jaximpact.scene import Scene
from jaximpact.units import DEGREE

from .biplanar import SLOPE, BiplanarCase


class ContactPoint(enum.Enum):
    """The point of the block whose velocity counts when the contact ends."""

    foundation = "centre of the foundation"
    """The point that the package uses."""
    deepest = "deepest point of the block"
    first = "point as far to the side as the one that touched first"


def with_contact_at(
    dataset: xr.Dataset, base: Scene, point: ContactPoint
) -> xr.Dataset:
    """Impacts over the orientation and the spin with the contact coefficient
    elsewhere, and the rigid-body coefficient that follows from it."""
    if point is ContactPoint.foundation:
        return dataset
    block = base.block

    def arm_at(turn):
        sin, cos = np.sin(turn), np.cos(turn)
        return np.asarray(block.shape.tangency_arm(block.semi_axes, sin, cos))

    start = np.radians(dataset.orientation_deg)
    touch = arm = xr.apply_ufunc(arm_at, start)
    if point is ContactPoint.deepest:
        arm = xr.apply_ufunc(arm_at, start + dataset.rotation_rad)
    spin = np.radians(dataset.angular_velocity_degps)
    normal: Any = float(base.impact.normal_velocity)
    e_contact = -(dataset.v_n_mps + arm * dataset.omega_radps) / (normal + touch * spin)

    def rigid_body(turn, contact, spinning):
        return np.asarray(
            vijayakumar_coefficient(block, turn, contact, normal, spinning)
        )

    rigid = xr.apply_ufunc(rigid_body, *xr.broadcast(start, e_contact, spin))
    return dataset.assign(e_contact=e_contact, e_n_vijayakumar=rigid)


@dataclasses.dataclass(frozen=True)
class SlopeReading:
    """How the paper's runs down a slope are read: the case itself, and what is
    counted."""

    case: BiplanarCase = dataclasses.field(default_factory=BiplanarCase)
    hop_threshold: float = HOP_THRESHOLD
    """Height of a flight, as a fraction of the block's heave, below which it rolls; see
    `simulate_runout`."""
    released_flight_jumps: bool = False
    """Whether the flight that a block is released in is a jump too."""
    out_of_the_crater: bool = True
    """Whether velocities after an impact are those with which the block goes on; else
    those before it climbs out of the ground."""


@dataclasses.dataclass(frozen=True)
class Reading:
    """What is read otherwise: quantities of the scene, laws, the point that the contact
    coefficient looks at, or the slope run-out."""

    name: str
    values: Mapping[str, float | str] = dataclasses.field(default_factory=dict)
    """Input columns and their values; what laws are for and their names."""
    contact: ContactPoint = ContactPoint.foundation
    slope: SlopeReading = dataclasses.field(default_factory=SlopeReading)


def _case(name: str, **changed) -> Reading:
    return Reading(name, slope=SlopeReading(BiplanarCase(**changed)))


AS_IT_IS = Reading("as it is")
_MODULUS, _EXPONENT = 900.0, 0.4
"""k_E and n_E of Table 1: a modulus taken at another depth is another k_E."""

READINGS = (
    Reading("dilatancy 0.5", {"dilatancy": 0.5}),
    Reading("dilatancy 1", {"dilatancy": 1.0}),
    Reading("no hardening by sliding", {"alpha_vT": 0.0}),
    Reading("hardening by rocking, alpha_vR 1", {"alpha_vR": 1.0}),
    Reading("c_v 0.5", {"c_v": 0.5}),
    Reading("c_v 2", {"c_v": 2.0}),
    Reading("hardening per root of the area", {"hardening": "HardeningPerRootArea"}),
    Reading("hardening per metre", {"hardening": "HardeningPerMetre"}),
    Reading("rho_c 0.001 at the start", {"hardening": "SofterStart"}),
    Reading("rho_c 0.1 at the start", {"hardening": "HarderStart"}),
    Reading("overstress not divided by rho_c", {"flow": "AbsoluteOverstress"}),
    Reading("overstress squared", {"flow": "SquaredOverstress"}),
    Reading("gamma_v 4", {"gamma_v": 4.0}),
    Reading("fluidity by B_t", {"flow": "FluidityRate"}),
    Reading("power 2 without a threshold", {"flow": "PowerNucleus"}),
    Reading("power 2 without a threshold, by B_t", {"flow": "PowerNucleusRate"}),
    Reading(
        "fluidity by B_t, hardening per root of the area",
        {"flow": "FluidityRate", "hardening": "HardeningPerRootArea"},
    ),
    Reading(
        "power 2 without a threshold, by B_t, hardening per root of the area",
        {"flow": "PowerNucleusRate", "hardening": "HardeningPerRootArea"},
    ),
    Reading("vertex rounded by 0.001", {"loading_surface": "SharperVertex"}),
    Reading("vertex rounded by 0.1", {"loading_surface": "BlunterVertex"}),
    Reading("no depth factor", {"bearing": "VesicWithoutDepthFactor"}),
    Reading("no surcharge", {"bearing": "VesicWithoutSurcharge"}),
    Reading("peak friction phi'", {"delta_1": 0.0, "delta_2": 0.0}),
    Reading("block-soil friction halved", {"alpha_s": 0.5}),
    Reading("modulus at r_0 / 2", {"k_E": _MODULUS * 0.5**_EXPONENT}),
    Reading("modulus at 2 r_0", {"k_E": _MODULUS * 2.0**_EXPONENT}),
    Reading(
        "modulus at the contact pressure", {"elasticity": "ContactPressureModulus"}
    ),
    Reading("work-conjugate sinking", {"kinematics": "WorkConjugate"}),
    Reading("e* at the deepest point", contact=ContactPoint.deepest),
    Reading("e* at the first arm", contact=ContactPoint.first),
)
"""All but the one that the package has. (4 m/s is what B_t makes of 8.7 for a
foundation of 0.46 m: it tells the size from the value.)"""
SLOPE_READINGS = (
    _case("released 10° downwards", direction=-10.0 * DEGREE),
    _case("released 10 m above the crest", height=10.0),
    _case("spins against the way", spin_sense=-1.0),
    _case("the same spin for all shapes", equal_energy=False),
    _case("major axis normal to the slope", orientation=SLOPE),
    _case("major axis horizontal", orientation=90.0 * DEGREE),
    _case("rolling friction 10°", rolling_friction_angle=10.0 * DEGREE),
    _case("rolling friction 25°", rolling_friction_angle=25.0 * DEGREE),
    Reading("each hop is an impact", slope=SlopeReading(hop_threshold=0.0)),
    Reading("hops up to half the heave", slope=SlopeReading(hop_threshold=0.5)),
    Reading("hops up to twice the heave", slope=SlopeReading(hop_threshold=2.0)),
    Reading(
        "the released flight is a jump", slope=SlopeReading(released_flight_jumps=True)
    ),
    Reading(
        "coefficients before the climb", slope=SlopeReading(out_of_the_crater=False)
    ),
)
"""Readings of the slope run-out, for which the others take too long."""

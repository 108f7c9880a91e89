"""Readings of the model, to measure what a claim hangs on.

Each changes one thing that the paper does not print, or prints without saying how it
enters.
"""

import dataclasses
from collections.abc import Mapping

from ..laws import Laws
from . import other_laws
from .contact_point import ContactPoint


@dataclasses.dataclass(frozen=True)
class Reading:
    """What is read otherwise: quantities of the scene, laws, or the point that the
    contact coefficient looks at."""

    name: str
    values: Mapping[str, float] = dataclasses.field(default_factory=dict)
    """Input columns and their values."""
    laws: Laws = dataclasses.field(default_factory=Laws)
    contact: ContactPoint = ContactPoint.foundation


def _with(name: str, **laws) -> Reading:
    return Reading(name, laws=dataclasses.replace(Laws(), **laws))


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
    _with("hardening per metre", hardening_rate=other_laws.hardening_per_metre),
    _with("rho_c 0.001 at the start", flow_rate=other_laws.flow_from_softer),
    _with("rho_c 0.1 at the start", flow_rate=other_laws.flow_from_harder),
    _with("overstress not divided by rho_c", flow_rate=other_laws.absolute_overstress),
    _with("overstress squared", flow_rate=other_laws.squared_overstress),
    Reading("gamma_v 4", {"gamma_v": 4.0}),
    _with("fluidity by B_t", flow_rate=other_laws.fluidity_by_size),
    _with("vertex rounded by 0.001", loading_surface=other_laws.sharper_vertex),
    _with("vertex rounded by 0.1", loading_surface=other_laws.blunter_vertex),
    _with("no depth factor", bearing_factors=other_laws.without_depth_factor),
    _with("no surcharge", bearing_factors=other_laws.without_surcharge),
    Reading("peak friction phi'", {"delta_1": 0.0, "delta_2": 0.0}),
    Reading("block-soil friction halved", {"alpha_s": 0.5}),
    Reading("modulus at r_0 / 2", {"k_E": _MODULUS * 0.5**_EXPONENT}),
    Reading("modulus at 2 r_0", {"k_E": _MODULUS * 2.0**_EXPONENT}),
    Reading("e* at the deepest point", contact=ContactPoint.deepest),
    Reading("e* at the first arm", contact=ContactPoint.first),
)
"""All but the one that the package has. (4 m/s is what B_t makes of 8.7 for a
foundation of 0.46 m: it tells the size from the value.)"""

"""The constitutive laws by what they are for, with the alternatives to each.

A law is a class with its parameters as fields and its equation as `__call__`. A
law of one's own derives from the abstract class of its file and is given to `Soil`.
"""

from .._safe import safe_power, safe_sqrt
from .._types import Scalar
from ..parameters import parameter
from .bearing import (
    AbstractBearing,
    AbstractPeakFriction,
    BearingFactors,
    Bolton,
    Vesic,
    VesicWithInertia,
    VesicWithoutDepthFactor,
    VesicWithoutSurcharge,
)
from .branch import Branch
from .elasticity import (
    AbstractDamping,
    AbstractElasticity,
    ContactPressureModulus,
    Damping,
    DampingRatios,
    DuncanChang,
    Stiffness,
)
from .flow import (
    AbsoluteOverstress,
    AbstractFlow,
    FlowRate,
    FluidityRate,
    Perzyna,
    PowerNucleus,
    PowerNucleusRate,
    SquaredOverstress,
    displacement_rates,
    flow_direction,
    overstress,
)
from .hardening import (
    AbstractHardening,
    HardeningPerLength,
    HardeningPerMetre,
    HardeningPerRootArea,
    HarderStart,
    SofterStart,
)
from .kinematics import AbstractKinematics, DeepestPoint, WorkConjugate
from .loading_surface import (
    AbstractLoadingSurface,
    BlunterVertex,
    Forces,
    Load,
    NovaMontrasio,
    SharperVertex,
)
from .slider import AbstractSlider, Coulomb

__all__ = [
    "AbsoluteOverstress",
    "AbstractBearing",
    "AbstractDamping",
    "AbstractElasticity",
    "AbstractFlow",
    "AbstractHardening",
    "AbstractKinematics",
    "AbstractLoadingSurface",
    "AbstractPeakFriction",
    "AbstractSlider",
    "BearingFactors",
    "BlunterVertex",
    "Bolton",
    "Branch",
    "ContactPressureModulus",
    "Coulomb",
    "Damping",
    "DampingRatios",
    "DeepestPoint",
    "DuncanChang",
    "FlowRate",
    "FluidityRate",
    "Forces",
    "HardeningPerLength",
    "HardeningPerMetre",
    "HardeningPerRootArea",
    "HarderStart",
    "Load",
    "NovaMontrasio",
    "Perzyna",
    "PowerNucleus",
    "PowerNucleusRate",
    "Scalar",
    "SharperVertex",
    "SofterStart",
    "SquaredOverstress",
    "Stiffness",
    "Vesic",
    "VesicWithInertia",
    "VesicWithoutDepthFactor",
    "VesicWithoutSurcharge",
    "WorkConjugate",
    "displacement_rates",
    "flow_direction",
    "overstress",
    "parameter",
    "safe_power",
    "safe_sqrt",
]

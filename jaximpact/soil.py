"""Soils: geotechnical description, and the laws of the macro-element."""

from . import laws
from ._types import Scalar
from .parameters import Composite, parameter, part


class Soil(Composite):
    """The ground under an impact; the defaults are Table 1, a very dense sand.

    It is made up of laws, each with parameters of its own and replaceable by another:
    `Soil(flow=FluidityRate())`. Parameters are set and read by their names alone,
    wherever they stand: `Soil(gamma_v=5.0)`, `soil.gamma_v`. Any of them can be swept,
    batched, differentiated and fitted. Angles in radians, unit weight in N/m3.

    Source: Dattola, Crosta and di Prisco (2023), Table 1. The paper does not print the
    functions in which these parameters stand; each law says of which source it is our
    reading.
    """

    unit_weight: Scalar = parameter(
        18.0, "kN/m3", "(0, inf)", "unit weight of the ground", usual=(1.0, 100.0)
    )
    friction_angle: Scalar = parameter(
        30.0, "deg", "(0, 60)", "friction angle phi'", usual=(2.0, 60.0)
    )
    relative_density: Scalar = parameter(
        0.90, "-", "[0, 1]", "relative density D_r0 (0 to 1, not percent)"
    )
    elasticity: laws.AbstractElasticity = part(
        laws.AbstractElasticity, laws.DuncanChang
    )
    damping: laws.AbstractDamping = part(laws.AbstractDamping, laws.DampingRatios)
    peak_friction: laws.AbstractPeakFriction = part(
        laws.AbstractPeakFriction, laws.Bolton
    )
    bearing: laws.AbstractBearing = part(laws.AbstractBearing, laws.Vesic)
    loading_surface: laws.AbstractLoadingSurface = part(
        laws.AbstractLoadingSurface, laws.NovaMontrasio
    )
    flow: laws.AbstractFlow = part(laws.AbstractFlow, laws.Perzyna)
    hardening: laws.AbstractHardening = part(
        laws.AbstractHardening, laws.HardeningPerLength
    )
    slider: laws.AbstractSlider = part(laws.AbstractSlider, laws.Coulomb)
    kinematics: laws.AbstractKinematics = part(
        laws.AbstractKinematics, laws.DeepestPoint
    )

    @classmethod
    def very_dense_sand(cls) -> "Soil":
        """The very dense sand of Dattola, Crosta and di Prisco (2023), Table 1: the
        defaults."""
        return cls()

    @classmethod
    def supplement_gamma_v_1_70(cls) -> "Soil":
        """The ground of the paper's supplementary material with c_v = 0.5 and
        gamma_v = 1.70 m/s; the rest is Table 1.

        Source: Dattola, Crosta and di Prisco (2023), discussion of the parametric sets.
        """
        return cls(c_v=0.5, gamma_v=1.70)

    @classmethod
    def supplement_gamma_v_0_85(cls) -> "Soil":
        """The ground of the supplementary material with gamma_v = 0.85 m/s: the slowest
        flow, and the highest rebound, of the three."""
        return cls(c_v=0.5, gamma_v=0.85)

r"""Laws of rebound in closed form, as today's rockfall programs use them: without time
and soil.

Each is a module whose parameters are its leaves; called with a block and an impact it
gives the velocities after. Pure `jnp`, differentiable; those here take arrays that
broadcast, too. A law of one's own derives from `AbstractRebound`. n into the ground, t
down-slope, rotation clockwise: a block that rolls down-slope without slip has
$v_t = \Omega R$.
"""

from .angle_power_law import AnglePowerLaw
from .base import AbstractRebound, Rebound
from .bozzolo_pamini import BozzoloPamini
from .constant_coefficients import ConstantCoefficients
from .frictional_ellipsoid import FrictionalEllipsoid
from .pfeiffer_bowen import PfeifferBowen
from .rigid_ellipsoid import RigidEllipsoid

__all__ = [
    "AbstractRebound",
    "AnglePowerLaw",
    "BozzoloPamini",
    "ConstantCoefficients",
    "FrictionalEllipsoid",
    "PfeifferBowen",
    "Rebound",
    "RigidEllipsoid",
]

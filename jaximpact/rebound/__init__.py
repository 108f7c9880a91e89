r"""Laws of rebound in closed form, as today's rockfall programs use them: without time
and soil.

Each is a module whose parameters are its leaves; called with a block and an impact it
gives the velocities after. Pure `jnp`, differentiable; those here take arrays that
broadcast, too. A law of one's own derives from `AbstractRebound`. n into the ground, t
down-slope, rotation clockwise: a block that rolls down-slope without slip has
$v_t = \Omega R$.
"""

from .base import AbstractRebound, Rebound
from .laws import (
    AnglePowerLaw,
    BozzoloPamini,
    ConstantCoefficients,
    FrictionalEllipsoid,
    PfeifferBowen,
    RigidEllipsoid,
)

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

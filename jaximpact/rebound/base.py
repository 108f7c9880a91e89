"""What a law of rebound has to give."""

import abc
from typing import ClassVar

from ..block import Block
from ..parameters import Part
from ..scene import Impact
from .velocities import Rebound


class AbstractRebound(Part):
    r"""A law of rebound in closed form.

    A law of one's own derives from this class, declares its parameters and defines
    `__call__` in `jax.numpy`, for scalars:

        class Sticky(AbstractRebound):
            e_n: Scalar = parameter(0.3, "-", "[0, 1]", "normal restitution")

            def __call__(self, block, impact):
                return Rebound(-self.e_n * impact.normal_velocity, 0.0, 0.0)

    n into the ground, t down-slope, rotation clockwise: a block that rolls down-slope
    without slip has $v_t = \Omega R$.
    """

    words: ClassVar[str] = ""
    """Its name in files, where that is not the name of the class."""

    @abc.abstractmethod
    def __call__(self, block: Block, impact: Impact) -> Rebound:
        """Velocities after an impact.

        Args:
            block: mass, inertia, `semi_axes` and shape. impact: velocities, spin and
                orientation before.
        """

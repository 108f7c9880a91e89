r"""The paper's slope of two planes, and the blocks released on it.

A plane 230 m high and 400 m long in plan, which the paper rounds to 30 degrees, then
600 m of level ground. Blocks of 100 kg start at 20 m/s, at 10 degrees to the
horizontal, with spins up to 20 000 deg/s. Shapes have the same energy of translation
and of rotation: spins $\Omega\sqrt{I_s/I}$, with $I_s$ of the sphere.

Source: Dattola et al. (2023), section 3.3. What it leaves open are the fields
of `BiplanarCase`, with our readings as defaults.
"""

import dataclasses
import itertools
import math

import numpy as np

from ..scene import Block, Soil
from ..units import DEGREE
from .blocks import Release
from .terrain import ROLLING_FRICTION_ANGLE, Profile

HEIGHT, SLOPE_LENGTH, FLAT_LENGTH = 230.0, 400.0, 600.0
"""Height and lengths in plan [m]."""
SLOPE = math.atan2(HEIGHT, SLOPE_LENGTH)
"""Angle of the upper plane [rad]."""
SPEED = 20.0
"""Speed at release [m/s]."""
ASPECT_RATIOS = (1.0, 1.5, 2.0, 3.0, 4.0)
"""Aspect ratios of the blocks; the paper has 1 to 4, the steps are ours."""
SPINS_DEGPS = tuple(np.linspace(0.0, 20_000.0, 9).tolist())
"""Spins of the sphere [deg/s]."""
COEFFICIENTS = (-1.0, 3.0)
"""Range of coefficients of restitution in the diagrams: those of grazing impacts have
no bounds."""


@dataclasses.dataclass(frozen=True)
class BiplanarCase:
    """Choices that the paper leaves open."""

    direction: float = 10.0 * DEGREE
    """Angle of the velocity above the horizontal [rad]: 10 degrees are upwards."""
    height: float = 1.0
    """Height of the centres above the crest, at x = 0, at release [m]. Every block is
    clear of the ground there, and all start from one point."""
    orientation: float = 0.0
    """Angle from the vertical to the major axis [rad]; the paper says "oriented along
    the major axis"."""
    spin_sense: float = 1.0
    """1 for spins that roll down the slope, -1 for those against."""
    equal_energy: bool = True
    """True if shapes have the sphere's energy of rotation; else they have its spin."""
    rolling_friction_angle: float = ROLLING_FRICTION_ANGLE
    """Angle of rolling friction [rad]."""

    def profile(self, soil: Soil) -> Profile:
        """Make the profile, of one soil."""
        return Profile(
            [0.0, SLOPE_LENGTH, SLOPE_LENGTH + FLAT_LENGTH],
            [HEIGHT, 0.0, 0.0],
            soil,
            self.rolling_friction_angle,
        )

    def release(self, block: Block | None = None) -> Release:
        """Release blocks of every aspect ratio at every spin, the spin fastest.

        Args:
            block: gives mass and density; 100 kg by default.
        """
        block = block or Block()
        shapes, spins = np.transpose(
            list(itertools.product(ASPECT_RATIOS, SPINS_DEGPS))
        )
        blocks = dataclasses.replace(block, aspect_ratio=shapes)
        spins = self.spin_sense * DEGREE * spins
        if self.equal_energy:
            sphere = dataclasses.replace(block, aspect_ratio=1.0)
            spins = spins * np.sqrt(sphere.inertia / np.asarray(blocks.inertia))
        return Release(
            blocks,
            x=0.0,
            y=HEIGHT + self.height,
            v_x=SPEED * math.cos(self.direction),
            v_y=SPEED * math.sin(self.direction),
            orientation=self.orientation,
            angular_velocity=spins,
        )

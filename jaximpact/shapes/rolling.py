"""The round block that rolls in place of one of another shape."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

Scalar = Float[Array, ""]

ORIENTATIONS = 64
"""Over a quarter of a turn."""
BESIDE = 1e-6
"""From an axis [rad]: how steep the support is beside a flat face is asked there."""


class RoundBlock(NamedTuple):
    """What rolling takes from the section in the plane of motion."""

    radius: Scalar
    """Of the circle of the same perimeter [m]: the mean of the support over a turn."""
    tallest: Scalar
    """Largest support [m]: the height of the centre as the block gets over its longest
    way across."""
    turning_slope: Scalar
    """Largest $|r_y'| / r_y$ [-]: tangent of the slope on which the block falls over
    from any side by itself."""


def round_block(shape, axes) -> RoundBlock:
    """The round block by the support at many orientations.

    The mean is that over the middles of equal intervals, the other two are the largest
    found: within some 1e-3.
    """
    quarter = 0.5 * np.pi
    middles = (np.arange(ORIENTATIONS) + 0.5) / ORIENTATIONS * quarter
    angles = np.concatenate([middles, [BESIDE, quarter - BESIDE]])

    def at(sin, cos):
        return shape.support(axes, sin, cos), shape.tangency_arm(axes, sin, cos)

    support, arm = jax.vmap(at)(jnp.sin(angles), jnp.cos(angles))
    return RoundBlock(
        radius=jnp.mean(support[:ORIENTATIONS]),
        tallest=jnp.max(support),
        turning_slope=jnp.max(jnp.abs(arm) / support),
    )

r"""Targets that follow from other results: what is measured where velocities are not.

With $v_n, v_t$ the velocities after the impact, and $v, \theta, m$ speed, angle and
mass before it,

$$ \frac{v_n^2 + v_t^2}{v^2}, \qquad \arctan\frac{v_t}{-v_n}, \qquad
   m (v \cos\theta - v_n), \qquad m (v \sin\theta - v_t) $$

are the ratio of translational energies, the angle of the rebound from the ground's
normal, and the changes of momentum: the impulses of the ground, less those of gravity.
"""

import jax.numpy as jnp
from jax import Array

from ...scene import Scene
from ...units import DEGREE

IMPULSES = ("normal_impulse_Ns", "tangential_impulse_Ns")
REBOUND_ANGLE = "rebound_angle_deg"
ENERGY_RATIO = "translational_ratio"


def derived(name: str, scene: Scene, v_n: Array, v_t: Array) -> Array:
    """Compute a derived target of an impact from its velocities after, by JAX."""
    block, impact = scene.block, scene.impact
    if name == ENERGY_RATIO:
        return (v_n**2 + v_t**2) / impact.speed**2
    if name == REBOUND_ANGLE:
        # At rest the angle is 0, and so is its derivative.
        at_rest = (v_n == 0.0) & (v_t == 0.0)
        return jnp.arctan2(v_t, jnp.where(at_rest, 1.0, -v_n)) / DEGREE
    normal = name == IMPULSES[0]
    along = jnp.cos(impact.angle) if normal else jnp.sin(impact.angle)
    return block.mass * (impact.speed * along - (v_n if normal else v_t))

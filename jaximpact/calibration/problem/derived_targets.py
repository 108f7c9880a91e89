r"""Targets that follow from other results: what is measured where velocities are not.

With $v_n, v_t$ the velocities after the impact, and $v, \theta, m$ speed, angle and
mass before it,

$$ \frac{v_n^2 + v_t^2}{v^2}, \qquad \arctan\frac{v_t}{-v_n}, \qquad
   m (v \cos\theta - v_n), \qquad m (v \sin\theta - v_t) $$

are the ratio of translational energies, the angle of the rebound from the ground's
normal, and the changes of momentum: the impulses of the ground, less those of gravity.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from ...units import DEGREE

VELOCITIES = ("v_n_mps", "v_t_mps")
IMPULSES = ("normal_impulse_Ns", "tangential_impulse_Ns")
REBOUND_ANGLE = "rebound_angle_deg"
ENERGY_RATIO = "translational_ratio"
DERIVED = (ENERGY_RATIO, REBOUND_ANGLE, *IMPULSES)
"""Targets that are computed from the velocities."""
ANGLE = "angle_deg"


class WithRate(NamedTuple):
    """A quantity of many impacts with its derivative along a direction."""

    value: np.ndarray
    rate: np.ndarray


def base_columns(targets: tuple[str, ...]) -> tuple[str, ...]:
    """List the results from which targets are computed: those that are not derived,
    and the velocities where one is."""
    plain = [name for name in targets if name not in DERIVED]
    if len(plain) == len(targets):
        return targets
    return tuple(dict.fromkeys([*plain, *VELOCITIES]))


def rebound_angle(v_n: WithRate, v_t: WithRate) -> WithRate:
    """Compute the angle of the velocity after from the normal, down-slope positive
    [deg]; its derivative is 0 for a block at rest."""
    square = v_n.value**2 + v_t.value**2
    turning = v_n.value * v_t.rate - v_t.value * v_n.rate
    moving = square > 0.0
    rate = np.where(moving, -turning / np.where(moving, square, 1.0), 0.0)
    return WithRate(np.arctan2(v_t.value, -v_n.value) / DEGREE, rate / DEGREE)


def _energy_ratio(v_n, v_t, speed, angle, mass) -> WithRate:
    ratio = (v_n.value**2 + v_t.value**2) / speed.value**2
    rate = 2.0 * (v_n.value * v_n.rate + v_t.value * v_t.rate) / speed.value**2
    return WithRate(ratio, rate - 2.0 * ratio * speed.rate / speed.value)


def _impulse(component: int) -> Callable:
    """Make the function for an impulse: 0 the normal one, 1 the tangential one."""

    def impulse(v_n, v_t, speed, angle, mass) -> WithRate:
        cos, sin = np.cos(angle.value), np.sin(angle.value)
        part, turned = (cos, -sin) if component == 0 else (sin, cos)
        after = (v_n, v_t)[component]
        change = speed.value * part - after.value
        rate = speed.rate * part + speed.value * turned * angle.rate - after.rate
        return WithRate(mass.value * change, mass.value * rate + mass.rate * change)

    return impulse


FUNCTIONS: Mapping[str, Callable] = {
    ENERGY_RATIO: _energy_ratio,
    REBOUND_ANGLE: lambda v_n, v_t, *_: rebound_angle(v_n, v_t),
    IMPULSES[0]: _impulse(0),
    IMPULSES[1]: _impulse(1),
}


def derive(
    targets: tuple[str, ...],
    values: np.ndarray,
    derivatives: np.ndarray,
    inputs: Mapping[str, WithRate],
) -> tuple[np.ndarray, np.ndarray]:
    """Compute targets and their derivatives along a direction, shape (impacts,
    targets).

    Args:
        values, derivatives: results that `base_columns` names, shape (impacts,
            results).
        inputs: `speed_mps`, `angle_deg` [rad] and `mass_kg` of the impacts.
    """
    if not any(name in DERIVED for name in targets):
        return values, derivatives
    base = base_columns(targets)
    of_base = {
        name: WithRate(values[:, place], derivatives[:, place])
        for place, name in enumerate(base)
    }
    before = [inputs[name] for name in ("speed_mps", "angle_deg", "mass_kg")]
    after = [of_base[name] for name in VELOCITIES]
    found = [
        FUNCTIONS[name](*after, *before) if name in DERIVED else of_base[name]
        for name in targets
    ]
    return (
        np.stack([one.value for one in found], axis=1),
        np.stack([one.rate for one in found], axis=1),
    )


def derived(name: str, scene, v_n, v_t):
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

r"""Correction of angles and velocities for a slope that differs from the stated one.

Angles of a test refer to the slope in its table. Where the true slope is steeper by
delta, velocity and orientation in space are unchanged, so that relative to the true
ground, with rotation clockwise and down-slope to the right,

$$ \alpha \to \alpha + \delta, \qquad \theta_0 \to \theta_0 - \delta . $$

Velocities after the impact are stated along the stated normal and slope too:

$$ v_n = v_n' \cos\delta + v_t' \sin\delta, \qquad
   v_t = v_t' \cos\delta - v_n' \sin\delta, $$

with primes along the true ground. `v_n_mps`, `v_t_mps`, `e_n`, `e_t`, the angle of the
rebound and, in the same way, both impulses are compared along the stated axes; the
other results are independent of the axes, or (`e_contact`) belong to the true ground.
"""

import numpy as np

from .derived_targets import (
    IMPULSES,
    REBOUND_ANGLE,
    VELOCITIES,
    WithRate,
    rebound_angle,
)

ANGLE, ORIENTATION = "angle_deg", "orientation_deg"
SIGN = {ANGLE: 1.0, ORIENTATION: -1.0}
"""Change of each for a degree more of slope."""
COMPONENTS = (*VELOCITIES, "e_n", "e_t", REBOUND_ANGLE, *IMPULSES)
"""Results along the axes of the ground."""


def needed(targets: tuple[str, ...]) -> tuple[str, ...]:
    """Return the targets, and after them the velocities and impulses that `as_stated`
    needs."""
    along_axes = any(name in COMPONENTS for name in targets)
    impulses = IMPULSES if any(name in IMPULSES for name in targets) else ()
    return (*targets, *VELOCITIES, *impulses) if along_axes else targets


def as_stated(targets, values, derivatives, turn, speed, angle):
    """Turn results and their derivatives to the stated axes.

    Args:
        targets: names of the results wanted.
        values, derivatives: results that `needed` names, along the true ground, and
            their derivatives along any direction, shape (impacts, results).
        turn: delta and its derivative along that direction [rad], each (impacts,).
        speed: impact speed and its derivative [m/s], each (impacts,).
        angle: stated impact angle [rad], shape (impacts,).

    Returns:
        Values and derivatives of the targets; e_t is NaN at a stated angle of 0.
    """
    count = len(targets)
    if values.shape[1] == count:
        return values, derivatives
    extra, rates = values[:, count:].T, derivatives[:, count:].T
    (v_n, v_n_rate), (v_t, v_t_rate) = _turned(extra[:2], rates[:2], turn)

    def ratio(velocity, rate, part):
        before = np.where(part == 0.0, np.nan, part) * speed[0]
        return velocity / before, (rate - velocity * speed[1] / speed[0]) / before

    made = {
        "v_n_mps": (v_n, v_n_rate),
        "v_t_mps": (v_t, v_t_rate),
        "e_n": ratio(-v_n, -v_n_rate, np.cos(angle)),
        "e_t": ratio(v_t, v_t_rate, np.sin(angle)),
        REBOUND_ANGLE: rebound_angle(WithRate(v_n, v_n_rate), WithRate(v_t, v_t_rate)),
    }
    if len(extra) > 2:
        made |= dict(zip(IMPULSES, _turned(extra[2:], rates[2:], turn), strict=True))
    values, derivatives = values[:, :count].copy(), derivatives[:, :count].copy()
    for place, name in enumerate(targets):
        if name in made:
            values[:, place], derivatives[:, place] = made[name]
    return values, derivatives


def _turned(vector, rates, turn) -> tuple[WithRate, WithRate]:
    """Turn a vector along the true normal and slope to the stated ones.

    Args:
        vector, rates: its two components and their derivatives, each (impacts,).
        turn: delta and its derivative [rad].
    """
    (normal, along), (normal_rate, along_rate) = vector, rates
    cos, sin = np.cos(turn[0]), np.sin(turn[0])
    first, second = normal * cos + along * sin, along * cos - normal * sin
    # A turn by d delta adds `second` d delta to `first`, which `second` loses.
    return (
        WithRate(first, normal_rate * cos + along_rate * sin + second * turn[1]),
        WithRate(second, along_rate * cos - normal_rate * sin - first * turn[1]),
    )

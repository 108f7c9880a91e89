r"""Apparent coefficients of restitution of the contacts of trajectories.

$$ e_n = -\frac{v_n}{v_n^{in}}, \qquad e_t = \frac{v_t}{v_t^{in}} $$

in the frame of the plane that is struck. Source: Dattola et al. (2023), section 2.3.
"""

from typing import NamedTuple

import numpy as np

from ..scene import GRAVITY
from .runs import Runs


class Restitutions(NamedTuple):
    """Coefficients, arrays `(contacts,)`, as the contacts of the record."""

    e_n: np.ndarray
    """NaN where the centre does not come down to the plane: a block that turns can
    strike while its centre rises."""
    e_t: np.ndarray
    """NaN there too, and where the centre does not move along the plane."""


def restitutions(runs: Runs, *, out_of_the_crater: bool = True) -> Restitutions:
    """Coefficients of every contact; NaN for touches that are no impact.

    Args:
        out_of_the_crater: velocities after as the block goes on; else as the impact
            ends, before what it takes to climb out of the ground. A block that cannot
            climb has stopped, with coefficients of zero, either way.
    """
    c = runs.contacts
    share = np.ones_like(c.time)
    if not out_of_the_crater:
        mass, inertia = (
            value[c.trajectory.astype(int)] for value in runs.release.matter
        )
        left = 0.5 * (
            mass * (c.normal_velocity**2 + c.tangential_velocity**2)
            + inertia * c.angular_velocity**2
        )
        climb = mass * GRAVITY * np.cos(c.slope) * np.maximum(c.sinking, 0.0)
        share = np.sqrt(1.0 + climb / np.where(left > 0.0, left, np.inf))
    comes_down = (c.outcome >= 0) & (c.normal_velocity_before > 0.0)
    moves = comes_down & (c.tangential_velocity_before != 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        e_n = -share * c.normal_velocity / c.normal_velocity_before
        e_t = share * c.tangential_velocity / c.tangential_velocity_before
    return Restitutions(np.where(comes_down, e_n, np.nan), np.where(moves, e_t, np.nan))

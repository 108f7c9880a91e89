"""Branches: the side of its switches on which each law is taken.

The laws switch: where the normal force is cut off at zero, at yield, at slip, where
dilatancy cuts the heave, where a rate whose size counts changes sign, where length and
width of the foundation change places. By itself every law looks where it is. Told a
`Branch`, it goes on as the branch does, past the switch, smoothly: so that the stages
of one step of the integration, and the derivatives of the step, all see one smooth
function.
"""

from typing import NamedTuple

from .._types import Flag


class Branch(NamedTuple):
    """The side taken at each switch."""

    presses: Flag
    """The normal force is positive, not cut off."""
    yields: Flag
    """The load is beyond the surface of the hardening reached."""
    heaves: Flag
    """The loading surface's gradient points out of the ground."""
    shears_up: Flag
    """The tangential force is negative."""
    rocks_back: Flag
    """The moment is negative."""
    slips_down: Flag
    """The tangential force is above the slider's limit."""
    slips_up: Flag
    """The tangential force is below minus the slider's limit."""
    oblong: Flag
    """The foundation is longer than wide."""
    side: Flag | None = None
    """Side on which the lowest corner lies, for a shape with flat faces; else None."""

"""The results of an impact, as numbers."""

import dataclasses
from typing import Any, NamedTuple

import equinox as eqx

from .._types import Scalar
from ..parameters import with_unit
from ..quantities import FURTHER_COLUMNS, RESULT_COLUMNS
from .history import History


class EnergyLedger(NamedTuple):
    """Work, dissipation and energies of an impact [J].

    `kinetic_in + gravity + arm + stiffness
    = kinetic_out + elastic + viscoplastic + slider + dashpot`,
    to the accuracy of the integration. Items of either sign on the left are work on the
    block; those on the right are what is left and what is dissipated (never negative).

    `arm` and `stiffness` belong to the model as the paper prints it, and are no
    dissipation: the normal force acts at the centre of the foundation while sinking is
    measured at the deepest point, and the springs' stiffness follows the foundation's
    size. `arm` is not small in eccentric impacts: a limit of the model.
    """

    kinetic_in: Scalar
    """Kinetic energy at impact."""
    kinetic_out: Scalar
    """Kinetic energy at the end."""
    gravity: Scalar
    """Work of gravity."""
    elastic: Scalar
    """Elastic energy left in the springs."""
    viscoplastic: Scalar
    """Energy dissipated by yielding."""
    slider: Scalar
    """Energy dissipated by sliding."""
    dashpot: Scalar
    """Energy dissipated by damping."""
    arm: Scalar
    """Work of the arm between the foundation's centre and the deepest point."""
    stiffness: Scalar
    """Work of the change of stiffness."""

    @property
    def residual(self) -> Scalar:
        """Error of the balance [J]: its left side less its right side."""
        return (
            self.kinetic_in
            + self.gravity
            + self.arm
            + self.stiffness
            - self.kinetic_out
            - self.elastic
            - self.viscoplastic
            - self.slider
            - self.dashpot
        )

    def __repr__(self) -> str:
        items = (
            f"{name}={with_unit(item, 'J')}" for name, item in self._asdict().items()
        )
        return f"EnergyLedger({', '.join(items)})"


class ImpactSummary(eqx.Module):
    """The results of an impact, in SI units and radians; n into the ground, t
    down-slope, rotation clockwise. Of many impacts each is an array."""

    e_n: Scalar
    """Apparent normal coefficient of restitution: of the centre of mass."""
    e_t: Scalar
    """Apparent tangential coefficient; NaN where the block came in along the normal,
    and it has no meaning."""
    e_contact: Scalar
    """Normal coefficient of restitution at the contact point."""
    e_bar: Scalar
    """Energetic coefficient of restitution."""
    R_r: Scalar
    """Final ratio of rotational to total kinetic energy."""
    e_n_vijayakumar: Scalar
    """Apparent normal coefficient of a rigid body with this `e_contact`."""
    max_penetration: Scalar
    """Largest penetration of the centre."""
    max_sinking: Scalar
    """Largest penetration of the lowest point."""
    max_normal_force: Scalar
    """Largest normal force."""
    max_tangential_force: Scalar
    """Largest magnitude of the tangential force."""
    max_moment: Scalar
    """Largest magnitude of the moment."""
    time_of_max_penetration: Scalar
    """Time since touch of the largest penetration of the centre."""
    time_of_max_sinking: Scalar
    """Time since touch of the largest penetration of the lowest point."""
    time_of_max_normal_force: Scalar
    """Time since touch of the largest normal force."""
    time_of_max_tangential_force: Scalar
    """Time since touch of the largest tangential force."""
    time_of_max_moment: Scalar
    """Time since touch of the largest moment."""
    final_penetration: Scalar
    """Penetration of the centre as the contact ends: a block that leaves, or rolls on,
    has to climb out of it."""
    final_sinking: Scalar
    """Penetration of the lowest point as the contact ends."""
    duration: Scalar
    """Time in contact."""
    rotation: Scalar
    """Rotation during contact."""
    normal_velocity: Scalar
    """Final normal velocity."""
    tangential_velocity: Scalar
    """Final tangential velocity."""
    angular_velocity: Scalar
    """Final angular velocity."""
    energy: EnergyLedger | None
    """Energy ledger; None where none was asked for."""
    outcome_code: Scalar
    """Number of the member of `Outcome`."""
    steps: Scalar
    """Steps of the integration, rejected ones included."""

    def __repr__(self) -> str:
        columns = {**RESULT_COLUMNS, **FURTHER_COLUMNS}.values()
        units = {column.field: column.unit for column in columns}
        names = [field.name for field in dataclasses.fields(ImpactSummary)]
        inside = (
            f"{n}={with_unit(getattr(self, n), units.get(n, '-'))}" for n in names
        )
        return f"{type(self).__name__}({', '.join(inside)})"


class Solution(NamedTuple):
    """Results of impacts."""

    numbers: ImpactSummary
    samples: History | None
    """Histories, where they were asked for."""


def empty_summary(ledger: bool) -> ImpactSummary:
    """A zero-filled summary, used as a template of its structure.

    Args:
        ledger: whether it has an energy ledger.
    """
    zeros: Any = dict.fromkeys((f.name for f in dataclasses.fields(ImpactSummary)), 0.0)
    items: Any = dict.fromkeys(EnergyLedger._fields, 0.0)
    zeros["energy"] = EnergyLedger(**items) if ledger else None
    return ImpactSummary(**zeros)

"""The numbers of an impact, as results hold them."""

import dataclasses
from typing import TYPE_CHECKING, NamedTuple

import equinox as eqx

from ._types import Scalar

if TYPE_CHECKING:
    from .history import History


class EnergyLedger(NamedTuple):
    """Where the energy went [J].

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
    kinetic_out: Scalar
    gravity: Scalar
    elastic: Scalar
    viscoplastic: Scalar
    slider: Scalar
    dashpot: Scalar
    arm: Scalar
    stiffness: Scalar

    @property
    def residual(self) -> Scalar:
        """What the ledger fails to account for [J]."""
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


class Numbers(eqx.Module):
    """The numbers of an impact. Lengths in m, forces in N, moments in N m, times in s,
    angles in rad; n into the ground, t down-slope, rotation clockwise.

    Coefficients: `e_n` and `e_t` are apparent (centre of mass; `e_t` is NaN where the
    block came in along the normal and it has no meaning), `e_contact` is at the contact
    point, `e_bar` is energetic, `R_r` the final ratio of rotational to total kinetic
    energy, `e_n_vijayakumar` the rigid-body estimate with this `e_contact`.

    `final_penetration` and `final_sinking` say how deep the block still sits as the
    contact ends: a block that leaves, or rolls on, has to climb out of that.
    """

    e_n: Scalar
    e_t: Scalar
    e_contact: Scalar
    e_bar: Scalar
    R_r: Scalar
    e_n_vijayakumar: Scalar
    max_penetration: Scalar
    max_sinking: Scalar
    max_normal_force: Scalar
    max_tangential_force: Scalar
    max_moment: Scalar
    time_of_max_penetration: Scalar
    time_of_max_sinking: Scalar
    time_of_max_normal_force: Scalar
    time_of_max_tangential_force: Scalar
    time_of_max_moment: Scalar
    final_penetration: Scalar
    final_sinking: Scalar
    duration: Scalar
    rotation: Scalar
    normal_velocity: Scalar
    tangential_velocity: Scalar
    angular_velocity: Scalar
    energy: EnergyLedger | None
    outcome_code: Scalar
    steps: Scalar


class Solution(NamedTuple):
    """What is computed of impacts."""

    numbers: Numbers
    samples: "History | None"


def numbers_of_no_value(ledger: bool) -> Numbers:
    """Zeros, to tell the structure."""
    energy = EnergyLedger(*[0.0] * len(EnergyLedger._fields)) if ledger else None
    fields = dict.fromkeys((f.name for f in dataclasses.fields(Numbers)), 0.0)
    return Numbers(**fields | {"energy": energy})

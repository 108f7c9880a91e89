"""The course of an impact: forces, motion and energies against time."""

import functools
from typing import TYPE_CHECKING, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from .laws import Branch
from .mechanics.dynamics import Work, elastic_energy, kinetic_energy
from .mechanics.outcomes import Outcome
from .mechanics.problem import Problem

if TYPE_CHECKING:  # which takes a while to load
    import xarray as xr

Series = Float[Array, "*lanes times"]

FORCES = ("normal_force", "tangential_force", "moment")


class History(NamedTuple):
    """An impact against time, in SI units: with `save_at` at the times given, along the
    last axis; with `history=True` at the start and at the end of every step.

    At other times than those in contact there are no forces: they are 0 before the
    contact, and after a block has detached; all else is NaN, as nothing is known of it.

    Energies in J: `kinetic + elastic + viscoplastic + slider + dashpot` equals the
    kinetic energy at the start plus `gravity + arm + stiffness`. From `gravity` on they
    are None without the energy ledger.
    """

    time: Series
    penetration: Series
    sinking: Series
    rotation: Series
    normal_velocity: Series
    tangential_velocity: Series
    angular_velocity: Series
    normal_force: Series
    tangential_force: Series
    moment: Series
    hardening: Series
    foundation_length: Series
    foundation_width: Series
    rotational_ratio: Series
    kinetic: Series
    elastic: Series
    gravity: Series | None = None
    viscoplastic: Series | None = None
    slider: Series | None = None
    dashpot: Series | None = None
    arm: Series | None = None
    stiffness: Series | None = None
    in_contact: Bool[Array, "*lanes times"] | None = None
    """Whether a time is in the contact; None with `history=True`, where all are."""

    def to_xarray(self, dims: tuple[str, ...] | None = None) -> "xr.Dataset":
        """The series as a dataset over `time`, with units and meanings.

        Args:
            dims: names of the axes before that of time; by default `scene`, or
                `scene_0`, `scene_1` and so on, as in `ImpactResult.to_xarray`.

        Raises InputError for impacts with different times, and for a wrong number of
        names.
        """
        from .formats.series import dataset_of_history

        return dataset_of_history(self, dims)


def history_at(
    problem: Problem,
    time,
    vector: Float[Array, " n"],
    work: Work | None,
    branch: Branch | None = None,
) -> History:
    """What a history holds of one state."""
    motion, now = problem.contact(vector, branch)
    ground = problem.ground
    kinetic = kinetic_energy(ground, motion)
    history = History(
        time=time,
        penetration=motion.penetration,
        sinking=now.foundation.sinking,
        rotation=motion.rotation,
        normal_velocity=motion.normal_velocity,
        tangential_velocity=motion.tangential_velocity,
        angular_velocity=motion.angular_velocity,
        normal_force=now.forces.normal,
        tangential_force=now.forces.tangential,
        moment=now.forces.moment,
        hardening=motion.hardening,
        foundation_length=now.foundation.length,
        foundation_width=now.foundation.width,
        rotational_ratio=0.5 * ground.inertia * motion.angular_velocity**2 / kinetic,
        kinetic=kinetic,
        elastic=elastic_energy(motion, now.stiffness),
        **({} if work is None else work._asdict()),
    )
    return jax.tree.map(
        lambda x: jnp.broadcast_to(jnp.asarray(x, float), jnp.shape(time)), history
    )


def history_of_no_value(ledger: bool) -> History:
    """Zeros, to tell the structure of what is sampled."""
    of_ledger = dict.fromkeys(Work._fields, 0.0) if ledger else {}
    required = [name for name in History._fields if name not in History._field_defaults]
    return History(**dict.fromkeys(required, 0.0), **of_ledger)


@functools.partial(jax.jit, inline=True)
def outside_contact(samples: History, outcome_code, times: Series) -> History:
    """The history at all times, by what was sampled in the contact.

    Args:
        samples: NaN after the end. What stands before the contact says nothing.
        outcome_code: `(*lanes,)`.
    """
    code = outcome_code[..., None]
    before, after = times < 0.0, jnp.isnan(samples.time)
    separating = code == Outcome.separating
    known = code != Outcome.failed
    in_contact = ~before & ~after & ~separating & known
    # NaN is no time.
    free = before | (after & (code == Outcome.detached)) | separating
    free = free & known & ~jnp.isnan(times)
    outside = samples._replace(time=times)
    for name in samples._fields[1:]:
        series = getattr(samples, name)
        if series is not None:
            otherwise = jnp.where(free, 0.0, jnp.nan) if name in FORCES else jnp.nan
            series = jnp.where(in_contact, series, otherwise)
            outside = outside._replace(**{name: series})
    return outside._replace(
        time=jnp.broadcast_to(times, in_contact.shape), in_contact=in_contact
    )

"""Results of an impact: its numbers, and its course as series over time."""

import dataclasses
import functools
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from .._precision import require_float64
from .._settings import own_settings
from .._tables import Row, align, html_table
from .._types import Scalar
from ..errors import InputError
from ..laws import Branch
from ..quantities import ENERGY_COLUMNS
from ..units import variable_attributes, with_unit
from .dynamics import ARM, LedgerItems, Work, elastic_energy, kinetic_energy
from .events import Outcome
from .problem import Problem
from .reduced_models import FORCES

if TYPE_CHECKING:  # which takes a while to load
    import xarray as xr

Series = Float[Array, "*lanes times"]

SCENE_DIMENSION = "scene"
"""Name of the dimension of scenes side by side."""
SERIES = {
    "time": ("s", "time since touch"),
    "penetration": ("m", "penetration of the centre, u_n"),
    "sinking": ("m", "penetration of the lowest point, u_D"),
    "rotation": ("rad", "rotation since touch"),
    "normal_velocity": ("m/s", "normal velocity, v_n, into the ground"),
    "tangential_velocity": ("m/s", "tangential velocity, v_t, down-slope"),
    "angular_velocity": ("rad/s", "spin, clockwise"),
    "normal_force": ("N", "normal force, N"),
    "tangential_force": ("N", "tangential force, T"),
    "moment": ("N m", "moment, M"),
    "hardening": ("-", "hardening variable, rho_c"),
    "foundation_length": ("m", "length of the equivalent foundation"),
    "foundation_width": ("m", "width of the equivalent foundation"),
    "rotational_ratio": ("-", "rotational over total kinetic energy"),
    "kinetic": ("J", "kinetic energy"),
    "elastic": ("J", "elastic energy"),
    "gravity": ("J", "work of gravity"),
    "viscoplastic": ("J", "dissipated by yielding"),
    "slider": ("J", "dissipated by sliding"),
    "dashpot": ("J", "dissipated by damping"),
    "arm": ("J", "work of the arm between centre and deepest point"),
    "stiffness": ("J", "work of the change of stiffness"),
    "in_contact": ("", "contact, whether the block is in it"),
}
"""Field of a history -> unit and meaning."""


class History(NamedTuple):
    """Impacts against time, in SI units and radians: with `save_at` at the times given,
    along the last axis; with `history=True` at the start and at the end of every step.

    At other times than those in contact there are no forces: they are 0 before the
    contact, and after a block has detached; all else is NaN, as nothing is known of it.
    A time later than the duration by no more than a millionth of it is in contact.

    Energies in J: `kinetic + elastic + viscoplastic + slider + dashpot` equals the
    kinetic energy at the start plus `gravity + arm + stiffness`. From `gravity` on they
    are None without the energy ledger. `SERIES` has units and meanings.
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

    def __reduce__(self):
        return read_in_float64, (type(self), *self)

    def __repr__(self) -> str:
        inside = (f"{name}={value}" for name, value, _ in self._rows())
        return f"History({', '.join(inside)})"

    def __str__(self) -> str:
        return f"History: {np.shape(self.time)[-1]} times\n{align(self._rows())}"

    def _repr_html_(self) -> str:
        return html_table(["History"], self._rows())

    def _rows(self) -> list[Row]:
        of_samples = {
            name: each for name, each in self._asdict().items() if each is not None
        }
        units = {name: unit or "-" for name, (unit, _) in SERIES.items()}
        return [
            (name, with_unit(each, units[name]), SERIES[name][1])
            for name, each in of_samples.items()
        ]

    def to_xarray(self, dims: Sequence[str] | None = None) -> "xr.Dataset":
        """Return the series as a dataset over `time`, with units and meanings.

        Args:
            dims: names of the axes before that of time; by default `scene`, or
                `scene_0`, `scene_1` and so on, as in `ImpactResult.to_xarray`.

        Raises InputError for impacts with different times, for no impacts, for a wrong
        number of names, and for a name of a series.
        """
        import xarray as xr

        lanes = np.shape(self.time)[:-1]
        names = dimension_names(len(lanes)) if dims is None else tuple(dims)
        if len(names) != len(lanes):
            raise InputError(
                f"dims must be {len(lanes)} names, one for each axis of the shape "
                f"{lanes}, but is {dims!r}"
            )
        check_beside_series(names)
        if 0 in lanes:
            raise InputError(
                "a dataset needs at least one impact, but the history has shape "
                f"{lanes}"
            )
        time = np.asarray(self.time)
        base = time[(0,) * len(lanes)]
        if not np.array_equal(np.broadcast_to(base, time.shape), time):
            raise InputError(
                "a dataset needs one time base, but the impacts of the history have "
                "times of their own; make one dataset of each"
            )
        variables = {
            name: ((*names, "time"), np.asarray(series), _attributes(name))
            for name, series in self._asdict().items()
            if name != "time" and series is not None
        }
        return xr.Dataset(variables, {"time": ("time", base, _attributes("time"))})


def read_in_float64(kind: type, *items):
    """Make what is read from a pickle, as `_module.set_in_float64` does of modules."""
    require_float64()
    return kind(*items)


def check_beside_series(dimensions: Iterable[str]) -> None:
    """Raise InputError for a dimension with the name of a series of histories."""
    for name in dimensions:
        if name in SERIES:
            raise InputError(
                f"{name} cannot be the name of a dimension, as it is that of a series "
                "over time"
            )


def _attributes(name: str) -> dict[str, str]:
    unit, meaning = SERIES[name]
    return variable_attributes(meaning, unit)


def dimension_names(count: int) -> tuple[str, ...]:
    """Return the names of the axes of impacts that nobody named."""
    if count == 1:
        return (SCENE_DIMENSION,)
    return tuple(f"{SCENE_DIMENSION}_{place}" for place in range(count))


def history_at(
    problem: Problem,
    time,
    vector: Float[Array, " n"],
    work: Work | None,
    branch: Branch | None = None,
) -> History:
    """Compute the entry of a history for one state."""
    motion, now = problem.contact(vector, branch)
    ground = problem.ground
    kinetic = kinetic_energy(ground, motion)
    elastic = elastic_energy(motion, now.stiffness)
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
        elastic=elastic,
        **({} if work is None else items_of(work, elastic)),
    )
    return jax.tree.map(
        lambda x: jnp.broadcast_to(jnp.asarray(x, float), jnp.shape(time)), history
    )


def empty_history(ledger: bool) -> History:
    """Make a zero-filled history, used as a template of its structure."""
    required = [name for name in History._fields if name not in History._field_defaults]
    zeros: Any = dict.fromkeys(required, 0.0)
    if ledger:
        zeros |= items_of(Work(*[0.0] * len(Work._fields)), 0.0)
    return History(**zeros)


@functools.partial(jax.jit, inline=True)
def outside_contact(samples: History, outcome_code, times: Series) -> History:
    """Complete a history sampled in the contact, NaN after the end and without meaning
    before the contact, by the times outside of it."""
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
            # A constant would make the derivatives of a lane of NaN vanish.
            lost = jnp.isnan(series) & ~known
            series = jnp.where(in_contact | lost, series, otherwise)
            outside = outside._replace(**{name: series})
    return outside._replace(
        time=jnp.broadcast_to(times, in_contact.shape), in_contact=in_contact
    )


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

    def __reduce__(self):
        return read_in_float64, (type(self), *self)

    @property
    def residual(self) -> Scalar:
        """Error of the balance [J]: its left side less its right side."""
        gains = self.kinetic_in + self.gravity + self.arm + self.stiffness
        lost = gains - self.kinetic_out - self.elastic
        return lost - self.viscoplastic - self.slider - self.dashpot

    def __repr__(self) -> str:
        items = (f"{name}={value}" for name, value, _ in self._rows())
        return f"EnergyLedger({', '.join(items)})"

    def __str__(self) -> str:
        return f"EnergyLedger\n{align(self._rows())}"

    def _repr_html_(self) -> str:
        return html_table(["EnergyLedger"], self._rows())

    def _rows(self) -> list[Row]:
        return [
            (name, with_unit(item, "J"), ENERGY_COLUMNS[f"energy_{name}_J"].meaning)
            for name, item in self._asdict().items()
        ]


UNDEFINED = 1e300
"""Number that stands for NaN among the results of JAX's programs.

`jax_debug_nans` ends a program that gives NaN, whoever asked for it or not. Sums and
means over impacts, one of which has this value, are nearly as large or infinite."""
LARGEST_DEFINED = 1e200
"""Magnitude above which a number stands for NaN."""


class ImpactSummary(eqx.Module):
    """The results of an impact, in SI units and radians; n into the ground, t
    down-slope, rotation clockwise. Of many impacts each is an array. Meanings are in
    `RESULT_COLUMNS` and `FURTHER_COLUMNS`."""

    e_n: Scalar
    tangential_ratio: Scalar
    """Apparent tangential coefficient `e_t`; `UNDEFINED` where that is NaN on purpose.
    """
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
    """Energy ledger; None where none was asked for."""
    outcome_code: Scalar
    """Number of the member of `Outcome`."""
    steps: Scalar
    """Steps of the integration, rejected ones included."""

    @property
    def e_t(self) -> Scalar:
        """Apparent tangential coefficient of restitution; NaN, with gradient 0, where
        the block came in along the normal, and it has no meaning."""
        value = self.tangential_ratio
        if not isinstance(value, jax.Array | np.ndarray | np.generic | float):
            return value  # in a tree of other things, such as types
        xp: Any = jnp if isinstance(value, jax.Array) else np
        # Also for who prints all numbers: what is computed with it is checked again.
        with jax.debug_nans(False), own_settings():
            return xp.where(xp.abs(value) > LARGEST_DEFINED, xp.nan, value)


class Solution(NamedTuple):
    """Results of impacts."""

    numbers: ImpactSummary
    samples: History | None
    """Histories, where they were asked for."""


def empty_summary(ledger: LedgerItems) -> ImpactSummary:
    """Make a zero-filled summary, used as a template of its structure."""
    zeros: Any = dict.fromkeys((f.name for f in dataclasses.fields(ImpactSummary)), 0.0)
    items: Any = dict.fromkeys(EnergyLedger._fields, 0.0)
    zeros["energy"] = EnergyLedger(**items) if ledger else None
    if ledger == ARM:
        zeros["energy"] = arm_alone(0.0)
    return ImpactSummary(**zeros)


def items_of(work: Work, elastic) -> dict[str, Any]:
    """Return the items of the ledger that are works or dissipation, by name."""
    items = work._asdict()
    del items["springs"]
    return items | {"stiffness": elastic - work.springs}


def arm_alone(arm) -> EnergyLedger:
    """Make a ledger of the arm work alone; its other items are None."""
    items: Any = dict.fromkeys(EnergyLedger._fields)
    return EnergyLedger(**items)._replace(arm=arm)

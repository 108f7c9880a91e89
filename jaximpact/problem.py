"""The initial value problem of one impact: unknowns, equations, what is watched.

The unknowns are one vector: the fields of `Motion`, and with dashpots those of
`Forces`.
"""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .accuracy import MAX_STEPS
from .dynamics import (
    Contact,
    Forces,
    Ground,
    Motion,
    Work,
    contact,
    force_rate,
    initial_motion,
    kinetic_energy,
    motion_rate,
    prepare,
    work_rate,
)
from .kinks import Switches, switches
from .laws import Branch, Laws
from .outcomes import Margins, end_margins
from .scene import Scene

Scalar = Float[Array, ""]


class Assembly(NamedTuple):
    """Choices that change the program; the numbers are in the scene."""

    laws: Laws
    damped: bool
    ledger: bool
    max_steps: int = MAX_STEPS


# Which rate (row) may depend on which unknown (column), in the order of Motion. Without
# dashpots the springs give the forces; with them the forces are unknowns as well.
_UNDAMPED = """
    penetration         . . n . . . . . .
    rotation            . . . . w . . . .
    normal_velocity     x x . . . N . . .
    tangential_velocity x x . . . . T . .
    angular_velocity    x x . . . N T M .
    elastic_normal      x x n . w N T M c
    elastic_tangential  x x . t w N T M c
    elastic_rotation    x x . . w N T M c
    hardening           x x . . . N T M c
"""
_DAMPED = """
    penetration         . . n . . . . . . . . .
    rotation            . . . . w . . . . . . .
    normal_velocity     . . . . . . . . . N . .
    tangential_velocity . . . . . . . . . . T .
    angular_velocity    x x . . . . . . . N T M
    elastic_normal      x x n . w . . . c N T M
    elastic_tangential  x x . t w . . . c N T M
    elastic_rotation    x x . . w . . . c N T M
    hardening           x x . . . . . . c N T M
    normal_force        x x n . w s . . c N T M
    tangential_force    x x . t w . s . c N T M
    moment              x x . . w . . s c N T M
"""


def _pattern(text: str) -> tuple[tuple[bool, ...], ...]:
    lines = text.strip().split("\n")
    return tuple(tuple(mark != "." for mark in line.split()[1:]) for line in lines)


JACOBIAN_PATTERN = {False: _pattern(_UNDAMPED), True: _pattern(_DAMPED)}
"""Where the Jacobian may differ from zero, with dashpots (True) and without."""
MOTIONS = len(Motion._fields)
LOADS = (
    *(i for i, name in enumerate(Motion._fields) if name.startswith("elastic")),
    *range(MOTIONS, MOTIONS + len(Forces._fields)),
)
"""Unknowns that carry the load."""


class Observed(NamedTuple):
    """Quantities whose largest value over the impact is wanted."""

    penetration: Scalar  # u_n [m]
    sinking: Scalar  # u_D [m]
    normal_force: Scalar  # N [N]
    tangential_force: Scalar  # |T| [N]
    moment: Scalar  # |M| [N m]


class Watched(NamedTuple):
    """What is worked out at the end of every step, T and M with their signs."""

    observed: Observed
    margin: Scalar
    """The least of the margins to an end."""
    switches: Switches


class Problem(eqx.Module):
    """The initial value problem of one impact."""

    ground: Ground
    scale: Float[Array, " n"]
    """Magnitude of each unknown over the impact."""
    force_scale: Scalar
    """Force of an elastic impact on a footing of the block's size [N]."""
    incoming_energy: Scalar
    tolerance: Scalar
    floor: Scalar
    """Of the error control; see `Accuracy`."""
    laws: Laws = eqx.field(static=True)
    damped: bool = eqx.field(static=True)
    ledger: bool = eqx.field(static=True)
    max_steps: int = eqx.field(static=True)

    def allowed_error(self, size, largest_force) -> Float[Array, " n"]:
        """Error of each unknown that a step may make: `tolerance (size + floor scale)`.

        What carries the load grows from a billionth of its scale. Were its errors at
        the onset measured by what it comes to, moment and shear would be noise there,
        and the load so far outside the surface that no step finds back; so the part of
        the scale is at most a tenth of what the normal force has come to.
        """
        share = self.tolerance * self.floor
        reached = jax.lax.stop_gradient(largest_force / self.force_scale)
        load_share = jnp.minimum(share, 0.1 * reached)
        return jnp.stack(
            [
                self.tolerance * size[row]
                + (load_share if row in LOADS else share) * self.scale[row]
                for row in range(len(self.scale))
            ]
        )

    @property
    def passing_time(self) -> Scalar:
        """Time in which the block moves by its semi-axis R [s]."""
        radius, _, speed, *_ = self.scale
        return radius / speed

    def contact(self, rows, branch: Branch | None = None) -> tuple[Motion, Contact]:
        """Named state and contact, from the rows of the state vector."""
        motion = Motion(*(rows[i] for i in range(MOTIONS)))
        forces = Forces(*rows[MOTIONS:]) if self.damped else None
        return motion, contact(self.ground, self.laws, motion, forces, branch)

    def rates(self, rows, branch: Branch | None = None) -> list[Scalar]:
        """Rates of all unknowns, rows to rows."""
        motion, now = self.contact(rows, branch)
        rates = list(motion_rate(self.ground, motion, now))
        if self.damped:
            rates += force_rate(self.ground, self.laws, now, self.passing_time)
        return rates

    def watch(self, rows, largest_force, branch: Branch | None = None) -> Watched:
        """Quantities whose peaks are wanted, margin and switches, by the largest normal
        force up to now."""
        motion, now = self.contact(rows, branch)
        observed = Observed(
            motion.penetration,
            now.foundation.sinking,
            now.forces.normal,
            now.forces.tangential,
            now.forces.moment,
        )
        force_scale = self._force_scale(now, largest_force)
        return Watched(
            observed,
            jnp.min(jnp.stack(self._margins(motion, now, force_scale)), axis=0),
            switches(self.ground, motion, now, force_scale),
        )

    def watch_with_rate(
        self, vector, rates, largest_force, branch: Branch
    ) -> tuple[Watched, Watched]:
        """Watched quantities and their rates of change, on a branch, by the rates of
        the unknowns."""
        return jax.jvp(
            lambda rows: self.watch(rows, largest_force, branch),
            (list(vector),),
            (list(rates),),
        )

    def power(self, vector, branch: Branch) -> Work:
        """Power of the ledger's items [W]."""
        motion, now = self.contact(vector, branch)
        return work_rate(self.ground, self.laws, motion, now, branch)

    def margins(self, vector, largest_force) -> Margins:
        """Distances to the ends of the impact."""
        motion, now = self.contact(vector)
        return self._margins(motion, now, self._force_scale(now, largest_force))

    def _force_scale(self, now, largest_force) -> Scalar:
        reached = jnp.maximum(largest_force, now.forces.normal)
        return jax.lax.stop_gradient(jnp.maximum(reached, 1e-15 * self.force_scale))

    def _margins(self, motion, now, force_scale) -> Margins:
        return end_margins(
            self.ground, motion, now, force_scale, self.scale[2], self.incoming_energy
        )


def pose(
    scene: Scene, assembly: Assembly, tolerance, floor
) -> tuple[Problem, Float[Array, " n"]]:
    """The initial value problem of a scene, and its initial state.

    Args:
        tolerance, floor: of the error control; see `Accuracy`.
    """
    laws = assembly.laws
    ground = prepare(scene, laws)
    motion = initial_motion(scene)
    radius = ground.axes.minor
    speed = scene.impact.speed
    # Displacement of the springs in an elastic impact on a footing of the block's size
    stiffness = laws.elastic_stiffness(
        2.0 * radius, 2.0 * radius, ground.unit_weight_normal, scene.soil
    )
    elastic = speed * jnp.sqrt(ground.mass / stiffness.normal)
    one = jnp.ones_like(radius)
    spin = speed / radius
    scale = [radius, one, speed, speed, spin, elastic, elastic, elastic / radius, one]
    force_scale = stiffness.normal * elastic
    start = list(motion)
    if assembly.damped:
        scale += [force_scale, force_scale, force_scale * radius]
        start += contact(ground, laws, motion).forces
    problem = Problem(
        ground=ground,
        scale=jax.lax.stop_gradient(jnp.stack(scale)),
        force_scale=jax.lax.stop_gradient(force_scale),
        incoming_energy=kinetic_energy(ground, motion),
        tolerance=jnp.asarray(tolerance, float),
        floor=jnp.asarray(floor, float),
        **assembly._asdict(),
    )
    return problem, jnp.stack(start)

"""Initial value problem of one impact: unknowns, equations, watched quantities.

The unknowns are one vector, named by the model: fields of `Motion`, and with dashpots
those of `Forces`.
"""

import dataclasses
from collections.abc import Callable
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .._types import Flag, Scalar, Structure
from ..accuracy import MAX_STEPS, MAX_STEPS_DAMPED
from ..laws import Branch, FlowRate, Stiffness
from ..quantities import columns_of
from ..scene import Scene
from ..shapes import Foundation
from .dynamics import (
    ARM,
    INITIAL_SINKING,
    Contact,
    Forces,
    ImpactConstants,
    LedgerItems,
    Motion,
    Work,
    arm_power,
    contact,
    for_laws,
    force_rate,
    initial_motion,
    jump_of_elastic_normal,
    kinetic_energy,
    motion_rate,
    prepare,
    work_rate,
)
from .events import Margins, Switches, branch_of, end_margins, switches
from .reduced_models import FORCES, PLANAR, PLANAR_DAMPED, Model, select_model
from .specialize import depends, leave_out_known


class Assembly(NamedTuple):
    """Choices that change the program; numbers are in the scene."""

    structure: Structure
    """Laws and shapes of the scene: its tree structure."""
    model: Model
    ledger: LedgerItems


def naming(assembly: Assembly, mode: str, sampled: bool) -> tuple[tuple, Any]:
    """Name code of an assembly, of a mode of derivatives and with samples: by its
    choices, and a tree of the structure of its scenes."""
    structure = assembly.structure
    tree = jax.tree.unflatten(structure, range(structure.num_leaves))
    return (assembly._replace(structure=None), mode, sampled), tree


def assemble(scene: Scene) -> Assembly:
    """Choose the assembly of a single impact: the cheapest model that is exact, with
    the ledger."""
    model = select_model(scene.block, scene.soil, scene.impact)
    return Assembly(jax.tree.structure(scene), model, ledger=True)


ELASTIC_SCALE = 0.01
"""Elastic displacement over R at which a stiffness that depends on it is taken for
the scale of the forces."""
LOADS = ("elastic_normal", "elastic_tangential", "elastic_rotation", *FORCES)
"""Unknowns that carry the load."""


EARLY, EARLY_TOLERANCE = 0.1, 0.03
"""Penetration by R up to which errors count less, and the most that may be allowed."""
ALLOWED_MORE = {
    "elastic_normal": 20.0,
    "elastic_tangential": 3.0,
    "elastic_rotation": 3.0,
}
"""How much more error is allowed of the springs. They follow the load at once: what is
wrong in one step is not carried on, and results hardly show it."""
OF_THEIR_SIZE = {
    "normal_velocity": 0.02,
    "tangential_velocity": 0.02,
    "angular_velocity": 0.02,
}
"""Part of its size that counts for the error allowed of a velocity. What is wrong in it
stays to the end, and the coefficients of restitution are made of it."""


class Observed(NamedTuple):
    """Quantities whose largest values are results."""

    penetration: Scalar  # u_n [m]
    sinking: Scalar  # u_D [m]
    normal_force: Scalar  # N [N]
    tangential_force: Scalar  # |T| [N]
    moment: Scalar  # |M| [N m]


class Watched(NamedTuple):
    """Quantities, margins and switches at the end of a step; T and M with signs."""

    observed: Observed
    margins: Margins
    switches: Switches
    arm_power: Scalar | None = None
    """Power of the arm work [W], where it is kept alone."""


class Problem(eqx.Module):
    """The initial value problem of one impact."""

    ground: ImpactConstants
    scale: Float[Array, " n"]
    """Magnitude of each unknown over the impact."""
    force_scale: Scalar
    """Force of an elastic impact on a footing of the block's size [N]."""
    incoming_energy: Scalar
    tolerance: Scalar
    """Tolerance of the error control; see `Accuracy`."""
    floor: Scalar
    """Floor of the error control; see `Accuracy`."""
    model: Model = eqx.field(static=True)
    ledger: LedgerItems = eqx.field(static=True)

    @property
    def max_steps(self) -> int:
        """Steps after which the impact is given up."""
        return MAX_STEPS_DAMPED if self.model.damped else MAX_STEPS

    def allowed_error(self, size, largest_force) -> Float[Array, " n"]:
        """Compute the error of each unknown allowed in a step: `tolerance w (r size +
        floor scale)` with `w` of `ALLOWED_MORE` and `r` of `OF_THEIR_SIZE`, else 1, and
        more at the onset.

        What carries the load grows from a billionth of its scale. Were its errors at
        the onset measured by what it comes to, moment and shear would be noise there,
        and the load so far outside the surface that no step finds back; so the part of
        the scale is at most 3 percent of what the normal force has come to.

        What is wrong early is small beside what comes later. So the tolerance is that
        given times the fourth root of u / u_n up to a penetration u, the lesser of
        0.1 R and of what an elastic impact comes to, though no more than 3 percent for
        any unknown. It saves one step in ten.
        """
        penetration = size[self.model.unknowns.index("penetration")]
        elastic = self.scale[self.model.unknowns.index("elastic_normal")]
        late = jnp.minimum(EARLY * self.ground.axes.minor, elastic)
        early = jnp.sqrt(jnp.sqrt(late / jnp.maximum(penetration, 1e-30)))
        reached = jax.lax.stop_gradient(largest_force / self.force_scale)
        rows = []
        for name, value, scale in zip(
            self.model.unknowns, size, self.scale, strict=True
        ):
            tolerance = self.tolerance * ALLOWED_MORE.get(name, 1.0)
            relative = tolerance * OF_THEIR_SIZE.get(name, 1.0)
            share = tolerance * self.floor
            if name in LOADS:
                share = jnp.minimum(share, 0.03 * reached)
            most = jnp.maximum(1.0, EARLY_TOLERANCE / tolerance)
            rows.append(jnp.clip(early, 1.0, most) * (relative * value + share * scale))
        return jnp.stack(rows)

    def is_jump_of_forces(self, before, after) -> Flag:
        """Tell whether a change of state is one of the forces alone, by no more than
        an elastic impact brings about. Only forces with dashpots jump.

        In a step that is too short for anything else to move, another change comes of
        stages that have left the range of the numbers although they are finite: rates
        near zero normal force can be that large where `beta` is below 0.1, as powers
        of more than ten of the load ratio.
        """
        if not self.model.damped:
            return jnp.zeros(jnp.shape(before)[1:], bool)
        most = jnp.stack(
            [
                row if name in LOADS else self.tolerance * row
                for name, row in zip(self.model.unknowns, self.scale, strict=True)
            ]
        )
        return jnp.all(jnp.abs(after - before) <= most, axis=0)

    @property
    def speed_scale(self) -> Scalar:
        """Impact speed [m/s]."""
        return self.scale[self.model.unknowns.index("normal_velocity")]

    @property
    def passing_time(self) -> Scalar:
        """Time in which the block moves by its semi-axis R [s]."""
        return self.ground.axes.minor / self.speed_scale

    @property
    def settled_sinking(self) -> Scalar:
        """Sinking from which normal forces count [m].

        Before, the load that the springs have at the start relaxes. It is no force of
        the impact, and may be a thousand times as large as all that follow: on narrow
        foundations, where moduli grow with the pressure.
        """
        return 2.0 * INITIAL_SINKING * self.ground.axes.minor

    def contact(self, rows, branch: Branch | None = None) -> tuple[Motion, Contact]:
        """Return the named state and contact, from the rows of the state vector."""
        return self._with_contact(lambda *state: state, rows, branch)

    def _with_contact(self, function: Callable, rows, branch: Branch | None):
        """Evaluate a function of state and contact, without the arithmetic on what the
        model leaves at zero."""
        model, motions = self.model, len(Motion._fields)
        names = (PLANAR_DAMPED if model.damped else PLANAR).unknowns

        def of_all(*values):
            motion = Motion(*values[:motions])
            forces = Forces(*values[motions:]) if model.damped else None
            return function(motion, contact(self.ground, motion, forces, branch))

        absent = [place for place, n in enumerate(names) if n not in model.unknowns]
        # A round block has arms of zero, that are left out too.
        if not absent and not model.is_round:
            return of_all(*rows)
        return leave_out_known(of_all, dict.fromkeys(absent, 0.0))(*rows)

    def rates(
        self, rows, branch: Branch | None = None, stalled: Scalar | float | None = 0.0
    ) -> list[Scalar]:
        """Rates of all unknowns, rows to rows; `stalled` counts the steps without
        progress at the onset, with dashpots."""

        def of_contact(motion, now):
            rates = motion_rate(self.ground, motion, now)._asdict()
            if self.model.damped:
                assert stalled is not None, "counted with dashpots"
                forces = force_rate(self.ground, now, self.passing_time, stalled)
                rates |= zip(FORCES, forces, strict=True)
            return [rates[name] for name in self.model.unknowns]

        return self._with_contact(of_contact, rows, branch)

    def watch(self, rows, largest_force, branch: Branch | None = None) -> Watched:
        """Return the quantities whose peaks are results, margins and switches, given
        the largest normal force up to now."""

        def of_contact(motion, now):
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
                self._margins(motion, now, force_scale),
                switches(self.ground, motion, now, force_scale),
                arm_power(self.ground, motion, now) if self.ledger == ARM else None,
            )

        return self._with_contact(of_contact, rows, branch)

    def watch_with_rate(
        self, vector, rates, largest_force, branch: Branch
    ) -> tuple[Watched, Watched]:
        """Return the watched quantities and their rates of change, on a branch, from
        the rates of the unknowns."""
        return jax.jvp(
            lambda rows: self.watch(rows, largest_force, branch),
            (list(vector),),
            (list(rates),),
        )

    def on_next_side(self, vector, branch: Branch, watched: Switches):
        """Return the state from which the next step starts: that at the end of a step,
        changed where the block has rolled over a level face; see
        `jump_of_elastic_normal`."""
        unknowns = self.model.unknowns
        if watched.side is None or "rotation" not in unknowns:
            return vector
        named = dict(zip(unknowns, vector, strict=True))
        motion = Motion(*(named.get(name, 0.0) for name in Motion._fields))
        after = branch_of(watched).side
        jump = jump_of_elastic_normal(self.ground, motion, branch, after)
        named["elastic_normal"] = named["elastic_normal"] + jump
        return jnp.stack(list(named.values()))

    def power(self, vector, rates, branch: Branch) -> Work:
        """Power of the works of the ledger [W], from the unknowns and their rates."""
        motion, now = self.contact(vector, branch)
        known = dict(zip(self.model.unknowns, rates, strict=True))
        elastic_rates = tuple(
            known.get(name, 0.0)
            for name in Motion._fields
            if name.startswith("elastic")
        )
        return work_rate(self.ground, motion, now, elastic_rates)

    def margins(self, vector, largest_force) -> Margins:
        """Return the distances to the ends of the impact."""
        motion, now = self.contact(vector)
        return self._margins(motion, now, self._force_scale(now, largest_force))

    def _force_scale(self, now, largest_force) -> Scalar:
        reached = jnp.maximum(largest_force, now.forces.normal)
        return jax.lax.stop_gradient(jnp.maximum(reached, 1e-15 * self.force_scale))

    def _margins(self, motion, now, force_scale) -> Margins:
        return end_margins(
            self.ground,
            motion,
            now,
            force_scale,
            self.speed_scale,
            self.incoming_energy,
        )


def stiffness_of_block(ground: ImpactConstants) -> Stiffness:
    """Compute the stiffness of the ground under a footing of the block's size."""
    radius = ground.axes.minor
    zero = jnp.zeros_like(radius)
    size = Foundation(2.0 * radius, 2.0 * radius, zero, radius, zero, zero)
    return ground.soil.elasticity(
        size, ground.unit_weight_normal, ELASTIC_SCALE * radius
    )


HALVINGS = 8
"""Halvings of the load at the start of a ground that flows below yield."""


def _relaxed(ground: ImpactConstants, motion: Motion) -> Motion:
    """Take the load at the start down to yield, and on until flow is no faster than the
    block sinks, where the ground flows below yield too.

    The load is ten thousand times as large: a power of that relaxes faster than any
    step, and past zero, where some laws have a state that they never leave. What the
    springs give up is flow, which hardens.
    """
    if not ground.soil.flow.flows_below_yield:
        return motion
    now = contact(ground, motion)
    excess = now.load.size / motion.hardening
    compression = motion.elastic_normal / jnp.maximum(excess, 1.0)
    for _ in range(HALVINGS):
        relaxed = contact(ground, motion._replace(elastic_normal=compression))
        flows = relaxed.flow.normal > relaxed.approach[0]
        compression = jnp.where(flows, 0.5 * compression, compression)
    zero = jnp.zeros_like(compression)
    hardening = ground.soil.hardening(
        motion.hardening,
        FlowRate(motion.elastic_normal - compression, zero, zero),
        for_laws(ground, now.foundation),
    )
    return motion._replace(
        elastic_normal=compression, hardening=motion.hardening + hardening
    )


def pose(
    scene: Scene, assembly: Assembly, tolerance, floor
) -> tuple[Problem, Float[Array, " n"]]:
    """Make the initial value problem of a scene, and its initial state."""
    ground = prepare(scene)
    if assembly.model.is_round:
        ground = ground._replace(shape=scene.block.shape.when_round())
    motion = _relaxed(ground, initial_motion(scene))
    radius = ground.axes.minor
    speed = scene.impact.speed
    stiffness = stiffness_of_block(ground)
    # Displacement of the springs in an elastic impact
    elastic = speed * jnp.sqrt(ground.mass / stiffness.normal)
    one = jnp.ones_like(radius)
    force_scale = stiffness.normal * elastic
    scale = Motion(
        penetration=radius,
        rotation=one,
        normal_velocity=speed,
        tangential_velocity=speed,
        angular_velocity=speed / radius,
        elastic_normal=elastic,
        elastic_tangential=elastic,
        elastic_rotation=elastic / radius,
        hardening=one,
    )._asdict()
    scale |= zip(FORCES, (force_scale, force_scale, force_scale * radius), strict=True)
    start = motion._asdict()
    if assembly.model.damped:
        start |= zip(FORCES, contact(ground, motion).forces, strict=True)
    unknowns = assembly.model.unknowns
    problem = Problem(
        ground=ground,
        scale=jax.lax.stop_gradient(jnp.stack([scale[name] for name in unknowns])),
        force_scale=jax.lax.stop_gradient(force_scale),
        incoming_energy=kinetic_energy(ground, motion),
        tolerance=jnp.asarray(tolerance, float),
        floor=jnp.asarray(floor, float),
        model=assembly.model,
        ledger=assembly.ledger,
    )
    return problem, jnp.stack([start[name] for name in unknowns])


LARGEST_ANGLE = 180.0
"""Impact angle up to which there are contacts [deg]. Beyond the declared range, of less
than 90, the centre of a block that turns rises as the block strikes. Run-outs have such
impacts."""


def is_in_range(scene: Scene) -> Flag:
    """Tell whether all values of a scene are in the ranges that are declared of them.

    Where values are known `check_scene` has refused others. Those that JAX traces are
    seen here alone.
    """
    allowed = jnp.ones((), bool)
    for column in columns_of(scene).values():
        if (column.part, column.field) == ("impact", "angle"):
            column = dataclasses.replace(
                column,
                lower=-LARGEST_ANGLE,
                upper=LARGEST_ANGLE,
                lower_allowed=True,
                upper_allowed=True,
            )
        value = getattr(getattr(scene, column.part), column.field)
        allowed = allowed & column.is_allowed(value / column.factor)
    return allowed


def jacobian_pattern(problem: Problem) -> tuple[tuple[bool, ...], ...]:
    """Return the sparsity of the Jacobian of the rates (rows) with respect to the
    unknowns (columns): True where it may differ from zero, read off the traced
    equations."""
    rows = [jnp.zeros_like(row) for row in problem.scale]
    traced = jax.make_jaxpr(lambda *rows: problem.rates(list(rows)))(*rows)
    columns = [
        depends(traced.jaxpr, [other == column for other in range(len(rows))])
        for column in range(len(rows))
    ]
    return tuple(zip(*columns, strict=True))

"""The objective function of a law of rebound, so that it is fitted as a ground is.

The parameters of the law take the place of the ground's; nuisance parameters and errors
of measurement stay.
"""

import dataclasses
import math
from collections.abc import Sequence
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from ..._types import Structure
from ...accuracy import PRESETS, Accuracy
from ...errors import InputError
from ...impact.events import Outcome
from ...quantities import DERIVED_COLUMNS, columns_of, leaf_places, own_columns
from ...rebound import AbstractRebound, Rebound
from ...restitution import defined_ratio, defined_root
from ...scene import Block, Impact, Scene
from ..problem.config import Study
from ..problem.fitted_parameters import Parameter
from ..problem.forward_model import forward_models, results_in_order
from ..problem.objective import Objective

NARROWER = {"friction_coefficient": (0.0, 2.0)}
"""Ranges of fits where a law allows much more than is found in the field."""


RESULTS = ("e_n", "e_t", "e_bar", "R_r", "v_n_mps", "v_t_mps", "omega_radps")
"""Results that follow from the velocities before and after an impact."""
PREDICTED = (*RESULTS, *DERIVED_COLUMNS)
"""Targets that every law of rebound predicts."""


def results_of(block: Block, impact: Impact, after: Rebound) -> dict[str, Array]:
    """Compute `RESULTS` of one impact from its velocities after it, in SI."""
    v_n, v_t, spin = after
    translational = block.mass * (v_n**2 + v_t**2)
    rotational = block.inertia * spin**2
    before = block.mass * impact.speed**2 + block.inertia * impact.angular_velocity**2
    total = translational + rotational
    e_bar, R_r = defined_root(total / before), defined_ratio(rotational, total)
    values = after.e_n(impact), after.e_t(impact), e_bar, R_r, v_n, v_t, spin
    return dict(zip(RESULTS, values, strict=True))


def parameters_of_law(law: type[AbstractRebound]) -> tuple[Parameter, ...]:
    """List the parameters of a law with the ranges in which they are fitted.

    Raises InputError for a law without parameters, and for one whose parameter has
    neither a finite range nor finite usual values.
    """
    columns = own_columns(law)
    if not columns:
        raise InputError(
            f"the law {law.__name__} has no parameter to fit; leave it out"
        )
    parameters = []
    for column in columns:
        lower, upper = NARROWER.get(
            column.name,
            (max(column.lower, column.usual[0]), min(column.upper, column.usual[1])),
        )
        if not (math.isfinite(lower) and math.isfinite(upper)):
            raise InputError(
                f"the parameter {column.name} of {law.__name__} is "
                f"{column.range_text}; declare usual=(low, high) to have it fitted"
            )
        parameters.append(Parameter(column.name, (lower + upper) / 2.0, lower, upper))
    return tuple(parameters)


class ReboundResponse(NamedTuple):
    """A law of rebound, whose leaves follow those of the scene."""

    targets: tuple[str, ...]
    law: type[AbstractRebound]

    def places(self, tree: tuple[Scene, AbstractRebound]) -> dict[str, int]:
        """Find the leaf of each column of a scene, and of the law."""
        first = len(jax.tree.leaves(tree[0]))
        inner = jax.tree.structure(tree[1])
        of_law = jax.tree.unflatten(inner, range(first, first + inner.num_leaves))
        of_columns = {c.name: getattr(of_law, c.field) for c in own_columns(self.law)}
        return leaf_places(tree[0]) | of_columns

    def in_xla(self, structure: Structure, leaves: Sequence) -> bool:
        """A law in closed form is a program of XLA."""
        return True

    def __call__(self, tree, times: Array, accuracy: Accuracy):
        """Compute impacts, exactly."""
        count = len(tree[0].impact.speed)

        def of_one(tree):
            scene, law = tree
            return results_of(scene.block, scene.impact, law(scene.block, scene.impact))

        # A law of a user's may be written for one impact.
        tree = jax.tree.map(lambda leaf: jnp.broadcast_to(leaf, count), tree)
        values = jax.vmap(of_one)(tree)
        results = results_in_order(self.targets, tree[0], values.__getitem__)
        return [results], jnp.full(count, float(Outcome.detached))


def rebound_objective(study: Study, law: type[AbstractRebound]) -> Objective:
    """Make the objective function of a law of rebound, whose parameters take the place
    of those of a study; the law predicts all of its targets."""
    variant, columns = study.variants[0], own_columns(law)
    alone = dataclasses.replace(
        study,
        parameters=parameters_of_law(law),
        tied=(),
        variants=(variant,),
        nuisances=tuple(n for n in study.nuisances if not n.pooled),
    )
    scene, tests = alone.scene_of(variant), len(study.tests)
    start = {
        column.field: np.full(tests, column.factor * parameter.start)
        for column, parameter in zip(columns, alone.parameters, strict=True)
    }
    known = columns_of(scene) | {column.name: column for column in columns}
    response = ReboundResponse(study.targets, law)
    (model,) = forward_models(alone, [(scene, law(**start))], known, response)
    return Objective(alone, variant, model, PRESETS["balanced"])

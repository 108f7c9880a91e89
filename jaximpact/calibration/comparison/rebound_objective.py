"""The objective function of a law of rebound, so that it is fitted as a ground is.

The parameters of the law take the place of the ground's: the leaves of the law follow
those of the scene, and everything else of `Objective` holds, nuisance parameters and
errors of measurement among them.
"""

import dataclasses
import math
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..._safe import safe_sqrt
from ...accuracy import PRESETS
from ...backend.xla_compilation import unfused_jit
from ...errors import InputError
from ...impact.events import Outcome
from ...quantities import leaf_places, own_columns
from ...rebound import AbstractRebound, Rebound
from ...restitution import defined_ratio
from ...scene import Block, Impact
from ..problem.config import Study
from ..problem.derived_targets import DERIVED, base_columns
from ..problem.engine import XLA_AT_ONCE, Engine
from ..problem.fitted_parameters import Parameter
from ..problem.forward_model import UnknownColumn, bounds_of
from ..problem.objective import Objective

NARROWER = {"friction_coefficient": (0.0, 2.0)}
"""Ranges of fits where a law allows much more than is found in the field."""


class ReboundResults(NamedTuple):
    """Results of an impact that follow from its velocities before and after."""

    e_n: Any
    e_t: Any
    e_bar: Any
    R_r: Any
    v_n_mps: Any
    v_t_mps: Any
    omega_radps: Any


PREDICTED = (*ReboundResults._fields, *DERIVED)
"""Targets that every law of rebound predicts."""


def results_of(block: Block, impact: Impact, after: Rebound) -> ReboundResults:
    """Compute the results of one impact from its velocities after it, in SI."""
    v_n, v_t, spin = after
    translational = block.mass * (v_n**2 + v_t**2)
    rotational = block.inertia * spin**2
    before = block.mass * impact.speed**2 + block.inertia * impact.angular_velocity**2
    total = translational + rotational
    return ReboundResults(
        e_n=after.e_n(impact),
        e_t=after.e_t(impact),
        e_bar=safe_sqrt(total / before),
        R_r=defined_ratio(rotational, total),
        v_n_mps=v_n,
        v_t_mps=v_t,
        omega_radps=spin,
    )


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
    found = []
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
        found.append(Parameter(column.name, (lower + upper) / 2.0, lower, upper))
    return tuple(found)


class ReboundEngine(Engine):
    """Law of rebound that computes impacts and their directional derivatives; exact, so
    that the accuracy has no meaning.

    Args:
        structure: tree structure of the scene and the law.
        targets: result columns that are wanted.
        places: index of the leaf of each column of the scene, whose leaves come first.
    """

    def __init__(self, structure, targets: tuple[str, ...], places: dict[str, int]):
        self.structure, self.places = structure, places
        self._set_targets(targets)
        self.kernel, self.name, self.valued = None, "closed form", 0

    def _in_xla(self, leaves, directions, places, accuracy) -> np.ndarray:
        filled = np.resize(places, XLA_AT_ONCE)  # repeats impacts to fill the program
        rows = jnp.asarray(leaves[:, filled]), jnp.asarray(directions[:, filled])
        wanted = [ReboundResults._fields.index(n) for n in base_columns(self.targets)]
        found = np.stack(_compiled(self.structure, *rows))[:, wanted, : len(places)]
        outcomes = np.full((2, 1, len(places)), float(Outcome.detached))
        return np.concatenate([found, outcomes], axis=1)


def _results(structure, leaves):
    def of_one(rows):
        scene, law = jax.tree.unflatten(structure, list(rows))
        return jnp.stack(
            results_of(scene.block, scene.impact, law(scene.block, scene.impact))
        )

    return jax.vmap(of_one, in_axes=1, out_axes=1)(leaves)


def _with_derivatives(structure, leaves, directions):
    return jax.jvp(lambda rows: _results(structure, rows), (leaves,), (directions,))


_compiled = unfused_jit(_with_derivatives, static_argnums=(0,))


class ReboundObjective(Objective):
    """Objective function of a law of rebound, in place of the parameters of a study,
    all of whose targets the law predicts."""

    def __init__(self, study: Study, law: type[AbstractRebound]):
        parameters, columns = parameters_of_law(law), own_columns(law)
        variant = study.variants[0]
        without = dataclasses.replace(
            study,
            parameters=(),
            tied=(),
            variants=(variant,),
            nuisances=tuple(n for n in study.nuisances if not n.pooled),
        )
        scene = without.scene_of(variant)
        template = law(
            **{
                column.field: column.factor * parameter.start
                for column, parameter in zip(columns, parameters, strict=True)
            }
        )
        structure = jax.tree.structure((scene, template))
        engine = ReboundEngine(structure, study.targets, leaf_places(scene))
        super().__init__(without, variant, engine, PRESETS["balanced"])
        count, first, tests = len(parameters), len(self._leaves), len(study.tests)
        self.study = dataclasses.replace(without, parameters=parameters)
        self.bounds = bounds_of(self.study)
        self.prior_mean = np.concatenate([np.zeros(count), self.prior_mean])
        self.prior_sd = np.concatenate([np.full(count, np.inf), self.prior_sd])
        of_law, inner = jax.tree.flatten(template)
        places = jax.tree.unflatten(inner, range(len(of_law)))
        own_leaves = [np.full(tests, float(leaf)) for leaf in of_law]
        self._leaves = np.concatenate([self._leaves, own_leaves])
        nothing = np.zeros(tests)
        self._columns = [
            UnknownColumn(
                *(first + getattr(places, column.field), column.factor, nothing),
                np.full(tests, index),
            )
            for index, column in enumerate(columns)
        ] + [
            column._replace(unknown=column.unknown + count) for column in self._columns
        ]

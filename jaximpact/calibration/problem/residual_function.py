"""The problem of a study as a plain function of JAX, for optimisers of one's own."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from ..._checks import expect
from ..._precision import require_float64
from ...errors import InputError
from ...quantities import CURVE_COLUMNS, TARGET_COLUMNS
from ...simulation import simulate
from .config import Study, read_study
from .derived_targets import DERIVED
from .forward_model import unknown_columns

Tree = dict[str, Array]


def residuals(
    study: Study | str | os.PathLike, variant: str | None = None
) -> tuple[Callable[[Tree], Array], Tree]:
    r"""Make the residuals of a study as a function of its parameters, and a start.

    $$ r_i(p) = \sqrt{w} \, \frac{y_i(p) - \hat y_i}{\sigma_i}, \qquad
       r_k(p) = \frac{p_k - m_k}{s_k}, $$

    one r_i for each measurement, test by test, and one r_k for each prior. Half the sum
    of their squares is the cost that `calibrate` minimises where sigmas are given and
    the loss is Gaussian.

    Args:
        study: study, or path of one: a study file, or a table of tests.
        variant: name of a variant; None for the first.

    Returns:
        The function, for `jax.jit`, `jax.grad`, `jax.jacfwd` and any optimiser or
        sampler of JAX, and the start of the study: for each parameter its value in the
        unit of its column, shape (); for each nuisance the values of its groups, shape
        (groups,). The function takes such a tree and returns an array (residuals,). A
        result that could not be computed makes its residual NaN. Sigmas that the study
        does not state are nominal: 5 % of the target's root mean square, or of each
        value where scatter is proportional. Bounds are the caller's to keep.

    Raises InputError for a study with limits among its measurements, tied or grouped
    parameters, or targets computed from others, which are no plain residuals; for an
    unknown variant; and as `read_study` does.
    """
    require_float64()
    expect("study", study, Study, str, os.PathLike)
    if not isinstance(study, Study):
        study = read_study(Path(study))
    _check(study)
    chosen = 0 if variant is None else study.index_of(variant)
    scene = study.scene_of(study.variants[chosen])
    names = [p.name for p in study.parameters] + [n.name for n in study.nuisances]
    columns = dict(zip(names, unknown_columns(study, scene), strict=True))
    leaves, structure = jax.tree.flatten(scene)
    tests, targets = np.nonzero(study.known)
    weight = np.sqrt(study.weights[targets]) / study.sigma[tests, targets]
    measured = study.measured[tests, targets]
    fields = [TARGET_COLUMNS[name].field for name in study.targets]
    fitted = [*study.parameters, *study.nuisances]
    priors = {n.name: (n.prior.mean, n.prior.sd) for n in fitted if n.prior}
    start: dict[str, Any] = {p.name: jnp.asarray(p.start) for p in study.parameters}
    start |= {n.name: jnp.full(len(n.groups), n.prior.mean) for n in study.nuisances}

    def residual(tree: Tree) -> Array:
        changed = list(leaves)
        for name, column in columns.items():
            group = column.unknown - np.min(column.unknown)
            value = jnp.atleast_1d(jnp.asarray(tree[name], float))[group]
            changed[column.leaf] = column.factor * (column.base + value)
        found = simulate(
            jax.tree.unflatten(structure, changed), accuracy=study.accuracy
        )
        predicted = jnp.stack([getattr(found, field) for field in fields], axis=1)
        rows = [(predicted[tests, targets] - measured) * weight]
        rows += [
            (jnp.ravel(tree[name]) - mean) / sd for name, (mean, sd) in priors.items()
        ]
        return jnp.concatenate(rows)

    return residual, start


def _check(study: Study) -> None:
    """Raise InputError for a study that is no sum of squares."""
    if np.any(study.censored):
        raise InputError(
            'has limits such as ">0.3" among its measurements, which are no '
            "residuals; leave these cells empty",
            file=study.path,
        )
    refused = {
        "ties parameters by expressions": bool(study.tied),
        "has parameters that differ by group": any(n.pooled for n in study.nuisances),
        "has a target that is computed from others": bool(
            set(study.targets) & set(DERIVED)
        ),
        "has forces at times": bool(set(study.targets) & set(CURVE_COLUMNS)),
    }
    for what, found in refused.items():
        if found:
            raise InputError(
                f"{what}, which plain residuals do not; fit it with calibrate",
                file=study.path,
            )

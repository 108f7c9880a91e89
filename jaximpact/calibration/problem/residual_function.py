"""The problem of a study as a plain function of JAX, for optimisers of one's own."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax.numpy as jnp
import numpy as np
from jax import Array

from ..._checks import expect
from ..._precision import require_float64
from ...accuracy import PRESETS
from ...errors import InputError
from .config import Study, read_study
from .forward_model import models_of

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
        (groups,); for a parameter that differs by group also, as "c_v by campaign", the
        logarithms of its factors. The function takes such a tree and returns an array
        (residuals,). A result that could not be computed makes its residual NaN. Sigmas
        that the study does not state are nominal: 5 % of the target's root mean square,
        or of each value where scatter is proportional. Bounds are the caller's to keep.

    Raises InputError for a study with limits among its measurements, which are no
    residuals; for an unknown variant; and as `read_study` does.
    """
    require_float64()
    expect("study", study, Study, str, os.PathLike)
    if not isinstance(study, Study):
        study = read_study(Path(study))
    if np.any(study.censored):
        raise InputError(
            'has limits such as ">0.3" among its measurements, which are no '
            "residuals; leave these cells empty",
            file=study.path,
        )
    model = models_of(study)[0 if variant is None else study.index_of(variant)]
    tests, targets = np.nonzero(study.known)
    weight = np.sqrt(study.weights[targets]) / study.sigma[tests, targets]
    measured = study.measured[tests, targets]
    start: dict[str, Any] = {p.name: jnp.asarray(p.start) for p in study.parameters}
    priors = {p.name: p.prior for p in study.parameters if p.prior}
    for nuisance in study.nuisances:
        name = f"{nuisance.name} by {nuisance.by}" if nuisance.pooled else nuisance.name
        start[name] = jnp.full(len(nuisance.groups), nuisance.prior.mean)
        priors[name] = nuisance.prior

    def residual(tree: Tree) -> Array:
        p = jnp.concatenate([jnp.ravel(jnp.asarray(tree[n], float)) for n in start])
        predicted = model.predict(p, PRESETS[study.accuracy])
        rows = [(predicted[tests, targets] - measured) * weight]
        rows += [(jnp.ravel(tree[n]) - one.mean) / one.sd for n, one in priors.items()]
        return jnp.concatenate(rows)

    return residual, start

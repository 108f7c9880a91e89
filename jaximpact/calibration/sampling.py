r"""Draws of the posterior by NUTS (Hoffman and Gelman 2014), with blackjax.

The density is that of `draws`: e^{-cost / s^2}, uniform in x between the bounds where
there is no prior, with the sigmas of the fit. It is sampled in y, without bounds,

$$ x = x_{low} + (x_{high} - x_{low}) / (1 + e^{-y}) , $$

from draws weighted by what they cost, whose covariance is the first mass matrix.

Impacts have the accuracy that the draws were found to need. What is sampled is the
density at that accuracy, whatever the errors of its gradient: a leapfrog step with any
force that depends on the place alone can be taken back and keeps volumes, and what is
taken is judged by the density. A wrong gradient costs steps, not truth. The error of
the density is looked for again in the samples.

The library wants a function of JAX. Value and gradient come from machine code through a
callback to the host, all chains at once: a call of some ms, beside which the way there
and back is nothing. In XLA the same takes a hundred times as long, and half a minute to
compile (docs/calibration.md).

Needs the extra `jaximpact[bayes]`.
"""

import importlib.util
import time
import warnings
from typing import TYPE_CHECKING, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from scipy.special import expit, logit

from ..accuracy import Accuracy
from ..errors import InputError
from ..formats.columns import RESULT_COLUMNS, columns_of
from ..formats.provenance import version_of, versions
from .draws import CHECKED, ROUGH, Draws, draw, error_of_costs
from .least_squares import Progress
from .losses import losses
from .objective import Objective
from .study import VariantResult

if TYPE_CHECKING:
    import arviz

EXTRA = "bayes"
CHAINS, WARMUP, KEPT = 4, 200, 500
KEEP_MASS = 25.0
"""Draws that the first mass matrix counts as, against those of the warm-up."""
MOST_DOUBLINGS = 8
EDGE = 1e-6
"""Part of the range that draws keep from the bounds, where y ends."""
TALK_EVERY = 0.5
"""Seconds."""


class Samples(NamedTuple):
    """The chains, after the warm-up."""

    names: list[str]
    """Of the unknowns."""
    values: np.ndarray
    """In the units of the columns, `(chains, draws, unknowns)`."""
    x: np.ndarray
    """Likewise, in the coordinates of the fit."""
    log_density: np.ndarray
    """`(chains, draws)`, up to a constant."""
    divergent: np.ndarray
    """Likewise: whether the integration ran off, as it does at a jump of an outcome."""
    acceptance: np.ndarray
    """Likewise: mean chance of being taken along the trajectory."""
    steps: np.ndarray
    """Likewise: of the trajectory."""
    scale_reduction: np.ndarray
    """R-hat of each unknown: 1 where the chains agree, above 1.01 draw more."""
    effective: np.ndarray
    """Independent draws that they are worth, for each unknown."""
    evaluations: int
    """Of the density and its gradient, warm-up included, all chains counting as one."""
    seconds: float
    accuracy: Accuracy
    """Of the impacts."""
    error: float
    """Largest error found of the logarithm of the density: of some of the draws,
    computed again, closer."""

    @property
    def rough(self) -> bool:
        """Whether that is too much."""
        return self.error > ROUGH


def sample_posterior(
    fitted: VariantResult,
    *,
    chains: int = CHAINS,
    warmup: int = WARMUP,
    count: int = KEPT,
    seed: int = 0,
    draws: Draws | None = None,
    progress: Progress = lambda text: None,
) -> Samples:
    """Sample the posterior of a fit.

    Args:
        fitted: a variant of a study, from `fit_study`.
        chains: side by side.
        warmup: draws of each that are thrown away; step and mass matrix adapt to them.
        count: draws of each that are kept.
        seed: of all that is random.
        draws: from `draw`, to start from; made if not given.
        progress: called with lines of text.

    The same numbers, on the same machine, for the same arguments.

    Raises InputError without the extra, or where there is no machine code.
    """
    check_extra()
    import blackjax
    from blackjax.diagnostics import (
        effective_sample_size,
        potential_scale_reduction,
    )

    inflation = fitted.uncertainty.inflation
    if fitted.objective.engine.kernel is None:
        raise InputError("sampling needs machine code, which these laws have not")
    begin = time.perf_counter()
    draws = draws or draw(
        fitted.objective, fitted.points, inflation, seed=seed, progress=progress
    )
    objective = fitted.objective.at(draws.accuracy)
    host = _Host(objective, inflation, progress, chains * (warmup + count))
    log_density = _as_function(host, len(fitted.names))
    random = np.random.default_rng(seed)
    chosen = random.choice(len(draws.x), chains, p=draws.weights)
    y = _y(objective, draws.x)
    apart = y - draws.weights @ y
    mass = (apart.T * draws.weights) @ apart
    mass = mass + 1e-9 * np.trace(mass) * np.eye(len(mass))
    key_warmup, key = jax.random.split(jax.random.key(seed))
    adaptation = blackjax.window_adaptation(
        blackjax.nuts,
        log_density,
        is_mass_matrix_diagonal=False,
        initial_inverse_mass_matrix=jnp.asarray(mass),
        imm_shrinkage_to_previous=KEEP_MASS,
        initial_step_size=0.5,
        max_num_doublings=MOST_DOUBLINGS,
        adaptation_info_fn=lambda *_: None,
    )

    @jax.jit
    @jax.vmap
    def warm(key, position):
        (state, found), _ = adaptation.run(key, position, num_steps=warmup)
        return state, found["step_size"], found["inverse_mass_matrix"]

    kernel = blackjax.nuts.build_kernel()

    @jax.jit
    @jax.vmap
    def step(key, state, step_size, mass):
        return kernel(
            key, state, log_density, step_size, mass, max_num_doublings=MOST_DOUBLINGS
        )

    state, step_size, mass = warm(
        jax.random.split(key_warmup, chains), jnp.asarray(y[chosen])
    )
    jax.block_until_ready(state)
    host.check()
    rows = []
    for number in range(count):
        keys = jax.random.split(jax.random.fold_in(key, number), chains)
        state, info = step(keys, state, step_size, mass)
        rows.append(
            jax.device_get(
                (
                    state.position,
                    state.logdensity,
                    info.is_divergent,
                    info.acceptance_rate,
                    info.num_integration_steps,
                )
            )
        )
        host.check()
        host.kept = number + 1
    position, *others = (np.stack(part, axis=1) for part in zip(*rows, strict=True))
    x = _x(objective, position)
    progress("sampling: some of the draws again, closer")
    every = -(-chains * count // CHECKED)
    chosen = x.reshape(-1, x.shape[-1])[::every]
    return Samples(
        fitted.names,
        objective.bounds.parameter(x),
        x,
        *others,
        scale_reduction=np.atleast_1d(potential_scale_reduction(jnp.asarray(x))),
        effective=np.atleast_1d(effective_sample_size(jnp.asarray(x))),
        evaluations=host.calls,
        seconds=time.perf_counter() - begin,
        accuracy=objective.accuracy,
        error=error_of_costs(
            objective, chosen, objective.values(chosen).cost, inflation
        ),
    )


def check_extra() -> None:
    """Raise InputError unless the extra is installed."""
    for package in ("blackjax", "arviz"):
        if importlib.util.find_spec(package) is None:
            raise InputError(
                f"sampling needs {package}: pip install 'jaximpact[{EXTRA}]'"
            )


def _y(objective: Objective, x: np.ndarray) -> np.ndarray:
    return logit(np.clip(objective.bounds.part(x), EDGE, 1.0 - EDGE))


def _x(objective: Objective, y: np.ndarray) -> np.ndarray:
    return objective.bounds.at_part(expit(y))


class _Host:
    """Density and gradient in y, for NumPy."""

    def __init__(self, objective, inflation, progress, wanted):
        self.objective, self.inflation = objective, inflation
        self.progress, self.wanted = progress, wanted
        self.calls, self.kept, self.talked = 0, 0, 0.0
        self.raised: BaseException | None = None

    def __call__(self, y: np.ndarray):
        """Of one chain `(unknowns,)`, or of chains `(chains, unknowns)`."""
        y = np.asarray(y)
        if self.raised is None:
            try:
                return self._evaluate(y)
            except BaseException as error:  # Ctrl-C too
                # Raised here it would come out of JAX as another one.
                self.raised = error
        # Such a trajectory diverges, and all is soon at its end.
        return np.full(y.shape[:-1], -np.inf), np.zeros(y.shape)

    def check(self) -> None:
        """Raise what was raised in a callback."""
        if self.raised is not None:
            raise self.raised

    def _evaluate(self, y: np.ndarray):
        part = expit(np.atleast_2d(y))
        bounds = self.objective.bounds
        points = self.objective(bounds.at_part(part))
        slope = (bounds.high - bounds.low) * part * (1.0 - part)
        value = -points.cost / self.inflation + np.sum(
            np.log(np.maximum(part * (1.0 - part), 1e-300)), axis=1
        )
        gradient = -points.gradient / self.inflation * slope + 1.0 - 2.0 * part
        self.calls += 1
        now = time.monotonic()
        if now - self.talked > TALK_EVERY:
            self.talked = now
            self.progress(f"sampling: draw {self.kept}, density {self.calls} times")
        return value.reshape(y.shape[:-1]), gradient.reshape(y.shape)


def _as_function(host: _Host, size: int):
    """The host's density as a function of JAX."""
    shapes = (
        jax.ShapeDtypeStruct((), jnp.float64),
        jax.ShapeDtypeStruct((size,), jnp.float64),
    )

    def both(y):
        return jax.pure_callback(host, shapes, y, vmap_method="broadcast_all")

    @jax.custom_vjp
    def log_density(y):
        return both(y)[0]

    log_density.defvjp(both, lambda gradient, change: (change * gradient,))
    return log_density


def to_inference_data(
    fitted: VariantResult, samples: Samples, *, seed: int = 0
) -> "arviz.InferenceData":
    """The chains for ArviZ: posterior, what it predicts of every measurement, and how
    probable each is (for `arviz.loo`).

    Variables `measured` of posterior_predictive, log_likelihood and observed_data have
    the dimension `measurement`, named by test and target, with its `unit` beside it;
    limits are left out of them. Parameters have theirs as the attribute `units`.

    Args:
        seed: of the scatter of what is predicted.
    """
    check_extra()
    with warnings.catch_warnings():
        # It announces its next version whenever it is imported.
        warnings.simplefilter("ignore", FutureWarning)
        import arviz

    objective = fitted.objective.at(samples.accuracy)
    study = objective.study
    tests, places = np.nonzero(study.known & (study.censored == 0))
    names = [
        f"{study.tests.name(test)}: {study.targets[place]}"
        for test, place in zip(tests, places, strict=True)
    ]
    chains, count, size = samples.x.shape
    x = samples.x.reshape(-1, size)
    predicted = objective.values(x).predicted[:, tests, places]
    sigma = objective.sigma[tests, places] * np.sqrt(fitted.uncertainty.inflation)
    measured = study.measured[tests, places]
    scatter = np.random.default_rng(seed).normal(size=predicted.shape)
    u = (predicted - measured) / sigma
    loss = losses(u, np.zeros(u.shape, int), study.loss).value
    shape = chains, count, len(names)
    data = arviz.from_dict(
        posterior={
            name: samples.values[:, :, place]
            for place, name in enumerate(samples.names)
        },
        posterior_predictive={"measured": (predicted + sigma * scatter).reshape(shape)},
        log_likelihood={
            "measured": (-loss - np.log(sigma * np.sqrt(2.0 * np.pi))).reshape(shape)
        },
        sample_stats={
            "lp": samples.log_density,
            "diverging": samples.divergent,
            "acceptance_rate": samples.acceptance,
            "n_steps": samples.steps,
        },
        observed_data={"measured": measured},
        coords={"measurement": names},
        dims={"measured": ["measurement"]},
        attrs={
            "title": study.title,
            "accuracy": samples.accuracy.name,
            "error_of_log_density": samples.error,
            "inference_library": "blackjax",
            "inference_library_version": version_of("blackjax"),
            **{f"version_of_{name}": found for name, found in versions().items()},
        },
    )
    for name, unit in zip(samples.names, _units(objective), strict=True):
        data.posterior[name].attrs["units"] = unit
    of_target = [RESULT_COLUMNS[study.targets[place]].unit for place in places]
    data.assign_coords(
        unit=("measurement", of_target),
        groups=["posterior_predictive", "log_likelihood", "observed_data"],
        inplace=True,
    )
    return data


def _units(objective: Objective) -> list[str]:
    """Of the unknowns."""
    study, known = objective.study, columns_of(objective.scene)
    columns = [parameter.name for parameter in study.parameters]
    for nuisance in study.nuisances:
        columns += [nuisance.name] * len(nuisance.groups)
    return [known[name].unit for name in columns]

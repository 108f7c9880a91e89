r"""Sampling of the posterior by NUTS (Hoffman and Gelman 2014), with blackjax.

The density is that of `importance_sampling`: e^{-cost / s^2}, uniform in x between the
bounds where there is no prior, with the sigmas of the fit. It is sampled in y, without
bounds,

$$ x = x_{low} + (x_{high} - x_{low}) / (1 + e^{-y}) , $$

starting from the weighted draws, whose covariance is the first mass matrix.

Impacts have the accuracy that the draws were found to need. The density sampled is that
of this accuracy, whatever the errors of its gradient: a leapfrog step with any force
that depends on the position alone is reversible and preserves volume, and acceptance is
decided by the density. A wrong gradient costs steps, not correctness. The error of the
density is checked again on the samples.

blackjax needs a function of JAX. Value and gradient come from machine code through a
callback to the host, all chains at once: a call of some ms, against which the callback
is negligible. In XLA the same takes a hundred times as long, and half a minute to
compile (docs/calibration.md).

Needs the extra `jaximpact[bayes]`.
"""

import importlib.util
import time
import warnings
from typing import TYPE_CHECKING, Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from scipy.special import expit, logit

from ..._packages import version_of, versions
from ...accuracy import Accuracy
from ...errors import InputError
from ...progress import Progress, ProgressFunction, as_progress
from ...quantities import TARGET_COLUMNS, columns_of
from ..problem.noise import losses
from ..problem.objective import Objective
from .importance_sampling import CHECKED, ROUGH, Draws, draw, error_of_costs
from .results import VariantResult

if TYPE_CHECKING:
    import arviz  # pyright: ignore[reportMissingImports]

EXTRA = "bayes"
"""Extra that holds arviz and blackjax, which pyright may not find."""
CHAINS, WARMUP, KEPT = 4, 200, 500
KEEP_MASS = 25.0
"""Weight of the first mass matrix against draws of the warm-up."""
MOST_DOUBLINGS = 8
EDGE = 1e-6
"""Least distance of draws from the bounds, as a fraction of the range."""
TALK_EVERY = 0.5
"""Time between lines of progress [s]."""
SHIFT = 0.25
"""Tolerated distance of the posterior mean from the best fit, in standard errors."""
RATIO = 1.25
"""Tolerated ratio of posterior standard deviation and standard error, either way."""
CHANCE = 3.0
"""Standard deviations of its noise within which a difference is due to chance."""


class Samples(NamedTuple):
    """Chains of NUTS after the warm-up."""

    names: list[str]
    """Names of the unknowns."""
    values: np.ndarray
    """Unknowns in the units of their columns, shape (chains, draws, unknowns)."""
    x: np.ndarray
    """The same in the coordinates of the fit."""
    log_density: np.ndarray
    """Logarithm of the density up to a constant, shape (chains, draws)."""
    divergent: np.ndarray
    """Mask of divergent trajectories, as at discontinuities, shape (chains, draws)."""
    acceptance: np.ndarray
    """Mean acceptance probability of each trajectory, shape (chains, draws)."""
    steps: np.ndarray
    """Number of leapfrog steps of each trajectory, shape (chains, draws)."""
    scale_reduction: np.ndarray
    """R-hat of each unknown, shape (unknowns,): near 1 where the chains agree."""
    effective: np.ndarray
    """Effective sample size of each unknown, shape (unknowns,)."""
    evaluations: int
    """Number of evaluations of density and gradient by all chains together, warm-up
    included."""
    seconds: float
    """Wall time [s]."""
    accuracy: Accuracy
    """Accuracy of the impacts."""
    error: float
    """Largest error of the logarithm of the density, on draws computed again."""

    @property
    def rough(self) -> bool:
        """Whether that error is too large."""
        return self.error > ROUGH


def sample_posterior(
    fitted: VariantResult,
    *,
    chains: int = CHAINS,
    warmup: int = WARMUP,
    count: int = KEPT,
    seed: int = 0,
    draws: Draws | None = None,
    progress: Progress | ProgressFunction | None = None,
) -> Samples:
    """Sample the posterior of a fit by NUTS.

    Args:
        fitted: a variant of a study, from `fit_study`.
        chains: number of chains, side by side.
        warmup: discarded draws of each chain; step size and mass matrix adapt to them.
        count: kept draws of each chain.
        seed: seed of the random numbers.
        draws: draws of `importance_sampling.draw` to start from; made if not given.
        progress: called with lines of text.

    Equal arguments give equal numbers on one machine.

    Raises InputError without the extra, or where there is no machine code.
    """
    check_extra()
    from blackjax import diagnostics  # pyright: ignore[reportMissingImports]

    progress = as_progress(progress)
    inflation = fitted.uncertainty.inflation
    if fitted.objective.engine.kernel is None:
        raise InputError("sampling needs machine code, which these laws have not")
    begin = time.perf_counter()
    draws = draws or draw(
        fitted.objective, fitted.points, inflation, seed=seed, progress=progress
    )
    objective = fitted.objective.at(draws.accuracy)
    host = _Host(objective, inflation, progress, chains * (warmup + count))
    rows = _run_chains(host, draws, len(fitted.names), chains, warmup, count, seed)
    position, *others = (np.stack(part, axis=1) for part in zip(*rows, strict=True))
    x = objective.bounds.at_fraction(expit(position))
    progress("sampling: some of the draws again, more accurately")
    every = -(-chains * count // CHECKED)
    chosen = x.reshape(-1, x.shape[-1])[::every]
    return Samples(
        fitted.names,
        objective.bounds.parameter(x),
        x,
        *others,
        scale_reduction=np.atleast_1d(
            diagnostics.potential_scale_reduction(jnp.asarray(x))
        ),
        effective=np.atleast_1d(diagnostics.effective_sample_size(jnp.asarray(x))),
        evaluations=host.calls,
        seconds=time.perf_counter() - begin,
        accuracy=objective.accuracy,
        error=error_of_costs(
            objective, chosen, objective.values(chosen).cost, inflation
        ),
    )


def _run_chains(
    host: "_Host",
    draws: Draws,
    size: int,
    chains: int,
    warmup: int,
    count: int,
    seed: int,
) -> list[tuple]:
    """Adapt and run the chains; position, log density, divergence, acceptance and
    number of steps of each draw."""
    import blackjax  # pyright: ignore[reportMissingImports]

    log_density = _as_function(host, size)
    chosen = np.random.default_rng(seed).choice(len(draws.x), chains, p=draws.weights)
    y = _unbounded(host.objective, draws.x)
    apart = y - draws.weights @ y
    mass = (apart.T * draws.weights) @ apart
    mass = mass + 1e-9 * np.trace(mass) * np.eye(len(mass))
    key_warmup, key = jax.random.split(jax.random.key(seed))
    # Their types are made at run time, where pyright does not see them.
    adaptation: Any = blackjax.window_adaptation(
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
        row = (state.position, state.logdensity, info.is_divergent)
        row += (info.acceptance_rate, info.num_integration_steps)
        rows.append(jax.device_get(row))
        host.check()
        host.kept = number + 1
    return rows


def check_extra() -> None:
    """Raise InputError unless the extra is installed."""
    for package in ("blackjax", "arviz"):
        if importlib.util.find_spec(package) is None:
            raise InputError(
                f"sampling needs {package}: pip install 'jaximpact[{EXTRA}]'"
            )


def _unbounded(objective: Objective, x: np.ndarray) -> np.ndarray:
    """Convert x to y."""
    return logit(np.clip(objective.bounds.fraction(x), EDGE, 1.0 - EDGE))


class _Host:
    """Density and gradient in y, computed by NumPy and machine code."""

    def __init__(self, objective, inflation, progress, wanted):
        self.objective, self.inflation = objective, inflation
        self.progress, self.wanted = progress, wanted
        self.calls, self.kept, self.talked = 0, 0, 0.0
        self.raised: BaseException | None = None

    def __call__(self, y: np.ndarray):
        """Evaluate one chain (unknowns,) or several (chains, unknowns)."""
        y = np.asarray(y)
        if self.raised is None:
            try:
                return self._evaluate(y)
            except BaseException as error:  # Ctrl-C too
                # Raised here it would leave JAX as another exception.
                self.raised = error
        # Such a trajectory diverges, and sampling ends soon.
        return np.full(y.shape[:-1], -np.inf), np.zeros(y.shape)

    def check(self) -> None:
        """Raise the exception of a callback, if there was one."""
        if self.raised is not None:
            raise self.raised

    def _evaluate(self, y: np.ndarray):
        part = expit(np.atleast_2d(y))
        bounds = self.objective.bounds
        points = self.objective(bounds.at_fraction(part))
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
    """Wrap the host's density as a function of JAX with a gradient."""
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
    """Convert the chains for ArviZ: posterior, posterior predictive, log likelihood.

    Variables `measured` of posterior_predictive, log_likelihood and observed_data have
    the dimension `measurement`, named by test and target, with the coordinate `unit`;
    limits are left out. Parameters have the attribute `units`.

    Args:
        seed: seed of the scatter of the posterior predictive.
    """
    check_extra()
    with warnings.catch_warnings():
        # ArviZ announces its next version whenever it is imported.
        warnings.simplefilter("ignore", FutureWarning)
        import arviz  # pyright: ignore[reportMissingImports]

    objective = fitted.objective.at(samples.accuracy)
    study = objective.study
    tests, targets = np.nonzero(study.known & (study.censored == 0))
    names = [
        f"{study.tests.name(test)}: {study.targets[target]}"
        for test, target in zip(tests, targets, strict=True)
    ]
    predictive, log_likelihood = _predictive(fitted, objective, samples, seed)
    sample_stats = {
        "lp": samples.log_density,
        "diverging": samples.divergent,
        "acceptance_rate": samples.acceptance,
        "n_steps": samples.steps,
    }
    data: Any = arviz.from_dict(
        posterior={
            name: samples.values[:, :, index]
            for index, name in enumerate(samples.names)
        },
        posterior_predictive={"measured": predictive},
        log_likelihood={"measured": log_likelihood},
        sample_stats=sample_stats,
        observed_data={"measured": study.measured[tests, targets]},
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
    known = columns_of(objective.scene)
    columns = [parameter.name for parameter in study.parameters]
    for nuisance in study.nuisances:
        columns += [nuisance.name] * len(nuisance.groups)
    for name, column in zip(samples.names, columns, strict=True):
        data.posterior[name].attrs["units"] = known[column].unit
    units = [TARGET_COLUMNS[study.targets[target]].unit for target in targets]
    data.assign_coords(
        unit=("measurement", units),
        groups=["posterior_predictive", "log_likelihood", "observed_data"],
        inplace=True,
    )
    return data


def _predictive(fitted: VariantResult, objective: Objective, samples: Samples, seed):
    """Sample the measurements that the chains predict, and compute the log likelihood
    of those made, both of shape (chains, draws, measurements)."""
    study = objective.study
    tests, targets = np.nonzero(study.known & (study.censored == 0))
    chains, count, size = samples.x.shape
    predicted = objective.values(samples.x.reshape(-1, size)).predicted
    predicted = predicted[:, tests, targets]
    sigma = objective.sigma[tests, targets] * np.sqrt(fitted.uncertainty.inflation)
    scatter = np.random.default_rng(seed).normal(size=predicted.shape)
    u = (predicted - study.measured[tests, targets]) / sigma
    loss = losses(u, np.zeros(u.shape, int), study.loss).value
    log_likelihood = -loss - np.log(sigma * np.sqrt(2.0 * np.pi))
    shape = chains, count, len(tests)
    return (predicted + sigma * scatter).reshape(shape), log_likelihood.reshape(shape)


def compare_errors(fitted: VariantResult, draws: Draws, samples: Samples) -> list[str]:
    """Compare standard errors, draws and NUTS of each parameter, and say which to use.

    All in x. The mean of n independent draws of standard deviation s has the error s /
    sqrt(n), their standard deviation the relative error 1 / sqrt(2 n), if normal.
    """
    count = len(fitted.verdicts)
    names = np.array(samples.names[:count])
    flat = samples.x.reshape(-1, samples.x.shape[-1])[:, :count]
    mean, deviation = np.mean(flat, axis=0), np.std(flat, axis=0)
    effective = samples.effective[:count]
    error = fitted.uncertainty.standard_errors[:count]
    best = fitted.points.x[0][:count]
    drawn = draws.effective_fraction[-1] * len(draws.x)
    noise = deviation * np.sqrt(1.0 / effective + 1.0 / drawn)
    differ = np.abs(mean - draws.mean()[:count]) > CHANCE * noise
    shift = np.abs(mean - best) / error
    allowed = SHIFT + CHANCE * deviation / (error * np.sqrt(effective))
    ratio = deviation / error
    widest = RATIO * (1.0 + CHANCE / np.sqrt(2.0 * effective))
    skew = (shift > allowed) | (np.maximum(ratio, 1.0 / ratio) > widest)
    known = np.array([verdict.determined for verdict in fitted.verdicts])
    lines = []
    if np.any(differ):
        lines.append(
            "Draws and NUTS differ by more than chance in "
            f"{', '.join(names[differ])}: one of them has not explored the whole "
            "posterior. Use neither, and sample more."
        )
    if np.any(~known):
        lines.append(
            f"Not identifiable: {', '.join(names[~known])}. There is no standard error "
            "to compare; the bounds truncate the posterior. Rely on the verdict, not "
            "on a mean."
        )
    skew &= known & ~differ
    for index in np.flatnonzero(skew):
        lines.append(
            f"{names[index]}: the posterior mean is {shift[index]:.2g} standard errors "
            "from the best fit, and the posterior standard deviation "
            f"{ratio[index]:.2g} standard errors. Use the posterior, not the standard "
            "error."
        )
    alike = known & ~(differ | skew)
    if np.any(alike):
        lines.append(
            f"Standard errors, draws and NUTS agree on {', '.join(names[alike])}, "
            f"within the noise of {np.min(effective[alike]):.0f} independent draws."
        )
    return lines

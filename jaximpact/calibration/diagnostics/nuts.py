r"""Sampling of the posterior by NUTS (Hoffman and Gelman 2014), with blackjax.

The density is that of `importance_sampling`, with the sigmas of the fit. It is sampled
in y, without bounds,

$$ x = x_{low} + (x_{high} - x_{low}) / (1 + e^{-y}) , $$

starting from the weighted draws, whose covariance is the first mass matrix.

Impacts have the accuracy that the draws were found to need. The density sampled is that
of this accuracy, whatever the errors of its gradient: a leapfrog step with any force
that depends on the position alone is reversible and preserves volume, and acceptance is
decided by the density. A wrong gradient costs steps, not correctness. The error of the
density is checked again on the samples.

Needs the extra `jaximpact[bayes]`.
"""

import importlib.util
import time
import warnings
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import jax
import jax.numpy as jnp
import numpy as np
from scipy.special import logit

from ..._jax_internals import namespace_of
from ..._packages import version_of, versions
from ...errors import InputError
from ...progress import Progress, ProgressFunction, reporting_to, tell, within
from ...quantities import TARGET_COLUMNS, columns_of
from ..problem.forward_model import XLA
from ..problem.noise import losses
from .importance_sampling import draw, error_of_costs
from .posterior import Chains, Draws, moments
from .results import VariantResult

if TYPE_CHECKING:
    import arviz  # pyright: ignore[reportMissingImports]

STATISTICS = "lp", "diverging", "acceptance_rate", "n_steps"
MOST_DOUBLINGS = 8
"""Doublings of a trajectory: at most 255 leapfrog steps."""
CHANCE = 3.0
"""Standard deviations of its noise within which a difference is due to chance."""


def sample_posterior(
    fitted: VariantResult,
    *,
    chains: int = 4,
    warmup: int = 200,
    count: int = 500,
    seed: int = 0,
    draws: Draws | None = None,
    progress: Progress | ProgressFunction | None = None,
) -> Draws:
    """Sample the posterior of a fit by NUTS.

    Args:
        fitted: a variant of a study, from `fit_study`.
        chains: number of chains, side by side.
        warmup: discarded draws of each chain; step size and mass matrix adapt to them.
        count: kept draws of each chain.
        seed: seed of the random numbers.
        draws: draws of `importance_sampling.draw` to start from; made if not given.

    Equal arguments give equal numbers on one machine.

    Raises InputError without the extra, or where there is no machine code.
    """
    check_extra()
    inflation = fitted.uncertainty.inflation
    if fitted.objective.model.engine == XLA:
        raise InputError("sampling needs machine code, which these laws have not")
    with reporting_to(progress):
        begin = time.perf_counter()
        at_best = fitted.objective, fitted.points, inflation
        draws = draws or draw(*at_best, seed=seed)
        objective = fitted.objective.at(draws.accuracy)
        bounds = objective.bounds

        def unknowns(y):
            return bounds.at_fraction(1.0 / (1.0 + namespace_of(y).exp(-y)))

        def log_density(y: jax.Array) -> jax.Array:
            # The logarithm of dx/dy, up to a constant.
            slope = jax.nn.log_sigmoid(y) + jax.nn.log_sigmoid(-y)
            x = unknowns(y)
            density = objective.log_density(x, objective.cost(x), inflation)
            return jnp.sum(slope) + density

        # Draws at a bound would be at infinity.
        y = logit(np.clip(bounds.fraction(draws.x), 1e-6, 1.0 - 1e-6))
        chosen = np.random.default_rng(seed).choice(len(y), chains, p=draws.weights)
        position, statistics = _run_chains(
            log_density,
            y[chosen],
            moments(y, draws.weights)[1],
            warmup=warmup,
            count=count,
            seed=seed,
        )
        sampled, arviz = unknowns(position), _arviz()
        scale_reduction, effective = (
            np.array([float(of_one(x)) for x in np.moveaxis(sampled, -1, 0)])
            for of_one in (arviz.rhat, arviz.ess)
        )
        x = sampled.reshape(chains * count, -1)
        with within("sampled: "):
            points = objective.values(x)
        every = slice(None, None, -(-len(x) // 64))
        error = error_of_costs(objective, x[every], points.cost[every], inflation)
        return Draws(
            x=x,
            log_weights=np.zeros(len(x)),
            cost=points.cost,
            predicted=points.predicted,
            effective_fraction=np.minimum(1.0, [np.min(effective) / len(x)]),
            accuracy=objective.accuracy,
            error=error,
            chains=Chains(
                statistics, scale_reduction, effective, time.perf_counter() - begin
            ),
        )


@within("sampling: ")
def _run_chains(
    log_density: Callable[[jax.Array], jax.Array],
    start: np.ndarray,
    mass: np.ndarray,
    *,
    warmup: int,
    count: int,
    seed: int,
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Adapt and run chains from points, shape (chains, unknowns), with a first inverse
    mass matrix: positions, shape (chains, draws, unknowns), and the statistics of
    `Chains`."""
    import blackjax  # pyright: ignore[reportMissingImports]

    chains = len(start)
    mass = mass + 1e-9 * np.trace(mass) * np.eye(len(mass))
    key_warmup, key = jax.random.split(jax.random.key(seed))
    # Their types are made at run time, where pyright does not see them.
    adaptation: Any = blackjax.window_adaptation(
        blackjax.nuts,
        log_density,
        is_mass_matrix_diagonal=False,
        initial_inverse_mass_matrix=jnp.asarray(mass),
        # In draws of the warm-up: the first matrix counts as much as 25 of them.
        imm_shrinkage_to_previous=25.0,
        initial_step_size=0.5,
        max_num_doublings=MOST_DOUBLINGS,
        adaptation_info_fn=lambda *_: None,
    )

    @jax.jit
    @jax.vmap
    def warm(key, position):
        (state, tuned), _ = adaptation.run(key, position, num_steps=warmup)
        return state, tuned["step_size"], tuned["inverse_mass_matrix"]

    kernel = blackjax.nuts.build_kernel()

    @jax.jit
    @jax.vmap
    def step(key, state, step_size, mass):
        return kernel(
            key, state, log_density, step_size, mass, max_num_doublings=MOST_DOUBLINGS
        )

    tell(f"warm-up of {warmup} draws")
    state, *adapted = warm(jax.random.split(key_warmup, chains), jnp.asarray(start))
    rows = []
    for number in range(count):
        tell(f"draw {number + 1} of {count}")
        keys = jax.random.split(jax.random.fold_in(key, number), chains)
        state, info = step(keys, state, *adapted)
        row = (state.position, state.logdensity, info.is_divergent)
        row += (info.acceptance_rate, info.num_integration_steps)
        rows.append(jax.device_get(row))
    position, *each = (np.stack(part, axis=1) for part in zip(*rows, strict=True))
    return position, dict(zip(STATISTICS, each, strict=True))


def check_extra() -> None:
    """Raise InputError unless the extra is installed."""
    for name in ("blackjax", "arviz"):
        if importlib.util.find_spec(name) is None:
            raise InputError(f"sampling needs {name}: pip install 'jaximpact[bayes]'")


def _arviz() -> Any:
    """Import ArviZ, which takes two seconds."""
    with warnings.catch_warnings():
        # It announces its next version whenever it is imported.
        warnings.simplefilter("ignore", FutureWarning)
        import arviz  # pyright: ignore[reportMissingImports]

    return arviz


def to_inference_data(
    fitted: VariantResult, samples: Draws, *, seed: int = 0
) -> "arviz.InferenceData":
    """Convert the chains for ArviZ: posterior, posterior predictive, log likelihood.

    Variables `measured` of posterior_predictive, log_likelihood and observed_data have
    the dimension `measurement`, named by test and target, with the coordinate `unit`;
    limits are left out. Parameters have the attribute `units`.

    Args:
        samples: result of `sample_posterior`.
        seed: seed of the scatter of the posterior predictive.
    """
    check_extra()
    chains = samples.chains
    if chains is None:
        raise InputError("ArviZ needs chains: the result of sample_posterior")
    objective = fitted.objective.at(samples.accuracy)
    study = objective.study
    cells = np.nonzero(study.exact)
    names = [
        f"{study.tests.name(test)}: {study.targets[target]}"
        for test, target in zip(*cells, strict=True)
    ]
    measured, predicted = study.measured[cells], samples.predicted[:, *cells]
    sigma = objective.sigma[cells] * np.sqrt(fitted.uncertainty.inflation)
    scatter = np.random.default_rng(seed).normal(size=predicted.shape)
    u = (predicted - measured) / sigma
    loss = losses(u, np.zeros(u.shape, int), study.loss).value
    log_likelihood = -loss - np.log(sigma * np.sqrt(2.0 * np.pi))
    shape = chains.statistics["lp"].shape
    parameters = objective.bounds.parameter(samples.x)
    posterior = dict(zip(fitted.names, parameters.T, strict=True))
    sampled = (predicted + sigma * scatter).reshape(*shape, -1)
    data: Any = _arviz().from_dict(
        posterior={n: values.reshape(shape) for n, values in posterior.items()},
        posterior_predictive={"measured": sampled},
        log_likelihood={"measured": log_likelihood.reshape(*shape, -1)},
        sample_stats=chains.statistics,
        observed_data={"measured": measured},
        coords={"measurement": names},
        dims={"measured": ["measurement"]},
        attrs={
            "title": study.title,
            "accuracy": samples.accuracy.name,
            "error_of_log_density": samples.error,
            "inference_library": "blackjax",
            "inference_library_version": version_of("blackjax"),
            **{f"version_of_{name}": version for name, version in versions().items()},
        },
    )
    known = columns_of(objective.scene)
    for name in fitted.names:
        data.posterior[name].attrs["units"] = known[name.split("[")[0]].unit
    units = [TARGET_COLUMNS[study.targets[target]].unit for target in cells[1]]
    data.assign_coords(
        unit=("measurement", units),
        groups=["posterior_predictive", "log_likelihood", "observed_data"],
        inplace=True,
    )
    return data


def compare_errors(fitted: VariantResult, draws: Draws, samples: Draws) -> list[str]:
    """Compare standard errors, draws and NUTS of each parameter, and say which to use.

    All in x. The mean of n independent draws of standard deviation s has the error s /
    sqrt(n), their standard deviation the relative error 1 / sqrt(2 n), if normal.
    """
    count = len(fitted.verdicts)
    names = np.array([verdict.name for verdict in fitted.verdicts])
    mean = samples.mean()[:count]
    deviation = np.sqrt(np.diag(samples.covariance())[:count])
    assert samples.chains is not None
    effective = samples.chains.effective[:count]
    error = fitted.uncertainty.standard_errors[:count]
    noise = deviation * np.sqrt(1.0 / effective + 1.0 / draws.effective)
    differ = np.abs(mean - draws.mean()[:count]) > CHANCE * noise
    shift = np.abs(mean - fitted.points.x[0][:count]) / error
    # A shift of the mean by a quarter of a standard error, and a ratio of the widths of
    # 1.25, change no conclusion.
    allowed = 0.25 + CHANCE * deviation / (error * np.sqrt(effective))
    ratio = deviation / error
    widest = 1.25 * (1.0 + CHANCE / np.sqrt(2.0 * effective))
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
    lines += [
        f"{names[index]}: the posterior mean is {shift[index]:.2g} standard errors "
        f"from the best fit, and the posterior standard deviation {ratio[index]:.2g} "
        "standard errors. Use the posterior, not the standard error."
        for index in np.flatnonzero(skew)
    ]
    alike = known & ~(differ | skew)
    if np.any(alike):
        lines.append(
            f"Standard errors, draws and NUTS agree on {', '.join(names[alike])}, "
            f"within the noise of {np.min(effective[alike]):.0f} independent draws."
        )
    return lines

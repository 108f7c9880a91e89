"""A whole study: read, fit every variant, judge, write."""

import time
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..accuracy import PRESETS
from ..batch import broadcast_scene
from ..errors import InputError
from ..laws import Laws
from ..model import PLANAR, PLANAR_DAMPED
from ..problem import Assembly
from ..scene import Scene
from ..soil import DAMPING_RATIOS, Soil, has_dashpots
from ..toml_values import SOIL_COLUMNS
from .fit import FINE, ROUGH, Fits, Progress, fit, spread_starts
from .likelihood_profile import LikelihoodProfile, profile_all
from .residuals import Case, Program
from .solver import Stepper, take
from .study_file import Study, Variant
from .transforms import Bounds
from .uncertainty import USELESS_ERROR, Uncertainty, estimate, jacobian_in_errors
from .verdict import Verdict, directions, judge_all, weakest_first

MAX_STEPS = 1000
"""Steps after which an impact of a fit counts as failed: all starts wait for the
slowest, and a soil on which an impact takes more is not the one looked for."""

LOWER_BY = 1e-3
"""A profile that finds a cost lower by more than this part starts the fit again."""


class VariantResult(NamedTuple):
    """What the fit of one variant gave; parameters in the units of their columns."""

    variant: Variant
    bounds: Bounds
    parameters: np.ndarray
    """At the best fit."""
    cost: float
    predicted: np.ndarray
    """`(tests, targets)`; NaN where there is no prediction."""
    failed: int
    """How many predictions there are not."""
    uncertainty: Uncertainty
    verdicts: list[Verdict]
    directions: list[str]
    profiles: dict[str, LikelihoodProfile]
    start_parameters: np.ndarray
    """Of every start, the given one first."""
    start_costs: np.ndarray
    """Where every start ended."""
    start_reasons: list[str]
    start_steps: np.ndarray
    reason: str
    """Why the fit that is reported stopped."""


class StudyResult(NamedTuple):
    """A study and what it gave."""

    study: Study
    variants: list[VariantResult]
    seconds: float
    """Wall time of all fits, compilation included."""


def fit_study(study: Study, *, progress: Progress = lambda text: None) -> StudyResult:
    """Fit every variant of a study."""
    begin = time.perf_counter()
    soils = [soil_of(study, variant) for variant in study.variants]
    fitted = tuple(parameter.name for parameter in study.parameters)
    damped = any(map(has_dashpots, soils)) or set(fitted) & {*DAMPING_RATIOS}
    program = Program(
        Assembly(
            Laws(),
            PLANAR_DAMPED if damped else PLANAR,
            ledger=False,
            max_steps=MAX_STEPS,
        ),
        fitted,
        study.targets,
    )
    progress("compiling once")
    results = []
    for variant in study.variants:
        start = f"{variant.name}: " if len(study.variants) > 1 else ""
        results.append(
            _fit_variant(
                study,
                program,
                variant,
                lambda text, start=start: progress(start + text),
            )
        )
    return StudyResult(study, results, time.perf_counter() - begin)


def soil_of(study: Study, variant: Variant) -> Soil:
    """The fixed soil: the table's columns, else the study's values, else Table 1."""
    values = dict(study.table.numbers) | study.soil | variant.soil
    return Soil(
        **{
            column.field: column.factor * values[name]
            for name, column in SOIL_COLUMNS.items()
            if name in values
        }
    )


def case_of(study: Study, variant: Variant) -> Case:
    """The numbers of a variant's fit."""
    table = study.table.scene()
    scene = Scene(table.block, soil_of(study, variant), table.impact)
    scene, _ = broadcast_scene(scene)
    accuracy = PRESETS[study.accuracy]
    return Case(
        scene=jax.tree.map(jnp.asarray, scene),
        measured=jnp.asarray(study.measured),
        sigma=jnp.asarray(study.sigma),
        bounds=bounds_of(study),
        tolerance=jnp.asarray(accuracy.tolerance),
        floor=jnp.asarray(accuracy.floor),
    )


def bounds_of(study: Study) -> Bounds:
    """Ranges of the study's parameters."""
    return Bounds(
        lower=jnp.asarray([p.lower for p in study.parameters]),
        upper=jnp.asarray([p.upper for p in study.parameters]),
        logarithmic=jnp.asarray([p.logarithmic for p in study.parameters]),
    )


def _fit_variant(
    study: Study, program: Program, variant: Variant, progress: Progress
) -> VariantResult:
    case = case_of(study, variant)
    bounds = case.bounds
    stepper = Stepper(program, case, study.starts)
    given = [parameter.start for parameter in study.parameters]
    starts = spread_starts(bounds, given, study.starts, study.seed)
    # Starts and profiles need no more accuracy than tells costs apart.
    fast = jnp.maximum(case.tolerance, PRESETS["fast"].tolerance)
    rough = Stepper(program, case._replace(tolerance=fast), study.starts)
    screened = fit(
        rough,
        starts,
        method=study.method,
        patience=ROUGH,
        progress=progress,
    )
    if not np.any(np.isfinite(screened.cost)):
        raise InputError("no start gives a finite cost", file=study.path)

    def refine(z) -> Fits:
        return fit(
            stepper,
            np.asarray(z)[None],
            patience=FINE,
            progress=lambda text: progress(f"refining, {text}"),
        )

    best = refine(screened.lanes.z[screened.best])
    uncertainty = _uncertainty(study, bounds, best)
    profiles: dict[str, LikelihoodProfile] = {}
    for found in profile_all(
        rough,
        _to_be_profiled(bounds, best, uncertainty),
        best.lanes.z[0],
        uncertainty.variance,
        progress,
    ):
        profiles[found.name] = found
    lowest = min(profiles.values(), key=lambda found: found.lowest_cost)
    if lowest.lowest_cost < (1.0 - LOWER_BY) * lowest.best_cost:
        best = refine(lowest.lowest_z)
        uncertainty = _uncertainty(study, bounds, best)
    lane = take(best.lanes, 0)
    parameters = np.asarray(bounds.parameter(jnp.asarray(lane.z)))
    predicted = study.measured + study.sigma * lane.residuals.reshape(
        study.measured.shape
    )
    predicted = np.where(lane.failed.reshape(predicted.shape) > 0.0, np.nan, predicted)
    return VariantResult(
        variant=variant,
        bounds=bounds,
        parameters=parameters,
        cost=float(best.cost[0]),
        predicted=predicted,
        failed=int(np.sum(lane.failed)),
        uncertainty=uncertainty,
        verdicts=judge_all(program.fitted, parameters, bounds, uncertainty, profiles),
        directions=directions(program.fitted, bounds, uncertainty),
        profiles=profiles,
        start_parameters=np.asarray(jax.vmap(bounds.parameter)(jnp.asarray(starts))),
        start_costs=screened.cost,
        start_reasons=[reason.value for reason in screened.reasons],
        start_steps=screened.steps,
        reason=best.reasons[0].value,
    )


def _uncertainty(study: Study, bounds: Bounds, best: Fits) -> Uncertainty:
    lane = take(best.lanes, 0)
    return estimate(
        lane.residuals,
        lane.failed,
        jacobian_in_errors(bounds, lane.z, lane.jacobian),
        sigma_given=study.sigma_given,
    )


DOUBTFUL_ERROR = 0.3 * USELESS_ERROR
"""A standard error above this is looked into by a profile."""


def _to_be_profiled(bounds: Bounds, best: Fits, uncertainty: Uncertainty) -> list[int]:
    """The weakest parameter, and all others that may not be determined."""
    parameters = bounds.parameter(jnp.asarray(best.lanes.z[0]))
    order = weakest_first(bounds, parameters, uncertainty)
    reached = bounds.bound_reached(parameters)
    return [
        place
        for rank, place in enumerate(order)
        if rank == 0
        or reached[place]
        or uncertainty.standard_errors[place] > DOUBTFUL_ERROR
    ]

"""Derivatives of trajectories with respect to blocks, ground and releases."""

import dataclasses
import functools
import json
from collections.abc import Callable, Iterable

import jax.numpy as jnp
import numpy as np
import xarray as xr

from ..._numpy_settings import numpy_settings
from ..._packages import versions
from ..._precision import require_float64
from ...accuracy import Accuracy, get_accuracy
from ...errors import InputError
from ...identity import part_names
from ...parameters import Composite, parts_of
from ...progress import Progress, ProgressFunction, as_progress
from ..blocks import Release
from ..contacts.contact_models import ClosedForm, Contacts, FullModel
from ..flight.placement import check_release
from ..scheduler import checked_limits
from ..state import EVENT_LIMIT, HOP_THRESHOLD, TIME_LIMIT, Limits
from ..terrain import Ground, Profile
from ..trajectory import Ending, Runs, RunTangents
from .comparison import (
    AGREES_WITHIN,
    STEPS,
    Attempt,
    Comparison,
    Judgement,
    Standing,
    all_attempts,
    judge,
)
from .outputs import chosen_outputs, follow_case, outputs_of
from .parameters import Case, Parameter, chosen_parameters

DEFAULT_PARAMETERS = ("c_v", "gamma_v", "k_E")
DEFAULT_OUTPUTS = ("x_m", "time_s", "max_height_m")
QUICK = FullModel(Accuracy("derivatives", 2e-6, 1e-2))
"""Default contacts."""
QUICK_STEPS = {1e-3: 2e-7, 1e-4: 1e-8}
"""Steps by which their derivatives are compared, and tolerances of the contacts of the
differences: errors are divided by the step."""
EXACT = FullModel("reference")
"""Default contacts of blocks whose derivatives that does not confirm."""


@numpy_settings()
def runout_gradients(
    profile: Profile,
    release: Release,
    contacts: Contacts | None = None,
    parameters: Iterable[str] = DEFAULT_PARAMETERS,
    outputs: Iterable[str] = DEFAULT_OUTPUTS,
    *,
    collectors: Iterable[float] = (),
    check: bool = True,
    time_limit: float = TIME_LIMIT,
    event_limit: int = EVENT_LIMIT,
    hop_threshold: float = HOP_THRESHOLD,
    ground: Ground | None = None,
    progress: Progress | ProgressFunction | None = None,
) -> xr.Dataset:
    """Differentiate trajectories, block by block, and check every derivative.

    Derivatives are carried along each trajectory, through flights, contacts, rolling
    and over edges: exact, but for the integration of contacts, as long as the block
    makes the same contacts. Where it does not, outputs jump, which no derivative shows.
    So each is compared with differences of blocks started with a little more and less
    of the parameters, of all at once and then, if need be, of one after the other; one
    that these do not confirm is refused. A single wrong derivative of a block is always
    found; of several, whose errors cancel, one that is wrong by more than 100 % is
    missed with a probability below 1 % (see `derivatives.comparison.judge`).

    By default contacts are integrated to a tolerance of 2e-6, and compared with
    differences of more exact ones over steps of 1e-3 and 1e-4. Blocks of which that
    does not confirm every derivative are computed again to 1e-8, and compared over all
    steps. All numbers of a block are of one tolerance, which `tolerance` says.

    The longer a block bounces, the smaller is the change that leaves its contacts
    alike, and the steeper and less useful are derivatives: `same_sequence_within` gives
    a lower bound of their reach. Averaged over blocks they are **not** the derivative
    of the mean, in which jumps count too.

    Args:
        profile, release: as for `simulate_runout`.
        contacts: contact model of all blocks; as said above if not given.
        parameters: names of parameters: columns of soil or block, of all segments alike
            (a block of more mass is larger); `rolling_friction_angle_deg`; of the
            release `x_m`, `y_m`, `speed_mps`, `direction_deg`, `orientation_deg` and
            `angular_velocity_degps`, all else of it as it is; fields of a `ClosedForm`
            law, such as `e_n`.
        outputs: names of outputs: `x_m`, `y_m`, `time_s` of the end; `max_height_m` of
            the centre above the ground, `max_speed_mps`, `max_energy_J` on the whole
            trajectory; `passage_...` of the first passage of each collector, as in a
            run-out study.
        collectors: places of collectors [m].
        check: compare with differences: two more runs in all if all is smooth, and up
            to eight more, and eight for each parameter, of the blocks for which it is
            not.
        time_limit, event_limit, hop_threshold, ground: as for `simulate_runout`.
        progress: called as `progress(done, comparisons)`.

    Returns:
        A dataset over `block`, `output` and `parameter`: `derivative`, in the unit of
        the output by that of the parameter, NaN where it is refused; `standing`
        (`Standing`); `derivative_by_differences`, in which other parameters that change
        at once take their part by their derivatives, and their `disagreement`,
        relative; `same_sequence_within`, the largest of `STEPS` within which the block
        makes the same contacts as they change; `output_value`, `ending`, `contacts`;
        `tolerance` of the contacts, NaN for laws in closed form.

    The first use compiles for some 15 s. Afterwards three derivatives of a trajectory
    take about as long as five trajectories, without the comparison.

    Raises:
        InputError: an unknown name, with the nearest known; check=False for blocks with
            flat faces, of whose derivatives one in seven is not that of differences.
        ValueError: a block that is released in the ground or off the profile; contacts
            of another kind.
        NotImplementedError: laws of the model without machine code.
    """
    progress = as_progress(progress)
    case = _checked_case(profile, release, contacts or QUICK, ground)
    limits = checked_limits(time_limit, event_limit, hop_threshold)
    if not check:
        _refuse_flat_faces(release, "give check=True, which compares with differences")
    chosen = chosen_parameters(case, parameters)
    units = chosen_outputs(outputs, collectors)
    stages = [(case.contacts, all_attempts(case.contacts) if check else ())]
    if check and contacts is None:
        # Of one parameter by itself all at once says no more.
        quick = (
            Attempt(len(chosen) > 1, step, FullModel(Accuracy("differences", t, 1e-2)))
            for step, t in QUICK_STEPS.items()
        )
        stages = [(QUICK, tuple(quick)), (EXACT, all_attempts(EXACT))]
    to_do = sum(1 + len(attempts) for _, attempts in stages)
    left, done, found = np.arange(release.count), 0, []
    for own, attempts in stages:
        part = case._replace(contacts=own).of_blocks(left)
        tell = functools.partial(_tell, progress, done, to_do)
        dataset = _judged(part, limits, chosen, units, attempts, tell)
        dataset = dataset.assign_coords(block=left)
        done += 1 + len(attempts)
        good = np.isin(dataset.standing, (Standing.confirmed, Standing.no_value))
        again = ~np.all(good, axis=(1, 2)) & (own is not stages[-1][0])
        found.append(dataset.isel(block=~again))
        left = left[again]
        if not len(left):
            break
    progress("runs", to_do, to_do)
    dataset = xr.concat(found, "block").sortby("block") if found[1:] else found[0]
    return dataset.assign_attrs(_attributes(case, [own for own, _ in stages]))


def _tell(progress: Progress, before: int, to_do: int, number: int) -> None:
    progress("runs", before + number, to_do)


def _judged(
    case: Case,
    limits: Limits,
    chosen: tuple[Parameter, ...],
    units: dict[str, str],
    attempts: tuple[Attempt, ...],
    progress: Callable[[int], None],
) -> xr.Dataset:
    """Compute derivatives of blocks, and compare them."""
    progress(0)
    result = follow_case(case, limits, chosen)
    found_outputs = outputs_of(result, units)
    slopes = np.stack([output.value.tangent for output in found_outputs], axis=2)
    comparison = Comparison(
        *(case, chosen, limits),
        base=result.runs,
        units=units,
        values=np.stack([output.value.value for output in found_outputs], axis=1),
        when=np.stack([output.when for output in found_outputs], axis=1),
        slopes=np.moveaxis(slopes, 0, 2),
    )
    judgement = judge(comparison, attempts, lambda number: progress(1 + number))
    return _dataset(comparison, judgement)


@numpy_settings()
def differentiate_runout(
    profile: Profile,
    release: Release,
    contacts: Contacts | None = None,
    parameters: Iterable[str] = DEFAULT_PARAMETERS,
    *,
    time_limit: float = TIME_LIMIT,
    event_limit: int = EVENT_LIMIT,
    hop_threshold: float = HOP_THRESHOLD,
    ground: Ground | None = None,
) -> tuple[Runs, RunTangents]:
    """Simulate trajectories, with unchecked derivatives of all their numbers.

    Args: as for `runout_gradients`; contacts not given are to a tolerance of 2e-6.

    Returns:
        The trajectories, and their derivatives, `(parameters, ...)`, in SI units and
        radians.

    Raises, beside what `runout_gradients` raises, InputError for blocks with flat
    faces: one in seven of their derivatives is not that of the differences.
    """
    case = _checked_case(profile, release, contacts, ground)
    limits = checked_limits(time_limit, event_limit, hop_threshold)
    _refuse_flat_faces(release, "runout_gradients compares them with differences")
    result = follow_case(case, limits, chosen_parameters(case, parameters))
    ends, records = result.blocks.tangent, (result.contacts, result.pieces)
    of_records = (record.tangent for record in records)
    return result.runs, RunTangents(ends.body.x, ends.body.y, ends.time, *of_records)


def _refuse_flat_faces(release: Release, cure: str) -> None:
    shape = release.block.shape
    if shape.side_of(jnp.zeros(()), jnp.ones(())) is not None:
        raise InputError(
            f"derivatives of run-outs are not reliable for blocks with flat faces "
            f"({type(shape).__name__}); {cure}"
        )


def _checked_case(
    profile: Profile,
    release: Release,
    contacts: Contacts | None,
    ground: Ground | None,
) -> Case:
    require_float64()
    check_release(release, profile)
    contacts = contacts or QUICK
    if not isinstance(contacts, FullModel | ClosedForm):
        raise ValueError(
            "derivatives of a run-out are for contacts by FullModel or ClosedForm, but "
            f"these are by {type(contacts).__name__}"
        )
    return Case(profile, release, contacts, ground or Ground.of_profile(profile))


def _dataset(comparison: Comparison, judgement: Judgement) -> xr.Dataset:
    case, parameters, _, base, units, values, _, slopes = comparison
    factors = np.array([parameter.factor for parameter in parameters])
    standing = judgement.standing
    standing[np.isfinite(values)[..., None] & ~comparison.known] = Standing.lost
    standing[~np.isfinite(values)] = Standing.no_value
    given = (standing == Standing.confirmed) | (standing == Standing.unchecked)
    by_output = ("block", "output", "parameter")
    flags = {
        "flag_values": [int(member) for member in Standing],
        "flag_meanings": " ".join(member.name for member in Standing),
    }
    return xr.Dataset(
        {
            "derivative": (
                by_output,
                np.where(given, slopes, np.nan) * factors,
                {"long_name": "d output / d parameter, in their units"},
            ),
            "derivative_by_differences": (
                by_output,
                judgement.by_differences * factors,
                {"long_name": "the same by differences"},
            ),
            "disagreement": (
                by_output,
                judgement.disagreement,
                {"long_name": "of the two, as part of the larger"},
            ),
            "standing": (by_output, standing, flags),
            "same_sequence_within": (
                ("block", "parameter"),
                judgement.same_within,
                {"long_name": "part of the parameter that changes no contact"},
            ),
            "output_value": (("block", "output"), values),
            "ending": ("block", np.array([str(e) for e in Ending])[base.ending]),
            "contacts": (
                "block",
                np.bincount(base.contacts.trajectory, minlength=len(values)),
            ),
            "tolerance": (
                "block",
                np.full(len(values), _tolerance(case.contacts)),
                {"long_name": "relative tolerance of the contacts"},
            ),
        },
        {
            "block": np.arange(len(values)),
            "output": list(units),
            "parameter": [parameter.name for parameter in parameters],
            "output_unit": ("output", list(units.values())),
            "parameter_unit": ("parameter", [p.unit for p in parameters]),
        },
    )


def _tolerance(contacts: FullModel | ClosedForm) -> float:
    if isinstance(contacts, ClosedForm):
        return np.nan
    return get_accuracy(contacts.accuracy).tolerance


def _attributes(case: Case, contacts: list[FullModel | ClosedForm]) -> dict:
    return {
        "title": "jaximpact: derivatives of run-outs",
        "case": json.dumps(_in_words(case, contacts)),
        "steps": json.dumps(STEPS),
        "agrees_within": AGREES_WITHIN,
        "versions": json.dumps(versions() | {"numpy": np.__version__}),
    }


def _in_words(case: Case, contacts: list[FullModel | ClosedForm]) -> dict:
    """Describe a case, with contacts by one after the other, ready for JSON, in SI
    units and radians."""

    def fields(module) -> dict:
        numbers = vars(module).items()
        own = {n: v for n, v in numbers if not dataclasses.is_dataclass(v)}
        return {name: np.asarray(value).tolist() for name, value in own.items()}

    def of_whole(whole: Composite) -> dict:
        own = fields(whole)
        for slot in parts_of(type(whole)):
            own |= fields(getattr(whole, slot))
        return own

    profile, release, _, ground = case
    first = contacts[0]
    if isinstance(first, FullModel):
        accuracies = [
            dataclasses.asdict(get_accuracy(own.accuracy))
            for own in contacts
            if isinstance(own, FullModel)
        ]
        how = {
            "laws": part_names(ground.soil, release.block),
            "accuracies": accuracies,
        }
    else:
        law = first.law
        how = {"law": type(law).__name__}
        if dataclasses.is_dataclass(law):
            how |= fields(law)
    return {
        "profile": {"x": profile.x.tolist(), "y": profile.y.tolist()},
        "ground": fields(ground) | {"soil": of_whole(ground.soil)},
        "release": fields(release) | {"block": of_whole(release.block)},
        "contacts": how,
    }

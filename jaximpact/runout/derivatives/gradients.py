"""Derivatives of trajectories with respect to blocks, ground and releases."""

import dataclasses
import json
from collections.abc import Iterable

import jax.numpy as jnp
import numpy as np
import xarray as xr

from ..._packages import versions
from ..._precision import require_float64
from ...accuracy import get_accuracy
from ...errors import InputError
from ...identity import part_names
from ...parameters import Composite, parts_of
from ...progress import Progress, ProgressFunction, as_progress
from ..blocks import Release
from ..contacts.contact_models import ClosedForm, Contacts, FullModel
from ..flight.placement import check_release
from ..scheduler import checked_limits
from ..state import EVENT_LIMIT, HOP_THRESHOLD, TIME_LIMIT
from ..terrain import Ground, Profile
from ..trajectory import Ending, Runs, RunTangents
from .comparison import (
    AGREES_WITHIN,
    COMPARISONS,
    STEPS,
    Comparison,
    Judgement,
    Standing,
    Whole,
    judge,
)
from .outputs import chosen_outputs, outputs_of
from .parameters import Case, chosen_parameters
from .results import follow_case

DEFAULT_PARAMETERS = ("c_v", "gamma_v", "k_E")
DEFAULT_OUTPUTS = ("x_m", "time_s", "max_height_m")


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

    The longer a block bounces, the smaller is the change that leaves its contacts
    alike, and the steeper and less useful are derivatives: `same_sequence_within` gives
    a lower bound of their reach. Averaged over blocks they are **not** the derivative
    of the mean, in which jumps count too.

    Args:
        profile, release: as for `simulate_runout`.
        contacts: contact model; `FullModel("reference")` if not given, since
            differences of less accurate contacts are noise.
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
        makes the same contacts as they change; `output_value`, `ending`, `contacts`.

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
    case = _checked_case(profile, release, contacts, ground)
    limits = checked_limits(time_limit, event_limit, hop_threshold)
    if not check:
        _refuse_flat_faces(release, "give check=True, which compares with differences")
    chosen = chosen_parameters(case, parameters)
    units = chosen_outputs(outputs, collectors)
    to_do = 1 + COMPARISONS * bool(check)
    progress("runs", 0, to_do)
    result = follow_case(case, limits, chosen)
    found_outputs = outputs_of(result, units)
    whole = Whole(
        base=result.runs,
        units=units,
        values=np.stack([output.value.value for output in found_outputs], axis=1),
        when=np.stack([output.when for output in found_outputs], axis=1),
    )
    slopes = np.stack([output.value.tangent for output in found_outputs], axis=2)
    comparison = Comparison(case, chosen, limits, whole, np.moveaxis(slopes, 0, 2))
    judgement = Judgement.of_none(comparison.slopes.shape)
    if check:
        judgement = judge(comparison, lambda done: progress("runs", 1 + done, to_do))
    progress("runs", to_do, to_do)
    return _dataset(comparison, judgement)


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

    Args: as for `runout_gradients`.

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
    x, y, time = result.ends.tangent
    found = RunTangents(x, y, time, result.contacts.tangent, result.pieces.tangent)
    return result.runs, found


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
    contacts = contacts or FullModel("reference")
    if not isinstance(contacts, FullModel | ClosedForm):
        raise ValueError(
            "derivatives of a run-out are for contacts by FullModel or ClosedForm, but "
            f"these are by {type(contacts).__name__}"
        )
    return Case(profile, release, contacts, ground or Ground.of_profile(profile))


def _dataset(comparison: Comparison, judgement: Judgement) -> xr.Dataset:
    case, parameters, _, whole, slopes = comparison
    base, units, values, _ = whole
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
        },
        {
            "block": np.arange(len(values)),
            "output": list(units),
            "parameter": [parameter.name for parameter in parameters],
            "output_unit": ("output", list(units.values())),
            "parameter_unit": ("parameter", [p.unit for p in parameters]),
        },
        {
            "title": "jaximpact: derivatives of run-outs",
            "case": json.dumps(_in_words(case)),
            "steps": json.dumps(STEPS),
            "agrees_within": AGREES_WITHIN,
            "versions": json.dumps(versions() | {"numpy": np.__version__}),
        },
    )


def _in_words(case: Case) -> dict:
    """Describe a case, ready for JSON, in SI units and radians."""

    def fields(module) -> dict:
        numbers = vars(module).items()
        own = {n: v for n, v in numbers if not dataclasses.is_dataclass(v)}
        return {name: np.asarray(value).tolist() for name, value in own.items()}

    def of_whole(whole: Composite) -> dict:
        own = fields(whole)
        for slot in parts_of(type(whole)):
            own |= fields(getattr(whole, slot))
        return own

    profile, release, contacts, ground = case
    if isinstance(contacts, FullModel):
        accuracy = dataclasses.asdict(get_accuracy(contacts.accuracy))
        how = {
            "laws": part_names(ground.soil, release.block),
            "accuracy": accuracy,
        }
    else:
        law = contacts.law
        how = {"law": type(law).__name__}
        if dataclasses.is_dataclass(law):
            how |= fields(law)
    return {
        "profile": {"x": profile.x.tolist(), "y": profile.y.tolist()},
        "ground": fields(ground) | {"soil": of_whole(ground.soil)},
        "release": fields(release) | {"block": of_whole(release.block)},
        "contacts": how,
    }

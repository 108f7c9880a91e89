"""Derivatives of trajectories with respect to blocks, ground and releases."""

import dataclasses
import enum
import json
from collections.abc import Iterable
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
import xarray as xr

from ..._precision import require_float64
from ..._versions import versions
from ...accuracy import get_accuracy
from ...errors import InputError
from ...identity import part_names
from ...parameters import Composite, parts_of
from ...progress import Progress, ProgressFunction, as_progress
from ..blocks import Release, select
from ..contacts.contact_models import ClosedForm, Contacts, FullModel
from ..flight.placement import check_release
from ..scheduler import WIDTH, advance, checked_limits, result_of
from ..state import EVENT_LIMIT, HOP_THRESHOLD, TIME_LIMIT, Limits, State
from ..terrain import Ground, Profile
from ..trajectory import Ending, Runs, RunTangents
from .outputs import Ends, Result, chosen_outputs, outputs_of
from .parameters import Case, Parameter, chosen_parameters, directions_of, replaced

DEFAULT_PARAMETERS = ("c_v", "gamma_v", "k_E")
DEFAULT_OUTPUTS = ("x_m", "time_s", "max_height_m")
STEPS = (1e-3, 1e-4, 1e-5, 1e-6)
"""Relative steps of the differences: each next one is for derivatives that the one
before does not confirm. Below, integration errors are too large a part of a
difference."""
AGREES_WITHIN = 1e-3
"""Relative difference between derivatives and differences that confirms them."""
SMALL = 1e-4
"""Floor of the scale of comparison: relative change of an output per relative change of
a parameter that counts as next to none."""


class Standing(enum.IntEnum):
    """Reliability of a derivative."""

    confirmed = 0
    """Blocks on both sides make the same contacts, and the differences agree."""
    unchecked = 1
    """No check was requested, or the parameter has no neighbour in its range."""
    sequence_changes = 2
    """Refused: with a relative change of 1e-6 the block makes other contacts, or moves
    in another mode between them."""
    differs = 3
    """Refused: differences of blocks that make the same contacts disagree. The output
    has a kink there, or bends too sharply for any step."""
    no_value = 4
    """The output has no value: the block did not pass, or its contact failed."""
    lost = 5
    """The output has a value, but its derivative was lost: a block started its flight
    in the ground, or something turned by an infinite rate."""

    def __str__(self) -> str:
        return self.name.replace("_", " ")


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
    of the parameter, and one that these do not confirm is refused.

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
        check: compare with differences; two to eight more runs for each parameter.
        time_limit, event_limit, hop_threshold, ground: as for `simulate_runout`.
        progress: called as `progress(done, runs)`, in runs of all blocks.

    Returns:
        A dataset over `block`, `output` and `parameter`: `derivative`, in the unit of
        the output by that of the parameter, NaN where it is refused; `standing`
        (`Standing`); `derivative_by_differences` and their `disagreement`, relative;
        `same_sequence_within`, the largest of `STEPS` within which the block makes the
        same contacts; `output_value`, `ending` and `contacts`.

    The first use compiles for some 15 s. Afterwards a derivative of an impact takes
    about as long as two impacts.

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
    runs_to_do = 1 + 2 * len(chosen) * bool(check)
    result = _follow(case, limits, chosen)
    found_outputs = outputs_of(result, units)
    whole = _Whole(
        base=result.runs,
        units=units,
        values=np.stack([output.value.value for output in found_outputs], axis=1),
        when=np.stack([output.when for output in found_outputs], axis=1),
    )
    slopes = np.stack([output.value.tangent for output in found_outputs], axis=2)
    found = []
    for number, (slope, parameter) in enumerate(zip(slopes, chosen, strict=True)):
        progress("runs", 1 + 2 * number * bool(check), runs_to_do)
        found.append(_judge(case, parameter, whole, slope, check, limits))
    progress("runs", runs_to_do, runs_to_do)
    return _dataset(case, chosen, whole, found)


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
    result = _follow(case, limits, chosen_parameters(case, parameters))
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


def _follow(
    case: Case, limits: Limits, parameters: tuple[Parameter, ...] = ()
) -> Result:
    """Follow all blocks, with derivatives with respect to some parameters."""
    directions = directions_of(case, parameters) if parameters else None
    state = State.at_release(
        case.profile, case.release, case.ground, limits, directions
    )
    advance(state, case.contacts, WIDTH, Progress())
    blocks = state.blocks
    return Result(
        runs=result_of(state),
        ends=blocks.map(lambda block: Ends(block.body.x, block.body.y, block.time)),
        contacts=state.contacts.whole(),
        pieces=state.pieces.whole(),
        constants=state.constants,
    )


class _Whole(NamedTuple):
    """Trajectories and their outputs."""

    base: Runs
    units: dict[str, str]
    """Units of the outputs by name."""
    values: np.ndarray
    """Outputs, `(blocks, outputs)`."""
    when: np.ndarray
    """Times by which the outputs are settled [s], `(blocks, outputs)`."""


def _judge(
    case: Case,
    parameter: Parameter,
    whole: _Whole,
    slopes: np.ndarray,
    check: bool,
    limits: Limits,
) -> dict[str, np.ndarray]:
    """Compare the derivatives with respect to one parameter with differences.

    Args:
        slopes: derivatives of the outputs, `(blocks, outputs)`, in SI units of the
            parameter.
    """
    _, _, values, when = whole
    blocks = len(values)
    size = np.broadcast_to(parameter.size(case), (blocks,))
    by_differences = np.full(values.shape, np.nan)
    disagreement = np.full(values.shape, np.nan)
    standing = np.full(values.shape, Standing.unchecked)
    same_within, compared = np.zeros(blocks), np.zeros(blocks, bool)
    exists = np.isfinite(values)
    known = exists & np.isfinite(slopes)
    undecided = np.any(known, axis=1) if check else np.zeros(blocks, bool)
    for step in STEPS:
        some = np.flatnonzero(undecided)
        if not len(some):
            break
        found = _differences(case, parameter, whole, some, step, size[some], limits)
        if found is None:
            continue
        compared[some] = True
        difference, until = found
        relative = _disagreement(difference, slopes[some], values[some], size[some])
        confirmed = standing[some] == Standing.confirmed
        new = (until[:, None] >= when[some]) & known[some] & ~confirmed
        by_differences[some] = np.where(new, difference, by_differences[some])
        disagreement[some] = np.where(new, relative, disagreement[some])
        agrees = new & (relative <= AGREES_WITHIN)
        verdict = np.where(agrees, Standing.confirmed, Standing.differs)
        standing[some] = np.where(new, verdict, standing[some])
        reached = np.where(np.isinf(until), step, 0.0)
        same_within[some] = np.maximum(same_within[some], reached)
        decided = (standing == Standing.confirmed) | ~known
        undecided = undecided & ~np.all(decided, axis=1)
    unchecked = standing == Standing.unchecked
    standing[unchecked & compared[:, None]] = Standing.sequence_changes
    standing[exists & ~known] = Standing.lost
    standing[~exists] = Standing.no_value
    given = (standing == Standing.confirmed) | (standing == Standing.unchecked)
    return {
        "derivative": np.where(given, slopes, np.nan) * parameter.factor,
        "derivative_by_differences": by_differences * parameter.factor,
        "disagreement": disagreement,
        "standing": standing,
        "same_sequence_within": np.where(compared, same_within, np.nan),
    }


def _differences(
    case: Case,
    parameter: Parameter,
    whole: _Whole,
    some: np.ndarray,
    step: float,
    size: np.ndarray,
    limits: Limits,
) -> tuple[np.ndarray, np.ndarray] | None:
    """Differentiate the outputs of some blocks by central differences.

    Args:
        step, size: relative step, and the sizes that it is relative to.

    Returns:
        Differences, `(some, outputs)`, and the times until which neighbours make the
        same contacts [s]; None where a neighbour is out of range.
    """
    above = _neighbour(case, parameter, some, 1.0 * step * size, limits)
    below = _neighbour(case, parameter, some, -1.0 * step * size, limits)
    if above is None or below is None:
        return None
    own = _only(whole.base, some)
    until = np.minimum(same_until(own, above.runs), same_until(own, below.runs))
    more, less = (
        np.stack([o.value.value for o in outputs_of(result, whole.units)], axis=1)
        for result in (above, below)
    )
    return (more - less) / (2.0 * step * size[:, None]), until


def _disagreement(
    differences: np.ndarray, slopes: np.ndarray, values: np.ndarray, size: np.ndarray
) -> np.ndarray:
    """Compute the relative disagreement of derivatives and differences."""
    floor = SMALL * np.abs(values) / size[:, None]
    scale = np.maximum(np.maximum(np.abs(differences), np.abs(slopes)), floor)
    with np.errstate(invalid="ignore"):
        return np.abs(differences - slopes) / np.where(scale > 0.0, scale, 1.0)


def _neighbour(
    case: Case,
    parameter: Parameter,
    some: np.ndarray,
    amount: np.ndarray,
    limits: Limits,
) -> Result | None:
    """Simulate some blocks with a parameter shifted; None where it leaves its range."""
    release = replaced(
        case.release,
        block=select(case.release.block, some),
        **select(case.release.body, some)._asdict(),
    )
    amount = amount if np.ndim(parameter.size(case)) else amount[0]
    ground = case.ground.of_blocks(some)
    shifted = parameter.shift(case._replace(release=release, ground=ground), amount)
    return _follow(shifted, limits) if parameter.allows(shifted) else None


def _dataset(case: Case, parameters, whole: _Whole, found: list[dict]) -> xr.Dataset:
    base, units, values, _ = whole
    by_output = ("block", "output", "parameter")
    judged = {name: np.stack([f[name] for f in found], axis=-1) for name in found[0]}
    trajectory = base.contacts.trajectory
    standing = {
        "flag_values": [int(member) for member in Standing],
        "flag_meanings": " ".join(member.name for member in Standing),
    }
    about = {
        "derivative": "d output / d parameter, in their units",
        "derivative_by_differences": "the same by differences",
        "disagreement": "of the two, as part of the larger",
    }
    return xr.Dataset(
        {name: (by_output, judged[name], {"long_name": about[name]}) for name in about}
        | {
            "standing": (by_output, judged["standing"], standing),
            "same_sequence_within": (
                ("block", "parameter"),
                judged["same_sequence_within"],
                {"long_name": "part of the parameter that changes no contact"},
            ),
            "output_value": (("block", "output"), values),
            "ending": ("block", np.array([str(e) for e in Ending])[base.ending]),
            "contacts": ("block", np.bincount(trajectory, minlength=len(values))),
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


def same_until(first: Runs, second: Runs) -> np.ndarray:
    """Find until when blocks make the same contacts, with the same outcomes, and move
    in the same modes between them [s]; inf where they do so to the same end."""
    until = np.where(first.ending == second.ending, np.inf, first.time)
    for name, columns in (
        ("contacts", ("segment", "outcome", "hop")),
        ("pieces", ("motion",)),
    ):
        one, other = getattr(first, name), getattr(second, name)
        owner = one.trajectory
        starts, counts = _spans(one, len(until))
        starts_of_other, counts_of_other = _spans(other, len(until))
        until = np.where(
            counts == counts_of_other, until, np.minimum(until, first.time)
        )
        rank = np.arange(len(owner)) - starts[owner]
        there = rank < counts_of_other[owner]
        place = np.where(there, starts_of_other[owner] + rank, 0)
        differs = ~there
        for column in columns if len(other.time) else ():
            differs = differs | (getattr(one, column) != getattr(other, column)[place])
        np.minimum.at(until, owner[differs], one.time[differs])
    return until


def _spans(record, blocks: int) -> tuple[np.ndarray, np.ndarray]:
    """Find the first row of each block, and the number of its rows."""
    counts = np.bincount(record.trajectory, minlength=blocks)
    return np.cumsum(counts) - counts, counts


def _only(runs: Runs, some: np.ndarray) -> Runs:
    """Select the trajectories of some blocks, for `same_until`."""
    place = np.full(runs.release.count, -1)
    place[some] = np.arange(len(some))
    records = {}
    for name in ("contacts", "pieces"):
        record = getattr(runs, name)
        kept = select(record, place[record.trajectory] >= 0)
        records[name] = kept._replace(trajectory=place[kept.trajectory])
    release = replaced(runs.release, x=runs.release.x[some])
    ends = {"ending": runs.ending[some], "time": runs.time[some]}
    return replaced(runs, release=release, **ends, **records)

"""Derivatives of trajectories, by what blocks and ground are and how blocks start."""

import dataclasses
import enum
import json
from collections.abc import Callable, Iterable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import xarray as xr

from ..accuracy import get_accuracy
from ..errors import InputError
from ..formats.provenance import versions
from ..identity import part_names
from ..parameters import Composite, parts_of
from ..precision import require_float64
from .dual import Dual, carrying, plain, tangent_of
from .ground import Ground
from .motion import Body
from .outputs import chosen_outputs, outputs_of
from .parameters import Case, Parameter, chosen_parameters, replaced
from .profile import Profile
from .rebounds import ClosedForm, Contacts, FullModel
from .release import Release, check_release
from .runs import Ending, Runs
from .state import State
from .trajectories import EVENT_LIMIT, TIME_LIMIT, WIDTH, follow

DEFAULT_PARAMETERS = ("c_v", "gamma_v", "k_E")
DEFAULT_OUTPUTS = ("x_m", "time_s", "max_height_m")
STEPS = (1e-3, 1e-4, 1e-5, 1e-6)
"""Of the differences, by the parameter's size: the next is for what the one before does
not confirm. Below, the integration's errors are too large a part of a difference."""
AGREES_WITHIN = 1e-3
"""Part of the derivative by which differences may differ from it."""
SMALL = 1e-4
"""Relative change of an output, by that of a parameter, that counts as next to none:
derivatives are compared as if they were at least so large."""


class Standing(enum.IntEnum):
    """What can be said of a derivative."""

    confirmed = 0
    """Blocks on both sides make the same contacts, and their differences agree."""
    unchecked = 1
    """No check was asked for, or the parameter has no neighbour in its range."""
    sequence_changes = 2
    """Refused: 1e-6 more or less of the parameter, and the block makes other contacts,
    or takes another way between them."""
    differs = 3
    """Refused: differences of blocks that make the same contacts give something else.
    The output has a kink there, or bends too sharply for any step."""
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
    ground: Ground | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    """Derivatives of what becomes of blocks on a slope, block by block.

    They are carried along each trajectory, through flights, contacts, rolling and over
    edges: exact, but for the integration of contacts, for as long as the block makes
    the same contacts. Where it does not, outputs jump, and there is no derivative that
    tells of it. So each is compared with differences of blocks started with a little
    more and less of the parameter, and one that these do not confirm is refused.

    The longer a block bounces, the smaller is the change that keeps its contacts as
    they are, and the steeper and less useful are derivatives: `same_sequence_within`
    says how far they reach at least. Averaged over blocks they are **not** the
    derivative of the mean, in which jumps count too.

    Args:
        profile, release: as for `simulate_runout`.
        contacts: likewise; `FullModel("reference")` if not given, since differences of
            less accurate contacts are noise.
        parameters: by which: columns of soil or block, of all segments alike (a block
            of more mass is larger); `rolling_friction_angle_deg`; of the release `x_m`,
            `y_m`, `speed_mps`, `direction_deg`, `orientation_deg` and
            `angular_velocity_degps`, all else of it as it is; fields of a `ClosedForm`
            law, such as `e_n`.
        outputs: of which: `x_m`, `y_m`, `time_s` of the end; `max_height_m` of the
            centre above the ground, `max_speed_mps`, `max_energy_J` on the whole way;
            `passage_...` of the first passage of each collector, as in a run-out study.
        collectors: places [m].
        check: compare with differences; two to eight more runs for each parameter.
        time_limit, event_limit, ground: as for `simulate_runout`.
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
    case = _checked_case(profile, release, contacts, ground)
    if not check:
        _refuse_flat_faces(release, "give check=True, which compares with differences")
    chosen = chosen_parameters(case, parameters)
    units = chosen_outputs(outputs, collectors)
    limits = time_limit, event_limit
    runs_to_do = 1 + 2 * len(chosen) * bool(check)
    carried = _differentiate(case, chosen, *limits)
    columns, when = outputs_of(carried, units)
    whole = _Whole(
        base=Runs(**{name: plain(value) for name, value in vars(carried).items()}),
        units=units,
        values=np.stack([plain(column) for column in columns], axis=1),
        when=np.stack(when, axis=1),
    )
    slopes = np.stack([tangent_of(column, len(chosen)) for column in columns], axis=2)
    found = []
    for number, (slope, parameter) in enumerate(zip(slopes, chosen, strict=True)):
        if progress is not None:
            progress(1 + 2 * number * bool(check), runs_to_do)
        found.append(_judge(case, parameter, whole, slope, check, limits))
    if progress is not None:
        progress(runs_to_do, runs_to_do)
    return _dataset(case, chosen, whole, found)


def differentiate_runout(
    profile: Profile,
    release: Release,
    contacts: Contacts | None = None,
    parameters: Iterable[str] = DEFAULT_PARAMETERS,
    *,
    time_limit: float = TIME_LIMIT,
    event_limit: int = EVENT_LIMIT,
    ground: Ground | None = None,
) -> Runs:
    """Trajectories, all numbers of which carry their derivatives, unchecked.

    Args: as for `runout_gradients`.

    Returns:
        `Runs` with arrays of type `Dual`, contacts and pieces of the way too: `value`,
        and `tangent`, `(parameters, ...)`, in SI units and radians.

    Raises, beside what `runout_gradients` raises, InputError for blocks with flat
    faces: one in seven of their derivatives is not that of the differences.
    """
    case = _checked_case(profile, release, contacts, ground)
    _refuse_flat_faces(release, "runout_gradients compares them with differences")
    chosen = chosen_parameters(case, parameters)
    return _differentiate(case, chosen, time_limit, event_limit)


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


def _differentiate(
    case: Case, parameters: tuple[Parameter, ...], time_limit: float, event_limit: int
) -> Runs:
    count = len(parameters)
    for parameter, direction in zip(parameters, np.eye(count), strict=True):
        case = parameter.move(case, Dual(0.0, direction))
    return _follow(case, count, time_limit, event_limit)


def _follow(case: Case, count: int, time_limit: float, event_limit: int) -> Runs:
    state = State.at_release(case.profile, case.release, case.ground)
    if count:
        changing = ("time", "way", "speed_squared", "plane", "normal", "gap")
        fields = {name: carrying(getattr(state, name), count) for name in changing}
        body = Body(*(carrying(value, count) for value in state.body))
        state = dataclasses.replace(state, body=body, **fields)
    return follow(state, case.contacts, time_limit, event_limit, WIDTH, None)


class _Whole(NamedTuple):
    """Trajectories and their outputs."""

    base: Runs
    units: dict[str, str]
    """Of the outputs, by their names."""
    values: np.ndarray
    """`(blocks, outputs)`"""
    when: np.ndarray
    """The times at which they stand [s], likewise."""


def _judge(
    case: Case,
    parameter: Parameter,
    whole: _Whole,
    slopes: np.ndarray,
    check: bool,
    limits: tuple[float, int],
) -> dict[str, np.ndarray]:
    """What can be said of the derivatives by one parameter.

    Args:
        slopes: of the outputs, `(blocks, outputs)`, in SI units of the parameter.
    """
    base, units, values, when = whole
    blocks = len(values)
    size = np.broadcast_to(parameter.size(case), (blocks,))
    by_differences = np.full(values.shape, np.nan)
    disagreement = np.full(values.shape, np.nan)
    standing = np.full(values.shape, Standing.unchecked)
    same_within, compared = np.zeros(blocks), np.zeros(blocks, bool)
    there = np.isfinite(values)
    known = there & np.isfinite(slopes)
    open_yet = np.any(known, axis=1) if check else np.zeros(blocks, bool)
    for step in STEPS:
        some = np.flatnonzero(open_yet)
        if not len(some):
            break
        neighbours = [
            _neighbour(case, parameter, some, sign * step * size[some], limits)
            for sign in (1.0, -1.0)
        ]
        if None in neighbours:
            continue
        compared[some] = True
        own = _only(base, some)
        until = np.minimum(*(same_until(own, n) for n in neighbours))
        above, below = (np.stack(outputs_of(n, units)[0], axis=1) for n in neighbours)
        found = (above - below) / (2.0 * step * size[some, None])
        floor = SMALL * np.abs(values[some]) / size[some, None]
        scale = np.maximum(np.maximum(np.abs(found), np.abs(slopes[some])), floor)
        with np.errstate(invalid="ignore"):
            off = np.abs(found - slopes[some]) / np.where(scale > 0.0, scale, 1.0)
        confirmed = standing[some] == Standing.confirmed
        new = (until[:, None] >= when[some]) & known[some] & ~confirmed
        by_differences[some] = np.where(new, found, by_differences[some])
        disagreement[some] = np.where(new, off, disagreement[some])
        agrees = new & (off <= AGREES_WITHIN)
        verdict = np.where(agrees, Standing.confirmed, Standing.differs)
        standing[some] = np.where(new, verdict, standing[some])
        reached = np.where(np.isinf(until), step, 0.0)
        same_within[some] = np.maximum(same_within[some], reached)
        decided = (standing == Standing.confirmed) | ~known
        open_yet = open_yet & ~np.all(decided, axis=1)
    unchecked = standing == Standing.unchecked
    standing[unchecked & compared[:, None]] = Standing.sequence_changes
    standing[there & ~known] = Standing.lost
    standing[~there] = Standing.no_value
    given = (standing == Standing.confirmed) | (standing == Standing.unchecked)
    return {
        "derivative": np.where(given, slopes, np.nan) * parameter.factor,
        "derivative_by_differences": by_differences * parameter.factor,
        "disagreement": disagreement,
        "standing": standing,
        "same_sequence_within": np.where(compared, same_within, np.nan),
    }


def _neighbour(
    case: Case,
    parameter: Parameter,
    some: np.ndarray,
    amount: np.ndarray,
    limits: tuple[float, int],
) -> Runs | None:
    """Some blocks with a little more of a parameter; None where that is out of its
    range."""
    release = replaced(
        case.release,
        block=jax.tree.map(lambda leaf: leaf[some], case.release.block),
        **{name: value[some] for name, value in case.release.body._asdict().items()},
    )
    amount = amount if np.ndim(parameter.size(case)) else amount[0]
    ground = case.ground.of_blocks(some)
    moved = parameter.move(case._replace(release=release, ground=ground), amount)
    return _follow(moved, 0, *limits) if parameter.allows(moved) else None


def _dataset(case: Case, parameters, whole: _Whole, found: list[dict]) -> xr.Dataset:
    base, units, values, _ = whole
    by_output = ("block", "output", "parameter")
    judged = {name: np.stack([f[name] for f in found], axis=-1) for name in found[0]}
    trajectory = base.contacts.trajectory.astype(int)
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
    """What was computed, ready for JSON, in SI units and radians."""

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
    """Until when blocks make the same contacts, with the same outcomes, and take the
    same kinds of way between them [s], inf where they do so to the same end."""
    until = np.where(first.ending == second.ending, np.inf, first.time)
    for name, columns in (("contacts", ("segment", "outcome")), ("pieces", ("way",))):
        one, other = getattr(first, name), getattr(second, name)
        owner = one.trajectory.astype(int)
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
    """Where the rows of each block start, and how many there are."""
    counts = np.bincount(record.trajectory.astype(int), minlength=blocks)
    return np.cumsum(counts) - counts, counts


def _only(runs: Runs, some: np.ndarray) -> Runs:
    """The trajectories of some blocks, for `same_until`."""
    place = np.full(runs.release.count, -1)
    place[some] = np.arange(len(some))
    records = {}
    for name in ("contacts", "pieces"):
        record = getattr(runs, name)
        chosen = place[record.trajectory.astype(int)] >= 0
        kept = type(record)(*(column[chosen] for column in record))
        records[name] = kept._replace(trajectory=place[kept.trajectory.astype(int)])
    release = replaced(runs.release, x=runs.release.x[some])
    ends = {"ending": runs.ending[some], "time": runs.time[some]}
    return replaced(runs, release=release, **ends, **records)

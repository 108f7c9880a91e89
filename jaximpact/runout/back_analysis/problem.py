"""Back-analysis as a study's file states it: parameters with priors, and
observations."""

import copy
import dataclasses
import json
import warnings
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from ...errors import nearest
from ...io.checks import check_memory
from ...io.files import read_input
from ...io.toml import Key, of_kind, parse_toml, typed, unknown, whole
from ...quantities import InputColumn
from ...scene import Soil
from ..contacts.contact_models import ClosedForm
from ..random_inputs import Distribution
from ..study.barriers import Barrier, read_barriers
from ..study.contact_laws import columns_of_law
from ..study.ground_file import PARTS, GroundInput
from ..study.quantity import read_ground_quantity
from ..study.slope_file import SlopeInput, read_slope_input
from ..terrain import ground_columns
from .observed import PER_PLACE, Observations, read_observed

FIT, CONTACTS = "fit", "contacts"
DATA_SETS = 1500
"""Default number of data sets behind the posterior."""
ENDS = np.array([1e-9, 0.5, 1.0 - 1e-9])


@dataclasses.dataclass(frozen=True)
class SlopeParameter:
    """Parameter of the ground, or of a contact law in closed form, that is fitted."""

    key: str
    """Key in the study: ground.materials.scree.gamma_v, or contacts.e_n."""
    prior: Distribution
    """Prior, in the unit of the name."""
    column: InputColumn

    @property
    def name(self) -> str:
        """Name in reports, without the table [ground]."""
        return self.key.removeprefix("ground.")


@dataclasses.dataclass(frozen=True)
class SlopeFit:
    """Back-analysis of a slope."""

    path: Path
    title: str
    slope: SlopeInput
    """Ground, blocks, releases and law, with priors in place of what is fitted."""
    parameters: tuple[SlopeParameter, ...]
    observed: Observations
    barriers: tuple[Barrier, ...]
    data_sets: int
    """Number of data sets behind the posterior."""
    identity: str
    """Text that names what simulated data sets depend on beside the candidates."""

    @property
    def places(self) -> list[float]:
        """List the places at which passages are found [m], increasing."""
        lines = {c.place for c in self.observed.channels if c.place is not None}
        return sorted(lines | {barrier.x for barrier in self.barriers})

    @property
    def inputs(self) -> list[Path]:
        """List the files that were read."""
        of_law = self.slope.laws[0].checksums
        return [self.path, *self.slope.checksums, *of_law, *self.observed.inputs]

    def values(self, u: np.ndarray) -> np.ndarray:
        """Turn probabilities under the priors into parameters, `(..., parameters)`."""
        columns = [p.prior.values(u[..., i]) for i, p in enumerate(self.parameters)]
        return np.stack(columns, axis=-1)


def read_slope_fit(path: Path, accuracy: str | None = None) -> SlopeFit:
    """Read a back-analysis; `jaximpact calibrate --help` describes the file.

    The accuracy of the full model stands in place of the file's.

    Raises InputError, naming file and key, for whatever cannot be used.
    """
    path = Path(path)
    top = Key(path)
    content = parse_toml(path, read_input(path, once=False))
    if FIT not in content:
        raise top[FIT].error("needs a table [fit]")
    fit = dict(typed(top, content, FIT, dict))
    numbers = {"data_sets": fit.pop("data_sets", DATA_SETS)}
    # The regression takes the nearest 20 %, and needs 25 for each coefficient.
    data_sets = whole(top[FIT], numbers, "data_sets", DATA_SETS, 200)
    soil = GroundInput.read(path, content).soil
    ground = typed(top, content, "ground", dict, {})
    merged = copy.deepcopy(content)
    of_law = _read_law_parameters(top, fit, merged)
    parameters = (*_read_parameters(top, fit, ground, soil), *of_law)
    if not parameters:
        raise top[FIT].error("names no parameter to fit")
    _merge(merged.setdefault("ground", {}), fit)
    slope = read_slope_input(path, merged, accuracy)
    if len(slope.laws) > 1:
        raise top["contacts"].error(f"names {len(slope.laws)} laws; a fit takes one")
    (law,) = slope.laws
    if isinstance(law.contacts, ClosedForm):
        _warn_of_soil(path, law.name, parameters)
    fitted = dict.fromkeys((p.column.name for p in of_law), "fitted")
    law = law._replace(description=law.description | fitted)
    profile = slope.layout.profile
    # What was observed and what the priors are changes no simulated block.
    rest = {k: v for k, v in content.items() if k not in ("observed", FIT, "title")}
    files = {f.name: c for f, c in (slope.checksums | law.checksums).items()}
    observed = read_observed(path, content, profile, slope.seed)
    back_analysis = SlopeFit(
        path=path,
        title=typed(top, content, "title", str, path.stem),
        slope=slope._replace(laws=[law]),
        parameters=parameters,
        observed=observed,
        barriers=read_barriers(path, content, profile),
        data_sets=data_sets,
        identity=json.dumps([rest, files, law.description], default=str),
    )
    columns = 2 + PER_PLACE * len(back_analysis.places)
    check_memory(
        data_sets * observed.released * columns,
        f"{data_sets} data sets of {observed.released} blocks",
        **top[FIT]["data_sets"].place,
    )
    return back_analysis


def _warn_of_soil(path: Path, law: str, parameters: Iterable[SlopeParameter]) -> None:
    """Warn of parameters that a law of rebound in closed form does not know."""
    for parameter in parameters:
        if parameter.column.part == "soil":
            warnings.warn(
                f"{path}, key {FIT}.{parameter.name}: is a parameter of the soil, "
                f"which the law {law} does not know: it acts where blocks slide, if "
                f"at all; [{FIT}.{CONTACTS}] takes the parameters of the law",
                stacklevel=3,
            )


def _read_law_parameters(top: Key, fit: dict, merged: dict) -> list[SlopeParameter]:
    """Take the priors of a contact law out of `fit`, and put their medians into the
    study, which must have a value for each."""
    if CONTACTS not in fit:
        return []
    priors = typed(top[FIT], fit, CONTACTS, dict)
    del fit[CONTACTS]
    table = typed(top, merged, CONTACTS, dict, {})
    columns, parameters = columns_of_law(top, table), []
    if not columns:
        raise top[FIT][CONTACTS].error(
            "is for a law in closed form, with parameters of its own"
        )
    for name, value in priors.items():
        if name not in columns:
            raise unknown(top[FIT][CONTACTS], name, columns)
        parameters.append(_parameter(top, f"{CONTACTS}.{name}", value, columns[name]))
        table[name] = float(parameters[-1].prior.values(ENDS)[1])
    return parameters


def _read_parameters(
    top: Key, fit: dict, ground: dict, soil: Soil
) -> tuple[SlopeParameter, ...]:
    """Read the priors; InputError for names that are unknown and for what is no
    prior."""
    columns, parameters = ground_columns(soil), []
    for name, value in fit.items():
        if name not in PARTS:
            if name not in columns:
                known = (*columns, *PARTS, CONTACTS, "data_sets")
                raise unknown(top[FIT], name, known)
            parameters.append(_parameter(top, f"ground.{name}", value, columns[name]))
            continue
        for part, quantities in typed(top[FIT], fit, name, dict).items():
            where = top[FIT][name][part]
            known = ground.get(name, {})
            if name == "materials" and part not in known:
                hint = f"; did you mean {nearest(part, known)}?" if known else ""
                raise where.error(f"is no material of [ground.materials]{hint}")
            for inner, prior in of_kind(where, quantities, dict).items():
                if inner not in columns:
                    raise unknown(where, inner, columns)
                key = f"ground.{name}.{part}.{inner}"
                parameters.append(_parameter(top, key, prior, columns[inner]))
    return tuple(parameters)


def _parameter(top: Key, key: str, value, column: InputColumn) -> SlopeParameter:
    where = top[FIT][key.removeprefix("ground.")]
    prior = read_ground_quantity(where, value, column)
    if not isinstance(prior, Distribution):
        raise where.error(
            "must be a prior: { from, to }, { mean, sd } or { median, geometric_sd }, "
            "the last two with least and most if wanted"
        )
    ends = prior.values(ENDS)
    if not np.all(column.is_allowed(ends)):
        raise where.error(
            f"must be {column.requirement}, but the prior reaches from {ends[0]:g} to "
            f"{ends[-1]:g}; least and most truncate it"
        )
    return SlopeParameter(key, prior, column)


def _merge(into: dict, table: dict) -> None:
    """Put the priors in place of what [ground] says."""
    for name, value in table.items():
        if name in PARTS:
            for part, quantities in value.items():
                into.setdefault(name, {}).setdefault(part, {}).update(quantities)
        else:
            into[name] = value

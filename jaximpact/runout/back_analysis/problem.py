"""Back-analysis as a study's file states it: parameters with priors, and
observations."""

import copy
import dataclasses
import json
import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import did_you_mean
from ...identity import part_names
from ...io.checks import check_memory
from ...io.files import by_name, read_input
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

    key: str  # key in the study: ground.materials.scree.gamma_v, or contacts.e_n
    prior: Distribution  # prior, in the unit of the name
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
    data_sets: int  # number of data sets behind the posterior
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


def read_slope_fit(path: Path) -> SlopeFit:
    """Read a back-analysis; `jaximpact calibrate --help` describes the file.

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
    soil = GroundInput.read(top, content).soil
    parameters = tuple(
        _parameter(top, *prior) for prior in _priors(top, content, fit, soil)
    )
    if not parameters:
        raise top[FIT].error("names no parameter to fit")
    slope = read_slope_input(top, _with_priors(content, fit, parameters))
    if len(slope.laws) > 1:
        raise top["contacts"].error(f"names {len(slope.laws)} laws; a fit takes one")
    (law,) = slope.laws
    if isinstance(law.contacts, ClosedForm):
        _warn_of_soil(path, law.name, parameters)
    of_law = [p.column.name for p in parameters if p.key.startswith(CONTACTS)]
    fitted = dict.fromkeys(of_law, "fitted")
    law = law._replace(description=law.description | fitted)
    profile = slope.layout.profile
    # What was observed and what the priors are changes no simulated block.
    rest = {k: v for k, v in content.items() if k not in ("observed", FIT, "title")}
    files = by_name(slope.checksums | law.checksums)
    observed = read_observed(top, content, profile, slope.seed)
    # Those of a user with a digest of their code: data sets of other code are not used.
    parts = part_names(slope.ground.soil, slope.blocks.base)
    back_analysis = SlopeFit(
        path=path,
        title=typed(top, content, "title", str, path.stem),
        slope=slope._replace(laws=[law]),
        parameters=parameters,
        observed=observed,
        barriers=read_barriers(top, content, profile),
        data_sets=data_sets,
        identity=json.dumps([rest, files, law.description, parts], default=str),
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


def _priors(
    top: Key, content: dict, fit: dict, soil: Soil
) -> Iterator[tuple[str, Any, InputColumn]]:
    """Yield key, prior and column of each parameter, those of a contact law last;
    InputError for names that are unknown."""
    where, ground = top[FIT], typed(top, content, "ground", dict, {})
    columns = ground_columns(soil)
    for name in sorted(fit, key=lambda name: name == CONTACTS):
        if name == CONTACTS:
            priors = typed(where, fit, CONTACTS, dict)
            of_law = columns_of_law(top, typed(top, content, CONTACTS, dict, {}))
            if not of_law:
                raise where[CONTACTS].error(
                    "is for a law in closed form, with parameters of its own"
                )
            for inner, prior in priors.items():
                if inner not in of_law:
                    raise unknown(where[CONTACTS], inner, of_law)
                yield f"{CONTACTS}.{inner}", prior, of_law[inner]
        elif name in PARTS:
            for part, quantities in typed(where, fit, name, dict).items():
                key, known = where[name][part], ground.get(name, {})
                if name == "materials" and part not in known:
                    hint = f"; {did_you_mean(part, known)}" if known else ""
                    raise key.error(f"is no material of [ground.materials]{hint}")
                for inner, prior in of_kind(key, quantities, dict).items():
                    if inner not in columns:
                        raise unknown(key, inner, columns)
                    yield f"ground.{name}.{part}.{inner}", prior, columns[inner]
        elif name in columns:
            yield f"ground.{name}", fit[name], columns[name]
        else:
            raise unknown(where, name, (*columns, *PARTS, CONTACTS, "data_sets"))


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


def _with_priors(
    content: dict, fit: dict, parameters: Iterable[SlopeParameter]
) -> dict:
    """Put the priors in place of what a study says; of a contact law, which must have a
    value for each parameter, their medians."""
    merged = copy.deepcopy(content)
    for parameter in parameters:
        *tables, name = parameter.key.split(".")
        into, prior = merged, fit
        for inner in tables:
            into = into.setdefault(inner, {})
            prior = prior if inner == "ground" else prior[inner]
        of_law = tables == [CONTACTS]
        median = float(parameter.prior.values(ENDS)[1])
        into[name] = median if of_law else prior[name]
    return merged

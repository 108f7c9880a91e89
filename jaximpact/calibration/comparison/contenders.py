"""Laws that are compared: grounds of the model, and laws of rebound."""

import contextlib
import dataclasses
import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from ..._checks import expect
from ...errors import InputError, did_you_mean
from ...finding import find_class, shipped
from ...laws.bearing import VesicWithInertia
from ...laws.elasticity import ContactPressureModulus
from ...parameters import Part, declared_of, parts_of
from ...quantities import BASES, USUAL, columns_of_part, shipped_parts
from ...rebound import (
    AbstractRebound,
    AnglePowerLaw,
    ConstantCoefficients,
    PfeifferBowen,
    RigidEllipsoid,
)
from ...scene import Soil
from ...scene_quantities import part_named
from ..problem.config import Study, Variant
from ..problem.laws import in_words, unusual, values_by_column

MODEL, COHESION = "model", "cohesion_kPa"
MODULUS = {"elasticity": ContactPressureModulus}
INERTIA = {"bearing": VesicWithInertia}
GROUNDS = {
    "model with cohesion": ({}, (COHESION,)),
    "model with modulus at contact pressure": (MODULUS, ()),
    "model with inertia": (INERTIA, ()),
    "model with modulus at contact pressure and cohesion": (MODULUS, (COHESION,)),
    "model with inertia and cohesion": (INERTIA, (COHESION,)),
}
"""Grounds that are compared with the model unless others are named: laws that take the
place of the study's, and parameters that are fitted beside the study's."""
SOIL_SLOTS = tuple(parts_of(Soil))
SIMPLE = (ConstantCoefficients, PfeifferBowen)
"""Laws of rebound that stand beside every prediction."""
REBOUND = (*SIMPLE, AnglePowerLaw, RigidEllipsoid)
"""Laws of rebound that are compared unless others are named."""

Law = str | type[AbstractRebound] | AbstractRebound | Soil | Part


class Contender(NamedTuple):
    """One of the laws that are compared."""

    name: str
    law: type[AbstractRebound] | Variant
    """Class of a law of rebound, or the ground of the model."""
    more: tuple[str, ...] = ()
    """Parameters that are fitted beside those of the study."""

    @property
    def is_rebound(self) -> bool:
        """Whether it is a law of rebound, without time and soil."""
        return not isinstance(self.law, Variant)


def default_contenders(study: Study) -> list[Contender]:
    """List the model as the study has it, `GROUNDS` as far as they differ from it, and
    laws of rebound; the first four answer most questions."""
    contenders = [_of_variant(variant, study) for variant in study.variants]
    grounds = (_ground(name, study) for name in GROUNDS)
    contenders += [ground for ground in grounds if isinstance(ground, Contender)]
    return contenders + [Contender(law.words, law) for law in REBOUND]


def contenders_of(laws: Iterable[Law] | None, study: Study) -> list[Contender]:
    """Resolve the laws that a user names.

    Args:
        laws: as for `compare`; files are relative to the study. None for
            `default_contenders`.

    Raises InputError for a law that is unknown or stands twice.
    """
    if laws is None:
        return default_contenders(study)
    if isinstance(laws, str):
        laws = (laws,)
    expect("laws", laws, Iterable)
    contenders = []
    for law in laws:
        contenders += (
            _named(law, study) if isinstance(law, str) else [_given(law, study)]
        )
    names = [contender.name for contender in contenders]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"laws names {name!r} twice; leave one out")
    if not contenders:
        raise InputError("laws is empty; name at least one, such as 'model'")
    return contenders


def _given(law, study: Study) -> Contender:
    kind = law if isinstance(law, type) else type(law)
    if issubclass(kind, AbstractRebound):
        return Contender(kind.words or kind.__name__, kind)
    first = study.variants[0]
    if isinstance(law, Soil):
        laws = {slot: getattr(law, slot) for slot in SOIL_SLOTS}
        name = in_words(unusual(laws)) or "usual laws"
        return _with_values(Variant(name, first.soil, laws), law, SOIL_SLOTS, study)
    for slot in SOIL_SLOTS:
        if isinstance(law, BASES[slot]):
            replaced = _replacing(first, slot, law)
            return _with_values(replaced, Soil(**{slot: law}), (slot,), study)
    raise InputError(
        "laws must hold names, Soils, laws of the soil or laws of rebound, but holds "
        f"{law!r}"
    )


def _with_values(
    variant: Variant, soil: Soil, slots: tuple[str, ...], study: Study
) -> Contender:
    """Make a contender of laws given as objects, with those of their values that are no
    defaults; fitted ones, and those of the tables, stay."""
    of_soil = values_by_column("laws", soil, slots, whole_too=slots == SOIL_SLOTS)
    columns = columns_of_part("soil", soil)
    one_each = (*study.parameters, *study.tied, *study.nuisances)
    taken = {*study.tests.inputs, *(one.name for one in one_each)}
    own = {
        name: value
        for name, value in of_soil.items()
        if name not in taken
        and not math.isclose(value, columns[name].default, rel_tol=1e-12)
    }
    words = (f"{name} {value:g}" for name, value in own.items())
    name = ", ".join([variant.name, *words])
    return _contender(Variant(name, variant.soil | own, variant.laws))


def _named(text: str, study: Study) -> list[Contender]:
    """Find what a text names; several contenders where it is "model" and the study has
    several variants."""
    if _folded(text) == MODEL:
        return [_of_variant(variant, study) for variant in study.variants]
    for name in GROUNDS:
        if _folded(text) == _folded(name):
            ground = _ground(name, study)
            if isinstance(ground, str):
                raise InputError(f"{name!r} cannot be compared: {ground}")
            return [ground]
    known = [MODEL, *GROUNDS]
    for law in shipped(AbstractRebound):
        if _folded(text) in (_folded(law.words), _folded(law.__name__)):
            return [Contender(law.words, law)]
        known.append(law.words)
    if ":" in text:
        return [_from_file(text, study)]
    for slot in SOIL_SLOTS:
        for kind in shipped_parts(slot):
            if _folded(text) == _folded(kind.__name__):
                return [_contender(_replacing(study.variants[0], slot, kind()))]
            known.append(kind.__name__)
    raise InputError(f"law {text!r} is unknown; {did_you_mean(text, known, repr)}")


def _from_file(text: str, study: Study) -> Contender:
    """Find a class of a user's file among laws of rebound and of every slot."""
    directory = study.path.parent
    with _other_base_allowed():
        law = find_class("law of rebound", AbstractRebound, text, directory)
        return Contender(law.__name__, law)
    for slot in SOIL_SLOTS:
        with _other_base_allowed():
            part = part_named(slot, text, directory)
            return _contender(_replacing(study.variants[0], slot, part))
    raise InputError(
        f"law {text!r} derives from no law of the ground and from no law of rebound"
    )


@contextlib.contextmanager
def _other_base_allowed() -> Iterator[None]:
    """Pass over the InputError for a class that derives from another base."""
    try:
        yield
    except InputError as error:
        if "must derive" not in str(error):
            raise


def _of_variant(variant: Variant, study: Study) -> Contender:
    name = MODEL if len(study.variants) == 1 else f"{MODEL}, {variant.name}"
    return Contender(name, variant)


def _ground(name: str, study: Study) -> Contender | str:
    """Make one of `GROUNDS`; or say why it is no other ground than the study's."""
    laws, more = GROUNDS[name]
    first = study.variants[0]
    own = {slot: USUAL[slot]() for slot in laws | {"bearing": None}}
    own |= study.parts | first.laws
    for slot, kind in laws.items():
        if type(own[slot]) is kind:
            return f"the study has {kind.__name__} already"
    laws = {slot: kind() for slot, kind in laws.items()}
    declared = declared_of(type((own | laws)["bearing"])).values()
    stated = {*study.soil, *first.soil, *study.tests.inputs}
    stated |= {one.name for one in (*study.parameters, *study.tied)}
    if more and COHESION not in {one.column for one in declared} - stated:
        return f"the study fits or states {COHESION}, or its bearing has none"
    if laws:
        first = dataclasses.replace(first, name=name, laws={**first.laws, **laws})
    return Contender(name, first, more)


def _contender(variant: Variant) -> Contender:
    return Contender(variant.name, variant)


def _replacing(variant: Variant, slot: str, part: Part) -> Variant:
    name = f"{slot.replace('_', ' ')} {type(part).__name__}"
    if type(part) is USUAL[slot]:
        name += " (usual)"
    laws = {**variant.laws, slot: part}
    return dataclasses.replace(variant, name=name, laws=laws)


def _folded(name: str) -> str:
    return "".join(c for c in name.lower() if c.isalnum())

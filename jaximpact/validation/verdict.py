"""What is said of a claim, and on what grounds."""

import dataclasses
import enum
from collections.abc import Mapping


class Verdict(enum.StrEnum):
    """Whether the model bears a claim out."""

    holds = "holds"
    """In all the parts that its criterion names."""
    partly = "partly"
    """In some."""
    fails = "fails"
    """In none."""
    not_computed = "not computed"
    """Nothing is known; the evidence says why."""


@dataclasses.dataclass(frozen=True)
class Judgement:
    """A verdict and what decides it."""

    verdict: Verdict
    evidence: str
    """The numbers that decide, with units, in a line."""
    numbers: Mapping[str, float] = dataclasses.field(default_factory=dict)
    """The same for programs; each name ends in its unit where it has one."""
    parts: int = 0
    """How many parts the criterion names."""
    parts_that_hold: int = 0


@dataclasses.dataclass(frozen=True)
class Finding:
    """A claim, from where, how it is judged, and the judgement."""

    id: str
    where: str
    claim: str
    criterion: str
    judgement: Judgement

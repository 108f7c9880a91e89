"""What is said of a claim, and on what grounds."""

import dataclasses
import enum
from collections.abc import Mapping


class Verdict(enum.StrEnum):
    """Whether the model bears a claim out, or does as a law says."""

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
    """What decides, in a line, numbers with their units."""
    numbers: Mapping[str, float] = dataclasses.field(default_factory=dict)
    """The numbers of the evidence; names end in the unit where there is one."""
    held: int = 0
    asked: int = 0
    """Of the checks that the criterion asks for, how many there are and how many hold:
    steps of trends, places of conditions."""


@dataclasses.dataclass(frozen=True)
class Finding:
    """A claim, where it stands, how it is judged, and the judgement."""

    id: str
    where: str
    claim: str
    criterion: str
    judgement: Judgement


class NotComputed(Exception):
    """What a claim is judged by could not be computed; the message says why."""

"""All that a validation found."""

from typing import NamedTuple

from .claims import JUDGES
from .verdict import Finding, Judgement, Verdict

ByReading = dict[str, dict[str, Judgement]]
"""Reading -> claim -> judgement."""


class Validation(NamedTuple):
    """All findings."""

    claims: list[Finding]
    laws: list[Finding]
    readings: ByReading
    """Empty if they were not asked for."""

    @property
    def missing(self) -> list[str]:
        """Ids of what should have been computed and was not."""
        return [
            finding.id
            for finding in (*self.claims, *self.laws)
            if finding.judgement.verdict is Verdict.not_computed
            and (finding.id in JUDGES or finding in self.laws)
        ]

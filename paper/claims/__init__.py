"""The paper's claims: what each says (claims.csv), and a function that judges it.

A function gets a `Study`, which has datasets by name, and gives a `Judgement`; what it
asks for stands as the criterion in claims.csv, which was written down before anything
was computed.
"""

import csv
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from jaximpact.parametric_sets import GROUNDS

from ..criteria import Judgement, Verdict, condition, judge
from ..study import Study
from . import impacts, restitution, slope

Judge = Callable[[Study], Judgement]


class Claim(NamedTuple):
    """A row of claims.csv."""

    id: str
    where: str
    claim: str
    criterion: str


def read_claims() -> dict[str, Claim]:
    """Read every claim by its id."""
    text = Path(__file__).with_name("claims.csv").read_text("utf-8")
    return {row["id"]: Claim(**row) for row in csv.DictReader(text.splitlines())}


OF_SETS: dict[str, Judge] = impacts.CLAIMS | restitution.CLAIMS
"""Judges of the claims on sets I to IV, in the order of their ids."""


def alike_on_other_grounds(study: Study) -> Judgement:
    """Judge whether the claims of sets I to IV have the same verdict on the other two
    grounds."""
    table_1, *others = (
        {name: judge(study.on(ground)).verdict for name, judge in OF_SETS.items()}
        for ground in GROUNDS
    )

    def in_words(ground: str, verdicts: dict[str, Verdict]) -> str:
        counts = Counter(verdicts.values())
        kinds = (Verdict.holds, Verdict.partly, Verdict.fails)
        return f"{ground}: " + "/".join(str(counts[kind]) for kind in kinds)

    parts, words = [], [in_words(GROUNDS[0], table_1)]
    for ground, verdicts in zip(GROUNDS[1:], others, strict=True):
        parts += [condition(verdicts[name] == table_1[name]) for name in OF_SETS]
        changes = ", ".join(
            f"{name} {verdicts[name]}"
            for name in OF_SETS
            if verdicts[name] != table_1[name]
        )
        words.append(f"{in_words(ground, verdicts)}, others: {changes or 'none'}")
    return judge("; ".join(words), *parts)


SUPPLEMENT = "C38"
"""The claim of the supplementary material, on other pairs of c_v and gamma_v; it is not
judged again under every reading."""
JUDGES: dict[str, Judge] = (
    OF_SETS
    | restitution.FURTHER_CLAIMS
    | impacts.SPHERICITY_CLAIMS
    | slope.CLAIMS
    | {SUPPLEMENT: alike_on_other_grounds}
)
"""Functions by the id of the claim that they judge."""
SLOPE_CLAIMS = tuple(slope.CLAIMS)
"""Claims on slope run-out, which have readings of their own."""

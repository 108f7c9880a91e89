"""Judgements in words, and in tables of Markdown and CSV."""

import textwrap
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

import pandas as pd

from .claims import Claim
from .criteria import Judgement, Verdict
from .readings import AS_IT_IS

WIDTH = 100
LETTERS = {
    Verdict.holds: "H",
    Verdict.partly: "P",
    Verdict.fails: "F",
    Verdict.not_computed: "?",
}
RANKS = {Verdict.holds: 2, Verdict.partly: 1, Verdict.fails: 0}
SAME = "·"
Judgements = Mapping[str, Judgement]
"""Claim -> judgement."""
ByReading = dict[str, dict[str, Judgement]]
"""Reading -> claim -> judgement."""


def in_words(claim: Claim, judgement: Judgement) -> str:
    """Write a claim, its verdict, and what decides."""
    head = f"{claim.id}  {judgement.verdict:<12}  "
    below = " " * len(head)
    said = textwrap.fill(
        claim.claim, WIDTH, initial_indent=head, subsequent_indent=below
    )
    below += "  "
    evidence = textwrap.fill(
        judgement.evidence, WIDTH, initial_indent=below, subsequent_indent=below
    )
    return f"{said}\n{evidence}\n"


def counts(judgements: Judgements) -> str:
    """Write how many claims have which verdict."""
    words = {
        Verdict.holds: "hold",
        Verdict.partly: "hold partly",
        Verdict.fails: "fail",
        Verdict.not_computed: "not computed",
    }
    number = Counter(judgement.verdict for judgement in judgements.values())
    kinds = [f"{number[kind]} {word}" for kind, word in words.items() if number[kind]]
    return f"{len(judgements)} claims: {', '.join(kinds)}"


def claims_table(claims: Mapping[str, Claim], judgements: Judgements) -> str:
    """Write a row of CSV for each claim."""
    return _csv(
        claims[name]._asdict() | _cells(judgement)
        for name, judgement in judgements.items()
    )


def readings_table(readings: ByReading) -> str:
    """Write a row of CSV for each reading and claim."""
    return _csv(
        {"reading": reading, "id": name, **_cells(judgement)}
        for reading, judgements in readings.items()
        for name, judgement in judgements.items()
    )


def _cells(judgement: Judgement) -> dict[str, str | int]:
    names = ("verdict", "met", "asked", "evidence")
    return {name: getattr(judgement, name) for name in names}


def _csv(rows: Iterable[Mapping]) -> str:
    return pd.DataFrame(rows).to_csv(index=False, lineterminator="\n")


def claims_page(claims: Mapping[str, Claim], judgements: Judgements) -> str:
    """Write the judgements and the criteria in tables of Markdown."""
    header = ("", "where", "claim", "verdict", "what decides")
    rows, criteria = [], []
    for name, judgement in judgements.items():
        claim, verdict = claims[name], judgement.verdict
        shown = f"**{verdict}**" if verdict is Verdict.fails else str(verdict)
        rows.append((name, claim.where, claim.claim, shown, judgement.evidence))
        criteria.append((name, claim.criterion))
    return (
        f"{markdown_table(header, rows)}\n{counts(judgements)}.\n\n"
        f"{markdown_table(('', 'criterion'), criteria)}"
    )


def markdown_table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Write a table in Markdown; bars in cells are escaped."""
    lines = [header, ("---",) * len(header), *rows]
    return "".join(
        "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"
        for cells in lines
    )


def readings_page(readings: ByReading) -> str:
    """Write what other readings change in tables of Markdown: first the readings that
    were asked of sets, then those of the slope run-out."""
    as_it_is, others = readings[AS_IT_IS.name], dict(readings)
    del others[AS_IT_IS.name]
    groups: dict[tuple[str, ...], ByReading] = {}
    for reading, judgements in others.items():
        groups.setdefault(tuple(judgements), {})[reading] = judgements
    parts = ["H holds, P partly, F fails, · as it is:\n"]
    for names, group in groups.items():
        before = {name: as_it_is[name] for name in names}
        parts += [matrix(before, group), moves(before, group)]
    return "\n".join(parts)


def matrix(as_it_is: Judgements, others: ByReading) -> str:
    """Write the verdicts by claim and reading, letters where a reading changes them."""
    rows = []
    for name, judgement in as_it_is.items():
        letter = LETTERS[judgement.verdict]
        changed = [LETTERS[other[name].verdict] for other in others.values()]
        rows.append([name, letter, *(SAME if x == letter else x for x in changed)])
    holding = (
        sum(judgement.verdict is Verdict.holds for judgement in judgements.values())
        for judgements in (as_it_is, *others.values())
    )
    rows.append(["hold", *map(str, holding)])
    legend = "".join(f"{number}. {name}\n" for number, name in enumerate(others, 1))
    numbers = map(str, range(1, len(others) + 1))
    return f"{legend}\n{markdown_table(('', 'as it is', *numbers), rows)}"


def moves(as_it_is: Judgements, others: ByReading) -> str:
    """Find, for each claim that does not hold, which readings move it, and how far."""
    rows = []
    for name, judgement in as_it_is.items():
        rank = RANKS.get(judgement.verdict)
        if rank is None or rank == RANKS[Verdict.holds]:
            continue
        ranks = {
            reading: RANKS.get(judgements[name].verdict, rank)
            for reading, judgements in others.items()
        }
        better = [reading for reading, other in ranks.items() if other > rank]
        worse = [reading for reading, other in ranks.items() if other < rank]
        nearest = max(others, key=lambda r: (ranks[r], _share(others[r][name])))
        best, gain = others[nearest][name], "none"
        if ranks[nearest] > rank or _share(best) > _share(judgement):
            gain = f"{nearest}: {_tally(best)}: {best.evidence}"
        lists = (", ".join(readings) or "none" for readings in (better, worse))
        rows.append((name, _tally(judgement), *lists, gain))
    header = ("", "as it is", "better with", "worse with", "nearest")
    return markdown_table(header, rows)


def _share(judgement: Judgement) -> float:
    return judgement.met / max(judgement.asked, 1)


def _tally(judgement: Judgement) -> str:
    return f"{judgement.verdict}, {judgement.met} of {judgement.asked}"

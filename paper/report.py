"""All findings of a validation, and as text, Markdown and CSV."""

import csv
import io
import textwrap
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from .claims import JUDGES
from .criteria import Finding, Judgement, Verdict
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
FINDING_COLUMNS = ("id", "where", "claim", "criterion")
JUDGEMENT_COLUMNS = ("verdict", "held", "asked", "evidence")
ByReading = dict[str, dict[str, Judgement]]
"""Reading -> claim -> judgement."""


class Validation(NamedTuple):
    """All findings."""

    claims: list[Finding]
    readings: ByReading
    """Empty if they were not asked for."""

    @property
    def missing(self) -> list[str]:
        """Ids of what should have been computed and was not."""
        return [
            finding.id
            for finding in self.claims
            if finding.judgement.verdict is Verdict.not_computed
            and finding.id in JUDGES
        ]


def as_text(validation: Validation) -> str:
    """Write the findings one below another, what they say and what decides, then
    counts."""
    parts = [*map(_lines, validation.claims), f"{_counts(validation.claims)}\n"]
    parts += map(_matrix_text, _groups(validation.readings))
    return "\n".join(parts)


def _lines(finding: Finding) -> str:
    head = f"{finding.id}  {finding.judgement.verdict:<12}  "
    below = " " * len(head)
    claim = textwrap.fill(
        finding.claim, WIDTH, initial_indent=head, subsequent_indent=below
    )
    below += "  "
    evidence = textwrap.fill(
        finding.judgement.evidence,
        WIDTH,
        initial_indent=below,
        subsequent_indent=below,
    )
    return f"{claim}\n{evidence}\n"


def _counts(findings: list[Finding]) -> str:
    """Write how many have which verdict."""
    words = {
        Verdict.holds: "hold",
        Verdict.partly: "hold partly",
        Verdict.fails: "fail",
        Verdict.not_computed: "not computed",
    }
    found = Counter(finding.judgement.verdict for finding in findings)
    counts = [f"{found[v]} {word}" for v, word in words.items() if found[v]]
    return f"{len(findings)} claims: {', '.join(counts)}"


def as_csv(findings: Iterable[Finding]) -> str:
    """Write a row for each finding."""
    rows = [{**vars(finding), **vars(finding.judgement)} for finding in findings]
    return _csv((*FINDING_COLUMNS, *JUDGEMENT_COLUMNS), rows)


def readings_csv(readings: ByReading) -> str:
    """Write a row for each reading and claim."""
    rows = [
        {"reading": reading, "id": name, **vars(judgement)}
        for reading, judgements in readings.items()
        for name, judgement in judgements.items()
    ]
    return _csv(("reading", "id", *JUDGEMENT_COLUMNS), rows)


def _csv(columns: tuple[str, ...], rows: Iterable[dict]) -> str:
    file = io.StringIO()
    writer = csv.DictWriter(file, columns, extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return file.getvalue()


def as_markdown(validation: Validation) -> str:
    """Write the findings in tables, and what the readings change."""
    header = ("", "where", "claim", "verdict", "what decides")
    rows = [
        (f.id, f.where, f.claim, _marked(f.judgement.verdict), f.judgement.evidence)
        for f in validation.claims
    ]
    parts = [markdown_table(header, rows), f"{_counts(validation.claims)}.\n"]
    asked = [(f.id, f.criterion) for f in validation.claims if f.judgement.asked]
    parts.append(markdown_table(("", "criterion"), asked))
    for group in _groups(validation.readings):
        parts += [matrix_markdown(group), moves(group)]
    return "\n".join(parts)


def _marked(verdict: Verdict) -> str:
    return f"**{verdict}**" if verdict is Verdict.fails else str(verdict)


def markdown_table(header: tuple[str, ...], rows: Iterable[Sequence[str]]) -> str:
    """Write a table in Markdown; bars in cells are escaped."""
    lines = [header, ("---",) * len(header), *rows]
    return "".join(
        "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"
        for cells in lines
    )


def _groups(readings: ByReading) -> list[ByReading]:
    """Readings under which the same claims were judged, each group with the first
    reading at its head."""
    if not readings:
        return []
    as_it_is, others = _split(readings)
    groups: dict[tuple[str, ...], ByReading] = {}
    for name, found in others.items():
        groups.setdefault(tuple(found), {})[name] = found
    return [
        {AS_IT_IS.name: {name: as_it_is[name] for name in names}} | group
        for names, group in groups.items()
    ]


def _matrix(readings: ByReading) -> tuple[list[str], list[list[str]]]:
    """Readings but the first, and for each claim its letters: under the first, then
    under each of the others where it is another one."""
    as_it_is, others = _split(readings)
    rows = []
    for name, judgement in as_it_is.items():
        letter = LETTERS[judgement.verdict]
        changed = (LETTERS[found[name].verdict] for found in others.values())
        rows.append([name, letter, *(SAME if x == letter else x for x in changed)])
    holding = (
        [found.verdict for found in judgements.values()].count(Verdict.holds)
        for judgements in readings.values()
    )
    return list(others), [*rows, ["hold", *map(str, holding)]]


def _split(readings: ByReading) -> tuple[Mapping[str, Judgement], ByReading]:
    others = {name: found for name, found in readings.items() if name != AS_IT_IS.name}
    return readings[AS_IT_IS.name], others


def _matrix_text(readings: ByReading) -> str:
    names, rows = _matrix(readings)
    header = ["", "", *(str(number) for number in range(1, len(names) + 1))]
    lines = [
        f"{cells[0]:<5}{cells[1]:<3}" + "".join(f"{cell:>3}" for cell in cells[2:])
        for cells in (header, *rows)
    ]
    legend = [f"  {number:>2}  {name}" for number, name in enumerate(names, start=1)]
    return (
        "verdicts under other readings (H holds, P partly, F fails; "
        f"{SAME} as it is):\n\n" + "\n".join(lines) + "\n\n" + "\n".join(legend) + "\n"
    )


def matrix_markdown(readings: ByReading) -> str:
    """Write the verdicts by claim and reading, letters where they differ from the
    first."""
    names, rows = _matrix(readings)
    numbers = [str(number) for number in range(1, len(names) + 1)]
    legend = "\n".join(f"{number}. {name}" for number, name in enumerate(names, 1))
    return legend + "\n\n" + markdown_table(("", "as it is", *numbers), rows)


def moves(readings: ByReading) -> str:
    """Find, for each claim that does not hold, which readings move it, and how far."""
    as_it_is, others = _split(readings)
    rows = []
    for name, judgement in as_it_is.items():
        rank = RANKS.get(judgement.verdict)
        if rank is None or rank == RANKS[Verdict.holds]:
            continue
        found = {reading: judgements[name] for reading, judgements in others.items()}
        moved = {r: RANKS.get(other.verdict, rank) for r, other in found.items()}
        better = [reading for reading, to in moved.items() if to > rank]
        worse = [reading for reading, to in moved.items() if to < rank]
        nearest = max(others, key=lambda r: (moved[r], _share(found[r])))
        best = found[nearest]
        gain = "none"
        if moved[nearest] > rank or _share(best) > _share(judgement):
            gain = f"{nearest}: {_tally(best)}: {best.evidence}"
        lists = (", ".join(readings) or "none" for readings in (better, worse))
        rows.append((name, _tally(judgement), *lists, gain))
    header = ("", "as it is", "better with", "worse with", "nearest")
    return markdown_table(header, rows)


def _share(judgement: Judgement) -> float:
    return judgement.held / max(judgement.asked, 1)


def _tally(judgement: Judgement) -> str:
    return f"{judgement.verdict}, {judgement.held} of {judgement.asked}"

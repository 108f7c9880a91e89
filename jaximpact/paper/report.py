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


def as_text(validation: Validation) -> str:
    """The findings one below another, what they say and what decides, then counts."""
    parts = []
    for findings, of in ((validation.claims, "claims"), (validation.laws, "laws")):
        if findings:
            parts += [_lines(finding) for finding in findings]
            parts.append(f"{len(findings)} {of}: {counts(findings)}\n")
    parts += [_matrix_text(group) for group in _groups(validation.readings)]
    return "\n".join(parts)


def _lines(finding: Finding) -> str:
    head = f"{finding.id}  {finding.judgement.verdict:<12}  "
    margin = " " * len(head)
    claim = textwrap.fill(
        finding.claim, WIDTH, initial_indent=head, subsequent_indent=margin
    )
    evidence = textwrap.indent(
        textwrap.fill(finding.judgement.evidence, WIDTH - len(margin) - 2),
        margin + "  ",
    )
    return f"{claim}\n{evidence}\n"


def counts(findings: Iterable[Finding]) -> str:
    """How many have which verdict, in words."""
    found = Counter(finding.judgement.verdict for finding in findings)
    words = {
        Verdict.holds: "hold",
        Verdict.partly: "hold partly",
        Verdict.fails: "fail",
        Verdict.not_computed: "not computed",
    }
    return ", ".join(
        f"{found[verdict]} {word}" for verdict, word in words.items() if found[verdict]
    )


def as_csv(findings: Iterable[Finding]) -> str:
    """A row for each finding."""
    return _csv(
        (*FINDING_COLUMNS, *JUDGEMENT_COLUMNS),
        (
            (*(getattr(f, name) for name in FINDING_COLUMNS), *_cells(f.judgement))
            for f in findings
        ),
    )


def readings_csv(readings: ByReading) -> str:
    """A row for each reading and claim."""
    return _csv(
        ("reading", "id", *JUDGEMENT_COLUMNS),
        (
            (reading, name, *_cells(judgement))
            for reading, judgements in readings.items()
            for name, judgement in judgements.items()
        ),
    )


def _cells(judgement: Judgement) -> tuple:
    return tuple(getattr(judgement, name) for name in JUDGEMENT_COLUMNS)


def _csv(header: tuple[str, ...], rows: Iterable[tuple]) -> str:
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return file.getvalue()


def as_markdown(validation: Validation) -> str:
    """The findings in tables, and what the readings change."""
    parts = []
    for findings, of in ((validation.claims, "claims"), (validation.laws, "laws")):
        if findings:
            parts.append(
                markdown_table(
                    ("", "where", "claim", "verdict", "what decides"),
                    (
                        (
                            f.id,
                            f.where,
                            f.claim,
                            _marked(f.judgement.verdict),
                            f.judgement.evidence,
                        )
                        for f in findings
                    ),
                )
            )
            parts.append(f"{len(findings)} {of}: {counts(findings)}.\n")
    parts.append(
        markdown_table(
            ("", "criterion"),
            ((f.id, f.criterion) for f in validation.claims if f.judgement.asked),
        )
    )
    for group in _groups(validation.readings):
        parts += [matrix_markdown(group), moves(group)]
    return "\n".join(parts)


def _marked(verdict: Verdict) -> str:
    return f"**{verdict}**" if verdict is Verdict.fails else str(verdict)


def markdown_table(header: tuple[str, ...], rows: Iterable[Sequence[str]]) -> str:
    """A table in Markdown; bars in cells are escaped."""
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
    holding = [
        str(sum(found.verdict is Verdict.holds for found in judgements.values()))
        for judgements in readings.values()
    ]
    return list(others), [*rows, ["hold", *holding]]


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
    """Verdicts by claim and reading, letters where they differ from the first."""
    names, rows = _matrix(readings)
    numbers = [str(number) for number in range(1, len(names) + 1)]
    legend = "\n".join(f"{number}. {name}" for number, name in enumerate(names, 1))
    return legend + "\n\n" + markdown_table(("", "as it is", *numbers), rows)


def moves(readings: ByReading) -> str:
    """For each claim that does not hold: which readings move it, and how far."""
    as_it_is, others = _split(readings)
    rows = []
    for name, judgement in as_it_is.items():
        rank = RANKS.get(judgement.verdict)
        if rank is None or rank == RANKS[Verdict.holds]:
            continue
        moved = {
            reading: RANKS.get(found[name].verdict, rank)
            for reading, found in others.items()
        }
        better = [reading for reading, to in moved.items() if to > rank]
        worse = [reading for reading, to in moved.items() if to < rank]
        nearest = max(others, key=lambda r: (moved[r], _share(others[r][name])))
        best = others[nearest][name]
        gains = moved[nearest] > rank or _share(best) > _share(judgement)
        rows.append(
            (
                name,
                f"{judgement.verdict}, {judgement.held} of {judgement.asked}",
                ", ".join(better) or "none",
                ", ".join(worse) or "none",
                f"{nearest}: {best.verdict}, {best.held} of {best.asked}: "
                f"{best.evidence}"
                if gains
                else "none",
            )
        )
    return markdown_table(
        ("", "as it is", "better with", "worse with", "nearest"), rows
    )


def _share(judgement: Judgement) -> float:
    return judgement.held / max(judgement.asked, 1)

"""The tables of docs/validation.md, against what was computed."""

import re

import numpy as np
from paths import DOCS

from paper.claims import SLOPE_CLAIMS
from paper.criteria import Finding, Verdict

PAGE = DOCS / "validation.md"


def page() -> str:
    return PAGE.read_text(encoding="utf-8")


def assert_page_shows(findings: list[Finding], letter: str) -> None:
    """Rows whose ids begin with a letter are these findings: words, verdicts, and
    numbers to three digits. Those of runs down a slope are left out, in which rounding
    grows from impact to impact: another processor has other ones."""
    shown = []
    for line in page().splitlines():
        if re.match(rf"\| {letter}\d\d \|", line):
            cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
            if len(cells) == 5 and cells[3].strip("*") in set(Verdict):
                shown.append([cell.replace("\\|", "|") for cell in cells])
    assert [cells[0] for cells in shown] == [finding.id for finding in findings]
    for finding, (name, where, claim, verdict, evidence) in zip(
        findings, shown, strict=True
    ):
        assert (where, claim) == (finding.where, finding.claim)
        assert verdict.strip("*") == finding.judgement.verdict, name
        if name in SLOPE_CLAIMS:
            continue
        # What is zero is so to rounding.
        np.testing.assert_allclose(
            numbers_in(evidence),
            numbers_in(finding.judgement.evidence),
            rtol=5e-3,
            atol=1e-4,
            err_msg=name,
        )


def numbers_in(text: str) -> list[float]:
    return [float(x) for x in re.findall(r"-?\d+\.?\d*(?:e[-+]\d+)?", text)]

"""Validation from claims and laws to its files.

validation.md, validation.csv and validation.json hold the findings; readings.csv the
verdicts under every reading of the model, written after each of them, so that an
interrupted run goes on. What the laws are compared by is drawn.
"""

import contextlib
import csv
import json
import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from ..accuracy import get_accuracy
from ..errors import InputError, nearest
from ..formats.files import make_directory, replacing
from ..formats.provenance import versions
from ..interruption import resumable
from ..precision import require_float64
from .claims import JUDGES, SLOPE_CLAIMS, read_claims
from .comparison import Comparison
from .findings import ByReading, Validation
from .law_findings import as_findings
from .laws import compare_with_laws
from .readings import AS_IT_IS, READINGS, SLOPE_READINGS
from .report import as_csv, as_markdown, readings_csv
from .study import ACCURACY, RANDOM_IMPACTS, SEED, Study
from .verdict import Finding, Judgement, NotComputed, Verdict

LAWS = "laws"
SUPPLEMENT = "C38"
"""The claim about other grounds, which is not asked again under every reading."""
Say = Callable[[str], None]


def validate(
    out: Path | None = None,
    *,
    only: Sequence[str] = (),
    readings: bool = False,
    progress: Say | None = None,
    say: Say | None = None,
) -> Validation:
    """Judge the paper's claims, and compare the model with laws of others.

    Args:
        out: directory for the files, made if need be; None writes none.
        only: ids of claims, and `laws`; all for none.
        readings: also judge the claims under every reading of `READINGS`, those on runs
            down a slope under `SLOPE_READINGS`, and write them to `out`.
        progress: takes lines of progress.
        say: takes what is worth a line of its own.

    A claim that fails is a finding like any other. One whose impacts could not be
    computed has the verdict `not computed`, and its evidence says why.

    Raises InputError for an unknown id or a directory that cannot be made, RuntimeError
    if JAX is set to float32, OSError where the file system refuses.
    """
    require_float64()
    progress, say = (what or (lambda text: None) for what in (progress, say))
    claims = read_claims()
    chosen = _choose(only, claims)
    if out is not None:
        make_directory(out, option="--out")
    study = Study(say=progress)
    found = []
    for name, claim in claims.items():
        if name in chosen:
            progress(f"{name}: {claim.claim}")
            found.append(Finding(*claim, _judge(name, study, claim.criterion)))
    comparisons: list[Comparison] = []
    if LAWS in chosen:
        comparisons = compare_with_laws(
            lambda done, count: progress(f"laws: {done} of {count}")
        )
    by_reading = {}
    if readings:
        ids = [name for name in JUDGES if name in chosen and name != SUPPLEMENT]
        by_reading = {AS_IT_IS.name: {f.id: f.judgement for f in found if f.id in ids}}
        with contextlib.nullcontext() if out is None else resumable():
            by_reading |= _judge_readings(ids, out, progress, say)
    validation = Validation(found, as_findings(comparisons), by_reading)
    if out is not None:
        _write_all(out, validation, comparisons)
    return validation


def _choose(only: Sequence[str], claims: Mapping) -> set[str]:
    known = (*claims, LAWS)
    for name in only:
        if name not in known:
            raise InputError(
                f"--only takes {next(iter(claims))} to {list(claims)[-1]} and {LAWS}, "
                f"but got {name!r}; did you mean {nearest(name, known)!r}?"
            )
    return set(only or known)


def _judge(name: str, study: Study, criterion: str) -> Judgement:
    if name not in JUDGES:
        return Judgement(Verdict.not_computed, criterion.partition(": ")[2])
    try:
        return JUDGES[name](study)
    except NotComputed as error:
        return Judgement(Verdict.not_computed, str(error))


def _judge_readings(
    ids: Sequence[str], out: Path | None, progress: Say, say: Say
) -> ByReading:
    """Judgements under every reading; those of an earlier run into the same directory
    are taken over."""
    found: ByReading = {}
    known = {} if out is None else _read_readings(out)
    if known:
        say(
            f"{len(known)} readings computed before; remove {_readings_path(out)} to "
            "compute them again"
        )
    on_slopes = [name for name in ids if name in SLOPE_CLAIMS]
    others = [name for name in ids if name not in SLOPE_CLAIMS]
    asked = [(reading, others) for reading in READINGS if others]
    asked += [(reading, on_slopes) for reading in SLOPE_READINGS if on_slopes]
    for number, (reading, names) in enumerate(asked, start=1):
        before = known.get(reading.name, {})
        study = Study(
            reading=reading,
            say=lambda text, number=number: progress(
                f"reading {number} of {len(asked)}: {text}"
            ),
        )
        found[reading.name] = {
            name: before.get(name) or _judge(name, study, "") for name in names
        }
        if out is not None:
            known[reading.name] = before | found[reading.name]
            _write(_readings_path(out), readings_csv(known))
            _write(_conditions_path(out), _as_json(conditions()))
    return found


def conditions() -> dict:
    """What all findings depend on besides the package's own functions."""
    setting = get_accuracy(ACCURACY)
    return {
        "accuracy": {
            "name": setting.name,
            "tolerance": setting.tolerance,
            "floor": setting.floor,
        },
        "random_impacts": RANDOM_IMPACTS,
        "seed": SEED,
        "versions": versions(),
    }


def _readings_path(out: Path) -> Path:
    return out / "readings.csv"


def _conditions_path(out: Path) -> Path:
    return out / "readings.json"


def _read_readings(out: Path) -> ByReading:
    """What an earlier run under the same conditions has found."""
    path, stored = _readings_path(out), _conditions_path(out)
    if not (path.is_file() and stored.is_file()):
        return {}
    if json.loads(stored.read_text(encoding="utf-8")) != conditions():
        return {}
    known: ByReading = {}
    with open(path, encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            known.setdefault(row["reading"], {})[row["id"]] = Judgement(
                Verdict(row["verdict"]),
                row["evidence"],
                held=int(row["held"]),
                asked=int(row["asked"]),
            )
    return known


def _write_all(
    out: Path, validation: Validation, comparisons: list[Comparison]
) -> None:
    figures = {row.figure_name: row.draw for row in comparisons}
    for name, draw in figures.items():
        with replacing(out / f"{name}.png") as temporary:
            draw().savefig(temporary, dpi=120)
    _write(out / "validation.csv", as_csv((*validation.claims, *validation.laws)))
    _write(out / "validation.md", as_markdown(validation))
    findings = [_finding_json(f) for f in (*validation.claims, *validation.laws)]
    _write(
        out / "validation.json",
        _as_json({"manifest": conditions(), "findings": findings}),
    )


def _finding_json(finding: Finding) -> dict:
    judgement = finding.judgement
    return {
        "id": finding.id,
        "where": finding.where,
        "claim": finding.claim,
        "criterion": finding.criterion,
        "verdict": judgement.verdict,
        "held": judgement.held,
        "asked": judgement.asked,
        "evidence": judgement.evidence,
        "numbers": {
            name: value if math.isfinite(value) else None
            for name, value in judgement.numbers.items()
        },
    }


def _as_json(value: dict) -> str:
    return json.dumps(value, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _write(path: Path, text: str) -> None:
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")

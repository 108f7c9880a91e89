"""Validation from claims to its files.

validation.md, validation.csv and validation.json hold the findings; readings.csv the
verdicts under every reading of the model, written after each of them, so that an
interrupted run goes on.
"""

import contextlib
import csv
import dataclasses
import io
import json
import math
from collections.abc import Callable, Sequence
from pathlib import Path

from jaximpact._packages import versions
from jaximpact._precision import require_float64
from jaximpact.accuracy import get_accuracy
from jaximpact.interruption import resumable
from jaximpact.io.checks import chosen_values
from jaximpact.io.files import read_text, write_text
from jaximpact.io.output_files import NewFile, output_directory
from jaximpact.progress import Progress, ProgressFunction, as_progress

from .claim_data import ACCURACY, RANDOM_IMPACTS, SEED, Study
from .claims import JUDGES, SLOPE_CLAIMS, SUPPLEMENT, read_claims
from .criteria import Finding, Judgement, NotComputed, Verdict
from .readings import AS_IT_IS, READINGS, SLOPE_READINGS
from .report import (
    FINDING_COLUMNS,
    JUDGEMENT_COLUMNS,
    ByReading,
    Validation,
    as_csv,
    as_markdown,
    readings_csv,
)

FILES = ("validation.csv", "validation.md", "validation.json")
READINGS_FILES = READINGS_TABLE, READINGS_CONDITIONS = "readings.csv", "readings.json"
Say = Callable[[str], None]


def validate(
    out: Path | None = None,
    *,
    only: Sequence[str] = (),
    readings: bool = False,
    progress: Progress | ProgressFunction | None = None,
    say: Say | None = None,
) -> Validation:
    """Judge the paper's claims.

    Args:
        out: directory for the files, made if need be; those of an earlier run there are
            replaced or removed, but for readings of the same model. None writes none.
        only: ids of claims; all for none.
        readings: also judge the claims under every reading of `READINGS`, those on
            slope run-out under `SLOPE_READINGS`, and write them to `out`.
        progress: takes lines of progress.
        say: takes what is worth a line of its own.

    A claim that fails is a finding like any other. One whose impacts could not be
    computed has the verdict `not computed`, and its evidence says why.

    Raises InputError for an unknown id or a directory that cannot be used, RuntimeError
    if JAX is set to float32, OSError where the file system refuses or another process
    writes there.
    """
    require_float64()
    progress, say = as_progress(progress), say or (lambda text: None)
    claims = read_claims()
    chosen = chosen_values("--only", only, {name: name for name in claims})
    directory, kept = contextlib.nullcontext(), {}
    if out is not None:
        out = Path(out)
        kept = _read_readings(out)
        names = FILES + (READINGS_FILES if readings or kept else ())
        directory = output_directory(out, "claims", names)
    with directory as new:
        study = Study(progress=progress)
        found = []
        for name, claim in claims.items():
            if name in chosen:
                progress(f"{name}: {claim.claim}")
                found.append(Finding(*claim, _judge(name, study, claim.criterion)))
        by_reading = {}
        if readings:
            ids = [name for name in JUDGES if name in chosen and name != SUPPLEMENT]
            own = {f.id: f.judgement for f in found if f.id in ids}
            by_reading = {AS_IT_IS.name: own}
            if kept:
                say(
                    f"{len(kept)} readings computed before; remove "
                    f"{out}/{READINGS_TABLE} to compute them again"
                )
            with contextlib.nullcontext() if new is None else resumable():
                by_reading |= _judge_readings(ids, kept, new, progress)
        validation = Validation(found, by_reading)
        if new is not None:
            _write_all(new, validation)
            if kept:
                # Those of an earlier run are of the same model, and stay.
                for name in READINGS_FILES:
                    new(name)
    return validation


def _judge(name: str, study: Study, criterion: str) -> Judgement:
    if name not in JUDGES:
        return Judgement(Verdict.not_computed, criterion.partition(": ")[2])
    try:
        return JUDGES[name](study)
    except NotComputed as error:
        return Judgement(Verdict.not_computed, str(error))


def _judge_readings(
    ids: Sequence[str], kept: ByReading, new: NewFile | None, progress: Progress
) -> ByReading:
    """Judge the claims under every reading.

    Args:
        kept: those of an earlier run into the same directory, which are taken over.
        new: where to keep them all after each reading, if anywhere.
    """
    found: ByReading = {}
    asked = []
    for readings, on_slopes in ((READINGS, False), (SLOPE_READINGS, True)):
        names = [name for name in ids if (name in SLOPE_CLAIMS) == on_slopes]
        asked += [(reading, names) for reading in readings if names]
    for number, (reading, names) in enumerate(asked, start=1):
        before = kept.get(reading.name, {})
        study = Study(
            reading=reading,
            progress=progress.within(f"reading {number} of {len(asked)}: "),
        )
        found[reading.name] = {
            name: before.get(name) or _judge(name, study, "") for name in names
        }
        if new is not None:
            kept[reading.name] = before | found[reading.name]
            write_text(new(READINGS_TABLE), readings_csv(kept))
            write_text(new(READINGS_CONDITIONS), _as_json(conditions()))
    return found


def conditions() -> dict:
    """Collect what all findings depend on besides the package's own functions."""
    return {
        "accuracy": dataclasses.asdict(get_accuracy(ACCURACY)),
        "random_impacts": RANDOM_IMPACTS,
        "seed": SEED,
        "versions": versions(),
    }


def _read_readings(out: Path) -> ByReading:
    """What an earlier run under the same conditions has found; nothing where files are
    not as such a run left them."""
    known: ByReading = {}
    try:
        if json.loads(read_text(out / READINGS_CONDITIONS)) != conditions():
            return {}
        table = io.StringIO(read_text(out / READINGS_TABLE), newline="")
        for row in csv.DictReader(table):
            known.setdefault(row["reading"], {})[row["id"]] = Judgement(
                Verdict(row["verdict"]),
                row["evidence"],
                held=int(row["held"]),
                asked=int(row["asked"]),
            )
    except (ValueError, LookupError, TypeError):
        return {}
    return known


def _write_all(new: NewFile, validation: Validation) -> None:
    table, page, tree = map(new, FILES)
    findings = validation.claims
    write_text(table, as_csv(findings))
    write_text(page, as_markdown(validation))
    stored = [_finding_json(finding) for finding in findings]
    write_text(tree, _as_json({"manifest": conditions(), "findings": stored}))


def _finding_json(finding: Finding) -> dict:
    judgement = finding.judgement
    numbers = {
        name: value if math.isfinite(value) else None
        for name, value in judgement.numbers.items()
    }
    return {
        **{name: getattr(finding, name) for name in FINDING_COLUMNS},
        **{name: getattr(judgement, name) for name in JUDGEMENT_COLUMNS},
        "numbers": numbers,
    }


def _as_json(value: dict) -> str:
    return json.dumps(value, indent=1, ensure_ascii=False, allow_nan=False) + "\n"

"""Claims judged, on the model as it is and under other readings of it.

Verdicts under readings are kept in a directory, and written after each reading: there
an interrupted run goes on.
"""

import dataclasses
import json
from collections.abc import Callable, Sequence
from pathlib import Path

import pandas as pd

from jaximpact._packages import versions
from jaximpact.accuracy import DEFAULT_ACCURACY, get_accuracy
from jaximpact.io.files import write_text

from .claims import JUDGES, SLOPE_CLAIMS, SUPPLEMENT
from .criteria import Judgement, NotComputed, Verdict
from .readings import AS_IT_IS, READINGS, SLOPE_READINGS
from .report import ByReading, readings_table
from .study import RANDOM_IMPACTS, SEED, Study

READINGS_TABLE, CONDITIONS = "readings.csv", "readings.json"


def judge_claim(name: str, study: Study) -> Judgement:
    """Judge a claim; the verdict is `not computed` where an impact of it failed."""
    try:
        return JUDGES[name](study)
    except NotComputed as error:
        return Judgement(Verdict.not_computed, str(error))


def judge_readings(
    names: Sequence[str], out: Path | None, say: Callable[[str], None]
) -> ByReading:
    """Judge claims on the model as it is and under every reading that concerns them.

    Args:
        names: ids of claims.
        out: directory that keeps the verdicts; None keeps none. Those that are there of
            the same conditions are not computed again.
        say: called with a line for each reading that is computed.
    """
    kept = {} if out is None else _read(out)
    of_sets = [n for n in names if n not in (*SLOPE_CLAIMS, SUPPLEMENT)]
    of_slope = [n for n in names if n in SLOPE_CLAIMS]
    asked = [(AS_IT_IS, [*of_sets, *of_slope])]
    asked += [(reading, of_sets) for reading in READINGS if of_sets]
    asked += [(reading, of_slope) for reading in SLOPE_READINGS if of_slope]
    if kept:
        say(
            f"{len(kept)} readings computed before; remove {out}/{READINGS_TABLE} to "
            "compute them again"
        )
    for number, (reading, judged) in enumerate(asked, start=1):
        known, study = kept.setdefault(reading.name, {}), Study(reading=reading)
        new = [name for name in judged if name not in known]
        if new:
            say(f"reading {number} of {len(asked)}: {reading.name}")
            known |= {name: judge_claim(name, study) for name in new}
        if new and out is not None:
            write_text(out / READINGS_TABLE, readings_table(kept))
            write_text(out / CONDITIONS, json.dumps(conditions(), indent=1) + "\n")
    return {
        reading.name: {name: kept[reading.name][name] for name in judged}
        for reading, judged in asked
    }


def conditions() -> dict:
    """Collect what all verdicts depend on besides the package's own functions."""
    return {
        "accuracy": dataclasses.asdict(get_accuracy(DEFAULT_ACCURACY)),
        "random_impacts": RANDOM_IMPACTS,
        "seed": SEED,
        "versions": versions(),
    }


def _read(out: Path) -> ByReading:
    """Read what an earlier run under the same conditions has kept; nothing where files
    are not as such a run left them."""
    known: ByReading = {}
    try:
        if json.loads((out / CONDITIONS).read_text("utf-8")) != conditions():
            return {}
        table = pd.read_csv(out / READINGS_TABLE, keep_default_na=False)
        for reading, name, verdict, met, asked, evidence in table.values:
            judgement = Judgement(Verdict(verdict), evidence, int(met), int(asked))
            known.setdefault(reading, {})[name] = judgement
    except (OSError, ValueError):
        return {}
    return known

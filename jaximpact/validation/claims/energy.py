"""Eq. 5: the energetic coefficient."""

import numpy as np

from ..study import RANDOM_SETS, Datasets
from ..verdict import Judgement, Verdict

ABOVE = 1e-6
"""By how much the coefficient may pass 1 for the errors of the integration."""
PAPER_SETS = ("I", "II", "III", "IV", "fig13")


def never_exceeds_one(sets: Datasets) -> Judgement:
    """The energetic coefficient is at most 1, in the sets and in random impacts."""
    in_sets = np.concatenate([_impacts(sets[name]).e_bar for name in PAPER_SETS])
    groups = {"sets": in_sets}
    failed = beyond_gravity = 0
    for name in RANDOM_SETS:
        impacts = _impacts(sets[name])
        finished = np.isfinite(impacts.e_bar)
        failed += int((~finished).sum())
        groups[name] = impacts.e_bar.values[finished]
        left = impacts.e_bar**2 - impacts.gravity_share
        beyond_gravity += int((left > (1.0 + ABOVE) ** 2).sum())
    above = {name: int(np.sum(x > 1.0 + ABOVE)) for name, x in groups.items()}
    if above["sets"]:
        verdict = Verdict.fails
    else:
        verdict = Verdict.partly if any(above.values()) else Verdict.holds
    numbers = {"above_1_without_gravity": beyond_gravity, "failed": failed}
    for name, values in groups.items():
        key = name.replace(", ", "_").replace(" ", "_")
        numbers |= {f"{key}_above_1": above[name], f"{key}_largest": values.max()}
    return Judgement(
        verdict,
        "above 1: "
        + "; ".join(
            f"{name} {above[name]} of {len(values)}, largest {values.max():.4g}"
            for name, values in groups.items()
        )
        + f"; with gravity's work taken off {beyond_gravity}"
        + (f"; {failed} random impacts failed" if failed else ""),
        {name: float(value) for name, value in numbers.items()},
        sum(count == 0 for count in above.values()),
        len(above),
    )


def _impacts(data):
    """Impacts in a row, those left out that are none."""
    flat = data[[n for n in ("e_bar", "gravity_share", "outcome") if n in data]]
    flat = flat.stack(point=data.outcome.dims, create_index=False)
    return flat.isel(point=flat.outcome.values != "separating")


CLAIMS = {"C29": never_exceeds_one}

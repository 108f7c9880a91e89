r"""Choice of a study's contact law by the error that its file allows.

The error of a law is measured on the impacts of the study's own blocks, the first ones,
which the full model follows down the slope: the largest of the errors of v_n, v_t and
Omega R after an impact, divided by the total speed before it,
$\sqrt{v^2 + (\Omega R)^2}$, as tables state theirs. It is the error of single
impacts. What it does to stopping places and energies a comparison of laws shows.
"""

import dataclasses
from collections.abc import Sequence

import jax
import numpy as np

from ..._numpy_settings import numpy_settings
from ...errors import InputError
from ...impact.events import Outcome
from ...impact_response import ImpactResponses
from ...lookup import Tabulated
from ...lookup.tabulation import relative_velocities
from ...progress import Progress, ProgressFunction
from ...scene import Block, Impact, Soil
from ..contacts.contact_models import Contacts, FullModel
from .run_study import simulate
from .slope_file import SlopeStudy

PILOT_BLOCKS = 64
"""Number of blocks whose impacts are compared. An elongated one makes some tens."""
SHARE = 0.99
"""Fraction of the impacts whose errors are to be below the one allowed."""


@dataclasses.dataclass
class _Recording:
    """Contact model that keeps the impacts that it is asked for."""

    contacts: Contacts
    kept: list[tuple[Block, Soil, Impact, ImpactResponses]]

    def __call__(self, block: Block, soil: Soil, impact: Impact) -> ImpactResponses:
        found = self.contacts(block, soil, impact)
        self.kept.append((block, soil, impact, found))
        return found


@numpy_settings()
def choose_contacts(
    studies: Sequence[SlopeStudy],
    progress: Progress | ProgressFunction | None = None,
) -> SlopeStudy:
    """Choose the quickest contact law whose error is no larger than `contact_error`.

    Laws in closed form are the quickest, then tables, then the full model, which has no
    error by definition; of two of one kind the one of smaller error is chosen.

    Args:
        studies: result of `read_slope_studies` of a file with `contact_error`.
        progress: called as `progress(done, blocks)`.

    Returns:
        The study of the law chosen, with the errors of all in its description.

    Raises InputError for studies without `contact_error`.
    """
    allowed = studies[0].contact_error
    if allowed is None:
        raise InputError("is needed", file=studies[0].path, key="contact_error")
    (full,) = (study for study in studies if isinstance(study.contacts, FullModel))
    recording = _Recording(full.contacts, [])
    pilot = np.arange(min(PILOT_BLOCKS, full.release.count))
    simulate(full._replace(contacts=recording), pilot, progress)
    errors = {study.law_name: _error(study.contacts, recording) for study in studies}
    good = [study for study in studies if errors[study.law_name] <= allowed]
    chosen = min(good, key=lambda study: (_cost(study), errors[study.law_name]))
    words = (f"{name} {error:.3g}" for name, error in errors.items())
    told = {
        "chosen for an error of": allowed,
        "errors of 99 % of the pilot impacts": ", ".join(words),
        "pilot impacts": sum(len(part[-1].outcome) for part in recording.kept),
    }
    return chosen._replace(law=chosen.law | told)


def _cost(study: SlopeStudy) -> int:
    """Rank laws by the time that an impact takes."""
    if isinstance(study.contacts, FullModel):
        return 2
    return int(isinstance(study.contacts, Tabulated))


def _error(contacts: Contacts, recording: _Recording) -> float:
    """Compute the error that `SHARE` of the impacts do not exceed; 0 for the full
    model, inf for a law that fails on more."""
    if contacts is recording.contacts:
        return 0.0
    errors = [np.zeros(0)]
    for block, soil, impact, expected in recording.kept:
        found = contacts(block, soil, impact)
        radius = np.asarray(jax.vmap(lambda block: block.semi_axes.minor)(block))
        model, own = (
            relative_velocities(impact, radius, responses.response[:3])
            for responses in (expected, found)
        )
        error = np.max(np.abs(own - model), axis=0)
        error = np.where(np.isfinite(error), error, np.inf)
        errors.append(error[expected.outcome != Outcome.failed])
    of_all = np.concatenate(errors)
    # Without an impact nothing is known of a law.
    if not len(of_all):
        return np.inf
    return float(np.quantile(of_all, SHARE, method="higher"))

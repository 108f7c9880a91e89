"""Variants of a study on threads of their own: the same numbers."""

import dataclasses

import numpy as np
import pytest
from calibration_studies import objective_of, study_of_columns

from jaximpact import PRESETS
from jaximpact.calibration import fit_study

pytestmark = pytest.mark.slow

DROPS = {
    "mass_kg": [100.0, 500.0, 50.0, 2000.0],
    "speed_mps": [6.0, 15.0, 25.0, 10.0],
    "e_n": [0.2, 0.25, 0.1, 0.3],
    "max_penetration_m": [0.2, 0.6, 0.4, 0.7],
}
VARIANTS = [
    {"name": "loose", "relative_density": 0.3},
    {"name": "dense", "relative_density": 0.9},
]


@pytest.fixture
def study():
    sigma = {"e_n": 0.01, "max_penetration_m": 0.005}
    return study_of_columns(DROPS, starts=3, variants=VARIANTS, default_sigma=sigma)


def test_variants_are_fitted_as_they_are_alone(study):
    """To the last bit: what runs beside an impact does not change it."""
    lines = []
    both = fit_study(study, progress=lines.append).variants
    for place, variant in enumerate(study.variants):
        (alone,) = fit_study(dataclasses.replace(study, variants=(variant,))).variants
        np.testing.assert_array_equal(both[place].parameters, alone.parameters)
        np.testing.assert_array_equal(both[place].end_costs, alone.end_costs)
        assert any(line.startswith(f"{variant.name}: ") for line in lines)


def test_accuracy_follows_the_sigmas(study):
    """Coarser impacts only where their errors are small beside every sigma."""
    objective = objective_of(study)
    size = np.abs(study.measured)
    fine = objective.with_sigma(0.5e-3 * size)
    coarse = objective.with_sigma(2e-3 * size)
    assert objective.accuracy == PRESETS["reference"]
    assert fine.no_finer_than_sigmas().accuracy == PRESETS["reference"]
    assert coarse.no_finer_than_sigmas().accuracy == PRESETS["balanced"]
    fast = coarse.at(PRESETS["fast"])
    assert fast.no_finer_than_sigmas().accuracy == PRESETS["fast"]

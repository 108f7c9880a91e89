"""Variants of a study on threads of their own: the same numbers, and an end to all of
them when one fails."""

import dataclasses

import numpy as np
import pytest
from test_calibration import STUDY, write_study

from jaximpact import PRESETS
from jaximpact.calibration import fit_study, read_study
from jaximpact.calibration.problem.forward_model import models_of
from jaximpact.calibration.problem.objective import Objective

pytestmark = pytest.mark.slow

VARIANTS = """
[[variants]]
name = "loose"
relative_density = 0.3
[[variants]]
name = "dense"
relative_density = 0.9
"""


def two_variants(folder):
    measured = np.array(
        [[0.2, 0.2, 4e4], [0.25, 0.6, 2e5], [0.1, 0.4, 8e4], [0.3, 0.7, 4e5]]
    )
    text = STUDY.replace("starts = 16", "starts = 3") + VARIANTS
    return read_study(write_study(folder, text, measured))


def test_variants_are_fitted_as_they_are_alone(tmp_path):
    """To the last bit: what runs beside an impact does not change it."""
    study = two_variants(tmp_path)
    lines = []
    both = fit_study(study, progress=lines.append).variants
    for place, variant in enumerate(study.variants):
        (alone,) = fit_study(dataclasses.replace(study, variants=(variant,))).variants
        np.testing.assert_array_equal(both[place].parameters, alone.parameters)
        np.testing.assert_array_equal(both[place].start_costs, alone.start_costs)
        assert any(line.startswith(f"{variant.name}: ") for line in lines)


def test_accuracy_follows_the_sigmas(tmp_path):
    """Coarser impacts only where their errors are small beside every sigma."""
    study = two_variants(tmp_path)
    objective = Objective(study, study.variants[0], models_of(study)[0])
    size = np.abs(study.measured)
    fine = objective.with_sigma(0.5e-3 * size)
    coarse = objective.with_sigma(2e-3 * size)
    assert objective.accuracy == PRESETS["reference"]
    assert fine.no_finer_than_sigmas().accuracy == PRESETS["reference"]
    assert coarse.no_finer_than_sigmas().accuracy == PRESETS["balanced"]
    fast = coarse.at(PRESETS["fast"])
    assert fast.no_finer_than_sigmas().accuracy == PRESETS["fast"]

"""Three hundred and sixty random impacts against an independent implementation.

`data/oracle_scenes.csv` holds scenes over the whole range of blocks, impacts and soils,
solved by `model_oracle.py` with SciPy; see `make_oracle_scenes.py`.
"""

import numpy as np
import pandas as pd
import pytest
from paths import DATA

from jaximpact import Block, Impact, Outcome, Scene, Soil, simulate_batch
from jaximpact.quantities import INPUT_COLUMNS, RESULT_COLUMNS

# Scenes at a knife edge, where the oracle itself moves by more than this when its
# tolerance is tightened, say nothing.
ORACLE_IS_SURE = 1e-4

# What is promised for "reference".
COEFFICIENTS = {"e_n": 1e-3, "e_t": 1e-3, "e_bar": 1e-3}
RELATIVE = 2e-3


def read_scenes():
    """Columns of the file as arrays, knife edges left out."""
    table = pd.read_csv(DATA / "oracle_scenes.csv")
    table = table[table.oracle_error < ORACLE_IS_SURE]
    return {name: table[name].to_numpy() for name in table}


def as_scene(columns) -> Scene:
    """The scenes, with array fields."""
    fields = {"block": {}, "soil": {}, "impact": {}}
    for column in INPUT_COLUMNS.values():
        fields[column.part][column.field] = column.factor * columns[column.name]
    return Scene(
        Block(**fields["block"]), Soil(**fields["soil"]), Impact(**fields["impact"])
    )


EVERYTHING = read_scenes()
DAMPED = sum(EVERYTHING[name] for name in ("eta_N", "eta_T", "eta_R")) > 0.0


@pytest.fixture(scope="module", params=["undamped", "damped"])
def pair(request):
    chosen = DAMPED if request.param == "damped" else ~DAMPED
    columns = {name: values[chosen] for name, values in EVERYTHING.items()}
    return columns, simulate_batch(as_scene(columns), accuracy="reference", ledger=True)


def test_scenes_cover_every_outcome():
    undamped = set(EVERYTHING["outcome"][~DAMPED])
    assert undamped >= {"detached", "toppled", "arrested", "in contact", "separating"}
    assert np.sum(~DAMPED) > 250
    assert np.sum(DAMPED) > 20


def test_outcomes_are_the_oracle_s(pair):
    columns, result = pair
    found = np.array([str(Outcome(int(code))) for code in result.outcome_code])
    assert not set(columns["scene"][found != columns["outcome"]])


@pytest.mark.parametrize("name", RESULT_COLUMNS)
def test_results_are_the_oracle_s(pair, name):
    columns, result = pair
    found = np.asarray(getattr(result, RESULT_COLUMNS[name].field))
    expected = columns[name]
    if name in ("max_penetration_m", "max_sinking_m"):
        # Without an impact there is no depth; the oracle gives where it starts from.
        expected = np.where(columns["outcome"] == "separating", 0.0, expected)
    scale = np.abs(expected)
    allowed = RELATIVE * scale
    if name in COEFFICIENTS:
        allowed = COEFFICIENTS[name] * np.maximum(1.0, scale)
    # e_t of a block that comes in along the normal has no value, in both.
    np.testing.assert_array_equal(np.isnan(found), np.isnan(expected))
    wrong = np.abs(found - expected) > allowed
    assert not np.any(wrong), dict(
        scenes=columns["scene"][wrong], found=found[wrong], expected=expected[wrong]
    )


def test_ledger_is_the_oracle_s_and_closes(pair):
    columns, result = pair
    struck = columns["outcome"] != "separating"
    incoming = columns["kinetic_in_J"]
    energy = result.energy
    for item in energy._fields:
        difference = np.abs(getattr(energy, item) - columns[f"{item}_J"])
        # 1e-3 of a velocity is 2e-3 of its energy.
        assert np.max((difference / incoming)[struck]) < RELATIVE, item
    # To the tolerance of the integration, 1e-8, over a few hundred steps.
    assert np.max(np.abs(np.asarray(energy.residual)) / incoming) < 1e-5

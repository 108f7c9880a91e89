"""Summary statistics of simulated data sets, from outcomes made up, and how far those
observed are from them."""

from types import SimpleNamespace

import numpy as np
import pytest

from jaximpact.runout.back_analysis.data_sets import (
    observed_summary,
    simulated_summaries,
    summary_names,
)
from jaximpact.runout.back_analysis.observed import (
    PER_PLACE,
    Observations,
    ObservedCount,
    ObservedValues,
)
from jaximpact.runout.back_analysis.predictive import _check

PLACE, BLOCKS = 30.0, 20


def data_set(stops, passed, failed):
    """Outcomes of 20 blocks, `(1, blocks, numbers)`: places where the first stop, how
    many pass a line, and how many of the last fail."""
    outcomes = np.full((1, BLOCKS, 1 + PER_PLACE + 1), np.nan)
    outcomes[0, : len(stops), 0] = stops
    outcomes[0, :passed, 1 : 1 + PER_PLACE] = 5.0
    outcomes[0, :, -1] = np.arange(BLOCKS) >= BLOCKS - failed
    return outcomes


def summaries(*channels, **outcomes):
    observed = Observations(channels, {}, BLOCKS, (), ())
    (simulated,) = simulated_summaries(observed, data_set(**outcomes), [PLACE], 0)
    names = summary_names(observed)
    ours, theirs = (
        dict(zip(names, of.tolist(), strict=True))
        for of in (observed_summary(observed), simulated)
    )
    return ours, theirs


def test_blocks_that_failed_neither_passed_nor_stayed():
    """Of 12 that did not fail 6 passed: half of them, as half of 20 or of 12 would."""
    ours, theirs = summaries(
        ObservedCount(PLACE, 10, BLOCKS), stops=[], passed=6, failed=8
    )
    assert ours == theirs == {"share past x = 30 m": 0.0}


def test_all_that_did_not_fail_stand_for_all():
    """A number of stops that failures alone make small would be explained by them."""
    stops = np.linspace(40.0, 50.0, BLOCKS)
    channel = ObservedValues("x_m", None, stops)
    ours, theirs = summaries(channel, stops=stops[:16], passed=16, failed=4)
    number = "number of x_m of stopping points"
    assert ours[number] == theirs[number] == 1.0
    _, theirs = summaries(channel, stops=stops[:8], passed=16, failed=4)
    assert theirs[number] == 0.5


@pytest.mark.parametrize("failed", [11, BLOCKS])
def test_a_data_set_in_which_most_blocks_failed_tells_nothing(failed):
    channels = (
        ObservedValues("x_m", None, np.linspace(40.0, 50.0, BLOCKS)),
        ObservedCount(PLACE, 10, BLOCKS),
    )
    left = BLOCKS - failed
    _, theirs = summaries(*channels, stops=[45.0] * left, passed=left, failed=failed)
    assert np.all(np.isnan([*theirs.values()]))


def test_what_the_fitted_ground_never_gives_is_no_number_of_deviations():
    """All blocks stop in every data set, and their mean spread is one of rounding."""
    x = 40.0 + 0.1 * np.arange(BLOCKS)
    outcomes = np.repeat(data_set(x, passed=0, failed=0), 200, axis=0)
    # Moved alike, so that the spread of each data set is the same but for rounding.
    outcomes[..., 0] += np.random.default_rng(1).normal(size=(200, 1))
    checks = []
    for apart in (0.1, 0.2):
        channel = ObservedValues("x_m", None, 40.0 + apart * np.arange(BLOCKS))
        observed = Observations((channel,), {}, BLOCKS, (), ())
        fit = SimpleNamespace(observed=observed, places=[PLACE])
        checks.append(_check(fit, outcomes))
    same, wider = checks
    assert same.explained
    assert same.deviation < 5.0
    assert not wider.explained
    assert wider.worst == "spread of x_m of stopping points"
    assert wider.deviation == np.inf

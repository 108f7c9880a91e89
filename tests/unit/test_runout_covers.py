"""Tables that lanes read, the tree over the segments of a profile, and what profiles
work out once."""

import copy
import pickle

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaximpact.backend.simd.tables import address_of, entries
from jaximpact.code_state import walk
from jaximpact.runout import Profile
from jaximpact.runout.covers import END, FAN, ROOT, Cover, cover_table
from jaximpact.runout.lane_programs import LaneProgram, _ByXla

TABLE = np.random.default_rng(0).normal(size=(40, 3))


def add_up(table, row):
    return table, row, 0.0 * row


def add(state):
    table, row, total = state
    first, _, last = entries(table, row, 3)
    # A lane that has ended is stepped too, beside others: it must stay in the table.
    below = jnp.maximum(row - 1.0, 0.0)
    return (table, below, total + first * last), row > 0.0


def total_of(_, state):
    return state[2]


def test_lanes_read_a_table():
    """From a row of their own down to the first."""
    rows = np.arange(40.0)[::-1]
    products = np.cumsum(TABLE[:, 0] * TABLE[:, 2])[::-1]
    # rounding of 40 sums in another order
    found = LaneProgram(add_up, add, total_of)(address_of(TABLE), rows)
    np.testing.assert_allclose(found, products, rtol=0.0, atol=1e-13)
    structure = jax.tree.structure((0.0, 0.0))
    by_xla = _ByXla((add_up, add, total_of), structure)
    (found,) = by_xla.run(np.stack([np.full(40, address_of(TABLE)), rows]))
    np.testing.assert_allclose(found, products, rtol=0.0, atol=1e-13)


def rough_profile(points):
    generator = np.random.default_rng(points)
    steps = generator.choice([0.01, 0.3, 1.0], points)
    return Profile(np.cumsum(steps), np.cumsum(generator.normal(-0.3, 0.5, points)))


def leaves_in_order(nodes, to_left):
    """Segments that a search comes to which goes into every cover."""
    found, row = [], ROOT
    while row != END:
        if nodes.segment[row] >= 0:
            found.append(int(nodes.segment[row]))
            row = (nodes.next_to_left if to_left else nodes.next_to_right)[row]
        else:
            row = (nodes.child_to_left if to_left else nodes.child_to_right)[row]
        row = int(row)
    return found


@pytest.mark.parametrize("segments", [1, 2, FAN, FAN + 1, 63, FAN**3, 1000])
def test_a_search_comes_to_every_segment_once_and_in_order(segments):
    profile = rough_profile(segments + 1)
    nodes = Cover(*cover_table(profile.x, profile.y).T)
    assert leaves_in_order(nodes, False) == list(range(segments))
    assert leaves_in_order(nodes, True) == list(range(segments))[::-1]


def test_covers_lie_above_their_segments():
    profile = rough_profile(1001)
    nodes = Cover(*cover_table(profile.x, profile.y).T)
    lowest = []
    for row in np.flatnonzero(nodes.segment[ROOT:] < 0.0) + ROOT:
        own = (profile.x >= nodes.left_x[row]) & (profile.x <= nodes.right_x[row])
        slope = nodes.right_y[row] - nodes.left_y[row]
        slope /= nodes.right_x[row] - nodes.left_x[row]
        line = nodes.left_y[row] + slope * (profile.x[own] - nodes.left_x[row])
        lowest.append(np.min(line - profile.y[own]))
    # rounding of heights of some 300 m; the chord is lifted no higher than it must be
    np.testing.assert_allclose(lowest, 0.0, atol=1e-12)


def test_what_a_profile_works_out_is_no_part_of_it():
    profile = rough_profile(100)

    def law(x):
        return x + profile.y[0]

    pickled, shown, state = pickle.dumps(profile), repr(profile), walk(law)
    worked_out = "slope", "length", "normal", "size", "covers"
    for name in worked_out:
        assert getattr(profile, name) is getattr(profile, name)
    assert pickle.dumps(profile) == pickled
    assert repr(profile) == shown
    assert walk(law) == state
    other = copy.deepcopy(profile)
    assert not set(worked_out) & set(vars(other))
    np.testing.assert_array_equal(other.slope, profile.slope)
    with pytest.raises(ValueError, match="read-only"):
        profile.slope[0] = 0.0

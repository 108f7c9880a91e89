"""The benchmark's rolling friction that loses as much energy as hops."""

import numpy as np
import pytest

from benchmarks.hop_friction import rolling_friction_of_hops
from jaximpact import Block, Soil

pytestmark = pytest.mark.slow


def test_longer_and_slower_blocks_lose_more():
    """Round blocks do not hop. The heave of the centre grows with the aspect ratio, and
    what a landing takes does not fall with the speed as the distance between landings
    does."""
    blocks = Block(mass=100.0, aspect_ratio=[1.0, 1.5, 2.0, 4.0])
    usual = rolling_friction_of_hops(blocks, Soil())
    fast = rolling_friction_of_hops(blocks, Soil(), speed=14.0)
    assert np.isnan(usual[0])
    assert np.all(np.isfinite(usual[1:]))
    assert np.all(np.diff(usual[1:]) > 0.0)
    assert np.all(fast[1:] < usual[1:])

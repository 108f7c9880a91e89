"""Rolling friction that loses as much energy as hops."""

import numpy as np
import pytest

from benchmarks.hop_friction import rolling_friction_of_hops
from jaximpact import Block, Soil
from jaximpact.runout import (
    FullModel,
    MotionMode,
    Profile,
    Release,
    simulate_runout,
)

GRAVITY = 9.81
BLOCKS = Block(mass=100.0, aspect_ratio=[1.0, 1.5, 2.0, 4.0])


@pytest.fixture(scope="module")
def angles():
    return rolling_friction_of_hops(BLOCKS, Soil())


def test_round_blocks_do_not_hop(angles):
    assert np.isnan(angles[0])
    assert np.all(np.isfinite(angles[1:]))


def test_longer_and_slower_blocks_lose_more(angles):
    """The heave of the centre grows with the aspect ratio, and what a landing takes
    does not fall with the speed as the distance between landings does."""
    assert np.all(np.diff(angles[1:]) > 0.0)
    fast = rolling_friction_of_hops(BLOCKS, Soil(), speed=14.0)
    assert np.all(fast[1:] < angles[1:])


def test_it_is_the_loss_between_flights(angles):
    """The energy of the flights before the second contact and before the last one, over
    the weight and the way between these contacts."""
    count, speed = 32, 10.0
    theta = (np.arange(count) + 0.5) / count * np.pi
    block = Block(mass=100.0, aspect_ratio=2.0)
    long, short = (
        float(half) for half in (block.semi_axes.major, block.semi_axes.minor)
    )
    # Of an ellipse; its mean is the radius of the circle of equal perimeter
    support = lambda turn: np.hypot(long * np.cos(turn), short * np.sin(turn))  # noqa: E731
    radius = np.mean(support((np.arange(4096) + 0.5) / 4096 * np.pi))
    release = Release(
        block,
        x=0.0,
        y=support(theta) + 1e-3,
        v_x=speed,
        orientation=theta,
        angular_velocity=speed / radius,
    )
    flat = Profile([-1000.0, 1000.0], [0.0, 0.0])
    runs = simulate_runout(flat, release, FullModel("fast"), hop_threshold=0.0)
    pieces, inertia = runs.pieces, float(block.inertia)
    lost = way = 0.0
    for lane in range(count):
        rows = np.flatnonzero(pieces.trajectory == lane)
        rolls = np.flatnonzero(np.isin(pieces.motion[rows], [1, 2]))
        rows = rows[: rolls[0]] if len(rolls) else rows
        flights = rows[pieces.motion[rows] == MotionMode.flight]
        hits = rows[
            1:
        ][
            (pieces.motion[rows[1:]] == MotionMode.contact)
            # Not the one in which a round block takes the place of the ellipse.
            & (pieces.motion[rows[:-1]] == MotionMode.flight)
        ]
        if len(hits) < 3:
            continue
        energies = [
            50.0 * (pieces.v_x[row] ** 2 + pieces.v_y[row] ** 2)
            + 0.5 * inertia * pieces.angular_velocity[row] ** 2
            + 100.0 * GRAVITY * pieces.y[row]
            for row in (
                flights[flights < hits[1]][-1],
                flights[flights < hits[-1]][-1],
            )
        ]
        lost += energies[0] - energies[1]
        way += pieces.x[hits[-1]] - pieces.x[hits[1]]
    # The radius and the start differ by rounding, which hops magnify.
    expected = np.arctan(lost / (100.0 * GRAVITY * way))
    assert angles[2] == pytest.approx(expected, rel=0.02)

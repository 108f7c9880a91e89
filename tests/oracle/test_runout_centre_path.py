"""The path of the centre of a round block against the highest circle that the ground
allows, by brute force over all points and segments."""

import numpy as np
import pytest
from circles_on_ground import heights

from jaximpact.runout import Profile
from jaximpact.runout.centre_path import CentrePath, in_small_turns
from jaximpact.runout.element_reach import reaches

LARGEST = 3.0


def random_points(g):
    steps = g.uniform(0.05, 1.0, g.integers(5, 50))
    return np.cumsum(steps), np.cumsum(g.normal(-0.2, g.uniform(0.05, 1.0), len(steps)))


def walls(g):
    """Terraces with faces of 1 mm, up and down."""
    x, y = [0.0], [0.0]
    for _ in range(15):
        x += [x[-1] + g.uniform(0.1, 2.0)]
        x += [x[-1] + 1e-3]
        y += [y[-1] + g.normal(0.0, 0.1)]
        y += [y[-1] + g.normal(-0.3, 1.0)]
    return np.array(x), np.array(y)


def notches(g):
    """Level ground with cuts and slots narrower than blocks, and needles."""
    x, y = [0.0], [0.0]
    for _ in range(12):
        wide, deep = g.uniform(0.02, 1.0), g.uniform(-3.0, 1.0)
        x += [x[-1] + g.uniform(0.2, 3.0)]
        x += [x[-1] + 0.5 * wide, x[-1] + wide]
        y += [0.0, deep, 0.0]
    return np.array(x), np.array(y)


def scan(g):
    """Points every 5 cm with centimetres of noise on a curve."""
    x = np.arange(0.0, 3.0, 0.05)
    return x, 0.2 * (x - 1.5) ** 2 + g.normal(0.0, 0.02, len(x))


def convex(g):
    """A round top, whose points circles of all sizes touch one after the other."""
    x = np.sort(g.uniform(0.0, 6.0, 40))
    return x, -0.1 * (x - 3.0) ** 2


GROUNDS = (random_points, walls, notches, scan, convex)


def margin(x, y, h, element):
    """Largest height of a circle on an element over those on all others [m]: a search
    on finer and finer places."""
    slope = np.concatenate([[np.inf], np.diff(y) / np.diff(x), [-np.inf]])
    sin = -np.sign(slope) * np.sqrt(1.0 - 1.0 / (1.0 + slope**2))
    k = element // 2
    if element % 2:
        low, high = x[k] + h * sin[k + 1], x[k + 1] + h * sin[k + 1]
    else:
        low, high = x[k] + h * sin[k], x[k] + h * sin[k + 1]
        if low >= high:
            return -np.inf
    others = np.delete(np.arange(2 * len(x) - 1), element)
    # Its neighbours begin where it ends.
    others = others[np.abs(others - element) > 1]
    best = -np.inf
    for _ in range(12):
        at = np.linspace(low, high, 41)
        all_of = heights(x, y, h, at)
        own = all_of[element]
        if not element % 2:
            own = y[k] + np.sqrt(np.maximum(h**2 - (at - x[k]) ** 2, 0.0))
        # Where nothing else is in reach the element is the highest by far.
        over = own - np.maximum(np.max(all_of[others], axis=0), -1e3)
        i = int(np.argmax(over))
        best = max(best, float(over[i]))
        low, high = at[max(i - 1, 0)], at[min(i + 1, 40)]
    return best


@pytest.mark.parametrize("ground", GROUNDS)
@pytest.mark.parametrize("seed", range(3))
def test_an_element_reaches_as_far_as_a_circle_on_it_is_the_highest(ground, seed):
    g = np.random.default_rng(seed)
    x, y = ground(g)
    reach = reaches(x, y, LARGEST)
    compared = 0
    for h in 10.0 ** g.uniform(-1.5, np.log10(LARGEST), 4):
        for element in range(len(reach)):
            over = margin(x, y, h, element)
            # Closer than the rounding of heights of some metres nothing is told.
            if abs(over) > 1e-12:
                compared += 1
                assert (reach[element] > h) == (over > 0.0), (
                    element,
                    h,
                    reach[element],
                )
    assert compared > 3 * len(reach)


@pytest.mark.parametrize("ground", GROUNDS)
@pytest.mark.parametrize("seed", range(4))
def test_centres_lie_as_high_as_the_ground_allows(ground, seed):
    g = np.random.default_rng(seed)
    x, y = ground(g)
    path = CentrePath.of(Profile(x, y), LARGEST)
    at = g.uniform(x[0], x[-1], 60)
    h = 10.0 ** g.uniform(-1.5, np.log10(LARGEST), 60)
    for direction in (1.0, -1.0):
        element, found = path.locate(at, h, np.full(60, direction))
        own = element if direction > 0.0 else path.mirrored(element)
        for i in range(60):
            all_of = heights(x, y, h[i], at[i : i + 1])[:, 0]
            # Rounding of heights of some metres.
            assert found[i] == pytest.approx(np.max(all_of), abs=1e-12)
            # Of equal heights it is the element ahead.
            assert all_of[own[i]] == pytest.approx(found[i], abs=1e-8 * h[i])


def walk(path, h, x, direction, width):
    """All elements from a place to the end of the profile, in small turns."""
    element, y = path.locate(np.array([x]), np.array([h]), np.array([direction]))
    parts, at = [], np.array([direction * x])
    while True:
        ahead = path.ahead(element, at, y, np.array([h]), width)
        count = int(np.count_nonzero(ahead.exists[0]))
        small = in_small_turns(ahead, np.array([h]))
        parts.append(type(small)(*(c[0][small.exists[0]] for c in small)))
        if count:
            element = ahead.next_element[:, count - 1]
            at, y = ahead.stop_x[:, count - 1], ahead.stop_y[:, count - 1]
        elif width > 2 * path.count:
            return type(parts[0])(*map(np.concatenate, zip(*parts, strict=True)))
        else:
            width *= 2


@pytest.mark.parametrize("ground", GROUNDS)
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_the_way_ahead_is_the_path(ground, direction):
    for seed in range(4):
        g = np.random.default_rng(seed)
        x, y = ground(g)
        path = CentrePath.of(Profile(x, y), LARGEST)
        start = (x[0] if direction > 0.0 else x[-1]) + direction * 1e-3
        for h in 10.0 ** g.uniform(-1.5, np.log10(LARGEST), 3):
            ahead = walk(path, h, start, direction, 2 * path.count + 1)
            assert np.all(ahead.stop_x >= ahead.start_x)
            np.testing.assert_array_equal(ahead.start_x[1:], ahead.stop_x[:-1])
            ends = (0 if direction > 0.0 else path.count) + path.count - 1
            assert ahead.next_element[-1] == ends
            for part in (0.0, 0.3, 1.0):
                along = (1.0 - part) * ahead.start_x + part * ahead.stop_x
                straight = (1.0 - part) * ahead.start_y + part * ahead.stop_y
                centre = path.elements.x[ahead.element], path.elements.y[ahead.element]
                about = np.sqrt(np.maximum(h**2 - (along - centre[0]) ** 2, 0.0))
                on_path = np.where(ahead.is_segment, straight, centre[1] + about)
                dense = np.max(heights(x, y, h, direction * along), axis=0)
                # An arc is vertical at its foot: rounding of x grows to its root.
                little = np.where(about < 1e-3 * h, 1e-7, 1e-9)
                assert np.all(np.abs(on_path - dense) < little)


@pytest.mark.parametrize("ground", GROUNDS)
def test_how_far_one_looks_changes_no_bit(ground):
    g = np.random.default_rng(7)
    x, y = ground(g)
    path = CentrePath.of(Profile(x, y), LARGEST)
    for h in (0.05, 0.4, 2.0):
        far = walk(path, h, x[0] + 1e-3, 1.0, 2 * path.count + 1)
        near = walk(path, h, x[0] + 1e-3, 1.0, 4)
        for one, other in zip(far, near, strict=True):
            np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("gap", [0.5, 1.0, 1.9])
def test_a_circle_over_a_gap_touches_both_edges(gap):
    """Of a slot as wide as the edges are apart, a circle of radius 1 touches neither
    floor nor walls; its path has a concave corner half-way."""
    x = np.array([-5.0, 0.0, 0.01, gap - 0.01, gap, 5.0])
    path = CentrePath.of(Profile(x, [0.0, 0.0, -9.0, -9.0, 0.0, 0.0]), 1.0)
    reach = path.reach[: path.count]
    assert np.all(reach[3:8] < 0.51 * gap)
    _, y = path.locate(np.array([0.5 * gap]), np.ones(1), np.ones(1))
    assert y[0] == pytest.approx(np.sqrt(1.0 - 0.25 * gap**2), abs=1e-12)

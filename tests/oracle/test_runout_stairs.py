r"""Spheres on stairs against an event-driven integration of a circle on points and
segments, written here without the package.

The rules: rolling by energy along the curve on which the centre stays at the radius r
from the ground, $v^2 = v_0^2 - 2g(\Delta y + \mu|\Delta x|)/1.4$; take-off where
$v^2 > g r\cos\alpha$ on an edge, if the flight comes higher than r/100 above the curve;
a strike where the curve turns up by more than 0.125; constant coefficients at each
contact, with the spin as it is; contacts slower than a fall of r/100 are none; and
rolling begins with the angular momentum about the contact.
"""

import dataclasses
import itertools

import numpy as np
import pytest
from circles_on_ground import heights
from scipy.integrate import quad
from scipy.optimize import brentq

from jaximpact import Block, ConstantCoefficients
from jaximpact.runout import (
    ClosedForm,
    Ending,
    MotionMode,
    Profile,
    Release,
    passages,
    simulate_runout,
)

G = 9.81
K = 0.4
"""k = I/(m r^2) of a sphere."""
SMALL = 0.01
"""Rise, as a fraction of the radius, that is neither a hop nor an impact."""
MILD = 0.125
E_N, E_T = 0.35, 0.85


class Curve:
    """The curve of the centre, as parts that follow on each other to the right: a part
    is a segment (foot, unit tangent, normal), or an arc about a point."""

    def __init__(self, x, y, r):
        self.x, self.y, self.r = np.asarray(x), np.asarray(y), r
        d_x, d_y = np.diff(self.x), np.diff(self.y)
        length = np.hypot(d_x, d_y)
        self.n_x, self.n_y = -d_y / length, d_x / length
        # On the last segment nothing changes.
        at = np.arange(self.x[0], self.x[-2] + 2.0 * r, 0.004 * r)
        of = np.argmax(self.heights(at), axis=0)
        self.element, self.start = [int(of[0])], [float(at[0])]
        for i in np.flatnonzero(np.diff(of)):
            for place, two in self.changes(at[i], at[i + 1], of[i], of[i + 1]):
                one = self.element[-1]
                if abs(one - two) == 1:
                    # A segment and its end have one height near where they meet.
                    segment, point = (one, two) if one % 2 else (two, one)
                    place = self.x[point // 2] + r * self.n_x[segment // 2]
                self.element.append(int(two))
                self.start.append(float(place))

    def changes(self, low, high, one, two):
        """Where the highest element changes between two places, by bisection."""
        if one == two:
            return []
        middle = 0.5 * (low + high)
        if not low < middle < high:
            return [(high, two)]
        of = int(np.argmax(self.heights(np.array([middle]))[:, 0]))
        below = self.changes(low, middle, one, of)
        return below + self.changes(middle, high, of, two)

    def heights(self, at):
        """Height of the centre on each point and segment."""
        return heights(self.x, self.y, self.r, at)

    def height(self, at):
        return np.max(self.heights(np.atleast_1d(at)), axis=0)

    def part(self, at, direction):
        """The part at a place; between two the one ahead."""
        side = "right" if direction > 0 else "left"
        return int(np.clip(np.searchsorted(self.start, at, side) - 1, 0, None))

    def normal(self, part, at):
        element = self.element[part]
        if element % 2:
            return self.n_x[element // 2], self.n_y[element // 2]
        n_x = (at - self.x[element // 2]) / self.r
        return n_x, np.sqrt(1.0 - n_x**2)

    def touching(self, x, y):
        """Normals at all that a circle there touches."""
        near = np.flatnonzero(np.abs(self.heights(np.array([x]))[:, 0] - y) < 1e-9)
        for element in near:
            k = element // 2
            if element % 2:
                yield self.n_x[k], self.n_y[k]
            else:
                yield (x - self.x[k]) / self.r, (y - self.y[k]) / self.r

    def ends(self, part):
        last = part + 1 == len(self.start)
        return self.start[part], self.x[-1] if last else self.start[part + 1]


@dataclasses.dataclass
class Sphere:
    """A sphere under way, and what is kept of it."""

    curve: Curve
    friction: float
    x: float
    y: float
    v_x: float
    v_y: float
    spin: float
    time: float = 0.0
    way: list = dataclasses.field(default_factory=list)
    """Parts of the way: time, x, y, velocities and spin at the start, and whether it
    flies."""
    impacts: int = 0

    def run(self):
        """Follow it until it stops."""
        go_on = self.fly
        for _ in range(500):
            go_on = go_on()
            if go_on is None:
                return self
        raise AssertionError("too many events")

    def fly(self):
        """Fly to the first contact."""
        c, r = self.curve, self.curve.r
        self.keep(True)
        for n in c.touching(self.x, self.y):
            # What it leaves may send it into what it touches as well.
            if self.v_x * n[0] + self.v_y * n[1] < -1e-8:
                return lambda n=n: self.touch(n)

        def over(t):
            x = self.x + self.v_x * t
            return self.y + (self.v_y - 0.5 * G * t) * t - c.height(x)

        speed = np.hypot(self.v_x, self.v_y)
        t, off = 0.0, False
        while self.x + self.v_x * t < c.x[-1]:
            ahead = t + 0.02 * r / (speed + G * t + 1.0) * np.arange(401)
            gaps = over(ahead)
            off = off or gaps[0] > 1e-6 * r
            free = np.maximum.accumulate(gaps > 1e-6 * r) | off
            hits = np.flatnonzero(free[:-1] & (gaps[1:] <= 0.0))
            # A flight from a contact may come back before it is seen to be free.
            if len(hits):
                i = hits[0]
                t = brentq(lambda s: over(s)[0], ahead[i], ahead[i + 1], xtol=1e-15)
                break
            off, t = bool(free[-1]), ahead[-1]
            assert gaps[-1] > -1e-3 * r, "in the ground"
        else:
            raise AssertionError("left the profile")
        self.y += (self.v_y - 0.5 * G * t) * t
        self.x += self.v_x * t
        self.v_y -= G * t
        self.time += t
        n = c.normal(c.part(self.x, np.sign(self.v_x)), self.x)
        return lambda: self.touch(n)

    def touch(self, n):
        """Touch a plane of this normal: rebound, or begin to roll."""
        n_x, n_y = n
        into = -(self.v_x * n_x + self.v_y * n_y)
        along = self.v_x * n_y - self.v_y * n_x
        slow = np.sqrt(2.0 * G * n_y * SMALL * self.curve.r)
        if into >= slow:
            self.impacts += 1
            into, along = -E_N * into, E_T * along
        if -into >= slow:
            self.v_x = along * n_y - into * n_x
            self.v_y = -along * n_x - into * n_y
            return self.fly
        return lambda: self.roll((along + K * self.curve.r * self.spin) / (1.0 + K))

    def roll(self, v, way=None):
        """Roll from where it is, at a velocity along the curve to the right, or from
        rest in a direction."""
        c, r = self.curve, self.curve.r
        way = np.sign(v) if way is None else way
        part, squared = c.part(self.x, way), v**2
        rate = 2.0 * G / (1.0 + K)
        while True:
            end = c.ends(part)[:: int(way)][1]
            n = c.normal(part, self.x)
            self.set_rolling(way, squared, n)
            x_0, y_0, squared_0 = self.x, self.y, squared

            def square(x, x_0=x_0, y_0=y_0, squared_0=squared_0):
                rise = c.height(x)[0] - y_0
                return squared_0 - rate * (rise + self.friction * abs(x - x_0))

            # Where does it become slow, or leave?
            stop = self.first_zero(square, x_0, end)
            leave = None
            if c.element[part] % 2 == 0:
                leave = self.leaves(
                    part, way, square, x_0, end if stop is None else stop
                )
            if leave is not None:
                self.pass_to(leave, square(leave), squared_0, way, part)
                self.set_rolling(way, square(leave), c.normal(part, leave))
                return self.fly
            if stop is not None:
                self.pass_to(stop, 0.0, squared_0, way, part)
                n_x, n_y = c.normal(part, stop)
                self.set_rolling(way, 0.0, (n_x, n_y))
                if abs(n_x) <= self.friction * n_y:
                    return None
                return lambda: self.roll(0.0, np.sign(n_x))
            squared = square(end)
            self.pass_to(end, squared, squared_0, way, part)
            part += int(way)
            if not 0 <= part < len(c.start):
                raise AssertionError("left the profile")
            n, ahead = c.normal(part - int(way), end), c.normal(part, end)
            turn = way * (n[0] * ahead[1] - n[1] * ahead[0])
            if turn < np.sin(MILD):
                continue
            self.set_rolling(way, squared, n)
            small = 2.0 * G * SMALL * r * ahead[1]
            if squared * turn**2 >= small:
                return lambda ahead=ahead: self.touch(ahead)
            cos = n[0] * ahead[0] + n[1] * ahead[1]
            squared *= ((cos + K) / (1.0 + K)) ** 2
            held = abs(ahead[0]) <= self.friction * ahead[1]
            between = way * ahead[0] <= 0.0 <= way * n[0]
            if squared < small and (held or between):
                self.set_rolling(way, 0.0, ahead)
                return None

    def first_zero(self, square, begin, end):
        x = np.linspace(begin, end, 201)
        values = np.array([square(place) for place in x])
        lost = np.flatnonzero(values[1:] < 0.0)
        if not len(lost):
            return None
        i = lost[0]
        if values[i] <= 0.0:
            return x[i]
        return brentq(square, x[i], x[i + 1], xtol=1e-15)

    def leaves(self, part, way, square, begin, end):
        """The place from which it flies off an edge, if it does: at once, or 0.001
        beyond where it is fast enough; it is asked again every 0.125 at most."""
        c, r = self.curve, self.curve.r
        point = c.x[c.element[part] // 2]
        angle = lambda x: np.arcsin((x - point) / r)  # noqa: E731
        one, two = angle(begin), angle(c.ends(part)[:: int(way)][1])
        # Halved until they are small.
        turn = abs(two - one)
        parts = 2 ** max(0, int(np.ceil(np.log2(turn / MILD) - 1e-12)))
        if parts == 1:
            # A point of a curve, from the middle of the shorter line beside it.
            k = c.element[part] // 2
            beside = np.hypot(np.diff(c.x), np.diff(c.y))[[k - 1, k]]
            curve = min(np.min(beside), 4.0 * r) + r * turn
            fast = square(begin) * turn > G * np.cos(one) * curve
            return begin if fast and self.rises_over(one, way, point, square) else None
        last = angle(end)

        def spare(a):
            x = point + r * np.sin(a)
            return square(x) - G * r * np.cos(a)

        for i in range(parts):
            low, high = (one + (two - one) * j / parts for j in (i, i + 1))
            if way * (low - last) >= 0.0:
                return None
            if spare(low) > 0.0:
                a = low
            elif spare(high) > 0.0 and way * (last - high) >= 0.0:
                a = brentq(spare, low, high, xtol=1e-15) + way * 1e-3
                a = way * min(way * a, way * high)
            else:
                continue
            if self.rises_over(a, way, point, square):
                return point + r * np.sin(a)
        return None

    def rises_over(self, a, way, point, square):
        """Whether a flight comes higher than a hop above the curve, across it."""
        c, r = self.curve, self.curve.r
        x = point + r * np.sin(a)
        y, v = c.height(x)[0], np.sqrt(square(x))
        t = np.arange(1, 4000) * 0.002 * r / (v + 1.0)
        at = x + way * v * np.cos(a) * t
        height = y - (way * v * np.sin(a) + 0.5 * G * t) * t - c.height(at)
        lands = np.flatnonzero(height < -1e-9 * r)
        flight = height[: lands[0] if len(lands) else None]
        steep = np.gradient(c.height(at), at)[: len(flight)]
        return np.any(flight / np.hypot(1.0, steep) >= SMALL * r)

    def pass_to(self, x, squared, squared_0, way, part):
        """Pass to a place on the same part."""
        c, r = self.curve, self.curve.r
        if c.element[part] % 2:
            length = abs(x - self.x) / c.normal(part, x)[1]
            if length > 0.0:
                speeds = np.sqrt(max(squared, 0.0)) + np.sqrt(max(squared_0, 0.0))
                self.time += 2.0 * length / speeds
        else:
            point, y_0 = c.x[c.element[part] // 2], self.y
            x_0, rate = self.x, 2.0 * G / (1.0 + K)
            one, two = (np.arcsin((place - point) / r) for place in (x_0, x))

            def slowness(u):
                # Angles close up to both ends, where it may be at rest.
                share = u * u * (3.0 - 2.0 * u)
                a = one + (two - one) * share
                place = point + r * np.sin(a)
                rise = r * (np.cos(a) - np.cos(one))
                left = squared_0 - rate * (rise + self.friction * abs(place - x_0))
                rush = 6.0 * u * (1.0 - u) * abs(two - one) * r
                return rush / np.sqrt(max(left, 1e-300))

            self.time += quad(slowness, 0.0, 1.0, epsabs=1e-10)[0]
            assert abs(y_0 - c.height(x_0)[0]) < 1e-9
        self.x, self.y = x, c.height(x)[0]

    def set_rolling(self, way, squared, n):
        v = way * np.sqrt(max(squared, 0.0))
        self.v_x, self.v_y, self.spin = v * n[1], -v * n[0], v / self.curve.r
        self.keep(False)

    def keep(self, flies):
        now = (self.time, self.x, self.y, self.v_x, self.v_y, self.spin)
        self.way.append((*now, flies))


def stairs(g, low, high):
    """Terraces with faces that lean by 1 cm, and level ground below."""
    x, y = [0.0], [0.0]
    for _ in range(10):
        x += [x[-1] + g.uniform(low, high)]
        x += [x[-1] + 0.01]
        y += [y[-1] - g.uniform(0.0, 0.1), 0.0]
        y[-1] = y[-2] - g.uniform(low, high)
    return np.array([*x, x[-1] + 40.0]), np.array([*y, y[-1]]) - y[-1]


def pits(g, low, high):
    """Ground that goes up and down by faces of all slopes."""
    count = 14
    steps = np.where(np.arange(count) % 2, g.uniform(0.01, 1.0, count), 1.0)
    x = np.cumsum([0.0, *steps * g.uniform(low, high, count)])
    y = np.cumsum([0.0, *g.normal(-0.3, 0.4, count) * (high - low)])
    y[:2] = np.max(y) + 1.0
    return np.array([-20.0, *x, x[-1] + 40.0]), np.array([y[0] + 9.0, *y, y[-1]])


def followed(x, y, mass, friction, release):
    """Runs of a sphere by the package and by the rules here, and how much the latter
    changes when a contact is as early as the package may find it."""
    block = Block(mass=mass)
    r = float(block.semi_axes.minor)
    x_0, y_0, v_x = release
    runs = simulate_runout(
        Profile(x, y, rolling_friction_angle=np.arctan(friction)),
        Release(block, x_0, y_0, v_x),
        ClosedForm(ConstantCoefficients(E_N, E_T)),
    )
    curve = Curve(x, y, r)
    one, *others = (
        Sphere(curve, friction, x_0 + shift * r, y_0, v_x, 0.0, 0.0).run()
        for shift in (0.0, 1e-8, -1e-8)
    )
    change = max(abs(other.x - one.x) for other in others)
    return runs, one, change


KINDS = {
    # Terraces over which spheres leap, stairs narrower than they are, and small ones.
    "leaps": (stairs, 0.4, 1.0, 1.0, 3.47),
    "rolls": (stairs, 0.34, 0.5, 2.5, 3.47),
    "small": (stairs, 0.03, 0.06, 0.0, 0.5),
    "pits": (pits, 0.7, 2.5, 1.5, 3.47),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(8))
def test_a_sphere_goes_down_as_the_rules_say(kind, seed):
    ground, low, high, *masses = KINDS[kind]
    g = np.random.default_rng(seed)
    mass = 10.0 ** g.uniform(*masses)
    x, y = ground(g, low, high)
    r = float(Block(mass=mass).semi_axes.minor)
    x_0 = g.uniform(0.1, 0.6) * low
    y_0 = np.interp(x_0, x, y) + 2.0 * r + g.uniform(0.0, 0.1)
    friction = np.tan(np.radians(g.uniform(5.0, 25.0)))
    release = x_0, y_0, g.uniform(0.3, 3.0)
    runs, sphere, change = followed(x, y, mass, friction, release)
    assert runs.ending[0] == Ending.stopped
    # Contacts come early by 1e-9 of the radius, some ten of them.
    little = 10.0 * change + 1e-7
    assert runs.x[0] == pytest.approx(sphere.x, abs=little)
    assert runs.y[0] == pytest.approx(sphere.y, abs=little)
    assert np.sum(runs.contacts.outcome >= 0) == sphere.impacts
    # Pieces about edges last as at constant acceleration. A sphere that is nearly at
    # rest on top stays some hundredths of a second longer there.
    assert runs.time[0] == pytest.approx(sphere.time, abs=0.15)

    pieces = runs.pieces
    flights = pieces.motion == MotionMode.flight
    found = np.stack([column[flights] for column in (*pieces[4:8], pieces[11])])
    expected = np.array([row[1:6] for row in sphere.way if row[6]]).T
    np.testing.assert_allclose(found, expected, atol=100.0 * little)

    # A collector in the middle of the longest flight.
    way = [*sphere.way, (sphere.time, sphere.x)]
    lengths = [
        abs(after[1] - row[1]) if row[6] else 0.0
        for row, after in itertools.pairwise(way)
    ]
    k = int(np.argmax(lengths))
    time, x_1, y_1, v_x, v_y, spin, _ = way[k]
    place = 0.5 * (x_1 + way[k + 1][1])
    t = (place - x_1) / v_x
    at = passages(runs, place)
    i = int(np.argmin(np.abs(at.time - time - t)))
    height = y_1 + (v_y - 0.5 * G * t) * t - np.interp(place, x, y)
    energy = 0.5 * mass * (v_x**2 + (v_y - G * t) ** 2 + K * (r * spin) ** 2)
    assert at.centre_height[i] == pytest.approx(height, abs=100.0 * little)
    assert at.energy[i] == pytest.approx(energy, rel=100.0 * little)

"""Cylinders and prisms in the reference implementation, for tests only.

Geometry written anew: the section of a prism is where a horizontal line meets the
straight sides and arcs of its outline, its area and moments are those of a polygon of
ten thousand corners. Everything else is `model_oracle.py`.
"""

import functools
import math
from unittest import mock

import model_oracle as oracle
import numpy as np
from shapely.geometry import Polygon, box


def rounded_rectangle(major, minor, radius, arcs=2500) -> Polygon:
    """A polygon of so many corners a quarter circle; y is along the major axis."""
    core = box(-(minor - radius), -(major - radius), minor - radius, major - radius)
    return core.buffer(radius, quad_segs=arcs) if radius > 0.0 else core


def polar_moment(polygon: Polygon) -> float:
    """Integral of x^2 + y^2 over a polygon that begins anywhere, by Green's theorem."""
    x, y = np.asarray(polygon.exterior.coords).T
    cross = x[:-1] * y[1:] - x[1:] * y[:-1]
    squares = (
        x[:-1] ** 2 + x[:-1] * x[1:] + x[1:] ** 2,
        y[:-1] ** 2 + y[:-1] * y[1:] + y[1:] ** 2,
    )
    return abs(float(np.sum(cross * (squares[0] + squares[1])))) / 12.0


def prism_section(major, minor, radius, theta, height):
    """Support, position of the lowest point, and ends of the foundation of a prism
    whose centre is `height` above the ground: (r_y, T_low, t_1, t_2)."""
    sin, cos = math.sin(theta), math.cos(theta)

    # Down (n) and down-slope (t) of a point at so much along the major axis and across
    def ground(along, across):
        return along * cos + across * sin, -along * sin + across * cos

    a, b = major - radius, minor - radius
    centres = [ground(p, q) for p in (a, -a) for q in (b, -b)]
    lowest = max(centres)
    support = lowest[0] + radius
    extreme = max(t for _, t in centres) + radius
    on_right = [n for n, t in centres if t > extreme - radius - 1e-12 * major]
    on_left = [n for n, t in centres if t < radius - extreme + 1e-12 * major]
    crossings = []
    for n, t in centres:
        if abs(height - n) <= radius:
            half = math.sqrt(radius**2 - (height - n) ** 2)
            crossings += [t - half, t + half]
    for sign in (1.0, -1.0):
        for ends in (
            [ground(sign * major, b), ground(sign * major, -b)],
            [ground(a, sign * minor), ground(-a, sign * minor)],
        ):
            (n_0, t_0), (n_1, t_1) = ends
            if min(n_0, n_1) <= height <= max(n_0, n_1) and n_0 != n_1:
                share = (height - n_0) / (n_1 - n_0)
                crossings.append(t_0 + share * (t_1 - t_0))
    # A point at depth n is below the ground where the centre is less than n above it.
    right = extreme if max(on_right) >= height else max(crossings)
    left = -extreme if max(on_left) >= height else min(crossings)
    return support, lowest[1], left, right


class PlaneModel(oracle.Model):
    """A block straight out of the plane: `B_w = 2 W`."""

    def __init__(self, scene, corner=None):
        super().__init__(scene)
        p, self.corner = self.p, corner
        ratio, wide = p["aspect_ratio"], p["out_of_plane_ratio"]
        if corner is None:
            area, second = math.pi * ratio, math.pi * ratio * (ratio**2 + 1.0) / 4.0
        else:
            polygon = rounded_rectangle(ratio, 1.0, corner * min(ratio, 1.0))
            area, second = polygon.area, polar_moment(polygon)
        volume = 2.0 * wide * area
        self.R = (self.mass / (p["density_kgm3"] * volume)) ** (1.0 / 3.0)
        self.H, self.W = ratio * self.R, wide * self.R
        self.inertia = self.mass * self.R**2 * second / area
        self.ry0, low = self.outline(0.0, 0.0)[:2]
        # On a level face the end that the spin drives down
        ahead = self.outline(math.copysign(1e-9, self.om0), 0.0)[1]
        flat = abs(math.sin(2.0 * self.theta0)) < 1e-12
        self.T_low0 = ahead if flat and self.om0 else 0.0 if flat else low
        self.E0 = (
            0.5 * self.mass * (self.vn0**2 + self.vt0**2)
            + 0.5 * self.inertia * self.om0**2
        )

    def outline(self, theta, height):
        theta = self.theta0 + theta
        if self.corner is not None:
            radius = self.corner * min(self.H, self.R)
            return prism_section(self.H, self.R, radius, theta, height)
        # In coordinates in which the ellipse is a unit circle
        sin, cos = math.sin(theta), math.cos(theta)
        down = np.array([self.H * cos, self.R * sin])
        along = np.array([-self.H * sin, self.R * cos])
        support, reach = np.hypot(*down), np.hypot(*along)
        low = along @ down / support
        middle = height * low / support
        share = max(1.0 - (height / support) ** 2, 0.0)
        half = self.H * self.R / support * math.sqrt(share)
        level = down @ along / reach
        return (
            support,
            low,
            -reach if -level >= height else middle - half,
            reach if level >= height else middle + half,
        )

    def geometry(self, un, theta):
        height = self.ry0 - un

        def ends(change_u, change_theta):
            _, _, t_1, t_2 = self.outline(theta + change_theta, height - change_u)
            return t_2 - t_1

        support, low = self.outline(theta, min(height, 0.0))[:2]
        if support - height <= 0.0:
            t_1 = t_2 = low
            slopes = 0.0, 0.0
        else:
            _, low, t_1, t_2 = self.outline(theta, height)
            step = 1e-7 * (support - height)
            # For the ledger alone
            slopes = (
                (ends(step, 0.0) - ends(0.0, 0.0)) / step,
                (ends(0.0, step / self.R) - ends(0.0, 0.0)) / (step / self.R),
            )
        return dict(
            ry=support,
            T_low=low,
            d=height,
            uD=support - height,
            t1=t_1,
            t2=t_2,
            Bt=t_2 - t_1,
            Bw=2.0 * self.W,
            r_n=height,
            r_t=0.5 * (t_1 + t_2),
            Bt_u=slopes[0],
            Bt_t=slopes[1],
            Bw_u=0.0,
            Bw_t=0.0,
        )

    def stiffness(self, Bt, Bw):
        radius = 0.5 * math.sqrt(Bt * Bw)
        depth = self.gamma_n * radius / oracle.P_A
        spring = self.G_fac * depth**self.n_E * radius
        # The ratio of the sizes counts up to 100.
        oblong = 0.957 * math.exp(0.0394 * min(max(Bt, Bw) / min(Bt, Bw), 100.0))
        return (
            oblong * 4.0 * spring / (1.0 - self.nu),
            8.0 * spring / (2.0 - self.nu),
            8.0 * spring * radius**2 / (3.0 * (1.0 - self.nu)),
        )

    def rhs(self, t, y):
        rates = super().rhs(t, y)
        found = self.evaluate([float(v) for v in y])
        if found["k"][0] > 0:
            normal, tangential, rotational = found["vp"]
            length = found["g"]["Bt"]
            hardens = max(normal, 0.0) + self.a_vT * abs(tangential)
            hardens += self.a_vR * length * abs(rotational)
            rates[9] = self.c_v * (1.0 - y[9]) * hardens / length
        return rates


def simulate(scene: dict, corner: float | None = None) -> dict:
    """One impact of an elliptic cylinder, or of a prism with its corner radius ratio.

    `scene`: as for `oracle.simulate`.
    """
    model = functools.partial(PlaneModel, corner=corner)
    with mock.patch.object(oracle, "Model", model):
        return oracle.simulate(scene)

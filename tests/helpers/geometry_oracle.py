"""Brute-force geometry of a tilted ellipsoid cut by the ground, for tests only.

Everything comes from the general equation of the ellipsoid, x^T A x = 1 with A = Q
diag(1/H^2, 1/R^2, 1/W^2) Q^T, by sampling and root finding; no closed form of a support
radius, section or chord is used. It serves to check the library's closed forms and to
show the misprints in the geometry appendix of Dattola, Crosta and di Prisco (2023).

Axes: n into the ground, t down-slope, w out of the plane, measured from the ground
level (n = 0) and from the block's centre (t = w = 0), which lies at n = -d. The major
half-axis H makes the angle Theta with n, clockwise positive (its lower tip moves
towards -t).

Accuracy: positions and lengths to about 1e-10 of the block's size, and less (about
1e-16 / q for section ends) where the ground only just touches the block.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq, root


def axes(theta: float) -> np.ndarray:
    """Columns: directions (n, t, w) of the half-axes H, R and W."""
    s, c = math.sin(theta), math.cos(theta)
    return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])


def quadric(H: float, R: float, W: float, theta: float) -> np.ndarray:
    """Matrix A of x^T A x = 1, x relative to the centre."""
    q = axes(theta)
    return q @ np.diag([1 / H**2, 1 / R**2, 1 / W**2]) @ q.T


def level(n, t, w, H, R, W, theta, d):
    """Value of x^T A x at a point of the ground's frame: below 1 inside the block, 1 on
    its surface."""
    x = np.stack(
        np.broadcast_arrays(
            np.asarray(n, float) + d, np.asarray(t, float), np.asarray(w, float)
        ),
        -1,
    )
    return np.einsum("...i,ij,...j->...", x, quadric(H, R, W, theta), x)


def surface(a, b, H, R, W, theta):
    """Points of the surface, relative to the centre, from two angles; the last axis is
    (n, t, w)."""
    a, b = np.broadcast_arrays(np.asarray(a, float), np.asarray(b, float))
    local = np.stack(
        [H * np.cos(a) * np.cos(b), R * np.sin(a) * np.cos(b), W * np.sin(b)], -1
    )
    return local @ axes(theta).T


def extreme(direction, H, R, W, theta) -> np.ndarray:
    """Surface point farthest along ``direction``: grid search, then stationarity in the
    two angles."""
    u = np.asarray(direction, float)
    # shift the angles' pole away from the points sought along w
    a = np.linspace(-np.pi, np.pi, 721)
    b = np.linspace(-np.pi / 2, np.pi / 2, 181)
    aa, bb = np.meshgrid(a, b, indexing="ij")
    i = np.unravel_index(np.argmax(surface(aa, bb, H, R, W, theta) @ u), aa.shape)
    a0, b0 = aa[i], bb[i]
    if abs(abs(b0) - np.pi / 2) < 1e-9:  # the pole itself: stationary already
        return surface(a0, b0, H, R, W, theta)
    q = axes(theta)

    def grad(x):
        ca, sa, cb, sb = math.cos(x[0]), math.sin(x[0]), math.cos(x[1]), math.sin(x[1])
        da = q @ np.array([-H * sa * cb, R * ca * cb, 0.0])
        db = q @ np.array([-H * ca * sb, -R * sa * sb, W * cb])
        return [float(da @ u), float(db @ u)]

    r = root(grad, [a0, b0], tol=1e-14)
    p = surface(*r.x, H, R, W, theta)
    if p @ u < surface(a0, b0, H, R, W, theta) @ u - 1e-13 * max(H, R, W):
        raise RuntimeError("refinement left the maximum")
    return p


def _line_minimum(f, scale):
    """Position of the minimum of a function that is a parabola along a line, from three
    samples."""
    y0, y1, y2 = f(-scale), f(0.0), f(scale)
    return -scale * (y2 - y0) / (2 * (y2 - 2 * y1 + y0))


def section_ends(H, R, W, theta, d):
    """Ends (t_a, t_b) of the block's cut with the ground line n = 0, w = 0; None if
    there is no cut."""
    size = max(H, R)

    def f(t):
        return float(level(0.0, t, 0.0, H, R, W, theta, d)) - 1.0

    tm = _line_minimum(f, size)
    if f(tm) >= 0:
        return None
    far = 3 * size + abs(tm)
    ta = brentq(f, tm - far, tm, xtol=1e-14 * size, rtol=1e-15)
    tb = brentq(f, tm, tm + far, xtol=1e-14 * size, rtol=1e-15)
    return ta, tb


def section_half_width(H, R, W, theta, d):
    """Half-width of the ground-level section out of the plane; 0 if there is none.

    At each t the surface's w follows by root finding; its maximum over t by sampling
    and shrinking.
    """
    ends = section_ends(H, R, W, theta, d)
    if ends is None:
        return 0.0

    def w_at(t):
        def f(w):
            return float(level(0.0, t, w, H, R, W, theta, d)) - 1.0

        return 0.0 if f(0.0) >= 0 else brentq(f, 0.0, 3 * W, xtol=1e-15 * W, rtol=1e-15)

    lo, hi = ends
    best = 0.0
    for _ in range(14):
        ts = np.linspace(lo, hi, 13)
        ws = [w_at(t) for t in ts]
        i = int(np.argmax(ws))
        best = max(best, ws[i])
        lo, hi = ts[max(i - 1, 0)], ts[min(i + 1, 12)]
    return best


def foundation(H: float, R: float, W: float, theta: float, d: float) -> dict:
    """Equivalent foundation of a block whose centre is ``d`` above the ground.

    Keys: ``u_D`` sinking of the deepest point and ``t_low`` its position; ``t_1``,
    ``t_2`` ends of the
    foundation, i.e. the section's ends at ground level, or the block's left and right
    extreme points
    where those lie at or below the ground; ``B_t``; ``B_w`` (of the section while the
    centre is above
    ground, else of the whole block); ``r_t`` the foundation's middle; ``section`` (ends
    or None) and
    ``section_half_width``; ``right`` and ``left``: (n, t) of the lateral extreme
    points, n > 0 below ground.
    """
    low = extreme((1, 0, 0), H, R, W, theta)
    right = extreme((0, 1, 0), H, R, W, theta)
    left = extreme((0, -1, 0), H, R, W, theta)
    side = extreme((0, 0, 1), H, R, W, theta)
    ends = section_ends(H, R, W, theta, d)
    half_w = section_half_width(H, R, W, theta, d)
    n_right, n_left = right[0] - d, left[0] - d
    nan = math.nan
    t_2 = right[1] if n_right >= 0 else (ends[1] if ends else nan)
    t_1 = left[1] if n_left >= 0 else (ends[0] if ends else nan)
    return dict(
        u_D=float(low[0] - d),
        t_low=float(low[1]),
        t_1=float(t_1),
        t_2=float(t_2),
        B_t=float(t_2 - t_1),
        B_w=2 * half_w if d > 0 else 2 * float(side[2]),
        r_t=float(0.5 * (t_1 + t_2)),
        section=ends,
        section_half_width=half_w,
        right=(float(n_right), float(right[1])),
        left=(float(n_left), float(left[1])),
    )


def sampled_extent(H, R, W, theta, d, points: int = 2001) -> dict:
    """Extent of the part of the surface at or below the ground by dense sampling alone.

    A blunter check of :func:`foundation` (good to about the sampling step, 1e-2 R): the
    largest and
    smallest t, and the largest w, of all sampled surface points with n >= 0.
    """
    a, b = np.meshgrid(
        np.linspace(-np.pi, np.pi, points),
        np.linspace(-np.pi / 2, np.pi / 2, points // 2),
        indexing="ij",
    )
    p = surface(a, b, H, R, W, theta).reshape(-1, 3)
    below = p[p[:, 0] >= d]
    if not len(below):
        return dict(u_D=float(p[:, 0].max() - d), t_1=math.nan, t_2=math.nan, B_w=0.0)
    return dict(
        u_D=float(below[:, 0].max() - d),
        t_1=float(below[:, 1].min()),
        t_2=float(below[:, 1].max()),
        B_w=2 * float(below[:, 2].max()),
    )


if __name__ == "__main__":
    from model_oracle import Model

    rng = np.random.default_rng(7)
    worst, worst_s, kinds = {}, {}, {}
    for i in range(300):
        scene = dict(
            aspect_ratio=float(rng.uniform(0.4, 4)),
            out_of_plane_ratio=float(rng.uniform(0.6, 1.6)),
            orientation_deg=float(rng.uniform(0, 180)),
        )
        mod = Model(scene)
        turn = float(rng.uniform(-2, 2))
        ry = math.hypot(
            mod.H * math.cos(mod.theta0 + turn), mod.R * math.sin(mod.theta0 + turn)
        )
        d = ry * float(rng.uniform(-0.98, 0.98))
        g = mod.geometry(mod.ry0 - d, turn)
        f = foundation(mod.H, mod.R, mod.W, mod.theta0 + turn, d)
        kind = (f["left"][0] >= 0, f["right"][0] >= 0, d > 0)
        kinds[kind] = kinds.get(kind, 0) + 1
        closed = dict(
            u_D=g["uD"],
            t_low=g["T_low"],
            t_1=g["t1"],
            t_2=g["t2"],
            B_w=g["Bw"],
            r_t=g["r_t"],
        )
        for k, v in closed.items():
            worst[k] = max(worst.get(k, 0), abs(v - f[k]) / mod.R)
        if i < 15:
            s = sampled_extent(mod.H, mod.R, mod.W, mod.theta0 + turn, d)
            for k, v in s.items():
                worst_s[k] = max(worst_s.get(k, 0), abs(v - f[k]) / mod.R)
    print(
        "closed forms of model_oracle.py against foundation(), largest difference / R:",
        worst,
    )
    print("sampled_extent() against foundation(), largest difference / R:", worst_s)
    print("cases (left below, right below, centre above):", kinds)

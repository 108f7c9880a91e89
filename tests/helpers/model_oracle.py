"""Reference implementation ("oracle") of the ellipsoid impact model, for tests only.

What it is
----------
A second, deliberately plain implementation of the rockfall impact model of Dattola,
Crosta and di Prisco (2023): an ellipsoidal block that sinks into the ground on an
equivalent foundation whose elasto-damping, visco-plastic and slider elements act in
series, with the constitutive functions read from the literature that the paper builds
on: Gazetas (1983) stiffness, Duncan and Chang (1970) modulus, Vesic (1973) bearing
capacity, Bolton (1986) dilatancy, Nova and Montrasio (1991) interaction surface,
Perzyna (1963) overstress flow. Those readings are ours, not the authors' code.

What it is for
--------------
To check the library. It shares no code with it: plain Python floats, SciPy's implicit
Radau IIA integrator, the laws with their kinks left sharp (no smoothing), SciPy's event
location for the end of the impact. It is slow (0.1 to some seconds an impact) and has
no gradients.

How it works
------------
Eleven states: u_n, s_t, theta, v_n, v_t, Omega, u_n^vp, u_t^vp, theta^vp, rho_c,
u_t^ps; the elastic displacement is what is left after subtraction. Six quadratures ride
along for the energy ledger: true tangential path of the centre, visco-plastic, slider
and dashpot dissipation, arm work, stiffness work. With any eta > 0 the forces follow
from an algebraic loop, solved at each right-hand side (:func:`Model.loop`): damped
Newton, then SciPy's ``root`` from several starts.

How accurate it is
------------------
``rtol`` is 1e-8 unless told otherwise. e_n, e_t and e_bar then change by about 1e-7 or
less when the tolerance is tightened, save for scenes at a knife edge (an end condition
that is only just met or missed); ``data/oracle_scenes.csv`` gives the change of each
scene in ``oracle_error``. The Coulomb slider is regularised with a relaxation time of 1
microsecond; everything else is sharp.

Signs: n into the ground, t down-slope, rotation positive clockwise (down-slope to the
right).
"""

from __future__ import annotations

import math
import warnings

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar, root

G_ACC = 9.81  # m/s2
P_A = 100e3  # Pa
T_MAX = 1.0  # s
E_VERTEX = 0.01  # rounds the surface's vertex
W_TANGENT = 0.95  # beyond this, F follows its tangent
TAU_S = 1e-6  # s, slider's relaxation time
N_UNDER_LOAD = 0.05  # of the largest N: below, an end by toppling is a detachment
Z_MAX = 1e6  # bound of sqrt(h^2+m^2)/xi, met only where the normal force vanishes

DEFAULTS = dict(
    mass_kg=100.0,
    density_kgm3=2577.8,
    aspect_ratio=1.0,
    out_of_plane_ratio=1.0,
    speed_mps=14.0,
    angle_deg=0.0,
    orientation_deg=0.0,
    angular_velocity_degps=0.0,
    slope_deg=0.0,
    unit_weight_kNm3=18.0,
    friction_angle_deg=30.0,
    relative_density=0.90,
    k_E=900.0,
    n_E=0.40,
    poisson=0.30,
    S_ef=1.0,
    eta_N=0.0,
    eta_T=0.0,
    eta_R=0.0,
    beta=0.90,
    c_v=1.0,
    gamma_v=8.7,
    delta_1=5.0,
    delta_2=1.0,
    alpha_vT=2.53,
    alpha_vR=0.0,
    psi=0.33,
    alpha_s=1.0,
    dilatancy=0.0,
    cohesion_kPa=0.0,
)

RESULTS = (
    "e_n",
    "e_t",
    "e_contact",
    "e_bar",
    "R_r",
    "max_penetration_m",
    "max_sinking_m",
    "max_normal_force_N",
    "max_moment_Nm",
    "duration_s",
    "rotation_rad",
    "v_n_mps",
    "v_t_mps",
    "omega_radps",
    "outcome",
    "kinetic_in_J",
    "kinetic_out_J",
    "gravity_J",
    "elastic_J",
    "viscoplastic_J",
    "slider_J",
    "dashpot_J",
    "arm_J",
    "stiffness_J",
)

N_STATE = 11
N_ALL = 17  # + x_t, W_vp, W_slider, W_dashpot, W_arm, W_stiffness


class LoopError(RuntimeError):
    """The algebraic loop for the forces found no solution."""


class Model:
    def __init__(self, scene: dict):
        unknown = set(scene) - set(DEFAULTS)
        if unknown:
            raise KeyError(f"unknown scene keys: {sorted(unknown)}")
        p = {**DEFAULTS, **{k: float(v) for k, v in scene.items()}}
        self.p = p
        self.mass = p["mass_kg"]
        ar, wr = p["aspect_ratio"], p["out_of_plane_ratio"]
        self.R = (3 * self.mass / (4 * math.pi * p["density_kgm3"] * ar * wr)) ** (
            1 / 3
        )
        self.H = ar * self.R
        self.W = wr * self.R
        self.inertia = self.mass * (self.H**2 + self.R**2) / 5
        self.theta0 = math.radians(p["orientation_deg"])
        ang = math.radians(p["angle_deg"])
        self.vn0 = p["speed_mps"] * math.cos(ang)
        self.vt0 = p["speed_mps"] * math.sin(ang)
        self.om0 = math.radians(p["angular_velocity_degps"])
        slope = math.radians(p["slope_deg"])
        self.g_n, self.g_t = G_ACC * math.cos(slope), G_ACC * math.sin(slope)
        self.gamma_n = p["unit_weight_kNm3"] * 1e3 * math.cos(slope)

        phi = math.radians(p["friction_angle_deg"])
        dil = min(max(p["delta_1"] * p["relative_density"] - p["delta_2"], 0.0), 4.0)
        phi_p = phi + math.radians(3.0) * dil
        self.tan_p = math.tan(phi_p)
        self.mu = self.tan_p
        self.N_q = (
            math.exp(math.pi * self.tan_p) * math.tan(math.pi / 4 + phi_p / 2) ** 2
        )
        self.N_g = 2 * (self.N_q + 1) * self.tan_p
        self.N_c = (self.N_q - 1) / self.tan_p
        self.cohesion = 1e3 * p["cohesion_kPa"]
        self.dq_fac = 2 * self.tan_p * (1 - math.sin(phi_p)) ** 2
        self.tan_b = p["alpha_s"] * math.tan(phi)
        self.nu = p["poisson"]
        self.n_E = p["n_E"]
        self.G_fac = p["S_ef"] * p["k_E"] * P_A / (2 * (1 + self.nu))
        self.eta3 = (p["eta_N"], p["eta_T"], p["eta_R"])
        self.damped = any(e > 0 for e in self.eta3)
        self.beta, self.c_v, self.gamma_v = p["beta"], p["c_v"], p["gamma_v"]
        self.a_vT, self.a_vR = p["alpha_vT"], p["alpha_vR"]
        self.psi, self.dilatancy = p["psi"], p["dilatancy"]

        s, c = math.sin(self.theta0), math.cos(self.theta0)
        self.ry0 = math.sqrt(self.H**2 * c * c + self.R**2 * s * s)
        self.T_low0 = -(self.H**2 - self.R**2) * s * c / self.ry0
        self.E0 = (
            0.5 * self.mass * (self.vn0**2 + self.vt0**2)
            + 0.5 * self.inertia * self.om0**2
        )
        self._warm = None

    # --------------------------------------------------------------------- geometry
    def geometry(self, un: float, theta: float) -> dict:
        """Equivalent foundation with the partial derivatives with respect to u_n and
        theta.

        Derivatives are (d/du_n, d/dtheta) pairs.
        """
        H2, R2 = self.H**2, self.R**2
        D = H2 - R2
        th = self.theta0 + theta
        s, c = math.sin(th), math.cos(th)
        ry = math.sqrt(H2 * c * c + R2 * s * s)
        ry_t = -D * s * c / ry  # T_low
        d = self.ry0 - un
        x = d / ry
        x_u, x_t = -1 / ry, -x * ry_t / ry
        if abs(x) < 1:
            q = math.sqrt((1 - x) * (1 + x))
            q_u, q_t = -x * x_u / q, -x * x_t / q
        else:
            q = q_u = q_t = 0.0
        HR = self.H * self.R
        at = HR * q / ry
        at_u, at_t = HR * q_u / ry, HR * (q_t / ry - q * ry_t / ry**2)
        sc = s * c
        tm = -d * sc * D / ry**2
        tm_u = sc * D / ry**2
        tm_t = -d * D * ((c * c - s * s) / ry**2 - 2 * sc * ry_t / ry**3)
        tau = math.sqrt(H2 * s * s + R2 * c * c)
        tau_t = D * sc / tau
        n_right = -d - D * sc / tau
        n_left = -d + D * sc / tau
        if n_right < 0:
            t2, t2_u, t2_t = tm + at, tm_u + at_u, tm_t + at_t
        else:
            t2, t2_u, t2_t = tau, 0.0, tau_t
        if n_left < 0:
            t1, t1_u, t1_t = tm - at, tm_u - at_u, tm_t - at_t
        else:
            t1, t1_u, t1_t = -tau, 0.0, -tau_t
        if d > 0:
            Bw, Bw_u, Bw_t = 2 * self.W * q, 2 * self.W * q_u, 2 * self.W * q_t
        else:
            Bw, Bw_u, Bw_t = 2 * self.W, 0.0, 0.0
        return dict(
            ry=ry,
            T_low=ry_t,
            d=d,
            uD=ry - d,
            t1=t1,
            t2=t2,
            Bt=t2 - t1,
            Bw=Bw,
            r_n=d,
            r_t=0.5 * (t1 + t2),
            Bt_u=t2_u - t1_u,
            Bt_t=t2_t - t1_t,
            Bw_u=Bw_u,
            Bw_t=Bw_t,
        )

    def stiffness(self, Bt: float, Bw: float):
        r0 = 0.5 * math.sqrt(Bt * Bw)
        G = self.G_fac * (self.gamma_n * r0 / P_A) ** self.n_E
        nu = self.nu
        Rs = max(Bt, Bw) / min(Bt, Bw)
        Js = 0.957 * math.exp(0.0394 * Rs)
        return (
            Js * 4 * G * r0 / (1 - nu),
            8 * G * r0 / (2 - nu),
            8 * G * r0**3 / (3 * (1 - nu)),
        )

    def stiffness_rates(self, k, g, vn, Om):
        """dk/dt of the three stiffnesses by the chain rule."""
        Bt, Bw = g["Bt"], g["Bw"]
        lt = (g["Bt_u"] * vn + g["Bt_t"] * Om) / Bt
        lw = (g["Bw_u"] * vn + g["Bw_t"] * Om) / Bw
        lr0 = 0.5 * (lt + lw)
        Rs_dot = Bt / Bw * (lt - lw) if Bt >= Bw else Bw / Bt * (lw - lt)
        n1 = self.n_E + 1
        return (
            k[0] * (n1 * lr0 + 0.0394 * Rs_dot),
            k[1] * n1 * lr0,
            k[2] * (self.n_E + 3) * lr0,
        )

    # ----------------------------------------------------------- visco-plastic part
    def V_M(self, uD: float, Bt: float, Bw: float) -> float:
        B, L = (Bt, Bw) if Bt < Bw else (Bw, Bt)
        area = 0.25 * math.pi * Bt * Bw
        u = uD if uD > 0 else 0.0
        s_q = 1 + B / L * self.tan_p
        s_g = 1 - 0.4 * B / L
        d_q = 1 + self.dq_fac * math.atan(u / B)
        s_c = 1 + B / L * self.N_q / self.N_c
        d_c = d_q + (d_q - 1) / (self.N_c * self.tan_p)
        gam = self.gamma_n
        return area * (
            self.cohesion * self.N_c * s_c * d_c
            + gam * u * self.N_q * s_q * d_q
            + 0.5 * gam * B * self.N_g * s_g
        )

    def flow(self, N, T, M, VM, Bt, rho_c):
        """Visco-plastic rates (du_n, du_t, dtheta) at the given forces."""
        xi = N / VM
        h = T / (self.mu * VM)
        mm = M / (self.psi * Bt * VM)
        hm = math.hypot(h, mm)
        if xi < hm / Z_MAX:
            xi = hm / Z_MAX
        if xi <= 0.0:
            return 0.0, 0.0, 0.0
        z2 = (hm / xi) ** 2
        S = math.sqrt(z2 + E_VERTEX * E_VERTEX)
        eta = z2 / (S + E_VERTEX)  # = S - e without cancellation
        ib = 1 / self.beta
        w = eta**ib
        wp = ib * eta ** (ib - 1)
        if w < W_TANGENT:
            F = 1 / (1 - w)
            Fp = F * F
        else:
            F0 = 1 / (1 - W_TANGENT)
            Fp = F0 * F0
            F = F0 + Fp * (w - W_TANGENT)
        Phi = xi * F / rho_c - 1
        if Phi <= 0:
            return 0.0, 0.0, 0.0
        gx = F - Fp * wp * z2 / S
        gh = Fp * wp * h / (xi * S)
        gm = Fp * wp * mm / (xi * S)
        if gx < 0:
            gx *= self.dilatancy
        norm = math.sqrt(gx * gx + gh * gh + gm * gm)
        f = self.gamma_v * Phi / norm
        return f * gx, f * gh / self.mu, f * gm / (self.psi * Bt)

    def slip(self, N, T, k_t):
        f = abs(T) - N * self.tan_b
        if f <= 0:
            return 0.0
        return math.copysign(f / (k_t * TAU_S), T)

    # ----------------------------------------------------------------------- forces
    def loop(self, elastic, c, trial, VM, Bt, rho_c, k_t):
        """Forces with dashpots.  Unknowns y = (N_raw, T, M), N = max(N_raw, 0):

        y = elastic + c (du/dt - vp(N, T, M) - slip(N, T)).
        """
        sc = (VM, self.mu * VM, self.psi * Bt * VM)
        tot = tuple(elastic[i] + c[i] * trial[i] for i in range(3))
        scale = [
            max(abs(tot[0]) / sc[0], abs(elastic[0]) / sc[0], 1e-6),
            max(abs(tot[1]) / sc[1], abs(elastic[1]) / sc[1], 1e-6),
            max(abs(tot[2]) / sc[2], abs(elastic[2]) / sc[2], 1e-6),
        ]

        def res(x):
            y0, y1, y2 = x[0] * sc[0], x[1] * sc[1], x[2] * sc[2]
            N = y0 if y0 > 0 else 0.0
            vn, vt, vr = self.flow(N, y1, y2, VM, Bt, rho_c)
            sl = self.slip(N, y1, k_t)
            return (
                x[0] - (tot[0] - c[0] * vn) / sc[0],
                x[1] - (tot[1] - c[1] * (vt + sl)) / sc[1],
                x[2] - (tot[2] - c[2] * vr) / sc[2],
            )

        def norm(r):
            return math.sqrt(
                (r[0] / scale[0]) ** 2 + (r[1] / scale[1]) ** 2 + (r[2] / scale[2]) ** 2
            )

        starts = []
        if self._warm is not None:
            starts.append(self._warm)
        el = tuple(elastic[i] / sc[i] for i in range(3))
        starts += [
            el,
            tuple(tot[i] / sc[i] for i in range(3)),
            (max(el[0], rho_c), 0.0, 0.0),
            (0.5 * rho_c, 0.0, 0.0),
        ]
        # an undamped component is known beforehand
        starts = [
            tuple(x0[i] if c[i] > 0 else el[i] for i in range(3)) for x0 in starts
        ]
        tol = 1e-12
        best, best_n = None, math.inf
        for x0 in starts:
            x, rn = self._newton(res, norm, x0, tol)
            if rn < best_n:
                best, best_n = x, rn
            if best_n <= 1e3 * tol:
                break
        if best_n > 1e3 * tol:
            for x0 in [best, *starts]:
                x, rn = self._newton(res, norm, self._relax(res, norm, x0, tol), tol)
                if rn < best_n:
                    best, best_n = x, rn
                if best_n <= 1e3 * tol:
                    break
        if best_n > 1e3 * tol:
            for x0 in [best, *starts]:
                for method in ("hybr", "lm", "df-sane"):
                    with warnings.catch_warnings():
                        warnings.simplefilter("ignore")
                        try:
                            r = root(
                                lambda x: np.array(res(x)), np.array(x0), method=method
                            )
                        except (
                            ValueError,
                            OverflowError,
                            ZeroDivisionError,
                            FloatingPointError,
                        ):
                            continue
                    x, rn = self._newton(res, norm, tuple(float(v) for v in r.x), tol)
                    if rn < best_n:
                        best, best_n = x, rn
                    if best_n <= 1e4 * tol:
                        break
                if best_n <= 1e4 * tol:
                    break
        if not best_n <= 1e-8:
            raise LoopError(f"algebraic loop: relative residual {best_n:.3g}")
        self._warm = best
        return tuple(best[i] * sc[i] for i in range(3))

    @staticmethod
    def _relax(res, norm, x, tol):
        """Pseudo-transient continuation: implicit Euler on dx/dtau = -res(x) with a
        growing step."""
        x = np.array(x, float)
        r = np.array(res(x))
        rn = norm(r)
        delta = 1e-3
        best, best_n = x, rn
        for _ in range(300):
            if rn <= tol or not math.isfinite(rn):
                break
            J = np.empty((3, 3))
            for j in range(3):
                hstep = 1e-8 * max(abs(x[j]), 1e-3 * float(np.abs(x).sum()), 1e-9)
                xj = x.copy()
                xj[j] += hstep
                J[:, j] = (np.array(res(xj)) - r) / hstep
            try:
                dx = np.linalg.solve(np.eye(3) / delta + J, -r)
            except np.linalg.LinAlgError:
                break
            x = x + dx
            r = np.array(res(x))
            rn, old = norm(r), rn
            delta = min(
                max(delta * min(max(old / max(rn, 1e-300), 0.3), 3.0), 1e-8), 1e12
            )
            if rn < best_n:
                best, best_n = x, rn
        return tuple(float(v) for v in best)

    @staticmethod
    def _newton(res, norm, x, tol):
        x = tuple(x)
        r = res(x)
        rn = norm(r)
        for _ in range(60):
            if rn == 0:
                break
            cols = []
            for j in range(3):
                hstep = 1e-7 * max(
                    abs(x[j]), 1e-3 * (abs(x[0]) + abs(x[1]) + abs(x[2])), 1e-9
                )
                xj = list(x)
                xj[j] += hstep
                rj = res(xj)
                cols.append(
                    (
                        (rj[0] - r[0]) / hstep,
                        (rj[1] - r[1]) / hstep,
                        (rj[2] - r[2]) / hstep,
                    )
                )
            a, b, d = cols
            det = (
                a[0] * (b[1] * d[2] - b[2] * d[1])
                - b[0] * (a[1] * d[2] - a[2] * d[1])
                + d[0] * (a[1] * b[2] - a[2] * b[1])
            )
            if det == 0 or not math.isfinite(det):
                break

            def det3(p, q, s):
                return (
                    p[0] * (q[1] * s[2] - q[2] * s[1])
                    - q[0] * (p[1] * s[2] - p[2] * s[1])
                    + s[0] * (p[1] * q[2] - p[2] * q[1])
                )

            dx = (-det3(r, b, d) / det, -det3(a, r, d) / det, -det3(a, b, r) / det)
            lam, done = 1.0, False
            # to the last digit: the integrator differentiates the result, so it must
            # not be lazy
            for _ in range(30 if rn > tol else 1):
                xn = (x[0] + lam * dx[0], x[1] + lam * dx[1], x[2] + lam * dx[2])
                rnew = res(xn)
                nn = norm(rnew)
                if nn < rn:
                    done = True
                    break
                lam *= 0.5
            if not done:
                break
            small = rn <= tol and nn > 0.1 * rn
            x, r, rn = xn, rnew, nn
            if small:
                break
        return x, rn

    def evaluate(self, y) -> dict:
        """All that follows from one state: geometry, stiffness, forces, rates."""
        un, st, th, vn, vt, Om, unv, utv, thv, rho_c, ups = y[:N_STATE]
        g = self.geometry(un, th)
        Bt, Bw = g["Bt"], g["Bw"]
        uD = g["uD"]
        if not (Bt > 1e-12 * self.R and Bw > 1e-12 * self.R):
            # stage of the integrator above the ground, past the end of contact: no
            # forces.
            return dict(
                g=g,
                k=(0.0, 0.0, 0.0),
                c=(0.0, 0.0, 0.0),
                ued=(uD - unv, st - utv - ups, th - thv),
                rates=(vn + g["T_low"] * Om, vt - g["d"] * Om, Om),
                N_raw=min(uD - unv, 0.0) * 1e3,
                N=0.0,
                T=0.0,
                M=0.0,
                vp=(0.0, 0.0, 0.0),
                slip=0.0,
            )
        k = self.stiffness(Bt, Bw)
        ued = (uD - unv, st - utv - ups, th - thv)
        VM = self.V_M(uD, Bt, Bw)
        rates = (vn + g["T_low"] * Om, vt - g["d"] * Om, Om)
        if self.damped:
            e = self.eta3
            c = (
                2 * e[0] * math.sqrt(k[0] * self.mass),
                2 * e[1] * math.sqrt(k[1] * self.mass),
                2 * e[2] * math.sqrt(k[2] * self.inertia),
            )
            el = (k[0] * ued[0], k[1] * ued[1], k[2] * ued[2])
            N_raw, T, M = self.loop(el, c, rates, VM, Bt, rho_c, k[1])
        else:
            c = (0.0, 0.0, 0.0)
            N_raw, T, M = k[0] * ued[0], k[1] * ued[1], k[2] * ued[2]
        N = N_raw if N_raw > 0 else 0.0
        vp = self.flow(N, T, M, VM, Bt, rho_c)
        sl = self.slip(N, T, k[1])
        return dict(
            g=g,
            k=k,
            c=c,
            ued=ued,
            rates=rates,
            N_raw=N_raw,
            N=N,
            T=T,
            M=M,
            vp=vp,
            slip=sl,
            VM=VM,
        )

    def rhs(self, t, y):
        y = [float(v) for v in y]
        f = self.evaluate(y)
        g, k, ued, rates, vp, sl = (
            f["g"],
            f["k"],
            f["ued"],
            f["rates"],
            f["vp"],
            f["slip"],
        )
        N, T, M = f["N"], f["T"], f["M"]
        vn, vt, Om = y[3], y[4], y[5]
        rho_c = y[9]
        Bt = g["Bt"]
        m = self.mass
        dvn = self.g_n - N / m
        dvt = self.g_t - T / m
        dOm = (T * g["r_n"] - N * g["r_t"] - M) / self.inertia
        if k[0] > 0:
            hard = (
                (vp[0] if vp[0] > 0 else 0.0)
                + self.a_vT * abs(vp[1])
                + self.a_vR * Bt * abs(vp[2])
            )
            drho = self.c_v * (1 - rho_c) * hard / Bt
            kd = self.stiffness_rates(k, g, vn, Om)
            w_k = 0.5 * (
                kd[0] * ued[0] ** 2 + kd[1] * ued[1] ** 2 + kd[2] * ued[2] ** 2
            )
        else:
            drho = w_k = 0.0
        w_vp = N * vp[0] + T * vp[1] + M * vp[2]
        w_sl = T * sl
        if self.damped:
            ud = (rates[0] - vp[0], rates[1] - vp[1] - sl, rates[2] - vp[2])
            # what the dashpot really takes: force less spring force (N may be clipped
            # at zero)
            w_d = (
                (N - k[0] * ued[0]) * ud[0]
                + (T - k[1] * ued[1]) * ud[1]
                + (M - k[2] * ued[2]) * ud[2]
            )
        else:
            w_d = 0.0
        w_arm = N * Om * (g["T_low"] - g["r_t"])
        return [
            vn,
            rates[1],
            Om,
            dvn,
            dvt,
            dOm,
            vp[0],
            vp[1],
            vp[2],
            drho,
            sl,
            vt,
            w_vp,
            w_sl,
            w_d,
            w_arm,
            w_k,
        ]

    def jac(self, t, y):
        """Jacobian for the integrator's Newton iteration, by differences whose steps
        follow the physics.

        Generic difference steps (relative to each state) drown in rounding here,
        because the elastic
        displacements are small differences of the states.  The right-hand side depends
        on the three
        elastic displacements, on (u_n, theta) through the geometry, on the velocities
        and on rho_c.
        """
        y = [float(v) for v in y]
        f0 = self.rhs(t, y)
        f = self.evaluate(y)
        g, ued, k = f["g"], f["ued"], f["k"]
        R, uD = self.R, g["uD"]
        u_N = (
            f["N"] / k[0] if k[0] > 0 else 0.0
        )  # = ued[0] without dashpots, may be far less with them
        J = np.zeros((N_ALL, N_ALL))

        def column(changes, h):
            z = list(y)
            for i, v in changes:
                z[i] += v
            fz = self.rhs(t, z)
            return np.array([(a - b) / h for a, b in zip(fz, f0, strict=True)])

        floor = 1e-13 * R
        h = 1e-6 * max(abs(ued[0]), floor)
        c_n = column([(6, -h)], h)
        h = 1e-6 * max(abs(ued[1]), 1e-6 * u_N, 1e-6 * floor)
        c_t = column([(7, -h)], h)
        h = 1e-6 * max(abs(ued[2]), 1e-6 * u_N / R, 1e-6 * floor / R)
        c_r = column([(8, -h)], h)
        h = 1e-5 * max(abs(uD), 1e-9 * R)
        geo_u = column([(0, h), (6, h)], h)
        h /= R
        rise = self.geometry(y[0], y[2] + h)["uD"] - uD
        geo_th = column([(2, h), (8, h), (6, rise)], h)
        J[:, 0] = geo_u + c_n
        J[:, 2] = geo_th + c_r + g["T_low"] * c_n
        J[:, 6], J[:, 8] = -c_n, -c_r
        J[:, 1] = c_t
        J[:, 7] = J[:, 10] = -c_t
        speed = math.hypot(self.vn0, self.vt0) + abs(self.om0) * R
        for i, h in (
            (3, 1e-6 * speed),
            (4, 1e-6 * speed),
            (5, 1e-6 * speed / R),
            (9, 1e-7 * abs(y[9]) + 1e-12),
        ):
            J[:, i] = column([(i, h)], h)
        return J

    # --------------------------------------------------------------------- energies
    def kinetic(self, y):
        return (
            0.5 * self.mass * (y[3] ** 2 + y[4] ** 2) + 0.5 * self.inertia * y[5] ** 2
        )

    def elastic(self, f):
        k, u = f["k"], f["ued"]
        un = u[0] if (self.damped or u[0] > 0) else 0.0
        return 0.5 * (k[0] * un**2 + k[1] * u[1] ** 2 + k[2] * u[2] ** 2)


def _floats(y):
    return [float(v) for v in y]


def _refine_max(sol, f_of_t, t_end):
    """Maximum of f over the run: step ends first, then the dense output around the best
    of them."""
    ts = [t for t in sol.t if t <= t_end]
    if not ts or ts[-1] < t_end:
        ts.append(t_end)
    v = [f_of_t(t) for t in ts]
    top = max(v)
    best = top
    cand = [
        i
        for i in range(len(v))
        if v[i] >= top - 0.03 * abs(top)
        and (i == 0 or v[i] >= v[i - 1])
        and (i == len(v) - 1 or v[i] >= v[i + 1])
    ]
    cand.sort(key=lambda i: -v[i])
    for i in cand[:6]:
        a, b = ts[max(i - 1, 0)], ts[min(i + 1, len(v) - 1)]
        # each of the two steps has its own interpolant: search them one by one
        for lo, hi in ((a, ts[i]), (ts[i], b)):
            if hi > lo:
                r = minimize_scalar(
                    lambda t: -f_of_t(t),
                    bounds=(lo, hi),
                    method="bounded",
                    options=dict(xatol=1e-5 * (hi - lo)),
                )
                best = max(best, -float(r.fun))
    return best


def simulate(scene: dict, rtol: float = 1e-8, history: bool = False) -> dict:
    """One impact.  ``scene`` may leave out any key of :data:`DEFAULTS`; see
    :data:`RESULTS` for the result.

    Further keys of the result: ``ledger_residual_J`` (what the energy ledger misses),
    ``e_vijayakumar``,
    ``e_bar_eq5``, ``R_r0``, ``message``, ``steps``, ``rhs_evaluations`` and, with
    ``history``,
    ``model`` and ``solution`` (SciPy's object).
    """
    mod = Model(scene)
    nan = math.nan
    out = {k: nan for k in RESULTS}
    out.update(
        ledger_residual_J=nan,
        e_vijayakumar=nan,
        e_bar_eq5=nan,
        message="",
        steps=0,
        rhs_evaluations=0,
    )
    out["kinetic_in_J"] = mod.E0
    out["R_r0"] = 0.5 * mod.inertia * mod.om0**2 / mod.E0
    v_contact0 = mod.vn0 + mod.T_low0 * mod.om0
    un0 = 1e-6 * mod.R
    y0 = [0.0] * N_ALL
    y0[0], y0[3], y0[4], y0[5], y0[9] = un0, mod.vn0, mod.vt0, mod.om0, 0.01

    if v_contact0 <= 0:
        out["outcome"] = "separating"
        out.update(
            max_penetration_m=un0,
            max_sinking_m=un0,
            max_normal_force_N=0.0,
            max_moment_Nm=0.0,
        )
        _fill(out, mod, y0, 0.0, r_t=mod.T_low0, v_contact0=v_contact0)
        out.update(
            gravity_J=0.0,
            elastic_J=0.0,
            viscoplastic_J=0.0,
            slider_J=0.0,
            dashpot_J=0.0,
            arm_J=0.0,
            stiffness_J=0.0,
            ledger_residual_J=0.0,
        )
        return out

    R, E_ref = mod.R, mod.E0
    M_round = (
        1e-10 * E_ref
    )  # a moment that is mere rounding must not topple a symmetric block

    def ev_normal(t, y):
        return mod.evaluate(_floats(y))["N_raw"]

    def ev_level(t, y):
        return mod.geometry(float(y[0]), float(y[2]))["uD"] / (0.5e-6 * R) - 1

    def ev_topple(t, y):
        f = mod.evaluate(_floats(y))
        g = f["g"]
        if f["N"] <= 0:
            a = math.inf if abs(f["M"]) > M_round else -1.0
        else:
            a = (abs(f["M"]) - M_round) / (0.5 * f["N"] * g["Bt"]) - 1
        return max(min(a, g["uD"] / (1e-3 * R) - 1, 1e3), -1e3)

    def ev_arrest(t, y):
        f = mod.evaluate(_floats(y))
        return (mod.kinetic(y) + mod.elastic(f)) / (1e-4 * E_ref) - 1

    for ev, direction in (
        (ev_normal, -1),
        (ev_level, -1),
        (ev_topple, 1),
        (ev_arrest, -1),
    ):
        ev.terminal, ev.direction = True, direction
    names = ("detached", "detached", "toppled", "arrested")

    speed = math.hypot(mod.vn0, mod.vt0) + abs(mod.om0) * mod.H
    a_len, a_ang = 1e-3 * rtol * R, 1e-2 * rtol
    a_v, a_om = 1e-3 * rtol * speed, 1e-3 * rtol * speed / R
    a_E = 1e-1 * rtol * E_ref
    atol = [
        a_len,
        a_len,
        a_ang,
        a_v,
        a_v,
        a_om,
        a_len,
        a_len,
        a_ang,
        1e-3 * rtol,
        a_len,
        a_len * 1e2,
    ] + [a_E] * 5
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            sol = solve_ivp(
                mod.rhs,
                (0.0, T_MAX),
                y0,
                method="Radau",
                jac=mod.jac,
                rtol=rtol,
                atol=atol,
                events=(ev_normal, ev_level, ev_topple, ev_arrest),
                dense_output=True,
                first_step=0.05 * un0 / max(v_contact0, speed),
            )
    except (
        LoopError,
        ValueError,
        OverflowError,
        ZeroDivisionError,
        FloatingPointError,
    ) as err:
        out["outcome"], out["message"] = "failed", f"{type(err).__name__}: {err}"
        return out
    out["steps"], out["rhs_evaluations"] = len(sol.t), sol.nfev
    if sol.status == 1:
        # the earliest event ended the run
        hits = [(te[0], i) for i, te in enumerate(sol.t_events) if len(te)]
        t_end, which = min(hits)
        y_end = sol.y_events[which][0]
        out["outcome"] = names[which]
    elif sol.status == 0:
        t_end, y_end = sol.t[-1], sol.y[:, -1]
        out["outcome"] = "in contact"
    else:
        out["outcome"], out["message"] = "failed", sol.message
        return out
    y_end = [float(v) for v in y_end]
    mod._warm = None
    f_end = mod.evaluate(y_end)
    _fill(out, mod, y_end, float(t_end), r_t=f_end["g"]["r_t"], v_contact0=v_contact0)

    def at(t):
        return _floats(sol.sol(t))

    out["max_penetration_m"] = _refine_max(sol, lambda t: float(sol.sol(t)[0]), t_end)

    def sink(t):
        y = sol.sol(t)
        return mod.geometry(float(y[0]), float(y[2]))["uD"]

    out["max_sinking_m"] = _refine_max(sol, sink, t_end)
    out["max_normal_force_N"] = _refine_max(
        sol, lambda t: mod.evaluate(at(t))["N"], t_end
    )
    out["max_moment_Nm"] = _refine_max(
        sol, lambda t: abs(mod.evaluate(at(t))["M"]), t_end
    )
    if (
        out["outcome"] == "toppled"
        and f_end["N"] < N_UNDER_LOAD * out["max_normal_force_N"]
    ):
        out["outcome"] = "detached"

    out["gravity_J"] = mod.mass * (mod.g_n * (y_end[0] - un0) + mod.g_t * y_end[11])
    out["elastic_J"] = mod.elastic(f_end)
    names_q = ("viscoplastic_J", "slider_J", "dashpot_J", "arm_J", "stiffness_J")
    for name, v in zip(names_q, y_end[12:], strict=True):
        out[name] = v
    f_start = mod.evaluate(y0)
    out["ledger_residual_J"] = (
        out["kinetic_in_J"]
        + mod.elastic(f_start)
        + out["gravity_J"]
        + out["arm_J"]
        + out["stiffness_J"]
        - out["kinetic_out_J"]
        - out["elastic_J"]
        - out["viscoplastic_J"]
        - out["slider_J"]
        - out["dashpot_J"]
    )
    if history:
        out["model"], out["solution"] = mod, sol
    return out


def _fill(out, mod, y, t_end, r_t, v_contact0):
    vn, vt, Om = y[3], y[4], y[5]
    E = mod.kinetic(y)
    out["e_n"] = -vn / mod.vn0
    out["e_t"] = vt / mod.vt0 if mod.vt0 != 0 else math.nan
    out["e_contact"] = -(vn + r_t * Om) / v_contact0
    out["e_bar"] = math.sqrt(E / mod.E0)
    out["R_r"] = 0.5 * mod.inertia * Om**2 / E
    out["duration_s"], out["rotation_rad"] = t_end, y[2]
    out["v_n_mps"], out["v_t_mps"], out["omega_radps"] = vn, vt, Om
    out["kinetic_out_J"] = E
    # e_bar from the apparent coefficients and the rotational shares
    E_t = 0.5 * mod.mass * (vn**2 + vt**2)
    if out["R_r"] < 1:
        out["e_bar_eq5"] = math.sqrt(E_t / (1 - out["R_r"]) / mod.E0)
    inertia, m, e = mod.inertia, mod.mass, out["e_contact"]
    r = mod.T_low0
    den = inertia + m * r * r
    out["e_vijayakumar"] = (inertia * e - m * r * r) / den + (
        1 + e
    ) * r * inertia / den * mod.om0 / mod.vn0


REFERENCE = (
    # scene, (e_n, e_t, e_bar, max u_n, max N, duration, rotation, end)
    (dict(), (0.1295, None, 0.1295, 0.2119, 89828, 0.02900, 0, "detached")),
    (
        dict(aspect_ratio=2, orientation_deg=30),
        (-0.0998, None, 0.2237, 0.2610, 75769, 0.02990, 0.3003, "detached"),
    ),
    (
        dict(aspect_ratio=2, angle_deg=40),
        (0.1085, 0.7352, 0.5076, 0.1844, 63219, 0.03248, 0.1465, "detached"),
    ),
    (
        dict(aspect_ratio=4, angle_deg=70),
        (-0.0748, 0.8699, 0.8498, 0.1627, 16453, 0.05095, 0.2265, "detached"),
    ),
    (
        dict(aspect_ratio=2, angle_deg=40, c_v=0.5, gamma_v=0.85),
        (0.2214, 0.7544, 0.5638, 0.1118, 114447, 0.02160, 0.1564, "detached"),
    ),
)
"""Five published check scenes of the model with their printed results."""


if __name__ == "__main__":
    import time

    keys = (
        "e_n",
        "e_t",
        "e_bar",
        "max_penetration_m",
        "max_normal_force_N",
        "duration_s",
        "rotation_rad",
        "outcome",
    )
    for scene, want in REFERENCE:
        t0 = time.perf_counter()
        r = simulate(scene)
        dt = time.perf_counter() - t0
        print(scene, f"{dt:.2f} s, {r['steps']} steps, {r['rhs_evaluations']} rhs")
        for key, w in zip(keys, want, strict=True):
            print(f"   {key:20s} {r[key]!s:>24} {w!s:>10}")
        print(
            "   residual",
            r["ledger_residual_J"],
            "max M",
            r["max_moment_Nm"],
            "e*",
            r["e_contact"],
        )
    r = simulate(dict(aspect_ratio=2, orientation_deg=30, angle_deg=math.degrees(0.3)))
    print({k: v if isinstance(v, str) else round(v, 4) for k, v in r.items()})

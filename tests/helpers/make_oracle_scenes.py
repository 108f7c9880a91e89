"""Regenerate data/oracle_scenes.csv: random scenes with the results of
:mod:`model_oracle`.

    OMP_NUM_THREADS=1 python make_oracle_scenes.py

The seed is fixed, so that the scenes are the same each time. Each is run at rtol 1e-8
and 1e-9; the results are those of 1e-9, and ``oracle_error`` is the largest change of
e_n, e_t and e_bar between the two (how far the oracle itself can be trusted in that
scene). ``outcome_loose`` is the outcome at 1e-8: where it differs from ``outcome`` the
scene sits on a knife edge. Progress goes to stderr.
"""

from __future__ import annotations

import math
import signal
import sys

import numpy as np
from model_oracle import DEFAULTS, RESULTS, simulate
from paths import DATA
from text_files import write_rows

SEED = 20231
LIMIT_S = 60
EXTRA = ("ledger_residual_J", "e_vijayakumar", "oracle_error", "outcome_loose")


COUNT = 300
COHESIVE = 60
"""Scenes whose ground has cohesion, behind the others."""


def scenes() -> list[dict]:
    """Random scenes, rounded so that the CSV holds exactly what was run."""
    cohesive = random_scenes(COHESIVE, SEED + 1)
    rng = np.random.default_rng(SEED + 2)
    for scene in cohesive:
        scene["cohesion_kPa"] = float(f"{10 ** rng.uniform(-1.0, 2.5):.6g}")
    return random_scenes(COUNT, SEED) + cohesive


def random_scenes(count: int, seed: int) -> list[dict]:
    rng = np.random.default_rng(seed)

    def uni(a, b):
        return float(rng.uniform(a, b))

    def log(a, b):
        return float(math.exp(rng.uniform(math.log(a), math.log(b))))

    out = []
    for i in range(count):
        sc = dict(DEFAULTS)
        sc["mass_kg"] = log(0.05, 1e4)
        sc["aspect_ratio"] = log(0.5, 4)
        sc["out_of_plane_ratio"] = uni(0.6, 1.6) if rng.random() < 1 / 3 else 1.0
        sc["speed_mps"] = log(1, 40)
        sc["angle_deg"] = uni(-85, 85) if rng.random() < 0.8 else 0.0
        sc["orientation_deg"] = uni(0, 180)
        sc["angular_velocity_degps"] = (
            0.0 if rng.random() < 1 / 3 else float(rng.choice([-1, 1])) * log(20, 20000)
        )
        sc["slope_deg"] = uni(0, 50) if rng.random() < 0.5 else 0.0
        if rng.random() < 0.6:
            sc["unit_weight_kNm3"] = uni(14, 22)
            sc["friction_angle_deg"] = uni(25, 42)
            sc["relative_density"] = uni(0.3, 1.0)
            sc["k_E"] = log(100, 5000)
            sc["n_E"] = uni(0.3, 0.7)
            sc["poisson"] = uni(0.1, 0.4)
            sc["beta"] = uni(0.7, 1.0)
            sc["c_v"] = log(0.1, 5)
            sc["gamma_v"] = log(0.3, 30)
            sc["psi"] = uni(0.2, 0.6)
            sc["alpha_vT"] = uni(0, 4)
            sc["alpha_vR"] = uni(0, 2)
            sc["alpha_s"] = uni(0.5, 1.5)
            sc["dilatancy"] = uni(0, 1)
        if i % 12 == 5:  # 25 of 300
            which = rng.random(3) < 0.7
            for key, on in zip(("eta_N", "eta_T", "eta_R"), which, strict=True):
                sc[key] = uni(0, 0.5) if on else 0.0
            if not which.any():
                sc["eta_N"] = uni(0, 0.5)
        out.append({k: float(f"{v:.6g}") for k, v in sc.items()})
    return out


class TooLong(Exception):
    pass


def _alarm(signum, frame):
    raise TooLong


def change(a: dict, b: dict) -> float:
    """Largest change of e_n, e_t, e_bar; inf where only one of the two has a number."""
    worst = 0.0
    for k in ("e_n", "e_t", "e_bar"):
        x, y = a[k], b[k]
        if math.isnan(x) and math.isnan(y):
            continue
        d = abs(x - y)
        worst = max(worst, math.inf if math.isnan(d) else d)
    return worst


def run(scene: dict, rtol: float):
    signal.signal(signal.SIGALRM, _alarm)
    signal.alarm(LIMIT_S)
    try:
        return simulate(scene, rtol=rtol)
    except TooLong:
        return None
    finally:
        signal.alarm(0)


def main() -> None:
    rows, todo = [], scenes()
    for number, scene in enumerate(todo):
        loose, tight = run(scene, 1e-8), run(scene, 1e-9)
        if loose is None:
            print(f"{number}: left out, over {LIMIT_S} s: {scene}", file=sys.stderr)
            continue
        sound = tight is not None and tight["outcome"] != "failed"
        best = tight if sound else loose
        error = change(loose, tight) if tight is not None else math.nan
        row = best | dict(oracle_error=error, outcome_loose=loose["outcome"])
        results = [row[name] for name in (*RESULTS, *EXTRA)]
        rows.append(
            [number, *(repr(scene[name]) for name in DEFAULTS)]
            + [x if isinstance(x, str) else f"{x:.10g}" for x in results]
        )
        words = f"{best['outcome']}, changes by {error:.1e} {best['message']}"
        print(f"{number + 1} of {len(todo)}: {words}", file=sys.stderr, flush=True)
    write_rows(DATA / "oracle_scenes.csv", ["scene", *DEFAULTS, *RESULTS, *EXTRA], rows)


if __name__ == "__main__":
    main()

"""Fig. 4: vertical impacts along the major axis (set I)."""

from ..parts import FALLS, RISES, between, from_to, judge, steps_that_go, trend
from ..study import Datasets
from ..verdict import Judgement, Verdict

RISE = 0.01
"""e_n below which a block counts as stopped."""


def penetration_grows(sets: Datasets) -> Judgement:
    """The largest u_n of set I rises with A_r."""
    depth = sets["I"].max_penetration_m.values
    return judge(
        f"{from_to(depth, 'm')}, {steps_that_go(depth, RISES)}",
        [trend(depth, RISES)],
        {"sphere_m": depth[0], "longest_m": depth[-1]},
    )


def force_falls(sets: Datasets) -> Judgement:
    """The largest N of set I falls with A_r."""
    force = sets["I"].max_normal_force_N.values / 1e3
    return judge(
        f"{from_to(force, 'kN')}, {steps_that_go(force, FALLS)}",
        [trend(force, FALLS)],
        {"sphere_kN": force[0], "longest_kN": force[-1]},
    )


def peaks_come_later(sets: Datasets) -> Judgement:
    """The times of the largest u_n and N of set I rise with A_r."""
    depth = 1e3 * sets["I"].time_of_max_penetration_s.values
    force = 1e3 * sets["I"].time_of_max_normal_force_s.values
    return judge(
        f"of u_n {from_to(depth, 'ms')}, {steps_that_go(depth, RISES)}; "
        f"of N {from_to(force, 'ms')}, {steps_that_go(force, RISES)}",
        [trend(depth, RISES), trend(force, RISES)],
        {
            "sphere_u_n_ms": depth[0],
            "longest_u_n_ms": depth[-1],
            "sphere_N_ms": force[0],
            "longest_N_ms": force[-1],
        },
    )


def short_blocks_stop(sets: Datasets) -> Judgement:
    """Blocks of low A_r stop, those of high A_r detach."""
    data = sets["I"]
    e_n = data.e_n.values
    detaches = (data.outcome.values == "detached") & (e_n > RISE)
    stops = data.outcome.isin(["arrested", "in contact"]).values | (abs(e_n) < RISE)
    mixed = stops.any() and detaches.any()
    first = int(detaches.argmax()) if mixed else 0
    divided = int(stops[:first].sum() + detaches[first:].sum()) if mixed else 0
    if not mixed:
        verdict = Verdict.fails
    elif first > 0 and divided == len(e_n):
        verdict = Verdict.holds
    else:
        verdict = Verdict.partly
    return Judgement(
        verdict,
        f"{stops.sum()} stop and {detaches.sum()} detach of {len(e_n)}, "
        f"e_n {between(e_n)}",
        {"stop": float(stops.sum()), "detach": float(detaches.sum())},
        divided,
        len(e_n),
    )


CLAIMS = {
    "C01": penetration_grows,
    "C02": force_falls,
    "C03": peaks_come_later,
    "C04": short_blocks_stop,
}

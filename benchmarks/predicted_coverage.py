"""How many new measurements lie in the intervals of 95 % predicted for them.

    python -m benchmarks.predicted_coverage [--campaigns 40] [--first 0] [--starts 4]
        [--noise proportional|constant] [--targets v_n_mps,v_t_mps] [--spread even|log]
        [--beyond]

A campaign is 15 impacts of 500 kg on the usual ground at 10 to 70 degrees and 2 to 30
m/s, evenly spread or in the logarithm of the speed, with noise of 3 % of each value, or
of 3 % of the target's root mean square. c_v, gamma_v and k_E are fitted three times:
with scatter estimated as constant, as proportional, and with sigmas of 3 % of each
measurement stated. 20 further impacts of the same range are predicted, and measured
with the same noise; with `--beyond` of 30 to 60 m/s. Told are the measurements inside,
of all, and of the third of least and of largest values in each campaign; and the median
width over the value.
"""

import argparse
import time

import jax
import numpy as np

TESTS, NEW = 15, 20
ANGLES, SPEEDS, MASS = (10.0, 70.0), (2.0, 30.0), 500.0
NOISE = 0.03
DRAWS = 256


def main() -> None:
    jax.config.update("jax_enable_x64", True)
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--campaigns", type=int, default=40)
    parser.add_argument("--first", type=int, default=0, help="seed")
    parser.add_argument("--starts", type=int, default=4)
    noises = "proportional", "constant"
    parser.add_argument("--noise", choices=noises, default=noises[0])
    parser.add_argument("--targets", default="v_n_mps,v_t_mps")
    parser.add_argument("--spread", choices=("even", "log"), default="even")
    parser.add_argument("--beyond", action="store_true")
    arguments = parser.parse_args()
    targets, begin = arguments.targets.split(","), time.perf_counter()
    kinds = *noises, "stated"
    rows, parts, skipped = {kind: [] for kind in kinds}, [], 0
    for seed in range(arguments.first, arguments.first + arguments.campaigns):
        random = np.random.default_rng(seed)
        columns, truth = _impacts(random, targets, arguments.spread, arguments.beyond)
        scale = np.abs(truth)
        if arguments.noise == "constant":
            scale = np.broadcast_to(np.sqrt(np.mean(truth**2, axis=0)), truth.shape)
        measured = truth + NOISE * scale * random.normal(size=truth.shape)
        found = {}
        for kind in kinds:
            study = _study(columns, measured, targets, kind, arguments.starts)
            found[kind] = _fit_and_predict(study, columns, measured, targets)
        if any(one is None for one in found.values()):
            skipped += 1
            continue
        for kind in kinds:
            rows[kind].append(found[kind][:2])
        parts.append(found[noises[0]][2])
    print(
        f"noise {arguments.noise}, {arguments.spread} speeds, {len(parts)} campaigns, "
        f"{skipped} without a trusted fit, {time.perf_counter() - begin:.0f} s"
    )
    for kind in kinds:
        _print(kind, rows[kind], targets)
    mean = (100.0 * np.mean(parts, axis=0)).tolist()
    print("r, mean:", *(f"{n} {r:.2f} %" for n, r in zip(targets, mean, strict=True)))


def _print(kind, rows, targets) -> None:
    inside, width = (np.array(part) for part in zip(*rows, strict=True))
    share = np.mean(inside, axis=(1, 2))
    error = np.std(share, ddof=1) / np.sqrt(len(share))
    print(f"{kind:13} {100 * np.mean(share):5.1f} +- {100 * error:.1f} % inside")
    third = NEW // 3
    for place, name in enumerate(targets):
        of_one, wide = inside[:, :, place], width[:, :, place]
        print(
            f"  {name:10} {100 * np.mean(of_one):5.1f} %; least third "
            f"{100 * np.mean(of_one[:, :third]):5.1f} %, width "
            f"{100 * np.median(wide[:, :third]):.0f} % of the value; largest third "
            f"{100 * np.mean(of_one[:, -third:]):5.1f} %, width "
            f"{100 * np.median(wide[:, -third:]):.0f} %"
        )


def _impacts(random, targets, spread, beyond):
    """Columns of all impacts, and what the model gives for them."""
    from jaximpact.calibration.arguments import table_given
    from jaximpact.calibration.problem.config import study_of
    from jaximpact.calibration.problem.dataset import joined_tables
    from jaximpact.calibration.problem.objective import Objective

    count = TESTS + NEW
    low, high = SPEEDS
    speeds = random.uniform(low, high, count)
    if spread == "log":
        speeds = np.exp(random.uniform(np.log(low), np.log(high), count))
    if beyond:
        speeds[TESTS:] = random.uniform(high, 2.0 * high, NEW)
    columns = {"mass_kg": np.full(count, MASS), "speed_mps": speeds}
    columns["angle_deg"] = random.uniform(*ANGLES, count)
    nothing = columns | {name: np.ones(count) for name in targets}
    study = study_of(joined_tables((table_given(nothing),)), {})
    objective = Objective(study, study.variants[0], _model_of(study))
    x = objective.bounds.coordinate(np.array([[p.start for p in study.parameters]]))
    found = objective.values(x)
    return columns, found.predicted[0]


def _model_of(study):
    from jaximpact.calibration.problem.forward_model import models_of

    return models_of(study)[0]


def _rows(columns, measured, targets, chosen):
    from jaximpact.calibration.arguments import table_given
    from jaximpact.calibration.problem.dataset import joined_tables

    rows = columns | dict(zip(targets, measured.T, strict=True))
    rows = {name: np.asarray(values)[chosen] for name, values in rows.items()}
    return joined_tables((table_given(rows),))


def _study(columns, measured, targets, kind, starts):
    from jaximpact.calibration.problem.config import study_of

    content = {"starts": starts, "accuracy": "balanced"}
    if kind == "stated":
        columns = columns | _sigmas(measured, targets)
    else:
        content["scatter"] = kind
    return study_of(_rows(columns, measured, targets, slice(None, TESTS)), content)


def _sigmas(measured, targets):
    names = [f"sigma_{name}" for name in targets]
    return dict(zip(names, NOISE * np.abs(measured).T, strict=True))


def _fit_and_predict(study, columns, measured, targets):
    """Which new measurements lie in their intervals and how wide these are, over the
    value, `(tests, targets)`, of each target the least value first; and r. None where
    the fit's draws are not to be trusted."""
    from jaximpact.calibration.fitted_ground import FittedGround
    from jaximpact.calibration.prediction import held_out_study, predict_variant

    fitted, parts = _fitted(study, targets)
    if not fitted.trusted:
        return None
    nothing = ("soil", "nuisances", "ranges", "results", "versions", "parts", "block")
    ground = FittedGround(
        title="campaign",
        variants=(fitted,),
        parameters=study.parameters,
        targets=study.targets,
        accuracy="balanced",
        seed=0,
        **{name: {} for name in nothing},
    )
    if np.any(study.sigma_given):
        columns = columns | _sigmas(measured, targets)
    new = held_out_study(ground, _rows(columns, measured, targets, slice(TESTS, None)))
    found = predict_variant(new, ground, fitted, _model_of(new))
    inside = (new.measured >= found.low_95) & (new.measured <= found.high_95)
    width = (found.high_95 - found.low_95) / np.abs(new.measured)
    order = np.argsort(np.abs(new.measured), axis=0)
    sorted_ = (np.take_along_axis(part, order, axis=0) for part in (inside, width))
    return *sorted_, parts


def _fitted(study, targets):
    """The variant as it is fitted, and r of each target."""
    from jaximpact.calibration.diagnostics.discrepancy import estimate_discrepancy
    from jaximpact.calibration.diagnostics.importance_sampling import (
        draw,
        weights_of,
    )
    from jaximpact.calibration.diagnostics.uncertainty import estimate
    from jaximpact.calibration.estimation.sigma import (
        freedom_of_targets,
        relative_sigma,
    )
    from jaximpact.calibration.fitted_ground import FittedVariant
    from jaximpact.calibration.problem.noise import ProportionalScatter
    from jaximpact.calibration.problem.objective import Objective
    from jaximpact.calibration.study import best_fit

    objective, best, *_ = best_fit(
        Objective(study, study.variants[0], _model_of(study))
    )
    points, bounds = best.points, objective.bounds
    uncertainty = estimate(objective, points)
    draws = draw(objective, points, uncertainty.inflation, count=DRAWS)
    parts = relative_sigma(study, objective.sigma, points.predicted[0])
    least = study.least_size

    def by_target(values):
        return dict(zip(targets, values, strict=True))

    scatter = by_target(map(ProportionalScatter, parts, least))
    proportional = by_target(study.proportional)
    fitted = FittedVariant(
        variant=study.variants[0],
        unknowns=tuple(p.name for p in study.parameters),
        best=bounds.parameter(points.x[0]),
        draws=bounds.parameter(draws.x),
        weights=weights_of(objective, points, draws),
        undetermined={},
        allowed={},
        sigma=by_target(np.median(objective.sigma, axis=0)),
        proportional={name: scatter[name] for name in targets if proportional[name]},
        estimated=by_target(~study.sigma_given),
        inflation=uncertainty.inflation,
        freedom=by_target(freedom_of_targets(objective, points)),
        accuracy=draws.accuracy,
        factors={},
        discrepancy=estimate_discrepancy(objective, points, uncertainty),
    )
    return fitted, parts


if __name__ == "__main__":
    main()

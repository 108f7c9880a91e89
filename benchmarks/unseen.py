"""Which law predicts impacts that it has not seen, and whether its intervals hold.

    python -m benchmarks.unseen [--only golf ...] [--out unseen.csv]

Of every study of `calibration/` with six tests or more, of the golf balls of
`e_n_against_speed`, and of golf balls at nine speeds and four angles after the same
author, with noise of 7 % in e_n and 5 % in e_t, these are left out in turn: the third
of the largest and of the smallest speeds, sizes and angles, every other test, and each
campaign where there are several. Grounds of the model, and laws of rebound where they
predict a target, are fitted to the rest and predict what was left out. Told are, of
each campaign and law, root mean square error (of coefficients absolute, of other
results relative to the measurement), mean log score, and how many measurements lie in
the intervals of 95 %, with discrepancy and without. The file goes on where it was
interrupted.
"""

import argparse
import csv
import dataclasses
from collections import defaultdict
from pathlib import Path

import jax
import numpy as np

from .e_n_against_speed import measured_drops
from .grounds import CALIBRATION

GOLF, GOLF_BY_ANGLE = "golf", "golf by angle"
STUDIES = sorted(path.parent.name for path in CALIBRATION.glob("*/study.toml"))
FEWEST = 6
COLUMNS = (
    *("campaign", "left_out", "law", "target", "test", "measured", "predicted"),
    *("deviation", "discrepancy", "score", "inside", "inside_without"),
)


def main() -> None:
    jax.config.update("jax_enable_x64", True)
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", default=[GOLF, GOLF_BY_ANGLE, *STUDIES])
    parser.add_argument("--out", type=Path, default=Path("out/unseen.csv"))
    arguments = parser.parse_args()
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    rows = _read(arguments.out)
    done = {(row["campaign"], row["left_out"], row["law"]) for row in rows}
    with open(arguments.out, "a", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS)
        if not rows:
            writer.writeheader()
        for campaign in arguments.only:
            for new in _predictions(campaign, done):
                writer.writerows(new)
                file.flush()
    _tell([row for row in _read(arguments.out) if row["campaign"] in arguments.only])


def _read(path: Path) -> list[dict]:
    if not path.exists():
        return []
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def _predictions(campaign: str, done: set):
    """Yield the rows of every group left out, and every law."""
    study = study_of(campaign)
    if np.sum(np.any(study.exact, axis=1)) < FEWEST:
        return
    for name, left in _groups(study).items():
        for contender in laws_of(study):
            if (campaign, name, contender.name) in done:
                continue
            print(f"{campaign} without {name}: {contender.name}", flush=True)
            try:
                rows = _predicted(study, left, contender)
            except Exception as error:  # a law that cannot be fitted to the rest
                print(f"  {error}", flush=True)
                continue
            origin = dict(campaign=campaign, left_out=name, law=contender.name)
            yield [origin | row for row in rows]


def study_of(campaign: str):
    """Read the study of a campaign, with the usual parameters and its first variant."""
    from jaximpact.calibration.arguments import study_given
    from jaximpact.calibration.problem.config import read_study

    if campaign in (GOLF, GOLF_BY_ANGLE):
        columns = measured_drops() if campaign == GOLF else golf_by_angle()
        study = study_given(columns)
    else:
        study = read_study(CALIBRATION / campaign / "study.toml")
    first = study.variants[:1]
    return dataclasses.replace(study, variants=first, starts=16, accuracy="balanced")


def golf_by_angle() -> dict:
    """Columns of golf balls that meet the turf at an angle (Penner 2002): it gives way,
    so that they rebound from a plane that is inclined by 15.4 degrees times v / 18.6
    m/s and angle / 44.4 degrees, with e_n of the speed normal to it, and roll."""
    drops, random = measured_drops(), np.random.default_rng(0)
    speeds = np.array([1.0, 2.0, 3.5, 5.0, 7.0, 9.0, 11.0, 14.0, 17.0])
    speed, angle = (
        part.ravel() for part in np.meshgrid(speeds, np.radians([5, 20, 40, 60]))
    )
    tilt = np.radians(15.4) * (speed / 18.6) * (angle / np.radians(44.4))
    normal = speed * np.cos(angle - tilt)
    normal *= 0.510 - 0.0375 * normal + 0.000903 * normal**2
    along = 5.0 / 7.0 * speed * np.sin(angle - tilt)
    e_n = normal * np.cos(tilt) + along * np.sin(tilt)
    e_t = along * np.cos(tilt) - normal * np.sin(tilt)
    e_n, e_t = e_n / (speed * np.cos(angle)), e_t / (speed * np.sin(angle))
    return drops | {
        "speed_mps": speed,
        "angle_deg": np.degrees(angle),
        "e_n": e_n * (1.0 + 0.07 * random.normal(size=len(speed))),
        "e_t": e_t * (1.0 + 0.05 * random.normal(size=len(speed))),
    }


def laws_of(study) -> list:
    """List the grounds, and laws of rebound where they predict a target."""
    from jaximpact.calibration.comparison.contenders import default_contenders
    from jaximpact.calibration.comparison.fitted_law import predicted_by_rebound

    laws = default_contenders(study)
    rebound = bool(predicted_by_rebound(study))
    return [law for law in laws if rebound or not law.is_rebound]


def _groups(study) -> dict[str, np.ndarray]:
    from jaximpact.calibration.diagnostics.discrepancy import places_of, thirds

    measured = np.any(study.exact, axis=1)
    groups = thirds(places_of(study.tests, study.soil), measured)
    groups["every other"] = measured & (np.cumsum(measured) % 2 == 0)
    labels = np.array(study.tests.labels["campaign"])
    if len(names := set(labels[measured])) > 1:
        groups |= {f"campaign: {name}": measured & (labels == name) for name in names}
    return groups


def _predicted(study, left: np.ndarray, contender) -> list[dict]:
    """Fit a law to the rest, and predict what was left out."""
    from scipy.stats import t

    from jaximpact.calibration.comparison.fitted_law import (
        fit_law,
        of_targets,
        predict_law,
        predicted_by_rebound,
    )

    if contender.is_rebound:
        study = of_targets(study, predicted_by_rebound(study))
    rest = dataclasses.replace(
        study, measured=np.where(left[:, None], np.nan, study.measured)
    )
    found = predict_law(fit_law(rest, contender).fitted, contender, rest)
    without = found._replace(discrepancy=np.zeros(found.best.shape))
    rows = []
    for test, place in zip(*np.nonzero(study.exact & left[:, None]), strict=True):
        cell, measured = (test, place), study.measured[test, place]
        if not np.isfinite(found.best[cell]):
            continue
        sd = np.hypot(found.deviation[cell], found.discrepancy[cell])
        apart = (measured - found.best[cell]) / sd

        def holds(prediction, cell=cell, measured=measured):
            low, high = prediction.interval(*cell)
            return int(low <= measured <= high)

        rows.append(
            dict(
                target=study.targets[place],
                test=study.tests.name(int(test)),
                measured=measured,
                predicted=found.best[cell],
                deviation=found.deviation[cell],
                discrepancy=found.discrepancy[cell],
                score=t.logpdf(apart, found.freedom[cell]) - np.log(sd),
                inside=holds(found),
                inside_without=holds(without),
            )
        )
    return rows


def _tell(rows: list[dict]) -> None:
    """Print a table of errors, scores and coverage, and of coverage by group."""
    tables = defaultdict(lambda: defaultdict(list))
    for row in rows:
        tables[row["campaign"]][row["law"]].append(row)
    print("| campaign | law | rms | score | inside | without discrepancy |")
    print("|---|---|---:|---:|---:|---:|")
    for campaign, laws in tables.items():
        for law, of_law in laws.items():
            errors, score = _errors(of_law), _mean(of_law, "score")
            print(
                f"| {campaign} | {law} | {', '.join(errors)} | {score:.2f} | "
                f"{_share(of_law, 'inside')} | {_share(of_law, 'inside_without')} |"
            )
    print("\n| left out | inside | without discrepancy |\n|---|---:|---:|")
    groups = defaultdict(list)
    for row in rows:
        groups[
            row["left_out"].split(" ")[0] + " " + row["left_out"].split(" ")[1]
            if not row["left_out"].startswith("campaign")
            else "campaign"
        ].append(row)
    groups["all"] = rows
    for name, of_group in groups.items():
        inside, without = (_share(of_group, n) for n in ("inside", "inside_without"))
        print(f"| {name} | {inside} | {without} |")


def _errors(rows: list[dict]) -> list[str]:
    words = []
    for target in dict.fromkeys(row["target"] for row in rows):
        of_one = [row for row in rows if row["target"] == target]
        measured, predicted = (
            np.array([float(row[n]) for row in of_one])
            for n in ("measured", "predicted")
        )
        size = 1.0 if target.startswith("e_") else measured
        error = np.sqrt(np.mean(((predicted - measured) / size) ** 2))
        words.append(f"{target} {error:.3f}")
    return words


def _mean(rows: list[dict], name: str) -> float:
    return float(np.mean([float(row[name]) for row in rows]))


def _share(rows: list[dict], name: str) -> str:
    return f"{100.0 * _mean(rows, name):.0f} % of {len(rows)}"


if __name__ == "__main__":
    main()

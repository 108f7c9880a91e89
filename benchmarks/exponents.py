"""How force, depth, duration and coefficients follow speed, size and angle: measured,
and by each ground law fitted to all tests.

    python -m benchmarks.exponents [--only golf ...] [--out docs/images]

Of every study of `calibration/` with three tests or more, and of the golf balls of
`e_n_against_speed`. Exponents p and q are those of the regression

    ln y = c + p ln v + q ln m + r angle

of the measurements, and of the predictions of the same tests, with the terms that vary
and the angle in radians. One figure is drawn for each campaign.
"""

import argparse
from pathlib import Path

import jax
import numpy as np

from .unseen import GOLF, STUDIES, laws_of, study_of

FEWEST = 3
TERMS = {"speed_mps": "v", "mass_kg": "m", "angle_deg": "angle"}


def main() -> None:
    jax.config.update("jax_enable_x64", True)
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", default=[GOLF, *STUDIES])
    parser.add_argument("--out", type=Path)
    arguments = parser.parse_args()
    from jaximpact.plotting.style import in_style

    for campaign in arguments.only:
        study = study_of(campaign)
        if np.sum(np.any(study.exact, axis=1)) < FEWEST:
            continue
        predicted = {"measured": study.measured}
        for contender in laws_of(study):
            if not contender.is_rebound:
                predicted[contender.name] = _fitted(study, contender)
        _tell(campaign, study, predicted)
        if arguments.out:
            path = arguments.out / f"ground-laws-{campaign}.png"
            in_style(_draw)(study, predicted, path)


def _fitted(study, contender) -> np.ndarray:
    from jaximpact.calibration.comparison.fitted_law import fit_law

    return fit_law(study, contender).points.predicted[0]


def _tell(campaign: str, study, predicted: dict[str, np.ndarray]) -> None:
    """Print a table of the exponents of each target."""
    columns = study.tests.columns(study.soil)
    for place, target in enumerate(study.targets):
        rows = study.exact[:, place]
        terms = [n for n in TERMS if len(np.unique(columns[n][rows])) > 1]
        print(f"\n{campaign}, {target}\n\n| | {' | '.join(map(TERMS.get, terms))} |")
        print(f"|---|{'---:|' * len(terms)}")
        for name, values in predicted.items():
            cells = _exponents(columns, terms, rows, values[:, place])
            print(f"| {name} | {' | '.join(cells)} |", flush=True)


def _exponents(columns, terms, rows, values) -> list[str]:
    used = rows & np.isfinite(values) & (values > 0.0)
    if np.sum(used) <= len(terms):
        return ["none"] * len(terms)
    along = [
        np.radians(columns[n]) if n == "angle_deg" else np.log(columns[n])
        for n in terms
    ]
    matrix = np.stack([np.ones(len(values)), *along], axis=1)[used]
    found, *_ = np.linalg.lstsq(matrix, np.log(values[used]), rcond=None)
    return [f"{exponent:.2f}" for exponent in found[1:]]


def _draw(study, predicted: dict[str, np.ndarray], path: Path) -> None:
    """Draw every target along every term of which a line has three tests or more."""
    from jaximpact.plotting.style import curve, log_scale, panels, save_figure
    from jaximpact.quantities import TARGET_COLUMNS

    columns = study.tests.columns(study.soil)
    drawn = [
        (place, axis, lines)
        for place in range(len(study.targets))
        for axis in TERMS
        if (lines := _lines(columns, axis, study.exact[:, place]))
    ]
    figure, all_axes = panels(1, len(drawn), height=4.2)
    for axes, (place, axis, lines) in zip(all_axes, drawn, strict=True):
        target = study.targets[place]
        for number, (name, values) in enumerate(predicted.items()):
            style = curve(number - 1) if number else dict(ls="", marker="o", color="k")
            for first, tests in enumerate(lines):
                label = None if first else name
                x, y = columns[axis][tests], values[tests, place]
                axes.plot(x, y, label=label, zorder=10 - number, **style)
        unit = TARGET_COLUMNS[target].unit
        axes.set(xlabel=axis, ylabel=f"{target} [{unit}]")
        if not target.startswith("e_") and axis != "angle_deg":
            log_scale(axes)
    handles, labels = all_axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=2)
    save_figure(figure, path)


def _lines(columns, axis: str, rows) -> list[np.ndarray]:
    """Find the tests that differ along an axis alone, in its order: those of three
    values or more."""
    others = np.stack([columns[name] for name in TERMS if name != axis], axis=1)
    lines = []
    for other in np.unique(others[rows], axis=0):
        same = np.flatnonzero(rows & np.all(others == other, axis=1))
        if len(np.unique(columns[axis][same])) >= FEWEST:
            lines.append(same[np.argsort(columns[axis][same])])
    return lines


if __name__ == "__main__":
    main()

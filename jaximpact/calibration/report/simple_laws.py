"""Predictions of simple laws beside those of the model, as sentences and tables."""

import numpy as np

from ...io.display import Rows
from ..comparison.fitted_law import LawPrediction
from ..prediction import PredictedTests, score


def simple_scores(
    prediction: PredictedTests, law: LawPrediction
) -> dict[str, tuple[float, float]]:
    """Compute the root mean square error and the mean CRPS of each target that a
    simple law predicts and of which anything was measured."""
    found = {}
    for place, name in enumerate(law.targets):
        target = prediction.targets.index(name)
        exact = prediction.censored[:, target] == 0
        exact &= np.isfinite(prediction.measured[:, target])
        tests = np.flatnonzero(exact & np.isfinite(law.best[:, place]))
        if not len(tests):
            continue
        measured = prediction.measured[tests, target]
        apart = law.best[tests, place] - measured
        scores = []
        for test, value in zip(tests, measured, strict=True):
            distribution = law.distribution(int(test), place)
            assert distribution is not None  # its best value is finite
            scores.append(distribution.crps(float(value)))
        found[name] = float(np.sqrt(np.mean(apart**2))), float(np.mean(scores))
    return found


def simple_remarks(prediction: PredictedTests) -> list[str]:
    """Say what the simple laws predict, and where one predicts better than the
    model."""
    compared = [f"Laws compared: {words}" for words in prediction.ground.compared[:1]]
    if not prediction.simple:
        return [
            "None: laws of rebound predict none of the fitted targets, or the fit is "
            "of an earlier version.",
            *compared,
        ]
    names = " and ".join(law.name for law in prediction.simple)
    targets = ", ".join(prediction.simple[0].targets)
    lines = [f"{names}, fitted to {targets} of the tests of the fit.", *compared]
    for variant in prediction.variants:
        of_model = score(prediction, variant)
        several = len(prediction.variants) > 1
        which = f"model {variant.fitted.variant.name}" if several else "model"
        for law in prediction.simple:
            for name, (_, crps) in simple_scores(prediction, law).items():
                own = of_model[name].crps if name in of_model else None
                if own is not None and crps < own:
                    lines.append(
                        f"{name}: {law.name} better than the {which}, CRPS {crps:.3g} "
                        f"against {own:.3g}."
                    )
    return lines


def simple_score_rows(prediction: PredictedTests) -> Rows:
    """Write rms and CRPS of the model and of every simple law, target by target."""
    laws = [(law, simple_scores(prediction, law)) for law in prediction.simple]
    names = list(dict.fromkeys(name for _, found in laws for name in found))
    if not names:
        return []
    several = len(prediction.variants) > 1
    rows: Rows = [("target", "law", "rms", "CRPS")]
    for name in names:
        for variant in prediction.variants:
            own = score(prediction, variant).get(name)
            label = variant.fitted.variant.name if several else "model"
            if own is not None and own.rms is not None and own.crps is not None:
                rows.append((name, label, f"{own.rms:.3g}", f"{own.crps:.3g}"))
        for law, found in laws:
            if name in found:
                rms, crps = found[name]
                rows.append((name, law.name, f"{rms:.3g}", f"{crps:.3g}"))
    return rows


def simple_rows(prediction: PredictedTests) -> Rows:
    """Write the predictions of the simple laws, test by test."""
    if not prediction.simple:
        return []
    rows: Rows = [("test", "law", *prediction.simple[0].targets)]
    for test in range(len(prediction.tests)):
        for law in prediction.simple:
            cells = []
            for place in range(len(law.targets)):
                low, high = law.interval(test, place)
                best = law.best[test, place]
                text = f"{best:.3g} ({low:.3g} to {high:.3g})"
                cells.append(text if np.isfinite(best) else "none")
            rows.append((prediction.tests.name(test), law.name, *cells))
    return rows

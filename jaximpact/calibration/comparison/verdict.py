"""Which law predicts best, which ones tie with it, and which to prefer, in words."""

from typing import NamedTuple

import numpy as np

from .comparison import Compared, GroupScores
from .stacking import ERRORS, FEWEST_UNITS, SMALL_DIFFERENCE, difference, is_tie


class Ranking(NamedTuple):
    """Ranking of laws by one way of leaving tests out."""

    best: int
    """Index of the law that predicts best."""
    apart: np.ndarray
    """Difference of each law to the best, shape (laws,); not positive."""
    error: np.ndarray
    """Standard error of the difference; NaN with too few groups."""
    ties: tuple[int, ...]
    """Indices of the laws that tie with the best, the best among them."""
    preferred: int
    """Index of the law with the fewest parameters among them; of several the best."""


def ranking(compared: Compared, scores: GroupScores) -> Ranking:
    """Rank the laws by their log predictive densities."""
    best = int(np.argmax(scores.totals))
    pairs = [difference(scores.scores, i, best) for i in range(len(compared.laws))]
    apart, error = (np.array(part) for part in zip(*pairs, strict=True))
    ties = tuple(i for i, pair in enumerate(pairs) if i == best or is_tie(*pair))
    counts = [law.count for law in compared.laws]
    preferred = min(ties, key=lambda i: (counts[i], -scores.totals[i]))
    return Ranking(best, apart, error, ties, preferred)


def verdict(compared: Compared) -> list[str]:
    """Say which law to use, first by single tests, then by groups."""
    found = ranking(compared, compared.by_test)
    lines = [_in_words(compared, found)]
    lines += [_by_group(compared, scores, found) for scores in compared.by_group]
    weights = [
        f"{law.name} {weight:.2f}"
        for law, weight in zip(compared.laws, compared.weights, strict=True)
        if weight >= 0.05
    ]
    lines.append(f"Stacking weights: {', '.join(weights)}.")
    return lines


def _in_words(compared: Compared, found: Ranking) -> str:
    names = [law.name for law in compared.laws]
    counts = [law.count for law in compared.laws]
    best, preferred = names[found.best], found.preferred
    if len(names) == 1:
        return f"{best} was compared with no other law."
    others = [names[i] for i in found.ties if i != found.best]
    if not others:
        return f"{best} predicts a test that it has not seen better than all others."
    few = " (the standard errors need more tests)" if _too_few(found) else ""
    text = f"A tie: {best} and {_listed(others)} predict equally well{few}."
    if preferred == found.best:
        return (
            f"{text} Prefer {best}: no law of the tie has fewer fitted parameters "
            f"({counts[preferred]})."
        )
    return (
        f"{text} Prefer {names[preferred]}, the simplest of them: "
        f"{counts[preferred]} fitted parameters against {counts[found.best]} of {best}."
    )


def _too_few(found: Ranking) -> bool:
    return not np.all(np.isfinite(found.error))


def _by_group(compared: Compared, scores: GroupScores, whole: Ranking) -> str:
    found = ranking(compared, scores)
    names = [law.name for law in compared.laws]
    text = f"By {scores.by} ({len(scores.groups)} groups left out one by one): "
    text += f"{names[found.best]} predicts best"
    if len(scores.groups) < FEWEST_UNITS:
        text += (
            f"; with fewer than {FEWEST_UNITS} groups the differences have no standard "
            "error"
        )
    elif len(found.ties) > 1:
        others = [names[i] for i in found.ties if i != found.best]
        text += f", in a tie with {_listed(others)}"
    else:
        text += ", better than all others"
    if whole.preferred not in found.ties:
        text += (
            f". {names[whole.preferred]}, preferred by single tests, predicts a new "
            f"{scores.by} worse"
        )
    return text + "."


def _listed(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


RULE = (
    f"Two laws tie where their scores differ by less than {ERRORS:g} standard errors, "
    f"or by less than {SMALL_DIFFERENCE:g}."
)

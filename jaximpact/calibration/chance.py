"""Whether intervals miss more often than chance."""

# Not scipy.stats, which takes 0.6 s to import.
from scipy.special import bdtr

SMALL = 0.02
"""Chance that is taken for none."""


def too_few(inside: int, count: int, confidence: float) -> bool:
    """Whether so few of the intervals would hold their measurement, of `confidence`
    each and independent, with a chance below `SMALL`."""
    return bool(bdtr(inside, count, confidence) < SMALL)

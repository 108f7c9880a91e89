"""What a peer answers."""

from typing import NamedTuple

import numpy as np

from . import model


class Answer(NamedTuple):
    """Impacts solved by a peer."""

    e_n: np.ndarray
    """NaN where it did not finish, or says so."""
    seconds: float
    """For all of them, without preparing the scenes and without compiling."""


def answer(p: np.ndarray, start: np.ndarray, e_n: np.ndarray, seconds: float) -> Answer:
    """The answer, with the e_n of -1 that a block has which never sinks."""
    e_n = np.where(model.is_separating(p, start), -1.0, e_n)
    return Answer(np.where(np.isfinite(e_n), e_n, np.nan), seconds)

"""NumPy's own answers to overflow, underflow and invalid operations."""

import numpy as np


def numpy_settings() -> np.errstate:
    """Make the settings that the package computes with, whatever the user's are.

    It is the decorator of what users call from Python, and of the commands. Under
    `numpy.seterr(all="raise")` a probability that underflows to 0, as it should, would
    end a calibration; libraries below compute such numbers too. Nothing is hidden that
    NumPy tells by itself.
    """
    return np.errstate(divide="warn", over="warn", under="ignore", invalid="warn")

"""Functions of arrays give the numbers of the C library."""

import math
import re
from pathlib import Path

import numpy as np
import pytest

from jaximpact.runout import libm

OF_ONE = ["exp", "log1p", "sin", "cos"]


@pytest.mark.parametrize("name", OF_ONE)
def test_numbers_are_those_of_the_c_library(name):
    x = np.linspace(-0.99, 6.0, 2000).reshape(2, 1000)
    values = getattr(libm, name)(x)
    assert values.shape == x.shape
    assert values.ravel().tolist() == [getattr(math, name)(one) for one in x.flat]


def test_arctan2_broadcasts():
    y, x = np.array([[1.0], [-0.0]]), np.array([2.0, -3.0, 0.0])
    expected = [[math.atan2(one, other) for other in x] for one in y[:, 0]]
    assert libm.arctan2(y, x).tolist() == expected


@pytest.mark.parametrize("name", OF_ONE)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_what_is_no_number_is_that_of_numpy(name):
    x = np.array([np.inf, -np.inf, np.nan, 1e3, 0.5])
    expected = getattr(np, name)(x)
    np.testing.assert_array_equal(
        np.isfinite(getattr(libm, name)(x)), np.isfinite(expected)
    )
    np.testing.assert_allclose(getattr(libm, name)(x), expected, rtol=1e-15)


def test_a_single_number_and_none():
    assert libm.sin(0.5) == math.sin(0.5)
    assert libm.exp(np.zeros((0, 3))).shape == (0, 3)


def test_motion_takes_them_nowhere_else():
    """What NumPy gives by another library on some processors: where blocks start and
    how they move."""
    of_numpy = r"\bnp\.((arc)?(sin|cos|tan)h?|arctan2|exp|expm1|log|log1p|power|cbrt)\("
    room = Path(libm.__file__).parent
    files = [*room.glob("*.py"), room / "study" / "block_file.py"]
    for part in ("flight", "contacts", "ground_motion"):
        files += (room / part).glob("*.py")
    assert len(files) > 20
    found = [
        file.name
        for file in files
        if file.name != "libm.py"
        and re.search(of_numpy, file.read_text(encoding="utf-8"))
    ]
    assert not found

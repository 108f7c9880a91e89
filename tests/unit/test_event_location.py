"""Where a step passes a switch or the end: the root of a course over it."""

import numpy as np

from jaximpact.integrator.accumulators import hermite_cubic
from jaximpact.integrator.event_location import root_of_cubic


def test_the_root_of_a_course_that_is_almost_straight_is_found():
    """To rounding, also where few Newton steps have found it before the last one."""
    draw = np.random.default_rng(0)
    start, end = np.exp(draw.uniform(-8.0, 1.0, (2, 10_000))) * [[1.0], [-1.0]]
    width = 0.3
    slopes = (end - start) / width * (1.0 + draw.uniform(-0.2, 0.2, (2, 10_000)))
    part = root_of_cubic(start, slopes[0], end, slopes[1], width)
    a, b, c = hermite_cubic(start, slopes[0], end, slopes[1], width)
    value = start + part * (a + part * (b + part * c))
    # Terms as large as the larger end cancel.
    rounding = 10.0 * np.finfo(float).eps * np.maximum(start, -end)
    np.testing.assert_array_less(np.abs(value), rounding)

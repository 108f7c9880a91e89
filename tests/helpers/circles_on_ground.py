"""Circles that touch a profile: brute force over all points and segments, without the
package."""

import numpy as np


def heights(x, y, radius, at):
    """Heights of the centres of circles at some x that touch each point and segment,
    `(2 points - 1, places)`: points at even places; -inf where they cannot touch it."""
    slope = np.diff(y) / np.diff(x)
    cos = 1.0 / np.hypot(1.0, slope)
    found = np.full((2 * len(x) - 1, len(at)), -np.inf)
    apart = radius**2 - (at - x[:, None]) ** 2
    found[::2] = np.where(apart >= 0.0, y[:, None] + np.sqrt(np.abs(apart)), -np.inf)
    foot = at + (radius * slope * cos)[:, None]
    over = (foot >= x[:-1, None]) & (foot <= x[1:, None])
    on_line = y[:-1, None] + slope[:, None] * (foot - x[:-1, None])
    found[1::2] = np.where(over, on_line + radius * cos[:, None], -np.inf)
    return found

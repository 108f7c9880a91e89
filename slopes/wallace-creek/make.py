"""Makes profile.csv from the grid of heights that SOURCE.md names.

    python slopes/wallace-creek/make.py carrizo.tif

Of all straight lines of 40 m between points of the grid, in steps of 5 degrees, the one
with the largest drop is lengthened to the edges of the grid, and heights are read along
it at the grid's spacing, bilinearly.
"""

import sys
from pathlib import Path

import numpy as np
from PIL import Image
from scipy.ndimage import map_coordinates

SPACING = 2.0
"""Distance of the grid's points [m]."""
STEEP = 40.0
"""Length over which the line is the steepest [m]."""


def steepest(heights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Find the line with the largest drop.

    Args:
        heights: of the grid [m], `(rows, columns)`.

    Returns:
        Its upper end, and its direction, as rows and columns.
    """
    found = []
    places = np.indices(heights.shape)
    for angle in np.radians(np.arange(0.0, 360.0, 5.0)):
        direction = np.array([np.sin(angle), np.cos(angle)])
        ends = places + (STEEP / SPACING * direction)[:, None, None]
        lower = map_coordinates(heights, ends, order=1, cval=np.inf)
        place = np.unravel_index(np.argmax(heights - lower), heights.shape)
        found.append(((heights - lower)[place], place, direction))
    drop, start, direction = max(found, key=lambda line: line[0])
    print(f"drop of {drop:.2f} m from row and column {start}, direction {direction}")
    return np.array(start), direction


def section(heights: np.ndarray, start, direction) -> tuple[np.ndarray, np.ndarray]:
    """Read the heights along a line through the whole grid, x from its upper edge."""
    steps = np.arange(-sum(heights.shape), sum(heights.shape))
    places = start[:, None] + steps * direction[:, None]
    last = np.array(heights.shape)[:, None] - 1
    inside = np.all((places >= 0) & (places <= last), axis=0)
    y = map_coordinates(heights, places[:, inside], order=1)
    return SPACING * np.arange(len(y)), y


if __name__ == "__main__":
    heights = np.asarray(Image.open(sys.argv[1]), float)
    x, y = section(heights, *steepest(heights))
    rows = [f"{a:g},{b:.3f}" for a, b in zip(x, y, strict=True)]
    text = "\n".join(["x_m,y_m", *rows]) + "\n"
    (Path(__file__).parent / "profile.csv").write_text(text, encoding="utf-8")

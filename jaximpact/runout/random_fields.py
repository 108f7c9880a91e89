r"""Ground that varies along the slope: a random field for each block.

The field is a Gaussian process along x, taken to a distribution by its distribution
functions (a translation field):

$$ f(x) = F^{-1}(\Phi(z(x))), \qquad
   \operatorname{corr}(z(x), z(x + d)) = e^{-|d|/\ell} . $$

So every value follows the distribution, between its bounds. With $\ell$ the correlation
falls to 1/e; it is half the scale of fluctuation of a ground with this, the simple
exponential correlation. z is a Markov process: from place to place

$$ z_{k+1} = \rho z_k + \sqrt{1 - \rho^2}\,\varepsilon_k, \qquad \rho = e^{-h/\ell}, $$

which needs no matrix and is exact for any number of places.

**Cells.** The profile is cut to cells of $h = \ell/4$, counted from its left end, and
the ground of a cell is that of its middle. Between two places anywhere at a distance d
the correlation then is $e^{-|d|/\ell}$ interpolated between multiples of h: above it by
no more than $h^2/(8 \ell^2)$ = 0.008. More cells are not better: run-outs do not differ
by them, but blocks that travel during an impact are held up at each cut, and blocks
that roll take an event for each.

Source: Vanmarcke (1983), Random fields: analysis and synthesis; Grigoriu (1984),
Crossings of non-Gaussian translation processes.
"""

from typing import NamedTuple

import numpy as np
from scipy.special import ndtr, ndtri

from .random_inputs import Distribution, key_of, uniforms_at

CELLS_PER_LENGTH = 4
"""Number of cells to a correlation length."""


class RandomField(NamedTuple):
    """Distribution of a quantity that varies along the slope."""

    distribution: Distribution
    """Distribution at each place."""
    correlation_length: float
    """Distance along x at which the correlation is 1/e [m], above 0."""

    @property
    def cell(self) -> float:
        """Width of the cells along x [m]."""
        return self.correlation_length / CELLS_PER_LENGTH

    def cells(self, x: np.ndarray, start: float) -> np.ndarray:
        """Give the numbers of the cells in which places lie, from 0 at `start`."""
        return np.floor((np.asarray(x) - start) / self.cell).astype(int)

    def boundaries(self, start: float, stop: float) -> np.ndarray:
        """List the boundaries of the cells between two places [m]."""
        # One more than needed: the last may fall short of `stop` by rounding.
        places = start + self.cell * np.arange(1, int((stop - start) / self.cell) + 2)
        return places[places < stop]

    def values(self, key: str, cells: np.ndarray, count: int, seed: int) -> np.ndarray:
        """Sample the field of each block in some cells.

        Args:
            key: names the stream of random numbers.
            cells: numbers of the cells, `(places,)`.
            count: number of blocks.
            seed: of all streams, a whole number from 0.

        Returns:
            Values `(count, places)`, in the unit of the distribution. Block i gets the
            same ones whatever the count, and a cell whatever other cells there are.
        """
        blocks = np.arange(count, dtype=np.uint64)
        words = blocks & np.uint64(0xFFFFFFFF), blocks >> np.uint64(32)
        stream = key_of(seed, f"{key} along the slope")
        rho = np.exp(-1.0 / CELLS_PER_LENGTH)
        wanted, place = np.unique(cells, return_inverse=True)
        found, z = np.empty((count, len(wanted))), np.zeros(count)
        column = 0
        for cell in range(int(wanted[-1]) + 1):
            step = ndtri(uniforms_at([np.uint64(cell), np.uint64(0), *words], stream))
            z = step if cell == 0 else rho * z + np.sqrt(1.0 - rho**2) * step
            if cell == wanted[column]:
                # Away from 0 and 1, as the inverse distribution functions need it.
                uniforms = np.clip(ndtr(z), 2.0**-54, 1.0 - 2.0**-53)
                found[:, column] = self.distribution.values(uniforms)
                column += 1
        return found[:, place]

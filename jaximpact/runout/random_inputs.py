r"""Inputs of many blocks: one number for all, lists, or samples of a distribution
or of a field along the slope.

Every quantity has a stream of random numbers of its own, by the seed and its name;
block i takes the i-th number of the stream. So a block's values depend neither on how
many blocks there are, nor on how they are batched, nor on the other quantities.

The streams are those of the counter-based generator Philox, uniform numbers u in (0,
1). Each distribution turns them into samples, one for one, by its inverse distribution
function:

$$ x = F^{-1}(u) $$

A distribution with `least` and `most` is truncated there: it has the shape that it
would have without them, and no value beyond.

Source: Salmon et al. (2011), Parallel random numbers: as easy as 1, 2, 3.
"""

import math
import zlib
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ndtr, ndtri

from .._checks import real_number, whole_number
from .._settings import numpy_settings
from ..errors import InputError
from ..io.checks import check_memory
from . import libm


class Normal(NamedTuple):
    """Normal distribution, truncated at both ends."""

    mean: float
    sd: float
    """Standard deviation, above 0, before the truncation."""
    least: float = -np.inf
    most: float = np.inf

    def values(self, uniforms: np.ndarray) -> np.ndarray:
        """Transform uniform numbers in (0, 1) to this distribution."""
        low, high, sign = self._ends()
        inside = low + (high - low) * (uniforms if sign > 0.0 else 1.0 - uniforms)
        standard = sign * ndtri(inside)
        return np.clip(self.mean + self.sd * standard, self.least, self.most)

    @property
    def probability_inside(self) -> float:
        """Probability between the ends; 0 where it is too small for a number."""
        low, high, _ = self._ends()
        return high - low

    def _ends(self) -> tuple[float, float, float]:
        """Give the probabilities below both ends, and 1; or, where both lie above the
        mean, those above them, which keep their digits, and -1."""
        ends = (np.array([self.least, self.most]) - self.mean) / self.sd
        sign = 1.0 if self.least <= self.mean else -1.0
        low, high = np.sort(ndtr(sign * ends))
        return float(low), float(high), sign


class Uniform(NamedTuple):
    """Uniform distribution between two ends."""

    start: float
    stop: float

    def values(self, uniforms: np.ndarray) -> np.ndarray:
        """Transform uniform numbers in (0, 1) to this distribution."""
        return self.start + (self.stop - self.start) * uniforms


class Lognormal(NamedTuple):
    r"""Lognormal distribution, truncated at both ends.

    $\ln x \sim N(\ln m, \ln s)$ with the median m and the geometric standard deviation
    s: two thirds of the values lie between $m/s$ and $m s$.
    """

    median: float
    """Median, above 0, before the truncation."""
    geometric_sd: float
    """Geometric standard deviation [-], above 1, before the truncation."""
    least: float = 0.0
    most: float = np.inf

    def values(self, uniforms: np.ndarray) -> np.ndarray:
        """Transform uniform numbers in (0, 1) to this distribution."""
        # A sample beyond the numbers is inf, which the range of the quantity refuses.
        with np.errstate(over="ignore"):
            values = libm.exp(self._logarithm.values(uniforms))
        return np.clip(values, self.least, self.most)

    @property
    def probability_inside(self) -> float:
        """Probability between the ends; 0 where it is too small for a number."""
        return self._logarithm.probability_inside

    @property
    def _logarithm(self) -> Normal:
        ends = (math.log(x) if x > 0.0 else -np.inf for x in (self.least, self.most))
        return Normal(math.log(self.median), math.log(self.geometric_sd), *ends)


class PowerLaw(NamedTuple):
    r"""Power law between two ends, as of the volumes of rockfalls.

    The number of blocks larger than x goes with $x^{-b}$:

    $$ P(X > x) = \frac{x^{-b} - M^{-b}}{L^{-b} - M^{-b}}, \qquad L \le x \le M . $$

    The density goes with $x^{-(b + 1)}$.

    Source: Dussauge, Grasso and Helmstetter (2003), Statistical analysis of rockfall
    volume distributions, doi 10.1029/2001JB000650: b of about 0.5 for cliffs.
    """

    exponent: float
    """Exponent b of the cumulative numbers [-], above 0."""
    least: float
    """Least value L, above 0."""
    most: float
    """Largest value M, above L."""

    def values(self, uniforms: np.ndarray) -> np.ndarray:
        """Transform uniform numbers in (0, 1) to this distribution."""
        # By logarithms: powers of the ends may be beyond the numbers.
        span = math.log(self.most) - math.log(self.least)
        missing = math.expm1(-self.exponent * span)
        steps = -libm.log1p(uniforms * missing) / self.exponent
        return np.clip(self.least * libm.exp(steps), self.least, self.most)


Distribution = Normal | Uniform | Lognormal | PowerLaw
"""Any of the distributions."""
BOUNDS = ("least", "most")
"""Ends at which a distribution may be truncated."""


def fault_of(distribution: Distribution) -> tuple[str, str] | None:
    """Find what is wrong with the parameters of a distribution: the name of one, or ""
    for several together, and what it must be, in words; None where all is well."""
    values = distribution._asdict()
    above = {"sd": 0.0, "median": 0.0, "geometric_sd": 1.0, "exponent": 0.0}
    if isinstance(distribution, PowerLaw):
        above["least"] = 0.0
    for name, limit in above.items():
        if name in values and not values[name] > limit:
            return name, f"must be above {limit:g}, but is {values[name]:g}"
    if isinstance(distribution, Uniform):
        start, stop = distribution
        words = f"must go up, but goes from {start:.10g} to {stop:.10g}"
        return None if start < stop else ("", words)
    least, most = values["least"], values["most"]
    if not least < most:
        both = f"{least:.10g} and {most:.10g}"
        return "", f"needs least below most, but they are {both}"
    if isinstance(distribution, PowerLaw) or distribution.probability_inside > 0.0:
        return None
    centre, spread = (f"{name} {value:.10g}" for name, value in [*values.items()][:2])
    return "", (
        f"holds nothing between least and most, {least:.10g} and {most:.10g}, so far "
        f"from a {centre} with {spread}"
    )


MULTIPLIERS = np.uint64(0xD2511F53), np.uint64(0xCD9E8D57)
KEY_STEPS = 0x9E3779B9, 0xBB67AE85
LOW, HALF = np.uint64(0xFFFFFFFF), np.uint64(32)


def philox(words: Sequence[ArrayLike], key: tuple[int, int]) -> list[np.ndarray]:
    """Compute four random words of 32 bits, as uint64, at a counter of four words,
    arrays of whole numbers below 2^32 that broadcast; two such numbers, the key, name
    the stream."""
    a, b, c, d = (np.asarray(word).astype(np.uint64) for word in words)
    for turn in range(10):
        first, second = (
            np.uint64((part + turn * step) & 0xFFFFFFFF)
            for part, step in zip(key, KEY_STEPS, strict=True)
        )
        product, other = MULTIPLIERS[0] * a, MULTIPLIERS[1] * c
        a, c = (other >> HALF) ^ b ^ first, (product >> HALF) ^ d ^ second
        b, d = other & LOW, product & LOW
    return [a, b, c, d]


def uniforms_at(words: Sequence[ArrayLike], key: tuple[int, int]) -> np.ndarray:
    """Give the uniform number in (0, 1) at each counter; see `philox`."""
    high, low, *_ = philox(words, key)
    return (((high << HALF) | low) >> np.uint64(11)).astype(float) * 2.0**-53 + 2.0**-54


Quantity = float | tuple[float, ...] | Distribution
"""One number for all blocks, a list, or a distribution to sample."""


def combinations(quantities: Mapping[str, Quantity]) -> int:
    """Count the combinations that the lists make."""
    lists = [q for q in quantities.values() if type(q) is tuple]
    return int(np.prod([len(values) for values in lists], dtype=int))


def is_random(quantities: Mapping[str, Quantity]) -> bool:
    """Tell whether any quantity has a distribution."""
    return any(isinstance(q, Distribution) for q in quantities.values())


@numpy_settings()
def draw(
    quantities: Mapping[str, Quantity], count: int, seed: int
) -> dict[str, np.ndarray]:
    """Sample each quantity once per block.

    Lists make every combination, in their order, the last one fastest; block i takes
    combination i, and after the last the first again.

    Args:
        quantities: by name; a number, a tuple or a distribution.
        count: number of blocks.
        seed: of all streams, a whole number from 0.

    Returns:
        Arrays `(count,)`, in the units of the quantities.

    Raises InputError for a distribution with parameters out of range.
    """
    count = whole_number("count", count, 0)
    check_memory(count * len(quantities), f"{count} blocks")
    samples, repeats = {}, combinations(quantities)
    for name, quantity in quantities.items():
        if type(quantity) is tuple:
            if not quantity:
                raise InputError(f"{name} is an empty list of values")
            repeats //= len(quantity)
            places = np.arange(count) // repeats % len(quantity)
            samples[name] = np.asarray(quantity)[places]
        elif isinstance(quantity, Distribution):
            for field, value in quantity._asdict().items():
                is_open = isinstance(value, float) and math.isinf(value)
                if not (field in BOUNDS and is_open):
                    number = real_number(f"{name}.{field}", value)
                    quantity = quantity._replace(**{field: number})
            if fault := fault_of(quantity):
                field, words = fault
                raise InputError(
                    f"{name}.{field} {words}" if field else f"{name} {words}"
                )
            samples[name] = quantity.values(uniforms(seed, name, count))
        else:
            samples[name] = np.full(count, real_number(name, quantity))
    return samples


def uniforms(seed: int, name: str, count: int) -> np.ndarray:
    """Give the first numbers, in (0, 1), of the stream of a quantity."""
    # Its raw numbers, which NumPy promises to keep from version to version.
    raw = np.random.Philox(_sequence(seed, name)).random_raw(count)
    return ((raw >> np.uint64(11)).astype(float) + 0.5) * 2.0**-53


def key_of(seed: int, name: str) -> tuple[int, int]:
    """Give the key of a stream for `uniforms_at`."""
    first, second = _sequence(seed, name).generate_state(2, np.uint32)
    return int(first), int(second)


def _sequence(seed: int, name: str) -> np.random.SeedSequence:
    seed = whole_number("seed", seed, 0)
    return np.random.SeedSequence((seed, zlib.crc32(name.encode())))


CELLS_PER_LENGTH = 4
"""Number of cells to a correlation length."""


class RandomField(NamedTuple):
    r"""Distribution of a quantity that varies along the slope: a field for each block.

    The field is a Gaussian process along x, taken to a distribution by its distribution
    functions (a translation field):

    $$ f(x) = F^{-1}(\Phi(z(x))), \qquad
       \operatorname{corr}(z(x), z(x + d)) = e^{-|d|/\ell} . $$

    So every value follows the distribution, between its bounds. With $\ell$ the
    correlation falls to 1/e; it is half the scale of fluctuation of a ground with this,
    the simple exponential correlation. z is a Markov process: from place to place

    $$ z_{k+1} = \rho z_k + \sqrt{1 - \rho^2}\,\varepsilon_k, \qquad
       \rho = e^{-h/\ell}, $$

    which needs no matrix and is exact for any number of places.

    **Cells.** The profile is cut to cells of $h = \ell/4$, counted from its left end,
    and the ground of a cell is that of its middle. Between two places anywhere at a
    distance d the correlation then is $e^{-|d|/\ell}$ interpolated between multiples of
    h: above it by no more than $h^2/(8 \ell^2)$ = 0.008. More cells are not better:
    run-outs do not differ by them, but blocks that travel during an impact are held up
    at each cut, and blocks that roll take an event for each.

    Source: Vanmarcke (1983), Random fields: analysis and synthesis; Grigoriu (1984),
    Crossings of non-Gaussian translation processes.
    """

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
        rho = math.exp(-1.0 / CELLS_PER_LENGTH)
        wanted, place = np.unique(cells, return_inverse=True)
        fields, z = np.empty((count, len(wanted))), np.zeros(count)
        column = 0
        for cell in range(int(wanted[-1]) + 1):
            step = ndtri(uniforms_at([np.uint64(cell), np.uint64(0), *words], stream))
            z = step if cell == 0 else rho * z + np.sqrt(1.0 - rho**2) * step
            if cell == wanted[column]:
                # Away from 0 and 1, as the inverse distribution functions need it.
                uniforms = np.clip(ndtr(z), 2.0**-54, 1.0 - 2.0**-53)
                fields[:, column] = self.distribution.values(uniforms)
                column += 1
        return fields[:, place]

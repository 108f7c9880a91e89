r"""Quantities of many blocks: one number for all, lists, or draws at random.

Every quantity has a stream of random numbers of its own, by the seed and its name;
block i takes the i-th number of the stream. So what a block gets depends neither on how
many blocks there are, nor on how they are put together, nor on the other quantities.

The streams are those of the counter-based generator Philox, turned into a normal or
uniform variable by its inverse distribution, one number a draw.

Source: Salmon et al. (2011), Parallel random numbers: as easy as 1, 2, 3.
"""

import zlib
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import jax
import numpy as np

from ..fields import real_number, whole_number
from ..formats.checks import check_memory

Numbers = np.ndarray


class Normal(NamedTuple):
    """A normal distribution, cut off at both ends."""

    mean: float
    sd: float
    least: float = -np.inf
    most: float = np.inf

    def values(self, shares: Numbers) -> Numbers:
        """At shares of the distribution, in (0, 1)."""
        low, high, sign = self._ends()
        inside = low + (high - low) * (shares if sign > 0.0 else 1.0 - shares)
        standard = sign * np.asarray(jax.scipy.special.ndtri(inside))
        return np.clip(self.mean + self.sd * standard, self.least, self.most)

    @property
    def share_inside(self) -> float:
        """Of the distribution, between the ends; 0 where that is too little for a
        number."""
        low, high, _ = self._ends()
        return high - low

    def _ends(self) -> tuple[float, float, float]:
        """Shares of the distribution below both ends, and 1; or, where both lie above
        the mean, those above them, which keep their digits, and -1."""
        ends = (np.array([self.least, self.most]) - self.mean) / self.sd
        sign = 1.0 if self.least <= self.mean else -1.0
        low, high = np.sort(np.asarray(jax.scipy.special.ndtr(sign * ends)))
        return float(low), float(high), sign


class Uniform(NamedTuple):
    """A uniform distribution between two ends."""

    start: float
    stop: float

    def values(self, shares: Numbers) -> Numbers:
        """At shares of the distribution, in (0, 1)."""
        return self.start + (self.stop - self.start) * shares


Quantity = float | tuple[float, ...] | Normal | Uniform
"""One number for all blocks, a list, or a distribution."""


def combinations(quantities: Mapping[str, Quantity]) -> int:
    """How many combinations the lists make."""
    lists = [q for q in quantities.values() if _is_list(q)]
    return int(np.prod([len(values) for values in lists], dtype=int))


def is_random(quantities: Mapping[str, Quantity]) -> bool:
    """Whether anything is drawn."""
    return any(isinstance(q, Normal | Uniform) for q in quantities.values())


def draw(
    quantities: Mapping[str, Quantity], count: int, seed: int
) -> dict[str, Numbers]:
    """The numbers of each quantity, `(count,)`.

    Lists make every combination, in their order, the last one fastest; block i takes
    combination i, and after the last the first again.
    """
    whole_number("count", count, 0)
    check_memory(count * len(quantities), f"{count} blocks")
    drawn, repeats = {}, combinations(quantities)
    for name, quantity in quantities.items():
        if _is_list(quantity):
            repeats //= len(quantity)
            places = np.arange(count) // repeats % len(quantity)
            drawn[name] = np.asarray(quantity)[places]
        elif isinstance(quantity, Normal | Uniform):
            drawn[name] = quantity.values(shares(seed, name, count))
        else:
            drawn[name] = np.full(count, real_number(name, quantity))
    return drawn


def shares(seed: int, name: str, count: int) -> Numbers:
    """The first numbers in (0, 1) of the stream of a quantity."""
    # Its raw numbers, which NumPy promises to keep from version to version.
    raw = np.random.Philox(_sequence(seed, name)).random_raw(count)
    return ((raw >> np.uint64(11)).astype(float) + 0.5) * 2.0**-53


def key_of(seed: int, name: str) -> tuple[int, int]:
    """The key of a stream of which numbers are asked by their place; see `philox`."""
    first, second = _sequence(seed, name).generate_state(2, np.uint32)
    return int(first), int(second)


def _sequence(seed: int, name: str) -> np.random.SeedSequence:
    whole_number("seed", seed, 0)
    entropy: Sequence[int] = (seed, zlib.crc32(name.encode()))
    return np.random.SeedSequence(entropy)


def _is_list(quantity: Quantity) -> bool:
    return type(quantity) is tuple

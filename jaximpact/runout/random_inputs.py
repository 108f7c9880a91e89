r"""Inputs of many blocks: one number for all, lists, or random samples.

Every quantity has a stream of random numbers of its own, by the seed and its name;
block i takes the i-th number of the stream. So a block's values depend neither on how
many blocks there are, nor on how they are batched, nor on the other quantities.

The streams are those of the counter-based generator Philox, turned into a normal or
uniform variable by its inverse distribution function, one number per sample.

Source: Salmon et al. (2011), Parallel random numbers: as easy as 1, 2, 3.
"""

import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import jax
import numpy as np
from numpy.typing import ArrayLike

from .._checks import real_number, whole_number
from ..errors import InputError
from ..io.checks import check_memory
from ..io.toml import check_keys, number, quantity
from ..quantities import InputColumn

MULTIPLIERS = np.uint64(0xD2511F53), np.uint64(0xCD9E8D57)
KEY_STEPS = 0x9E3779B9, 0xBB67AE85
ROUNDS = 10
LOW, HALF = np.uint64(0xFFFFFFFF), np.uint64(32)


def philox(words: Sequence[ArrayLike], key: tuple[int, int]) -> list[np.ndarray]:
    """Compute four random words of 32 bits, as uint64, at a counter of four words.

    Args:
        words: counter, arrays of whole numbers below 2^32 that broadcast.
        key: two such numbers that name the stream.
    """
    a, b, c, d = (np.asarray(word).astype(np.uint64) for word in words)
    for turn in range(ROUNDS):
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
        standard = sign * np.asarray(jax.scipy.special.ndtri(inside))
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
        low, high = np.sort(np.asarray(jax.scipy.special.ndtr(sign * ends)))
        return float(low), float(high), sign


class Uniform(NamedTuple):
    """Uniform distribution between two ends."""

    start: float
    stop: float

    def values(self, uniforms: np.ndarray) -> np.ndarray:
        """Transform uniform numbers in (0, 1) to this distribution."""
        return self.start + (self.stop - self.start) * uniforms


Quantity = float | tuple[float, ...] | Normal | Uniform
"""One number for all blocks, a list, or a distribution to sample."""


def combinations(quantities: Mapping[str, Quantity]) -> int:
    """Count the combinations that the lists make."""
    lists = [q for q in quantities.values() if type(q) is tuple]
    return int(np.prod([len(values) for values in lists], dtype=int))


def is_random(quantities: Mapping[str, Quantity]) -> bool:
    """Tell whether any quantity has a distribution."""
    return any(isinstance(q, Normal | Uniform) for q in quantities.values())


def draw(
    quantities: Mapping[str, Quantity], count: int, seed: int
) -> dict[str, np.ndarray]:
    """Sample each quantity once per block.

    Lists make every combination, in their order, the last one fastest; block i takes
    combination i, and after the last the first again.

    Args:
        quantities: by name; a number, a tuple, `Normal` or `Uniform`.
        count: number of blocks.
        seed: of all streams, a whole number from 0.

    Returns:
        Arrays `(count,)`, in the units of the quantities.
    """
    whole_number("count", count, 0)
    check_memory(count * len(quantities), f"{count} blocks")
    samples, repeats = {}, combinations(quantities)
    for name, given in quantities.items():
        if type(given) is tuple:
            repeats //= len(given)
            places = np.arange(count) // repeats % len(given)
            samples[name] = np.asarray(given)[places]
        elif isinstance(given, Normal | Uniform):
            samples[name] = given.values(uniforms(seed, name, count))
        else:
            samples[name] = np.full(count, real_number(name, given))
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
    whole_number("seed", seed, 0)
    return np.random.SeedSequence((seed, zlib.crc32(name.encode())))


def read_quantity(path: Path, key: str, value, column: InputColumn | None) -> Quantity:
    """Read a number, a list or a distribution from a file's value.

    Args:
        column: gives the range that numbers must keep, if there is one.

    Raises InputError, naming file and key, for anything else.
    """

    def one(value, key=key) -> float:
        if column is None:
            return number(path, key, value)
        return quantity(path, key, column, value)

    if isinstance(value, list):
        if not value:
            raise InputError("is an empty list", file=path, key=key)
        return tuple(one(v) for v in value)
    if not isinstance(value, dict):
        return one(value)
    kinds = (("mean", "sd", "least", "most"), ("from", "to"))
    check_keys(path, key, value, kinds[0] + kinds[1])
    if set(value) == set(kinds[1]):
        ends = [one(value[n], f"{key}.{n}") for n in kinds[1]]
        if not ends[0] < ends[1]:
            raise InputError(
                f"must go up, but goes from {ends[0]:g} to {ends[1]:g}",
                file=path,
                key=key,
            )
        return Uniform(*ends)
    if not {"mean", "sd"} <= set(value) <= set(kinds[0]):
        raise InputError(
            "must be a number, a list, { from, to } or { mean, sd }, the latter with "
            f"least and most if wanted, but is {value!r}",
            file=path,
            key=key,
        )
    given = {n: number(path, f"{key}.{n}", v) for n, v in value.items()}
    normal = Normal(**given)
    if normal.sd <= 0.0:
        raise InputError(
            f"must be above 0, but is {normal.sd:g}", file=path, key=f"{key}.sd"
        )
    if not normal.least < normal.most:
        raise InputError(
            f"needs least below most, but they are {normal.least:g} and "
            f"{normal.most:g}",
            file=path,
            key=key,
        )
    if not normal.probability_inside > 0.0:
        raise InputError(
            f"holds nothing between least and most, {normal.least:g} and "
            f"{normal.most:g}, so far from a mean of {normal.mean:g} with sd "
            f"{normal.sd:g}",
            file=path,
            key=key,
        )
    return normal

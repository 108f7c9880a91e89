r"""Inputs of many blocks: one number for all, lists, or random samples.

Every quantity has a stream of random numbers of its own, by the seed and its name;
block i takes the i-th number of the stream. So a block's values depend neither on how
many blocks there are, nor on how they are batched, nor on the other quantities.

The streams are those of the counter-based generator Philox, turned into a variable of
each distribution by its inverse distribution function, one number per sample.

Source: Salmon et al. (2011), Parallel random numbers: as easy as 1, 2, 3.
"""

import zlib
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from .._checks import real_number, whole_number
from ..io.checks import check_memory
from .distributions import Distribution

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


Quantity = float | tuple[float, ...] | Distribution
"""One number for all blocks, a list, or a distribution to sample."""


def combinations(quantities: Mapping[str, Quantity]) -> int:
    """Count the combinations that the lists make."""
    lists = [q for q in quantities.values() if type(q) is tuple]
    return int(np.prod([len(values) for values in lists], dtype=int))


def is_random(quantities: Mapping[str, Quantity]) -> bool:
    """Tell whether any quantity has a distribution."""
    return any(isinstance(q, Distribution) for q in quantities.values())


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
    """
    whole_number("count", count, 0)
    check_memory(count * len(quantities), f"{count} blocks")
    samples, repeats = {}, combinations(quantities)
    for name, given in quantities.items():
        if type(given) is tuple:
            repeats //= len(given)
            places = np.arange(count) // repeats % len(given)
            samples[name] = np.asarray(given)[places]
        elif isinstance(given, Distribution):
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

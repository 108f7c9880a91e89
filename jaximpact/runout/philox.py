"""Random numbers by their place alone: any number of a stream, without those before it.

Philox-4x32-10 for arrays of places. Source: Salmon et al. (2011), Parallel random
numbers: as easy as 1, 2, 3.
"""

import numpy as np

MULTIPLIERS = np.uint64(0xD2511F53), np.uint64(0xCD9E8D57)
KEY_STEPS = 0x9E3779B9, 0xBB67AE85
ROUNDS = 10
LOW, HALF = np.uint64(0xFFFFFFFF), np.uint64(32)


def philox(words: list[np.ndarray], key: tuple[int, int]) -> list[np.ndarray]:
    """Four random words of 32 bits, as uint64, for four words that say which.

    Args:
        words: arrays of whole numbers below 2^32 that broadcast.
        key: of the stream, two such numbers.
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


def shares_at(words: list[np.ndarray], key: tuple[int, int]) -> np.ndarray:
    """A number in (0, 1) for each place."""
    high, low, *_ = philox(words, key)
    return (((high << HALF) | low) >> np.uint64(11)).astype(float) * 2.0**-53 + 2.0**-54

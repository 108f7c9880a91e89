"""Sentences in lines."""

import textwrap
from collections.abc import Iterable

WIDTH = 88


def wrapped(text: str, first: int = 0, further: int = 0) -> list[str]:
    """A text in lines, the first and the further ones indented by so much."""
    return textwrap.wrap(
        text,
        WIDTH,
        initial_indent=" " * first,
        subsequent_indent=" " * further,
        break_on_hyphens=False,
    )


def listed(texts: Iterable[str]) -> list[str]:
    """Texts in lines, one after the other; further lines of each are indented more."""
    return [line for text in texts for line in wrapped(text, 2, 4)]

"""Results as trees of what JSON can hold."""

import dataclasses
import enum
import json
import math
import os
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

NUMBERS = re.compile(r"\[\n\s*([^\[\]{}\"]+?)\n\s*\]")


def plain(value: object) -> Any:
    """Convert a result to what JSON can hold: dataclasses and named tuples by their
    fields, arrays, enumerations and paths; None for a number that is not finite."""
    if isinstance(value, enum.Enum | os.PathLike):
        return str(value)
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = dataclasses.fields(value)
        return {field.name: plain(getattr(value, field.name)) for field in fields}
    if isinstance(value, tuple) and hasattr(value, "_asdict"):
        value = value._asdict()  # pyright: ignore[reportAttributeAccessIssue]
    if isinstance(value, Mapping):
        return {str(key): plain(inner) for key, inner in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [plain(inner) for inner in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def json_text(tree: object) -> str:
    """Write a tree, each list of numbers, thousands of them, in one line."""
    text = json.dumps(plain(tree), indent=1, allow_nan=False)
    # A line end within brackets stands in no string, where it would be escaped.
    return NUMBERS.sub(lambda match: f"[{' '.join(match[1].split())}]", text) + "\n"

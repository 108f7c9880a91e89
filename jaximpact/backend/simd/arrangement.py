"""Operations of a jaxpr that put values in other places, and compute none."""

import numpy as np

from .arrays import Values
from .graph import Node, NoMachineCode


def _broadcast(params, x: Values) -> Values:
    shape = [1] * len(params["shape"])
    for size, axis in zip(x.shape, params["broadcast_dimensions"], strict=True):
        shape[axis] = size
    return np.broadcast_to(x.reshape(shape), params["shape"])


def _slice(params, x: Values) -> Values:
    strides = params["strides"] or (1,) * x.ndim
    bounds = zip(params["start_indices"], params["limit_indices"], strides, strict=True)
    return x[tuple(slice(*b) for b in bounds)]


def _dynamic_slice(params, x: Values, *starts: Values) -> Values:
    places = [start.item() for start in starts]
    if any(isinstance(place, Node) for place in places):
        raise NoMachineCode("no native dynamic_slice at an unknown place")
    sizes = params["slice_sizes"]
    return x[
        tuple(
            slice(min(max(place, 0), n - size), min(max(place, 0), n - size) + size)
            for place, size, n in zip(places, sizes, x.shape, strict=True)
        )
    ]


def _pad(params, x: Values, value: Values) -> Values:
    edges = params["padding_config"]
    if any(between for _, _, between in edges):
        raise NoMachineCode("no native pad between entries")
    widths = [(max(low, 0), max(high, 0)) for low, high, _ in edges]
    padded = np.full(
        [n + sum(width) for n, width in zip(x.shape, widths, strict=True)],
        value.item(),
        object,
    )
    padded[
        tuple(slice(low, low + n) for n, (low, _) in zip(x.shape, widths, strict=True))
    ] = x
    return padded[
        tuple(
            slice(max(-low, 0), n - max(-high, 0))
            for n, (low, high, _) in zip(padded.shape, edges, strict=True)
        )
    ]


STRUCTURE = {
    "stop_gradient": lambda params, x: x,
    "copy": lambda params, x: x,
    "broadcast_in_dim": _broadcast,
    "reshape": lambda params, x: x.reshape(params["new_sizes"]),
    "squeeze": lambda params, x: np.squeeze(x, tuple(params["dimensions"])),
    "transpose": lambda params, x: np.transpose(x, params["permutation"]),
    "slice": _slice,
    "pad": _pad,
    "dynamic_slice": _dynamic_slice,
    "concatenate": lambda params, *x: np.concatenate(x, params["dimension"]),
    "stack": lambda params, *x: np.stack(x, params["axis"]),
    "rev": lambda params, x: np.flip(x, params["dimensions"]),
    "tile": lambda params, x: np.tile(x, params["reps"]),
    "unstack": lambda params, x: list(np.moveaxis(x, params["axis"], 0)),
    "split": lambda params, x: np.split(
        x, np.cumsum(params["sizes"])[:-1], params["axis"]
    ),
}
"""Operations that put values in other places; those that take an array apart give a
list."""

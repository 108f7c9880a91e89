"""Gradients in reverse mode: cotangents of results, propagated back through the steps.

A forward sweep takes a lane to its end, and records on a tape what each step begins
with. A reverse sweep takes the steps from the last to the first: a gradient with
respect to all inputs costs some four times what the value does, however many inputs
there are. A derivative along a direction costs three quarters of the value.

The functions of the reverse sweep are those of `jax.vjp`, traced for one lane as those
of the forward sweep are.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp


class Reverse(NamedTuple):
    """What a gradient is with respect to."""

    inputs: Sequence[int]
    """Leaves of the inputs that vary."""
    state: Sequence[int]
    """Leaves of the state that vary with them."""
    advance: Callable
    """Function from a state to that after one step that is accepted."""
    accepted: Callable
    """Function from a state to the number of steps that were accepted, which must be an
    array of the state."""


class ReverseSweep(NamedTuple):
    """Functions that propagate cotangents back."""

    from_end: Callable
    """Function from inputs, cotangents of the results, and the state at the end to
    cotangents of the inputs and of the state."""
    over_step: Callable
    """Function from the state that a step begins with, and cotangents of the one after
    it, to its cotangents."""
    to_start: Callable
    """Function from inputs, their cotangents up to here, and cotangents of the state at
    the start, to all cotangents of the inputs."""


def reverse_sweep(begin: Callable, finish: Callable, reverse: Reverse) -> ReverseSweep:
    """Make the functions of the reverse sweep, for lanes that begin and finish so."""
    of_inputs, of_state = reverse.inputs, reverse.state

    def from_end(inputs, cotangents, state):
        def results(varied_inputs, varied_state):
            there = _with(state, of_state, varied_state)
            return finish(_with(inputs, of_inputs, varied_inputs), there)

        varied = _chosen(inputs, of_inputs), _chosen(state, of_state)
        numbers, pull_back = jax.vjp(results, *varied)
        # What is no number depends on nothing.
        known = jax.tree.map(
            lambda number, weight: jnp.where(jnp.isnan(number), 0.0, weight),
            numbers,
            cotangents,
        )
        return pull_back(known)

    def over_step(state, cotangents):
        def after(varied):
            return _chosen(reverse.advance(_with(state, of_state, varied)), of_state)

        _, pull_back = jax.vjp(after, _chosen(state, of_state))
        return pull_back(cotangents)[0]

    def to_start(inputs, cotangents, of_start):
        def start(varied):
            return _chosen(begin(_with(inputs, of_inputs, varied)), of_state)

        _, pull_back = jax.vjp(start, _chosen(inputs, of_inputs))
        (further,) = pull_back(of_start)
        return jax.tree.map(jnp.add, cotangents, further)

    return ReverseSweep(from_end, over_step, to_start)


def _chosen(tree, places: Sequence[int]) -> list[Any]:
    leaves = jax.tree.leaves(tree)
    return [leaves[place] for place in places]


def _with(tree, places: Sequence[int], values: Sequence):
    """Put values in the places of some leaves of a tree."""
    leaves, structure = jax.tree.flatten(tree)
    for place, value in zip(places, values, strict=True):
        leaves[place] = value
    return jax.tree.unflatten(structure, leaves)

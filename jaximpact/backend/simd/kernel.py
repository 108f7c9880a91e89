"""Kernels: machine code that takes lanes from their inputs to their results.

What a lane does is given by functions in JAX, which are traced for one lane and
compiled for vectors of eight. Eight columns of memory hold lanes under way; one that
has come to its end gives its place to the next. Lanes know nothing of each other: a
lane's results do not depend, to the last bit, on what runs beside it.
"""

import math
from collections.abc import Callable, Sequence
from itertools import count
from typing import NamedTuple

import jax
import numpy as np

from .driver import Program
from .graph import INPUT, NUMPY, Graph, Node
from .llvm_ir import Function, Output, write_function
from .lower_jaxpr import Translator
from .object_files import compile_functions, lanes_for, load


class Code(NamedTuple):
    """Compiled lane functions."""

    object_files: list[bytes]
    input_rows: int
    common_inputs: int
    """First rows of inputs, which copies of a lane have in common."""
    result_rows: int
    rows: int
    """Rows of inputs, state, results and samples together."""
    spare_rows: int
    """Rows behind them, for what functions keep while they run."""
    time_row: int = -1
    """Row of the state that holds the time reached; -1 where nothing is sampled."""
    sampled_rows: int = 0


class Retries(NamedTuple):
    """Retries of a lane that has failed: with tolerances times each of the factors,
    unless it has used up its steps."""

    tolerance_row: int
    """Row of the tolerance among the inputs."""
    outcome_row: int
    """Row of the outcome among the results."""
    steps_row: int
    failed: float
    most_steps: float
    factors: tuple[float, ...]


class Kernel:
    """Compiled code that is ready to run; its results are a tree with a row for each
    leaf."""

    def __init__(self, code: Code, structure, retries: Retries | None = None):
        self.code, self.structure = code, structure
        self.engine = load(code.object_files)
        address = self.engine.get_function_address
        asked = code.rows - code.sampled_rows - 1  # after the results
        self.program = Program(
            begin=address("begin"),
            step=address("step"),
            finish=address("finish"),
            sample=address("sample") if code.sampled_rows else None,
            rows=code.rows + code.spare_rows,
            input_rows=code.input_rows,
            results_row=(asked if code.sampled_rows else code.rows) - code.result_rows,
            result_rows=code.result_rows,
            tolerance=-1,
            time=code.time_row,
            asked=asked,
            sampled_row=asked + 1,
            sampled_rows=code.sampled_rows,
        )
        if retries is not None:
            self.program.tolerance = retries.tolerance_row
            self.program.outcome = retries.outcome_row
            self.program.steps = retries.steps_row
            self.program.failed = retries.failed
            self.program.most_steps = retries.most_steps
            self.program.retries[:] = retries.factors

    @property
    def layout(self) -> bytes:
        """Description of the code for the driver, without addresses, as bytes."""
        layout = Program.from_buffer_copy(self.program)
        layout.begin = layout.step = layout.finish = layout.sample = None
        return bytes(layout)


class LaneFunctions(NamedTuple):
    """Functions in JAX that say what a lane does.

    Each takes and gives what copies of a lane have in common, and what each has of its
    own; without copies the latter are empty trees. Copies are worked out side by side,
    and what is common once: a lane with several derivatives has one copy for each.
    """

    begin: Callable
    """Function from inputs, and own inputs, to a state and an own state."""
    step: Callable
    """Function from both states to the next ones, and whether the lane goes on."""
    finish: Callable
    """Function from inputs, own inputs and both states to results and own results."""
    sample: Callable | None = None
    """Function from both states and a time that the last step has passed to samples
    there, common and own."""
    time: Callable | None = None
    """Function from a state to the time reached, which must be an array of the
    state."""


def without_copies(
    begin: Callable,
    step: Callable,
    finish: Callable,
    sample: Callable | None = None,
    time: Callable | None = None,
) -> LaneFunctions:
    """Make lane functions of those of lanes that have nothing of their own."""

    def step_both(state, _):
        state, going = step(state)
        return state, (), going

    return LaneFunctions(
        lambda inputs, _: (begin(inputs), ()),
        step_both,
        lambda inputs, _, state, __: (finish(inputs, state), ()),
        sample and (lambda state, _, time: (sample(state, time), ())),
        time,
    )


def compile_kernel(begin: Callable, step: Callable, finish: Callable, inputs) -> Kernel:
    """Compile functions of lanes, as for `without_copies`, ready to run; inputs are as
    for `compile_code`."""
    functions = without_copies(begin, step, finish)
    code, (results, _) = _compiled(functions, inputs)
    return Kernel(code, jax.tree.structure(results))


def compile_code(
    functions: LaneFunctions, inputs, own_inputs=(), copies: int = 1
) -> Code:
    """Compile functions of lanes.

    Args:
        inputs: a tree of arrays, or of what stands for them, with one lane: every
            array of the functions has one axis of length 1, the lane's.
        own_inputs: the same, of one copy.
        copies: how many there are.

    Rows are inputs, own inputs of each copy, state, own states, results, own results;
    with samples the time asked for, samples and own samples.

    Raises NoMachineCode if a function does what has no native code.
    """
    return _compiled(functions, inputs, own_inputs, copies)[0]


def _compiled(
    functions: LaneFunctions, inputs, own_inputs=(), copies: int = 1
) -> tuple[Code, tuple]:
    """Give the code, and shapes of results and own results."""
    arguments = inputs, own_inputs
    begin, states = jax.make_jaxpr(functions.begin, return_shape=True)(*arguments)
    step = jax.make_jaxpr(functions.step)(*states)
    finish, results = jax.make_jaxpr(functions.finish, return_shape=True)(
        *arguments, *states
    )
    layout = _Layout(copies)
    at_given, at_states, at_results = map(layout.allot, (arguments, states, results))
    functions_written = [
        ("begin", begin, at_given, at_states, dict(masked=True)),
        ("step", step, at_states, at_states, dict(says=True)),
        ("finish", finish, at_given + at_states, at_results, {}),
    ]
    time_row, sampled_rows = -1, 0
    if functions.sample is not None and functions.time is not None:
        asked = jax.ShapeDtypeStruct((1,), float)
        sample, samples = jax.make_jaxpr(functions.sample, return_shape=True)(
            *states, asked
        )
        at_asked, _ = layout.allot((asked, ()))
        at_samples = layout.allot(samples)
        sampled_rows = sum(part.rows for part in at_samples)
        time_row = at_states[0].place_of(functions.time, states[0])
        sources = [*at_states, at_asked]
        functions_written.append(
            ("sample", sample, sources, at_samples, dict(masked=True))
        )
    written, spare_rows = zip(
        *(
            _written(*arguments, free_row=layout.rows, **how)
            for *arguments, how in functions_written
        ),
        strict=True,
    )
    code = Code(
        compile_functions(written, copies),
        sum(part.rows for part in at_given),
        at_given[0].rows,
        sum(part.rows for part in at_results),
        layout.rows,
        max(spare_rows),
        time_row,
        sampled_rows,
    )
    return code, results


class _Part(NamedTuple):
    """Rows that hold a tree, or one tree for each copy."""

    start: int
    shapes: list[tuple[int, ...]]
    copies: int

    @property
    def size(self) -> int:
        """Rows of one copy."""
        return sum(map(math.prod, self.shapes))

    @property
    def rows(self) -> int:
        return self.size * self.copies

    def place_of(self, choose: Callable, tree) -> int:
        """Return the row of a leaf, chosen from the tree."""
        leaves, structure = jax.tree.flatten(tree)
        chosen = choose(jax.tree.unflatten(structure, range(len(leaves))))
        return self.start + sum(map(math.prod, self.shapes[:chosen]))


class _Layout:
    def __init__(self, copies: int):
        self.copies, self.rows = copies, 0

    def allot(self, pair) -> list[_Part]:
        """Reserve rows for a tree that copies have in common, and for one that each
        has."""
        parts = []
        for tree, copies in zip(pair, (1, self.copies), strict=True):
            shapes = [leaf.shape for leaf in jax.tree.leaves(tree)]
            parts.append(_Part(self.rows, shapes, copies))
            self.rows += parts[-1].rows
        return parts


def _written(
    name: str,
    traced,
    sources: Sequence[_Part],
    targets: Sequence[_Part],
    masked: bool = False,
    says: bool = False,
    free_row: int = 0,
) -> tuple[Function, int]:
    """Write a traced function for LLVM. Its arguments are in the rows of the sources,
    its results go to those of the targets, but for the truth that it `says` last."""
    graph, arrays, said = Graph(), [], False
    kinds = iter(traced.in_avals)
    for part in sources:
        rows = count(part.start)
        for shape in part.shapes:
            kind, values = NUMPY[next(kinds).dtype.kind], np.empty(shape, object)
            for index in np.ndindex(shape):
                values[index] = graph.input(next(rows), kind)
            arrays.append(values)
    arrays = Translator(graph).run(traced.jaxpr, traced.consts, arrays)
    if says:
        *arrays, truth = arrays
        said = truth.item()
    copies = max(part.copies for part in (*sources, *targets))

    def row_in_copy(row: int, copy: int) -> int:
        holds = (p for p in sources if p.copies > 1 and 0 <= row - p.start < p.size)
        return row + copy * next((part.size for part in holds), 0)

    of_copies = graph.repeat(copies, row_in_copy)
    outputs, remaining = [], iter(arrays)
    for part in targets:
        results: list = [x for _ in part.shapes for x in next(remaining).ravel()]
        outputs += map(Output, count(part.start), results)
        for copy in range(1, part.copies):
            of_copy = of_copies[copy - 1]
            own = [of_copy.get(id(result), result) for result in results]
            outputs += map(Output, count(part.start + copy * part.size), own)
    # What is in its row already stays there.
    changed = [
        output
        for output in outputs
        if not isinstance(output.value, Node)
        or (output.value.operation, output.value.arguments) != (INPUT, (output.row,))
    ]
    return write_function(name, changed, said, masked, free_row, lanes_for(copies))

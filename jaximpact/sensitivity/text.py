"""The results of a sensitivity study as text."""

import json
from collections.abc import Callable, Mapping, Sequence

import numpy as np
import xarray as xr

from ..io.display import align
from ..quantities import OUTCOME_COLUMN
from .elasticities import Check, State

MARKS = {Check.differs: "!", Check.undecided: "?"}
MARK_MEANINGS = {
    Check.differs: "differences of neighbouring impacts give something else: not to "
    "be trusted",
    Check.undecided: "a jump or a kink lies within the steps of the differences",
}
STATE_MEANINGS = {
    State.parameter_is_zero: "the parameter is zero, and has no relative change",
    State.output_is_zero: "the output is zero, and has no relative change",
    State.output_has_no_value: "the output has no value here",
    State.impact_failed: "the integration did not finish",
    State.derivative_is_not_finite: "the derivative is not finite",
}


def in_words(dataset: xr.Dataset) -> str:
    """Write a table of the results, and what is to be known beside.

    Args:
        dataset: from `elasticities`, `sobol` or `morris`. Elasticities of many impacts
            are summed up: for each parameter the median of absolute values.

    Raises ValueError for another dataset.
    """
    if "elasticity" in dataset:
        single = set(dataset.elasticity.dims) == {"parameter", "output"}
        return _elasticities(dataset) if single else _many_elasticities(dataset)
    if "total_order" in dataset:
        return _sobol(dataset)
    if "mean_absolute_effect" in dataset:
        return _morris(dataset)
    raise ValueError(
        "the dataset must be from elasticities, sobol or morris, but holds "
        f"{list(dataset)}"
    )


def _table(
    dataset: xr.Dataset,
    before: tuple[str, ...],
    row: Callable[[xr.Dataset], Sequence[str]],
    after: tuple[str, ...] = (),
) -> str:
    """Write a row for each output, with a column for each parameter between others."""
    rows = [("output", *before, *map(str, dataset.parameter.values), *after)]
    rows += [(str(n), *row(dataset.sel(output=n))) for n in dataset.output.values]
    return align(rows)


def _elasticities(dataset: xr.Dataset) -> str:
    def row(of_output: xr.Dataset) -> list[str]:
        places = range(of_output.sizes["parameter"])
        cells = [cell_text(of_output.isel(parameter=k), ".3g", MARKS) for k in places]
        value, unit = float(of_output.output_value), str(of_output.output_unit.values)
        return [f"{value:.4g}", unit, *cells]

    lines = [
        f"Elasticities ({dataset[OUTCOME_COLUMN].values} impact): "
        "per cent of the output for one per cent of the parameter",
        _table(dataset, ("value", "unit"), row),
    ]
    for state, words in STATE_MEANINGS.items():
        if state in dataset.state:
            lines.append(f"  {state.short}: {words}")
    for check, words in MARK_MEANINGS.items():
        if check in dataset.check:
            lines.append(f"  {MARKS[check]} {words}")
    lines.append(f"  {_check_in_words(dataset)}")
    return "\n".join(lines)


def cell_text(entry: xr.Dataset, digits: str, marks: Mapping[Check, str]) -> str:
    """Write an elasticity, with a mark if it is doubtful, or why there is none."""
    state = State(int(entry.state))
    if state is not State.defined:
        return state.short
    return f"{float(entry.elasticity):{digits}}{marks.get(Check(int(entry.check)), '')}"


def _check_in_words(dataset: xr.Dataset) -> str:
    checked = dataset.check.values != Check.unchecked
    count = int(checked.sum())
    if not count:
        return "Not checked by differences."
    agree = int((dataset.check.values == Check.agrees).sum())
    largest = dataset.disagreement.values[dataset.check.values == Check.agrees]
    words = f"Checked by differences: {agree} of {count} agree"
    return words + (f", the worst to {largest.max():.1g}." if agree else ".")


def _many_elasticities(dataset: xr.Dataset) -> str:
    others = [d for d in dataset.elasticity.dims if d not in ("parameter", "output")]

    def row(of_output: xr.Dataset) -> list[str]:
        size = np.abs(of_output.elasticity).median(others, skipna=True)
        return [_number(x) for x in size.values]

    count = int(np.prod([dataset.sizes[name] for name in others]))
    without = int((dataset.state.values != State.defined).sum())
    lines = [
        f"Median absolute elasticity of {count} impacts",
        _table(dataset, (), row),
        f"  {without} of {dataset.state.size} have no elasticity.",
        f"  {_check_in_words(dataset)}",
    ]
    return "\n".join(lines)


def _number(value: float, digits: str = ".3g", sign: str = "") -> str:
    return f"{sign}{float(value):{digits}}" if np.isfinite(value) else "none"


def _pairs(left: xr.DataArray, right: xr.DataArray, digits: str) -> list[str]:
    return [
        f"{a:{digits}} / {b:{digits}}" if np.isfinite(a + b) else "none"
        for a, b in zip(left.values, right.values, strict=True)
    ]


def _sobol(dataset: xr.Dataset) -> str:
    def row(of_output: xr.Dataset) -> list[str]:
        intervals = of_output.first_order_interval, of_output.total_order_interval
        return [
            _number(float(of_output["mean"])),
            _number(float(of_output.standard_deviation)),
            str(of_output.output_unit.values),
            *_pairs(of_output.first_order, of_output.total_order, ".2f"),
            _number(max(float(each.max()) for each in intervals), ".2f", "+-"),
        ]

    head = ("mean", "deviation", "unit")
    title = "Sobol indices, first-order / total: part of the output's variance"
    table = _table(dataset, head, row, ("largest interval",))
    return "\n".join([title, table, *_left_out(dataset, "block", "blocks")])


def _morris(dataset: xr.Dataset) -> str:
    def row(of_output: xr.Dataset) -> list[str]:
        strength, deviation = of_output.mean_absolute_effect, of_output.effect_deviation
        unit = str(of_output.output_unit.values)
        return [unit, *_pairs(strength, deviation, ".2g")]

    title = "Elementary effects of the whole range, mu* / sigma"
    table = _table(dataset, ("unit",), row)
    return "\n".join([title, table, *_left_out(dataset, "trajectory", "trajectories")])


def _left_out(dataset: xr.Dataset, group: str, plural: str) -> list[str]:
    """Outcomes, groups that were dropped, and outputs without an estimate."""
    outcomes = json.loads(dataset.attrs["outcomes"])
    ends = ", ".join(f"{count} {outcome}" for outcome, count in outcomes.items())
    lines = [f"  Impacts: {ends}."]
    dropped, kept = dataset.groups_dropped.values, dataset.groups_kept.values
    if not dropped.any():
        lines.append(f"  No {group} was left out.")
    for name, out, rest, reason in zip(
        dataset.output.values, dropped, kept, dataset.reason.values, strict=True
    ):
        if out:
            lines.append(
                f"  {name}: {out} of {out + rest} {plural} left out, "
                "since an impact in them has no value."
            )
        if reason:
            lines.append(f"  {name}: none, since {reason}.")
    return lines

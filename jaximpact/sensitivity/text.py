"""The results of a sensitivity study as text."""

import json

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
    """A table of the results, and what is to be known beside.

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


def _elasticities(dataset: xr.Dataset) -> str:
    parameters = [str(name) for name in dataset.parameter.values]
    rows = [("output", "value", "unit", *parameters)]
    for name in dataset.output.values:
        of_output = dataset.sel(output=name)
        cells = [
            _cell(of_output.isel(parameter=place)) for place in range(len(parameters))
        ]
        value, unit = float(of_output.output_value), str(of_output.output_unit.values)
        rows.append((str(name), f"{value:.4g}", unit, *cells))
    lines = [
        f"Elasticities ({dataset[OUTCOME_COLUMN].values} impact): "
        "per cent of the output for one per cent of the parameter",
        align(rows),
    ]
    for state, words in STATE_MEANINGS.items():
        if state in dataset.state:
            lines.append(f"  {state.short}: {words}")
    for check, words in MARK_MEANINGS.items():
        if check in dataset.check:
            lines.append(f"  {MARKS[check]} {words}")
    lines.append(f"  {_check_in_words(dataset)}")
    return "\n".join(lines)


def _cell(entry: xr.Dataset) -> str:
    state = State(int(entry.state))
    if state is not State.defined:
        return state.short
    return f"{float(entry.elasticity):.3g}{MARKS.get(Check(int(entry.check)), '')}"


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
    parameters = [str(name) for name in dataset.parameter.values]
    others = [d for d in dataset.elasticity.dims if d not in ("parameter", "output")]
    rows = [("output", *parameters)]
    for name in dataset.output.values:
        size = np.abs(dataset.elasticity.sel(output=name)).median(others, skipna=True)
        rows.append((str(name), *(_number(float(x)) for x in size)))
    count = int(np.prod([dataset.sizes[name] for name in others]))
    total = dataset.state.size
    without = int((dataset.state.values != State.defined).sum())
    lines = [
        f"Median absolute elasticity of {count} impacts",
        align(rows),
        f"  {without} of {total} have no elasticity.",
        f"  {_check_in_words(dataset)}",
    ]
    return "\n".join(lines)


def _number(value: float) -> str:
    return f"{value:.3g}" if np.isfinite(value) else "none"


def _sobol(dataset: xr.Dataset) -> str:
    parameters = [str(name) for name in dataset.parameter.values]
    rows = [("output", "mean", "deviation", "unit", *parameters, "largest interval")]
    for name in dataset.output.values:
        of_output = dataset.sel(output=name)
        cells = [
            f"{first:.2f} / {total:.2f}" if np.isfinite(total) else "none"
            for first, total in zip(
                of_output.first_order.values, of_output.total_order.values, strict=True
            )
        ]
        interval = max(
            float(of_output.first_order_interval.max()),
            float(of_output.total_order_interval.max()),
        )
        rows.append(
            (
                str(name),
                _number(float(of_output["mean"])),
                _number(float(of_output.standard_deviation)),
                str(of_output.output_unit.values),
                *cells,
                f"+-{interval:.2f}" if np.isfinite(interval) else "none",
            )
        )
    title = "Sobol indices, first-order / total: part of the output's variance"
    return "\n".join([title, align(rows), *_left_out(dataset, "block")])


def _morris(dataset: xr.Dataset) -> str:
    parameters = [str(name) for name in dataset.parameter.values]
    rows = [("output", "unit", *parameters)]
    for name in dataset.output.values:
        of_output = dataset.sel(output=name)
        cells = [
            f"{strength:.2g} / {deviation:.2g}" if np.isfinite(strength) else "none"
            for strength, deviation in zip(
                of_output.mean_absolute_effect.values,
                of_output.effect_deviation.values,
                strict=True,
            )
        ]
        rows.append((str(name), str(of_output.output_unit.values), *cells))
    title = "Elementary effects of the whole range, mu* / sigma"
    return "\n".join([title, align(rows), *_left_out(dataset, "trajectory")])


def _left_out(dataset: xr.Dataset, group: str) -> list[str]:
    """Outcomes, groups that were dropped, and outputs without an estimate."""
    outcomes = json.loads(dataset.attrs["outcomes"])
    ends = ", ".join(f"{count} {outcome}" for outcome, count in outcomes.items())
    lines = [f"  Impacts: {ends}."]
    dropped, kept = dataset.groups_dropped.values, dataset.groups_kept.values
    plural = {"block": "blocks", "trajectory": "trajectories"}[group]
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

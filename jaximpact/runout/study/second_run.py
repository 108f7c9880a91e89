"""Second run of a study: the same random numbers, the other kinematics of the soil.

With the kinematics of the paper, `DeepestPoint`, the normal force does arm work in
eccentric impacts: energy without a source, given to the block or taken from it.
With `WorkConjugate` it does none. By how much design values differ is an error of the
model, which no interval of random blocks holds. Round blocks do not differ, and are not
run again.
"""

import dataclasses
import json
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import xarray as xr

from ...laws import DeepestPoint, WorkConjugate
from ...reports.tables import Table, at_x, interval_text, number_text, place_text
from ..contacts.contact_models import FullModel
from ..trajectory import NOTABLE_E_N
from .barriers import DESIGN_PERCENTILES, DESIGN_QUANTITIES, estimates_of
from .intervals import DIFFERS, Percentile, is_apart
from .results import run_left, second_of, stops_of, valid_blocks
from .slope_file import SlopeStudy

LEFT_OUT = "it was turned off"
OTHER_LAW = "the contact law has no kinematics of the soil"
ROUND = "all blocks are round, and either kinematics gives the same results"
MOST_SHOWN = 4
"""Number of differences that are told in sentences."""
PASSAGES = {
    "speed": ("passage_speed_mps", "m/s", 1.0),
    "energy": ("passage_energy_J", "kJ", 1e-3),
    "height of the centre": ("passage_centre_height_m", "m", 1.0),
    "height of the lowest point": ("passage_lowest_height_m", "m", 1.0),
}
"""Quantities of passages by their words: variable, unit and factor."""


class Run(NamedTuple):
    """Blocks of a study that are run, whose rows of numbers follow each other."""

    study: SlopeStudy
    blocks: np.ndarray  # their numbers
    first: int  # place of the first row


def second_run_of(study: SlopeStudy) -> Run | str:
    """Prepare the second run, of the elongated blocks by the other kinematics, whose
    rows follow those of the first; or say why there is none."""
    if not isinstance(study.law.contacts, FullModel):
        return OTHER_LAW
    elongated = np.flatnonzero(study.release.outline.heave > 0.0)
    if not len(elongated):
        return ROUND
    ground = study.ground
    is_other = isinstance(ground.soil.kinematics, WorkConjugate)
    other = DeepestPoint() if is_other else WorkConjugate()
    soil = dataclasses.replace(ground.soil, kinematics=other)
    # A kinematics of the user's may have random parameters, which the other has not.
    inputs = study.inputs._replace(ground_samples={})
    again = study._replace(ground=ground.with_soil(soil), inputs=inputs)
    return Run(again, elongated, study.release.count)


def kinematics_of(study: SlopeStudy) -> str:
    """Give the name of the kinematics of a study's soil."""
    return type(study.ground.soil.kinematics).__name__


class DesignValue(NamedTuple):
    """Percentile of the blocks that barriers and the like are designed by."""

    words: str
    unit: str
    percentile: Percentile


def differences(dataset: xr.Dataset) -> list[str]:
    """Write a sentence for each design value that differs between the two runs by more
    than their intervals."""
    if (second := second_of(dataset)) is None:
        return []
    kinematics, other = second
    left = run_left(dataset)
    pairs = zip(design_values(dataset, left), design_values(other, left), strict=True)
    return [
        f"{a.words}: {_value_text(a)}, but {_value_text(b)} by {kinematics}."
        for a, b in pairs
        if is_apart(a.percentile.ends, b.percentile.ends)
    ]


def _value_text(value: DesignValue) -> str:
    # x may be in national coordinates.
    write = place_text if value.unit == "m" else number_text
    ends = interval_text(*value.percentile.ends, write)
    return f"{write(value.percentile.value)} {value.unit} ({ends})"


def design_values(dataset: xr.Dataset, left: bool) -> Iterator[DesignValue]:
    """Yield the design values of a result: what comes to barriers, x where blocks
    stopped, which run to the left or to the right, and what passes collectors."""
    for barrier, estimates, *_ in estimates_of(dataset):
        for name, (_, unit, _, words) in DESIGN_QUANTITIES.items():
            for percent in DESIGN_PERCENTILES:
                percentile = Percentile(*estimates[f"{name}_p{percent}"][2:])
                words_here = f"{words} at {barrier.name}, {percent} %"
                yield DesignValue(words_here, unit, percentile)
    for percent in DESIGN_PERCENTILES:
        way, from_left = ("beyond", 100 - percent) if left else ("by", percent)
        words_here = f"x {way} which {percent} % of the blocks stopped"
        yield DesignValue(words_here, "m", Percentile.of(stops_of(dataset), from_left))
    valid = valid_blocks(dataset)
    places = dataset.collector.values if "collector" in dataset.sizes else ()
    for place, x in enumerate(places):
        for words, (name, unit, factor) in PASSAGES.items():
            values = factor * dataset[name].values[valid, place]
            for percent in DESIGN_PERCENTILES:
                words_here = f"{words} at {at_x(x)}, {percent} %"
                yield DesignValue(words_here, unit, Percentile.of(values, percent))


def energy_table(dataset: xr.Dataset) -> Table:
    """Write what impacts did with the energy that came in, by each kinematics."""
    runs = [(json.loads(dataset.attrs["kinematics"]), dataset)]
    if (second := second_of(dataset)) is not None:
        runs.append(second)
    rows = [(kinematics, *_energy_cells(result)) for kinematics, result in runs]
    above = f"e_n above {NOTABLE_E_N}"
    return Table(
        (
            *("kinematics", "energy at impact [MJ]", "arm work gives", "and takes"),
            *(f"{above}: of impacts", "of the energy", "impacts that gain energy"),
        ),
        rows,
    )


def _energy_cells(dataset: xr.Dataset) -> tuple:
    valid = valid_blocks(dataset)

    def total(name: str) -> float:
        return float(np.sum(dataset[name].values[valid]))

    energy, impacts = total("energy_at_impacts_J"), total("impacts")
    return (
        1e-6 * energy,
        *(
            f"{total(name) / max(whole, 1e-300):.2%}"
            for name, whole in (
                ("arm_work_given_J", energy),
                ("arm_work_taken_J", energy),
                ("impacts_of_high_e_n", impacts),
                ("energy_of_high_e_n_J", energy),
            )
        ),
        int(total("impacts_that_gain")),
    )


def note(dataset: xr.Dataset) -> list[str]:
    """Say which numbers to take for design, where the two runs differ by more than
    their intervals; nothing where they do not."""
    second = json.loads(dataset.attrs["second_run"])
    if isinstance(second, str) or not second["differences"]:  # or why there is none
        return []
    apart, other = second["differences"], second["kinematics"]
    used = json.loads(dataset.attrs["kinematics"])
    rest = f"And {len(apart) - MOST_SHOWN} more, marked below: {DIFFERS}."
    return [
        f"By the kinematics {used} and {other} of the soil {len(apart)} design values "
        "differ by more than their intervals, with the same random numbers. For design "
        "take those by WorkConjugate, which gives no block energy that the ground "
        "cannot give, and the difference as an error of the model: docs/limits.md.",
        *apart[:MOST_SHOWN],
        *([rest] if len(apart) > MOST_SHOWN else []),
    ]

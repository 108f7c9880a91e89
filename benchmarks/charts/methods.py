"""What is measured: this solver, and the peers that are there."""

import dataclasses
import importlib
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Protocol

import jax
import numpy as np

from jaximpact.accuracy import PRESETS, Accuracy
from jaximpact.batch import simulate_batch
from jaximpact.errors import InputError
from jaximpact.laws.slider import RELAXATION_TIME
from jaximpact.scene import Scene
from jaximpact.simulation import simulate

from .. import peers as peers_package
from ..impacts import Answer, choose

FLOOR = PRESETS["balanced"].floor
EXACT = Accuracy("exact", 1e-10, FLOOR)
"""What errors are measured against."""


class Method(Protocol):
    """A way to compute impacts."""

    name: str
    family: str
    """Methods of one family share a colour."""
    tolerances: tuple[float, ...]
    """Tolerances from coarse to fine."""

    def solve(self, scenes: Scene, tolerance: float, batch: bool) -> Answer:
        """Impacts all at once on every core, or one after another."""


class Ours:
    """`simulate` and `simulate_batch`."""

    name = family = "jaximpact"
    tolerances = tuple(
        sorted({1e-2, 1e-4, 1e-6, *(p.tolerance for p in PRESETS.values())})[::-1]
    )

    def __init__(self, slider_time: float = RELAXATION_TIME):
        self.slider_time = slider_time

    def with_slider_time(self, slider_time: float) -> "Ours":
        """The same with another relaxation time of the slider [s]."""
        return Ours(slider_time)

    def solve(self, scenes: Scene, tolerance: float, batch: bool) -> Answer:
        """Impacts all at once on every core, or one after another."""
        accuracy = Accuracy("measured", tolerance, FLOOR)
        scenes = with_slider(scenes, self.slider_time)
        if batch:
            timing = {}
            begin = time.perf_counter()
            result = simulate_batch(scenes, accuracy=accuracy, timing=timing)
            seconds = time.perf_counter() - begin - timing["compile_s"]
            return Answer(np.asarray(result.e_n), seconds)
        each = [choose(scenes, place) for place in range(count_of(scenes))]
        begin = time.perf_counter()
        e_n = [simulate(s.block, s.soil, s.impact, accuracy=accuracy).e_n for s in each]
        e_n = np.array(jax.block_until_ready(e_n), float)
        return Answer(e_n, time.perf_counter() - begin)


def with_slider(scenes: Scene, slider_time: float) -> Scene:
    """The scenes with another relaxation time of the slider."""
    slider = dataclasses.replace(scenes.soil.slider, relaxation_time=slider_time)
    soil = dataclasses.replace(scenes.soil, slider=slider)
    return Scene(scenes.block, soil, scenes.impact)


def count_of(scenes: Scene) -> int:
    """How many scenes there are."""
    return int(np.size(scenes.impact.speed))


def exact_e_n(scenes: Scene, slider_time: float = RELAXATION_TIME) -> np.ndarray:
    """e_n to some 1e-9; NaN where it could not be had."""
    return Ours(slider_time).solve(scenes, EXACT.tolerance, batch=True).e_n


def find_peers(directory: Path | None, say: Callable[[str], None]) -> list[Method]:
    """The methods of the modules `*_peer.py` of a directory.

    Args:
        directory: a package; None for `benchmarks.peers`.
        say: is told what is left out because a package is not installed.

    Raises InputError for a directory that holds no peers.
    """
    package = peers_package.__name__
    place = Path(peers_package.__path__[0])
    if directory is not None and directory.resolve() != place.resolve():
        place = directory.resolve()
        package = place.name
        if str(place.parent) not in sys.path:
            # Last, so that what lies beside it hides no installed package.
            sys.path.append(str(place.parent))
    modules = sorted(place.glob("*_peer.py"))
    if not modules:
        raise InputError(f"--peers must hold files *_peer.py, but {directory} has none")
    found = []
    for module in modules:
        try:
            peer = importlib.import_module(f"{package}.{module.stem}")
        except ImportError as error:
            say(f"{module.stem} is left out: {error}")
            continue
        found += peer.methods()
    return found

"""A study fitted by `jaximpact calibrate`, and by SciPy's least squares on peers.

    python -m benchmarks.calibration [--starts 8] [--scipy-starts 1] [--repeats 2]
        [--out FILE.csv]

The study is `calibration/wyllie`, both variants, 64 starts each. Ours is fitted in
processes of its own, with nothing compiled before (cold) and again (warm); SciPy with
finite differences on the compiled right-hand side of `benchmarks/peers/model.py`, from
the first starts of the same 64, integrated by numbalsoda, the fastest peer, and by
`scipy.integrate.solve_ivp`. What peers compile is not timed. Peers take minutes for a
few starts; what 64 would take is in proportion.
"""

import argparse
import csv
import importlib
import json
import os
import platform
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from datetime import date
from pathlib import Path
from typing import NamedTuple

import numpy as np

from jaximpact._tables import align
from jaximpact.io.files import replacing

ROOT = Path(__file__).parent.parent
STUDY = ROOT / "calibration" / "wyllie" / "study.toml"
GOALS = {"dilatancy 0": 0.126, "dilatancy 1": 0.074}
"""rms in e_n that each variant shall come to."""


class Peer(NamedTuple):
    """A method of a peer."""

    module: str
    method: str
    tolerance: float
    """The coarsest at which none of the study's impacts fails, and e_n is right to 1e-5
    nearly everywhere."""
    in_this_process: bool
    """Else its processor time is not known."""


PEERS = (
    Peer("numbalsoda_peer", "numbalsoda LSODA", 1e-8, True),
    Peer("scipy_peer", "SciPy LSODA", 1e-6, False),
)


class Fitted(NamedTuple):
    """Fits of both variants by one method."""

    method: str
    rms: np.ndarray
    """Root mean square at the end of each start, the given one first, shape (variants,
    starts)."""
    seconds: float
    """Wall time of all of them."""
    processor_seconds: float
    """Processor time of all cores; NaN where it was not measured."""
    impacts: int
    search: bool = False
    """Whether the fit begins with a search, and needs no other starts."""

    def seconds_of_all(self, starts: int) -> float:
        """Seconds for all starts of the study: of a search, or in proportion to those
        made."""
        return self.seconds * (1 if self.search else starts / self.rms.shape[1])


def as_rows(fitted: list[Fitted], starts: int, cold: float) -> list[tuple[str, ...]]:
    """Every method beside ours: a table, its head first. For each variant it tells the
    rms from the start that the study gives, the least rms, and how many starts come to
    the goal.

    Args:
        starts: of the study.
        cold: seconds that ours takes for all of them with nothing compiled.
    """
    head = ["way", "starts"]
    for name, goal in GOALS.items():
        head += [f"{name}: rms given", "best", f"<= {goal}"]
    rows = [(*head, "impacts", "s", "CPU s", "s for all starts", "times ours cold")]
    for one in fitted:
        made, used = one.rms.shape[1], one.processor_seconds
        cells = [one.method, "search" if one.search else str(made)]
        for rms, goal in zip(one.rms, GOALS.values(), strict=True):
            reached = np.sum(rms <= goal)
            cells += [f"{rms[0]:.4f}", f"{np.min(rms):.4f}", f"{reached} of {made}"]
        cells += [str(one.impacts), f"{one.seconds:.1f}"]
        cells.append("-" if np.isnan(used) else f"{used:.1f}")
        seconds = one.seconds_of_all(starts)
        rows.append((*cells, f"{seconds:.4g}", f"{seconds / cold:.3g}"))
    return rows


def _child(command: list[str], cache: Path) -> tuple[str, float, float]:
    """What a command prints, its wall time and its processor time."""
    environment = os.environ | {
        "JAXIMPACT_CACHE_DIR": str(cache / "jaximpact"),
        "JAX_COMPILATION_CACHE_DIR": str(cache),
        "JAX_ENABLE_X64": "1",
    }
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    ran = subprocess.run(
        command, cwd=ROOT, env=environment, check=True, capture_output=True, text=True
    )
    seconds = time.perf_counter() - begin
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return ran.stdout, seconds, used


class Ours(NamedTuple):
    """One run of ours."""

    answer: dict
    """What `our_fit` prints."""
    seconds: float
    processor_seconds: float
    command_seconds: float
    """Time of `jaximpact calibrate`, with examination and report."""
    command_processor_seconds: float


def _ours(cache: Path, out: Path) -> Ours:
    python = [sys.executable, "-m"]
    fitting = [*python, "benchmarks.our_fit", str(time.time()), str(STUDY)]
    printed, *seconds = _child(fitting, cache / "fit")
    command = [*python, "jaximpact", "calibrate", str(STUDY), "--out", str(out)]
    _, *whole = _child(command, cache / "command")
    return Ours(json.loads(printed), *seconds, *whole)


def in_words(kind: str, run: Ours) -> str:
    """What took how long."""
    answer = run.answer
    return (
        f"ours, {kind}: {run.seconds:.1f} s ({run.processor_seconds:.1f} s of CPU): "
        f"start and imports {answer['import_s']:.1f} s, compiling "
        f"{answer['compile_s']:.1f} s, fits {answer['fit_s']:.1f} s; the whole "
        f"command with its report {run.command_seconds:.1f} s "
        f"({run.command_processor_seconds:.1f} s of CPU)"
    )


def fit_ours(repeats: int) -> dict[str, Ours]:
    """The shortest of several runs, cold and warm."""
    runs = {"cold": [], "warm": []}
    for _ in range(repeats):
        with tempfile.TemporaryDirectory() as folder:
            for kind in runs:
                runs[kind].append(_ours(Path(folder), Path(folder) / "out"))
    # The machine may be busy: parts and whole are of the same run.
    return {kind: min(made, key=lambda run: run.seconds) for kind, made in runs.items()}


def fit_peer(
    study, peer: Peer, method, starts: int, say: Callable[[str], None]
) -> Fitted:
    """SciPy's least squares on a peer, from the study's first starts."""
    from jaximpact.calibration.estimation.evolution import spread
    from jaximpact.calibration.problem.forward_model import models_of
    from jaximpact.calibration.problem.objective import Objective

    from . import least_squares

    engine = models_of(study)[0]
    ended, used = [], 0.0
    for variant in study.variants:
        x = spread(Objective(study, variant, engine), starts)
        misfit = least_squares.Misfit(study, variant, method, peer.tolerance)
        misfit(1.0 + misfit.bounds.fraction(x[0]))  # compiles
        for place, start in enumerate(x, 1):
            begin = time.process_time()
            ended.append(least_squares.fit(misfit, start))
            used += time.process_time() - begin
            one = ended[-1]
            say(
                f"{peer.method}, {variant.name}, start {place} of {starts}: rms "
                f"{one.rms:.4f}, {one.impacts} impacts, {one.seconds:.1f} s"
            )
    return Fitted(
        f"least squares on {peer.method}",
        np.array([one.rms for one in ended]).reshape(len(study.variants), -1),
        sum(one.seconds for one in ended),
        used if peer.in_this_process else float("nan"),
        sum(one.impacts for one in ended),
    )


def methods_of(peers: tuple[Peer, ...]) -> list:
    """The peers' methods. Ends the program, in one line, where a package is missing."""
    found = []
    for peer in peers:
        try:
            module = importlib.import_module(f".peers.{peer.module}", __package__)
        except ImportError as error:
            sys.exit(f"{error}; the peers need pip install 'jaximpact[peers]'")
        found.append(next(m for m in module.methods() if m.name == peer.method))
    return found


def main() -> None:
    import jax

    jax.config.update("jax_enable_x64", True)
    from jaximpact.calibration import read_study

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--starts", type=int, default=8, help="of numbalsoda")
    parser.add_argument("--scipy-starts", type=int, default=1, help="of solve_ivp")
    parser.add_argument("--repeats", type=int, default=2, help="of ours")
    parser.add_argument("--out", type=Path, help="a table, CSV")
    arguments = parser.parse_args()
    methods, study = methods_of(PEERS), read_study(STUDY)
    ours = fit_ours(arguments.repeats)
    fitted = [
        Fitted(
            f"jaximpact, {kind}",
            np.array(run.answer["rms"]),
            run.seconds,
            run.processor_seconds,
            run.answer["impacts"],
            search=True,
        )
        for kind, run in ours.items()
    ]
    processor = platform.processor() or platform.machine()
    load = f"load {os.getloadavg()[0]:.1f}"
    print(f"{processor}, {os.cpu_count()} cores, {load}, {date.today()}")
    for kind, run in ours.items():
        print(in_words(kind, run), flush=True)

    def say(text: str) -> None:
        print(text, file=sys.stderr, flush=True)

    counts = arguments.starts, arguments.scipy_starts
    for peer, method, starts in zip(PEERS, methods, counts, strict=True):
        fitted.append(fit_peer(study, peer, method, starts, say))
    rows = as_rows(fitted, study.starts, ours["cold"].seconds)
    print(align(rows))
    print(f"load at the end {os.getloadavg()[0]:.1f}")
    if arguments.out is not None:
        with (
            replacing(arguments.out) as temporary,
            open(temporary, "w", newline="", encoding="utf-8") as file,
        ):
            csv.writer(file).writerows(rows)


if __name__ == "__main__":
    main()

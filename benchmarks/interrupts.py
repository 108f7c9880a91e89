"""Ctrl-C at random moments of the commands: `python -m benchmarks.interrupts 200`.

Each command is interrupted several times, with a cache of programs that is empty at
first and a busy process beside, then run to its end. Counted are interrupts that were
lost, that said more or less than one line, and that left a file half-written; and
commands whose files in the end differ from those of a run in one go.
"""

import argparse
import contextlib
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

STUDIES = Path(__file__).parents[1] / "calibration"
IN_A_ROW = 8
"""Interrupts of a command before it is run to its end."""
STARTING = 0.06
"""Seconds in which Python itself starts, and serves no signal of ours."""
TEMPLATE = "[impact]\nangle_deg = 40\norientation_deg = 30\n"
SLOPE = """\
count = 40
[profile]
points_m = [[0, 230], [400, 0], [1000, 0]]
[block]
mass_kg = { mean = 100, sd = 30, least = 20 }
[release]
x_m = 2
clearance_m = 1
speed_mps = 20
direction_deg = 10
"""
COMMANDS = {
    "batch": ("batch", "scenes.csv", "--out", "out.csv", "--accuracy", "fast"),
    "calibrate": ("calibrate", str(STUDIES / "twins/very-dense/noisy.csv")),
    "runout": ("runout", "slope.toml"),
    "sweep": ("sweep", "sweep.toml", "--out", "out.nc"),
    "store": ("sweep", "sweep.toml", "--out", "out.zarr"),
    "simulate": ("simulate", "scene.toml", "--plot", "out.png"),
}
VOLATILE = {"report.html", "fit.json", "manifest.json", "jaximpact-files.json"}
"""Files that tell seconds or dates, or digests of those."""


def prepare(folder: Path) -> None:
    """Put the files that the commands take into a directory."""
    folder.mkdir()
    rng = random.Random(3)
    rows = (f"{rng.uniform(1, 100)!r},{rng.uniform(0, 80)!r}" for _ in range(20_000))
    (folder / "scenes.csv").write_text("\n".join(["mass_kg,angle_deg", *rows]) + "\n")
    (folder / "scene.toml").write_text(TEMPLATE)
    (folder / "slope.toml").write_text(SLOPE)
    axes = "[axes]\nangle_deg = { from = 0, to = 80, count = 200 }\n"
    (folder / "sweep.toml").write_text(axes + "aspect_ratio = [1, 1.5, 2, 3]\n")


def start(name: str, folder: Path, cache: Path) -> subprocess.Popen:
    """A command of the list, in a directory and with a cache of its own."""
    command = COMMANDS[name]
    if name in ("calibrate", "runout"):
        command = (*command, "--out", "out")
    return subprocess.Popen(
        [sys.executable, "-m", "jaximpact", *command],
        cwd=folder,
        env=os.environ | {"JAXIMPACT_CACHE_DIR": str(cache)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )


def names_in(folder: Path) -> set[Path]:
    """Files and directories, relative to the directory."""
    return {path.relative_to(folder) for path in folder.rglob("*")}


def results(folder: Path) -> dict[str, bytes]:
    """What a command has written that is the same each time."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name not in VOLATILE
    }


def judge(code: int, errors: str, folder: Path, was_done: bool) -> str:
    """What became of an interrupt, in a few words."""
    said = [line for line in errors.splitlines() if line.startswith("jaximpact: ")]
    if "Traceback" in errors or "ignored" in errors:
        return "noise"
    there = [path.name for path in folder.rglob("*")]
    if any(".partial" in name or name.endswith("-lock") for name in there):
        return "a file left behind"
    if code == 0:
        return "after its work" if was_done else "LOST"
    if code not in (130, 143):
        return f"exit code {code}"
    return "served" if len(said) == 1 else f"{len(said)} lines"


def time_of_run(name: str, place: Path) -> float:
    """Seconds that a command takes that is let run to its end."""
    begin = time.monotonic()
    run = start(name, place / "work", place / "cache")
    _, errors = run.communicate()
    assert run.returncode == 0, errors
    return time.monotonic() - begin


@contextlib.contextmanager
def busy() -> Iterator[None]:
    """A process beside that takes a core, for as long as this one is there."""
    code = f"import os\nwhile os.getppid() == {os.getpid()}: pass"
    beside = subprocess.Popen([sys.executable, "-c", code])
    try:
        yield
    finally:
        beside.kill()
        beside.wait()


def interrupt_in_a_row(
    name: str,
    place: Path,
    limits: list[float],
    names: set[Path],
    rng: random.Random,
    number: int,
) -> Iterator[tuple[str, float, float, str]]:
    """Interrupt a command, again and again; verdict, moment, wait and stderr of each.

    A run that has come to its end by then ends the row, and does not count. The work
    is done when the files of the given names are there and no others.
    """
    folder, cache = place / "work", place / "cache"
    prepare(folder)
    for limit in limits:
        run = start(name, folder, cache)
        moment = rng.uniform(STARTING, limit)
        time.sleep(moment)
        if run.poll() is not None:
            break
        was_done = names_in(folder) == names
        sent = time.monotonic()
        run.send_signal(number)
        _, errors = run.communicate()
        verdict = judge(run.returncode, errors, folder, was_done)
        yield verdict, moment, time.monotonic() - sent, errors
        if run.returncode == 0:
            break


def main() -> int:
    """Interrupt, count and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("count", type=int, help="interrupts, of all commands together")
    parser.add_argument("--only", nargs="+", choices=COMMANDS, default=list(COMMANDS))
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--terminate", action="store_true", help="by SIGTERM")
    arguments = parser.parse_args()
    number = signal.SIGTERM if arguments.terminate else signal.SIGINT
    # A shell lets what it runs in the background ignore Ctrl-C, commands included.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    rng, failures = random.Random(arguments.seed), 0
    with tempfile.TemporaryDirectory() as directory, busy():
        for name in arguments.only:
            whole = Path(directory) / name
            whole.mkdir()
            prepare(whole / "work")
            cold, warm = time_of_run(name, whole), time_of_run(name, whole)
            expected = results(whole / "work")
            names = names_in(whole / "work")
            verdicts, waits = Counter(), []
            left = -(-arguments.count // len(arguments.only))
            while left > 0:
                place = Path(tempfile.mkdtemp(dir=directory))
                for verdict, moment, wait, errors in interrupt_in_a_row(
                    *(name, place, [cold, *[warm] * (min(left, IN_A_ROW) - 1)]),
                    *(names, rng, number),
                ):
                    verdicts[verdict] += 1
                    waits.append(wait)
                    left -= 1
                    if verdict not in ("served", "after its work"):
                        print(f"  {moment:.2f} s: {verdict}: {errors[-600:]}")
                        failures += 1
                warm = time_of_run(name, place)
                same = results(place / "work") == expected
                verdicts["whole afterwards" if same else "DIFFERENT afterwards"] += 1
                failures += not same
            print(
                f"{name}, {cold:.1f} or {warm:.1f} s: {dict(verdicts)}, "
                f"served after {max(waits):.2f} s at most",
                flush=True,
            )
    return min(failures, 1)


if __name__ == "__main__":
    sys.exit(main())

"""The benchmark from its sections to its files.

Each chart is NAME.png, its data NAME.csv and its figures NAME.md; manifest.json says
what all of them were measured with. A section whose data are there, measured with the
same settings, methods and versions, is drawn again and not measured again; so an
interrupted benchmark goes on. Within a section all is measured in one go, because times
taken at different hours are not to be compared.
"""

import dataclasses
import datetime
import hashlib
import json
import os
import platform
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import pandas as pd

from jaximpact._packages import version_of, versions
from jaximpact._precision import require_float64
from jaximpact._tables import align
from jaximpact.errors import InputError, check_choice
from jaximpact.io.files import replacing, write_text
from jaximpact.io.output_files import NewFile, output_directory
from jaximpact.plotting.style import save_figure

from .. import peers as peers_package
from .code_for_avx2 import methods_for_avx2
from .compile_time import COMPILE_TIME
from .explicit_step import EXPLICIT_STEP
from .in_jax import IN_JAX
from .ladder import LADDER
from .methods import Ours, find_peers
from .section import Bench, Row, Section, Settings, Table
from .stability import STABILITY
from .target import TARGET
from .throughput import THROUGHPUT
from .work_precision import GRADIENT, WORK_PRECISION

SECTIONS = {
    section.name: section
    for section in (
        WORK_PRECISION,
        GRADIENT,
        TARGET,
        IN_JAX,
        LADDER,
        THROUGHPUT,
        COMPILE_TIME,
        STABILITY,
        EXPLICIT_STEP,
    )
}
MANIFEST = "manifest.json"
PEER_PACKAGES = ("numba", "numbalsoda", "scipy", "scikit-sundae", "diffsol-jax")


def choose_sections(names: Sequence[str]) -> list[Section]:
    """The sections of these names; all for none.

    Raises InputError for a name that is not known, with the nearest known.
    """
    for name in names:
        check_choice("--only", name, SECTIONS)
    return [section for name, section in SECTIONS.items() if not names or name in names]


def run_benchmark(
    out: Path,
    *,
    only: Sequence[str] = (),
    peers: Path | None = None,
    settings: Settings | None = None,
    progress: Callable[[str], None] | None = None,
    say: Callable[[str], None] | None = None,
) -> str:
    """Measure and draw.

    Args:
        out: directory, made if need be; one with results of other settings is refused.
        only: names of sections; all for none.
        peers: directory of other methods; None for `benchmarks.peers`.
        settings: how much is measured.
        progress: called with lines of progress.
        say: called with what is worth a line of its own.

    Returns:
        The tables of the sections, as Markdown.

    Raises InputError for unknown sections, a directory without peers, or one that
    cannot be used, RuntimeError if JAX is set to float32, OSError where the file system
    refuses or another process writes there.
    """
    require_float64()
    settings = settings or Settings()
    say = say or (lambda text: None)
    sections = choose_sections(only)
    ours, others = [Ours(), *methods_for_avx2()], find_peers(peers, say)
    methods = [*ours, *others]
    directory = (
        str((peers or Path(peers_package.__path__[0])).resolve()) if others else ""
    )
    bench = Bench(settings, methods, directory, progress or (lambda text: None))
    names = [f"{s.name}.{kind}" for s in sections for kind in ("csv", "png", "md")]
    told = dataclasses.asdict(settings)
    names.append(MANIFEST)
    read = Path(directory).glob("*_peer.py") if directory else ()
    files = output_directory(out, "benchmark", names, inputs=read, study=told)
    with files as new:
        texts = [_run_section(section, bench, out, new, say) for section in sections]
    return "\n".join(texts)


def _run_section(section: Section, bench: Bench, out: Path, new: NewFile, say) -> str:
    settings = json.loads(json.dumps(dataclasses.asdict(bench.settings)))
    conditions = {
        "settings": settings,
        "methods": [method.name for method in bench.methods],
        "versions": versions()
        | {package: version_of(package) for package in PEER_PACKAGES},
    }
    data = out / f"{section.name}.csv"
    known = _read_manifest(out).get(section.name, {})
    same = all(known.get(key) == value for key, value in conditions.items())
    if same and data.is_file() and known.get("sha256") == _digest(data):
        say(f"{section.name}: measured before; remove {data} to measure again")
    else:
        begin, load = time.perf_counter(), _load()
        started = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
        rows = section.measure(
            bench._replace(say=lambda text: bench.say(f"{section.name}: {text}"))
        )
        write_table(new(data.name), rows)
        seconds = time.perf_counter() - begin
        record = conditions | {
            "sha256": _digest(data),
            "started": started,
            "seconds": round(seconds, 1),
            "load_before_and_after": [load, _load()],
            "machine": machine(),
        }
        others = _read_manifest(out).items()
        manifest = {name: r for name, r in others if r["settings"] == settings}
        manifest[section.name] = record
        write_text(new(MANIFEST), json.dumps(manifest, indent=1) + "\n")
        say(f"{section.name}: measured in {seconds:.0f} s")
    measured = read_table(data)
    save_figure(section.draw(measured), new(f"{section.name}.png"))
    lines = section.table(measured)
    write_text(new(f"{section.name}.md"), as_markdown(lines))
    return f"{section.name}\n{align(lines)}\n"


def write_table(path: Path, rows: list[Row]) -> None:
    """The rows under their keys, numbers with all their digits."""
    with replacing(path) as temporary:
        pd.DataFrame(rows).to_csv(
            temporary, index=False, na_rep="nan", lineterminator="\n"
        )


def read_table(path: Path) -> Table:
    """The rows as they were written; columns that look like numbers as numbers."""
    texts = pd.read_csv(path, dtype=str, keep_default_na=False)

    def numbers_or_texts(column):
        try:
            return column.astype(float)  # exact, as reading numbers is not everywhere
        except ValueError:
            return column

    return texts.apply(numbers_or_texts)


def as_markdown(lines: list[tuple[str, ...]]) -> str:
    """A Markdown table, the first line its header."""
    header, *rest = lines
    rule = ("---",) * len(header)
    return "".join(f"| {' | '.join(cells)} |\n" for cells in (header, rule, *rest))


def machine() -> dict[str, str | int | None]:
    """Processor, cores and system."""
    name = platform.processor() or platform.machine()
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            models = [line for line in file if line.startswith("model name")]
        name = models[0].split(":", 1)[1].strip() if models else name
    except OSError:
        pass
    return {"processor": name, "cores": os.cpu_count(), "system": platform.platform()}


def _load() -> float | None:
    """Processes that want a core, mean of the last minute; None where unknown."""
    return round(os.getloadavg()[0], 2) if hasattr(os, "getloadavg") else None


def _read_manifest(out: Path) -> dict:
    path = out / MANIFEST
    if not path.is_file():
        return {}
    try:
        return dict(json.loads(path.read_bytes()))
    except ValueError as error:
        raise InputError(f"is no manifest: {error}; remove it", file=path) from None


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()

"""Machine code that comes with the package: the usual scene compiles nothing.

There is an archive for each level of x86, with code for Linux. It holds for the source
that it was made of alone, each file of which stands in it with a digest: where one
differs, all is compiled, as for other scenes. `make machine-code` makes it anew.
"""

import functools
import hashlib
import json
import pickle
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path

import jax

from ..identity import described
from ..impact.dynamics import ARM
from ..impact.problem import Assembly
from ..impact.reduced_models import MODELS, PLANAR
from ..scene import Scene
from .simd import LEVELS, MOST_DIRECTIONS, Code, host

ROOT = Path(__file__).parents[1]
ARCHIVES = ROOT / "backend" / "machine_code"
MANIFEST = "manifest.json"
SOURCE = "source"
"""What the manifest calls the digests of the files of the source, by their paths."""


def usual_impacts() -> Iterator[tuple[Assembly, int, bool]]:
    """List what is shipped: impacts of an ellipsoid on the laws of `Soil`, the
    directions of their derivatives, and whether there is a history. There are values
    alone, with the energy ledger as a single impact has it, with its history as a plot
    needs it, with the arm work of run-outs, and derivatives."""
    structure = jax.tree.structure(Scene())
    for model in MODELS:
        yield Assembly(structure, model, False), 0, False
        yield Assembly(structure, model, True), 0, False
        yield Assembly(structure, model, True), 0, True
        yield Assembly(structure, model, False), MOST_DIRECTIONS, False
    yield Assembly(structure, PLANAR, ARM), 0, False


def shipped_code(what: tuple, tree) -> Code | None:
    """Return the code for the processor at hand, by what names it for `kept_code`; None
    where there is none, or the source has changed since it was made."""
    level = host()[0]
    if not sys.platform.startswith("linux") or level not in LEVELS:
        return None
    archive, name = open_archive(level), name_of(what, tree)
    if archive is None or name not in archive.namelist():
        return None
    return pickle.loads(archive.read(name))


@functools.cache
def open_archive(level: str) -> zipfile.ZipFile | None:
    """Open the archive of a level; None where it is not there or damaged, is not that
    of this source, or where this Python was built without lzma."""
    try:
        archive = zipfile.ZipFile(ARCHIVES / f"{level}.zip")
        source = json.loads(archive.read(MANIFEST))[SOURCE]
        is_same = all(digest_of(ROOT / name) == source[name] for name in source)
    except (OSError, zipfile.BadZipFile, RuntimeError):
        return None
    return archive if is_same else None


def name_of(what: tuple, tree) -> str:
    """Name code in an archive."""
    return hashlib.sha256(repr((what, described(tree))).encode()).hexdigest()[:32]


def digest_of(file: Path) -> str:
    """Compute the digest of a file of the source."""
    return hashlib.sha256(file.read_bytes()).hexdigest()

"""Machine code that comes with the package: the usual scene compiles nothing.

There is an archive for each level of x86, with code for Linux. It names the source
files from which it was made, with the digest of each. Where one of them differs, the
archive is not used, and all is compiled as for other scenes. `make machine-code` makes
it anew.
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

from ..impact.dynamics import ARM
from ..impact.problem import Assembly
from ..impact.reduced_models import MODELS, PLANAR, ROUND
from ..laws import DeepestPoint, WorkConjugate
from ..scene import Scene, Soil
from .simd import LEVELS, Code, Mode, host

ROOT = Path(__file__).parents[1]
ARCHIVES = ROOT / "backend" / "machine_code"
MANIFEST = "manifest.json"
SOURCE = "source"
"""What the manifest calls the digests of the files of the source, by their paths."""


def usual_impacts() -> Iterator[tuple[Assembly, Mode, bool]]:
    """List the impacts whose code is shipped, those of an ellipsoid on the laws of
    `Soil`: each with the mode of its derivatives, and whether it has a history. A
    single impact keeps the energy ledger, its plot needs the history, and run-outs need
    the arm work, by either kinematics."""
    structure = jax.tree.structure(Scene())
    for model in MODELS:
        for mode in Mode:
            yield Assembly(structure, model, False), mode, False
        for sampled in (False, True):
            yield Assembly(structure, model, True), Mode.VALUES, sampled
    for kinematics in (DeepestPoint(), WorkConjugate()):
        structure = jax.tree.structure(Scene(soil=Soil(kinematics=kinematics)))
        yield Assembly(structure, ROUND, ARM), Mode.VALUES, False
        yield Assembly(structure, PLANAR, ARM), Mode.VALUES, False


def shipped_code(what: tuple, description: tuple | None) -> Code | None:
    """Return the code for the processor at hand, by what names it for `kept_code` and
    the description of its inputs; None where there is none, or the source has changed
    since it was made."""
    if not is_shipped(what, description):
        return None
    # Not kept open: processes that are forked would share the place of reading.
    with zipfile.ZipFile(ARCHIVES / f"{host()[0]}.zip") as archive:
        return pickle.loads(archive.read(name_of(what, description)))


def is_shipped(what: tuple, description: tuple | None) -> bool:
    """Tell whether there is such code as `shipped_code` gives."""
    level = host()[0]
    return (
        sys.platform.startswith("linux")
        and level in LEVELS
        and name_of(what, description) in names_in_archive(level)
    )


@functools.cache
def names_in_archive(level: str) -> frozenset[str]:
    """List what the archive of a level holds; nothing where it is missing or damaged,
    was made from another source, or where this Python was built without lzma."""
    try:
        with zipfile.ZipFile(ARCHIVES / f"{level}.zip") as archive:
            source = json.loads(archive.read(MANIFEST))[SOURCE]
            names = frozenset(archive.namelist())
        is_same = all(digest_of(ROOT / name) == source[name] for name in source)
    except (OSError, zipfile.BadZipFile, RuntimeError):
        return frozenset()
    return names if is_same else frozenset()


def name_of(what: tuple, description: tuple | None) -> str:
    """Name code in an archive."""
    return hashlib.sha256(repr((what, description)).encode()).hexdigest()[:32]


def digest_of(file: Path) -> str:
    """Compute the digest of a file of the source."""
    return hashlib.sha256(file.read_bytes()).hexdigest()

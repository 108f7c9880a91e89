"""Files of results, named one by one, and what comes along beside them."""

import contextlib
import json
import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from ..errors import InputError
from .directory import LIST, Listed
from .files import check_writable, refuse_inputs
from .lock import locked

MANIFEST = ".manifest.json"
JOURNAL = ".journal"
BESIDE = "the file beside it"
"""How messages call a file that the user did not name."""


def manifest_path(path: Path) -> Path:
    """Where the manifest of a table of results lies: beside it."""
    return path.parent / (path.name + MANIFEST)


def journal_path(path: Path) -> Path:
    """Where the journal of results lies: beside them."""
    return path.parent / (path.name + JOURNAL)


@contextlib.contextmanager
def output_files(
    outputs: Mapping[str, Path],
    *,
    inputs: Iterable[Path] = (),
    beside: Mapping[Path, Path] | None = None,
    journals: Iterable[Path] = (),
) -> Iterator[None]:
    """Write files, each whole and each by one process; to be entered before a long
    computation.

    Args:
        outputs: by their options. Those that are there are to be replaced.
        inputs: files that the run reads.
        beside: further files that will be written, and the manifest that says of one
            which is there that it may be replaced.
        journals: of the run; removed when the block ends without an error.

    Raises InputError for outputs that cannot be written, are inputs, or belong to other
    results; BlockingIOError while another process writes one of them.
    """
    beside = dict(beside or {})
    journals = [*journals]
    written = [*outputs.items(), *((BESIDE, path) for path in (*beside, *journals))]
    refuse_inputs(written, inputs)
    _check_different(written)
    for what, path in written:
        check_writable(path, option=what)
    for option, path in outputs.items():
        _check_unowned(option, path)
    for path, manifest in beside.items():
        if path.exists() and not _is_manifest(manifest):
            raise InputError(
                f"{path} is in the way, and no manifest says that jaximpact wrote it; "
                "move it, or choose another name of results"
            )
    with contextlib.ExitStack() as stack:
        for path in outputs.values():
            stack.enter_context(locked(path))
        yield
        for journal in journals:
            journal.unlink(missing_ok=True)


def _check_different(written: Iterable[tuple[str, Path]]) -> None:
    seen = {}
    for what, path in written:
        other = seen.setdefault(os.path.realpath(path), (what, path))
        if other != (what, path):
            raise InputError(f"{other[0]} and {what} must differ, but both are {path}")


def _check_unowned(option: str, path: Path) -> None:
    """Raise InputError for a file that belongs to other results."""
    for suffix in (MANIFEST, JOURNAL, LIST):
        if path.name.endswith(suffix):
            raise InputError(
                f"{option} must not end in {suffix}, as what belongs to other results "
                f"does, but is {path}"
            )
    target = Path(os.path.realpath(path))
    for directory in target.parents[:2]:
        listed = Listed(directory)
        if str(target.relative_to(directory)) in listed.files:
            raise InputError(
                f"{option} {path} would overwrite a file of jaximpact "
                f"{listed.command}; choose another name"
            )


def _is_manifest(path: Path) -> bool:
    """Whether a file says with which version of this package it was written."""
    try:
        tree = json.loads(path.read_bytes())
        return "jaximpact" in tree.get("manifest", tree)["versions"]
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        return False

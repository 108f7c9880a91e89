"""Outputs of commands: files named one by one, and directories of a study.

`jaximpact-study.json` in a directory says whose results it has. A directory is used if
it is new, or if it has the results of the same study; of what came by a pipe nobody can
tell.
"""

import contextlib
import hashlib
import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path

from ..errors import IncompleteError, InputError, shown
from .files import (
    by_name,
    check_writable,
    locked,
    make_directory,
    put_text,
    read_input,
    refuse_inputs,
    replacing,
    write_text,
)

MARK = "jaximpact-study.json"
MANIFEST = ".manifest.json"
JOURNAL = ".journal"
BESIDE = "the file beside it"
"""Name, in messages, of a file that the user did not name."""

NewFile = Callable[[str], Path]
"""Function from the name of a file in a directory to the path to write it to."""


@contextlib.contextmanager
def output_directory(
    path: Path,
    command: str,
    names: Iterable[str],
    *,
    inputs: Iterable[Path] = (),
    study: Mapping | None = None,
) -> Iterator[NewFile]:
    """Write the files of a study into a directory, which is made if need be.

    Yields a function that is called, with its name, for every file written.

    Args:
        names: files that will be written.
        inputs: files that the run reads.
        study: what the same study agrees in, ready for JSON; the contents of its inputs
            if not given.

    Raises InputError for a directory that cannot be made, that has other files or the
    results of another study, or any results where an input is a pipe, and for inputs
    that would be overwritten; BlockingIOError while another process writes there.
    """
    path, inputs = Path(path), [*inputs]
    files = [path / name for name in names]
    make_directory(path, option="--out")
    check_writable(path / MARK, option="--out")
    with locked(path):
        refuse_inputs((("--out", file) for file in files), inputs)
        mark = {"command": command, "study": study or _contents(inputs)}
        is_new = _is_new(path, mark)
        if not (study or is_new):
            _check_comparable(path, inputs)
        for file in files:
            make_directory(file.parent, option="--out")
            if os.path.lexists(file) and not file.is_file():
                raise InputError(f"--out needs a file {file}, but it is something else")
        if is_new:
            write_text(path / MARK, json.dumps(mark, indent=1) + "\n")
        yield lambda name: path / name


@contextlib.contextmanager
def together(new: NewFile) -> Iterator[NewFile]:
    """Have all files that are written in the block appear when it ends, or none.

    Raises IncompleteError, in one sentence, for whatever else than input and system
    keeps one from being written, as drawing it.
    """
    try:
        with contextlib.ExitStack() as files:
            yield lambda name: files.enter_context(replacing(new(name)))
    except (OSError, InputError, IncompleteError, MemoryError):
        raise
    except Exception as error:
        raise IncompleteError(
            shown(f"no file was written: {type(error).__name__}: {error}")
        ) from error


def _is_new(directory: Path, mark: dict) -> bool:
    """Tell whether a directory has no files yet. Raises InputError for one that has
    other files than the results of the study with this mark."""
    theirs = _mark_of(directory)
    names = [name for name in os.listdir(directory) if not name.startswith(".")]
    others = {*names} - {MARK}
    # A run that failed may have left nothing but its mark.
    if not others:
        return True
    if theirs is None:
        raise InputError(
            f"--out {directory} has {min(others)}, and no results of jaximpact "
            f"{mark['command']}; choose a new directory"
        )
    # As it comes back from a file.
    if theirs != json.loads(json.dumps(mark)):
        raise InputError(
            f"--out {directory} has results of jaximpact {theirs['command']} for "
            "another study; choose another directory, or remove this one"
        )
    return False


def _mark_of(directory: Path) -> dict | None:
    """Read the mark of a directory; None where there is none. Raises InputError for a
    file of that name that is none."""
    path = directory / MARK
    if not os.path.lexists(path):
        return None
    with contextlib.suppress(ValueError):
        mark = json.loads(read_input(path))
        if isinstance(mark, dict) and mark.keys() == {"command", "study"}:
            return mark
    raise InputError(
        "is in the place of what jaximpact writes; move it, or choose another name",
        file=path,
    )


def _contents(inputs: Iterable[Path]) -> dict[str, str]:
    """Return the SHA-256 of input files by their names; a pipe is empty by now."""
    files = [path for path in inputs if path.is_file()]
    return by_name({f: hashlib.sha256(f.read_bytes()).hexdigest() for f in files})


def _check_comparable(directory: Path, inputs: Iterable[Path]) -> None:
    """Raise InputError, for a directory with results, where an input is no file: what
    came by a pipe cannot be compared with what the results are of."""
    for path in inputs:
        if not path.is_file():
            raise InputError(
                f"--out {directory} has results, but what comes by {path}, which is no "
                "file, cannot be compared with what they are of; choose a new directory"
            )


def manifest_path(path: Path) -> Path:
    """Return the path of the manifest of a table of results, beside it."""
    # Not `with_name`, which refuses what has no name: errors say that better.
    return path.parent / (path.name + MANIFEST)


def journal_path(path: Path) -> Path:
    """Return the path of the journal of results, beside them."""
    return path.parent / (path.name + JOURNAL)


@contextlib.contextmanager
def replacing_with_manifest(path: Path, manifest: Mapping) -> Iterator[Path]:
    """Give a temporary path for results, as `replacing` does; they appear with their
    manifest beside them.

    Raises InputError where another file has the manifest's name.
    """
    _check_manifest(manifest_path(path))
    with replacing(manifest_path(path)) as beside, replacing(path) as temporary:
        put_text(beside, json.dumps(manifest, indent=2) + "\n")
        yield temporary


@contextlib.contextmanager
def output_files(
    outputs: Mapping[str, Path],
    *,
    inputs: Iterable[Path] = (),
    manifests: Iterable[Path] = (),
    journals: Iterable[Path] = (),
) -> Iterator[None]:
    """Write files, each whole and each by one process; to be entered before a long
    computation.

    Args:
        outputs: by their options. Those that are there are to be replaced.
        inputs: files that the run reads.
        manifests: of the outputs; those that are there may be replaced.
        journals: of the run; removed when the block ends without an error.

    Raises InputError for outputs that cannot be written, are inputs, or belong to other
    results; BlockingIOError while another process writes one of them.
    """
    manifests, journals = [*manifests], [*journals]
    written = [*outputs.items(), *((BESIDE, path) for path in (*manifests, *journals))]
    refuse_inputs(written, inputs)
    seen = {}
    for what, path in written:
        other, _ = first = seen.setdefault(os.path.realpath(path), (what, path))
        if first != (what, path):
            raise InputError(f"{other} and {what} must differ, but both are {path}")
    for what, path in written:
        check_writable(path, option=what)
    for option, path in outputs.items():
        _check_unowned(option, path)
    for path in manifests:
        _check_manifest(path)
    with contextlib.ExitStack() as stack:
        for path in outputs.values():
            stack.enter_context(locked(path))
        yield
        for journal in journals:
            journal.unlink(missing_ok=True)


def _check_manifest(path: Path) -> None:
    """Raise InputError for a file that is there, and does not say with which version of
    this package it was written."""
    if not path.exists():
        return
    with contextlib.suppress(ValueError, LookupError, TypeError, AttributeError):
        tree = json.loads(read_input(path))
        if "jaximpact" in tree.get("manifest", tree)["versions"]:
            return
    raise InputError(
        f"{path} is in the way, and no manifest says that jaximpact wrote it; move it, "
        "or choose another name of results"
    )


def _check_unowned(option: str, path: Path) -> None:
    for suffix in (MANIFEST, JOURNAL, MARK):
        if path.name.endswith(suffix):
            raise InputError(
                f"{option} must not end in {suffix}, as what belongs to other results "
                f"does, but is {path}"
            )
    target = Path(os.path.realpath(path))
    for directory in target.parents[:2] if target.exists() else ():
        if (mark := _mark_of(directory)) is not None:
            raise InputError(
                f"{option} {path} is among the results of jaximpact "
                f"{mark['command']}; choose another name"
            )

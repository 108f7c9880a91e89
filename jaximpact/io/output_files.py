"""Outputs of commands: files named one by one, and directories whose files are known.

`jaximpact-files.json` in a directory names the command and each file that it wrote,
with the file's SHA-256, or null while a run is still writing. Nothing is replaced or
removed that a run before did not write.
"""

import contextlib
import hashlib
import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path, PurePosixPath, PureWindowsPath

from ..errors import IncompleteError, InputError, shown
from .files import (
    check_writable,
    locked,
    make_directory,
    put_text,
    read_input,
    refuse_inputs,
    replacing,
    same_file,
    write_text,
)

LIST = "jaximpact-files.json"
MANIFEST = ".manifest.json"
JOURNAL = ".journal"
BESIDE = "the file beside it"
"""Name, in messages, of a file that the user did not name."""

NewFile = Callable[[str], Path]
"""Function from the name of a file in a directory to the path to write it to."""


class FileList:
    """The list of a directory's files; empty where there is none.

    Raises InputError for a file of that name that is no list.
    """

    def __init__(self, directory: Path):
        self.path = directory / LIST
        self.command: str | None = None
        self.study: dict | None = None
        self.files: dict[str, str | None] = {}
        if not os.path.lexists(self.path):
            return
        try:
            tree = json.loads(read_input(self.path))
            self.command, self.study = str(tree["command"]), tree["study"]
            self.files = {str(name): digest for name, digest in tree["files"].items()}
        except (ValueError, LookupError, TypeError, AttributeError):
            self.command = ""
        outside = (
            path.anchor or ".." in path.parts
            for name in self.files
            for path in (PurePosixPath(name), PureWindowsPath(name))
        )
        if not self.command or any(outside):
            raise InputError(
                "is no list of files that jaximpact wrote; move it, or choose another "
                "directory",
                file=self.path,
            )

    def write(self) -> None:
        files = dict(sorted(self.files.items()))
        tree = {"command": self.command, "study": self.study, "files": files}
        write_text(self.path, json.dumps(tree, indent=1) + "\n")


@contextlib.contextmanager
def output_directory(
    path: Path,
    command: str,
    names: Iterable[str],
    *,
    inputs: Iterable[Path] = (),
    study: dict | None = None,
) -> Iterator[NewFile]:
    """Write the files of a command into a directory, which is made if need be.

    Yields a function that is called, with its name, for every file written. Before
    the first one, whatever the same command left there for another study is removed:
    the files that are on the list and not among `names`, unless they were changed.
    Files that are not on the list are neither replaced nor removed.

    Args:
        names: files that will be written, checked before the block runs; others may
            follow.
        inputs: files that the run reads.
        study: what files of earlier runs must agree in to stay; None: none stays.

    Raises InputError for a directory that cannot be made or belongs to another command,
    for files in the way and for inputs that would be overwritten or removed;
    BlockingIOError while another process writes there.
    """
    path, names, inputs = Path(path), [*names], [*inputs]
    make_directory(path, option="--out")
    check_writable(path / LIST, option="--out")
    with locked(path):
        run = _Run(path, command, names, study)
        for name in {*run.list.files, *names}:
            if (read := same_file(path / name, inputs)) is not None:
                raise InputError(
                    f"--out {path} would replace or remove {read}, which is read; "
                    "choose another directory"
                )
        for name in names:
            run.check(name)
        yield run.new
        run.finish()


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


class _Run:
    """A run that writes into a directory."""

    def __init__(self, path: Path, command: str, names: list[str], study: dict | None):
        self.path, self.command, self.names = path, command, names
        # As it comes back from the file.
        self.study = json.loads(json.dumps(study))
        self.list = FileList(path)
        self.written: set[str] = set()
        if self.list.command not in (None, command):
            raise InputError(
                f"--out {path} holds results of jaximpact {self.list.command}; choose "
                "another directory"
            )

    def check(self, name: str) -> None:
        """Raise InputError if something else is in the way of a file."""
        target = self.path / name
        folder = target.parent
        if os.path.lexists(folder) and not folder.is_dir():
            raise InputError(f"--out needs a directory {folder}, but it is a file")
        listed = name in self.list.files
        # What a link points to is not what was written, unless the content says so.
        ours = listed and (not target.is_symlink() or self._is_unchanged(name))
        if os.path.lexists(target) and not (ours and target.is_file()):
            raise InputError(
                f"--out {self.path} holds {name}, which is not known to be from "
                f"jaximpact {self.command}; move it, or choose another directory"
            )

    def new(self, name: str) -> Path:
        """Return the path of a file to be written."""
        if not self.written:
            self._renew(self.names)
        if name not in self.written:
            self.check(name)
            make_directory((self.path / name).parent, option="--out")
            self.written.add(name)
            # Listed beforehand: a run that is killed here knows the file again.
            self.list.files[name] = None
            self.list.write()
        return self.path / name

    def finish(self) -> None:
        """List the files as they were written."""
        if not self.written:
            return
        self._renew(self.written)
        for name in self.written:
            self.list.files[name] = _digest(self.path / name)
        self.list.write()

    def _renew(self, new: Iterable[str]) -> None:
        """Remove what belongs to another study and is not new, and make the list this
        one's."""
        stays = self.study is not None and self.list.study == self.study
        for name in [] if stays else [*self.list.files]:
            if name in new:
                continue
            if self._is_unchanged(name):
                (self.path / name).unlink(missing_ok=True)
                for folder in [*PurePosixPath(name).parents][:-1]:
                    with contextlib.suppress(OSError):  # of a folder that holds more
                        (self.path / folder).rmdir()
            del self.list.files[name]
        self.list.command, self.list.study = self.command, self.study

    def _is_unchanged(self, name: str) -> bool:
        digest, path = self.list.files[name], self.path / name
        if not path.is_file():
            return False
        # One of a run that was cut short is known by its name alone.
        return (digest is None and not path.is_symlink()) or digest == _digest(path)


def _digest(path: Path) -> str:
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


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

    Raises OSError where the file system refuses.
    """
    with replacing(manifest_path(path)) as beside, replacing(path) as temporary:
        put_text(beside, json.dumps(manifest, indent=2) + "\n")
        yield temporary


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
    seen = {}
    for what, path in written:
        other, _ = first = seen.setdefault(os.path.realpath(path), (what, path))
        if first != (what, path):
            raise InputError(f"{other} and {what} must differ, but both are {path}")
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


def _check_unowned(option: str, path: Path) -> None:
    for suffix in (MANIFEST, JOURNAL, LIST):
        if path.name.endswith(suffix):
            raise InputError(
                f"{option} must not end in {suffix}, as what belongs to other results "
                f"does, but is {path}"
            )
    target = Path(os.path.realpath(path))
    for directory in target.parents[:2]:
        listed = FileList(directory)
        if target.relative_to(directory).as_posix() in listed.files:
            raise InputError(
                f"{option} {path} would overwrite a file of jaximpact "
                f"{listed.command}; choose another name"
            )


def _is_manifest(path: Path) -> bool:
    """Tell whether a file says with which version of this package it was written."""
    try:
        tree = json.loads(read_input(path))
        return "jaximpact" in tree.get("manifest", tree)["versions"]
    except (ValueError, LookupError, TypeError, AttributeError):
        return False

"""Files that are there whole or not at all."""

import contextlib
import os
from collections.abc import Iterable, Iterator
from pathlib import Path

from ..errors import InputError
from ..interruption import unfinished


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A temporary path to write to, which takes the name `path` when the block ends.

    It lies beside the target, so that the renaming is atomic, and keeps the target's
    suffix. It is removed when the block is left by an exception, and by Ctrl-C; what
    a killed process leaves is hidden and says `partial`. A link is followed.

    Raises OSError where the file system refuses.
    """
    target = _target(path)
    temporary = _beside(target)
    with unfinished(temporary):
        try:
            yield temporary
            os.replace(temporary, target)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise


def write_text(path: Path, text: str) -> None:
    """Write a text whole or not at all; OSError where the file system refuses."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def make_directory(path: Path, *, option: str) -> None:
    """Make a directory if it is not there; InputError, naming the option, where that
    cannot be."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{option} {path} cannot be made: {error.strerror}") from error


def check_writable(path: Path, *, option: str) -> None:
    """Raise InputError, naming the option, unless `replacing(path)` will work.

    To be called before a long computation. Devices and pipes are refused, since they
    would be replaced by a file.
    """
    target = _target(path)
    try:
        if target.exists() and not target.is_file():
            raise InputError(f"{option} must be a file, but {path} is something else")
        if not target.parent.is_dir():
            raise InputError(
                f"{option} must lie in an existing directory, but {target.parent} "
                "is none"
            )
        probe = _beside(target)
        with unfinished(probe):
            probe.touch()
            probe.unlink()
    except OSError as error:
        raise InputError(
            f"{option} {path} cannot be written: {error.strerror}"
        ) from error


def refuse_inputs(outputs: Iterable[tuple[str, Path]], inputs: Iterable[Path]) -> None:
    """Raise InputError if an output, each with what it is called, is an input too."""
    inputs = [*inputs]
    for what, path in outputs:
        if (read := same_file(path, inputs)) is not None:
            raise InputError(
                f"{what} {path} would replace {read}, which is read; choose another "
                "name"
            )


def same_file(path: Path, others: Iterable[Path]) -> Path | None:
    """The first of some files that is this one, by whatever name or link; None where
    none is, or this one is not there."""
    for other in others:
        with contextlib.suppress(OSError):
            if os.path.samefile(path, other):
                return other
    return None


def _target(path: Path) -> Path:
    """What is to be replaced: a link's target, not the link."""
    return Path(os.path.realpath(path))


def _beside(target: Path) -> Path:
    """The temporary path that belongs to a target."""
    return target.with_name(f".{target.stem}.{os.getpid()}.partial{target.suffix}")

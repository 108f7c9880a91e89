"""The command `jaximpact`.

A module adds its commands by `add_parser(commands)`. JAX takes a second to load:
whatever needs it is imported by the function that runs the command.
"""

import argparse
import contextlib
import io
import os
import re
import sys
import warnings
from collections.abc import Callable, Sequence
from typing import TextIO, cast

from .._packages import needed, version_of
from ..errors import (
    IncompleteError,
    InputError,
    UnusualValueWarning,
    did_you_mean,
)
from ..finding import describe_error, users_line
from ..interruption import is_interrupt
from ..progress_lines import forget, say
from . import calibrate, impacts, runout, schema, sweep, tabulate

COMMANDS = (impacts, sweep, runout, tabulate, calibrate, schema)
MOVED = {
    "benchmark": "benchmarks",
    "figures": "paper figures",
    "validate": "paper claims",
}
"""Former commands, and the modules of the repository that do their work now."""


class Parser(argparse.ArgumentParser):
    """Reports a wrong argument like any other wrong input: in one line."""

    def format_help(self) -> str:
        # Texts that are read off the laws need JAX, which takes a second to load: they
        # are functions, called where help is asked for.
        for name in ("description", "epilog"):
            text = getattr(self, name)
            setattr(self, name, text() if callable(text) else text)
        return super().format_help()

    def parse_known_args(self, args=None, namespace=None):
        # argparse tells first what is missing, which a misspelt option was to give.
        words = sys.argv[1:] if args is None else args
        commands, known = self._subparsers, self._option_string_actions
        for word in words:
            option = word.partition("=")[0]
            if word == "--" or (commands and not option.startswith("-")):
                break
            if re.match("--?[a-zA-Z]", option) and option not in known:
                long = [name for name in known if name.startswith("--")]
                raise InputError(
                    f"{option} is no option of {self.prog}; "
                    f"{did_you_mean(option, long)}"
                )
        return super().parse_known_args(args, namespace)

    def error(self, message):
        raise InputError(f"{message}; see {self.prog} --help")

    def _print_message(self, message, file=None):
        # argparse passes over help that cannot be written.
        (file or sys.stderr).write(message)


def main(
    argv: Sequence[str] | None = None,
    make_parser: Callable[[], argparse.ArgumentParser] | None = None,
) -> int:
    """Run a command and return its exit code.

    0: done. 1: the system refused, for example a full disk, or something could not be
    computed. 2: wrong arguments or input. 130: interrupted from the keyboard. 141: the
    reader of stdout has left. Whatever went wrong is one line on stderr. Sets JAX to
    float64, and to keep compiled programs in the package's cache if
    `JAX_COMPILATION_CACHE_DIR` does not say where.
    """
    _prepare_streams()
    try:
        stdout = contextlib.redirect_stdout(cast(TextIO, _Stdout(sys.stdout)))
        with _warnings_in_one_line(), stdout:
            _run(argv, make_parser or _parser)
    except InputError as error:
        return _report(f"error: {error}", 2)
    except KeyboardInterrupt as error:
        return _report("; ".join(("interrupted", *error.args)), 130)
    except BrokenPipeError:
        return 141
    except (OSError, IncompleteError) as error:
        return _report(f"error: {_stdout_problem() or error}", 1)
    except MemoryError as error:
        return _report(f"error: out of memory: {error}", 1)
    return 0


def _run(
    argv: Sequence[str] | None, make_parser: Callable[[], argparse.ArgumentParser]
) -> None:
    words = sys.argv[1:] if argv is None else argv
    if make_parser is _parser and (instead := MOVED.get("".join(words[:1]))):
        raise InputError(
            f"{words[0]} is no longer a command of jaximpact; in a checkout of the "
            f"repository run python -m {instead}"
        )
    if any("\0" in text for text in argv or ()):
        raise InputError("an argument holds a null character, which no name may hold")
    parser = make_parser()
    if "_ARGCOMPLETE" in os.environ:  # a shell asks what may follow
        needed("argcomplete", "completion", "completion").autocomplete(parser)
    try:
        arguments = parser.parse_args(argv)
    except SystemExit:  # --help and --version are done
        sys.stdout.flush()
        raise
    _set_up_jax()
    os.environ["MPLBACKEND"] = "agg"  # drawings go to files
    from .._settings import numpy_settings

    try:
        with numpy_settings():
            arguments.run(arguments)
    except (InputError, IncompleteError, OSError, MemoryError):
        raise
    except BaseException as error:
        file, row = users_line(error)
        if is_interrupt(error) or not (file or isinstance(error, SystemExit)):
            raise
        raise InputError(describe_error(error), file=file, row=row) from error
    sys.stdout.flush()


def _parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="jaximpact",
        description="Impacts of rock blocks on deformable ground.",
        allow_abbrev=False,
    )
    parser.add_argument(
        "--version", action="version", version=f"%(prog)s {version_of('jaximpact')}"
    )
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    for module in COMMANDS:
        module.add_parser(commands)
    return parser


def _set_up_jax() -> None:
    try:
        import jax

        from ..backend.xla_compilation import keep_programs
    except ValueError as error:  # of a setting in the environment
        raise InputError(f"JAX cannot be set up: {error}") from None

    jax.config.update("jax_enable_x64", True)
    _check_platforms(jax)
    keep_programs()


def _check_platforms(jax) -> None:
    asked = jax.config.jax_platforms
    if not asked:
        return
    try:
        jax.devices()
    except (RuntimeError, AssertionError):
        jax.config.update("jax_platforms", None)
        there = jax.devices()[0].platform
        raise InputError(
            f"JAX_PLATFORMS asks for {asked!r}, which JAX cannot use here; there is "
            f"{there}: unset JAX_PLATFORMS, or set it to {there}"
        ) from None


def _report(message: str, code: int) -> int:
    say(message)
    return code


def _prepare_streams() -> None:
    """Make the standard streams such that any text can be written to them.

    A character that the encoding lacks is replaced. Writing to a closed stdout fails as
    on a full disk, and to a closed stderr is lost. Under `PYTHONUNBUFFERED` stdout
    keeps a line: without a buffer Python passes over that for which a disk has no room.
    Descriptors 0 to 2 are taken, so that no file of ours gets one that other code
    writes to.
    """
    for descriptor in range(3):
        try:
            os.fstat(descriptor)
        except OSError:
            # The lowest free descriptor is this one.
            os.open(os.devnull, os.O_RDWR if descriptor == 2 else os.O_RDONLY)
    if sys.stdout is None:
        sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    elif sys.stdout is sys.__stdout__ and _has_no_buffer(sys.stdout):
        sys.stdout = open(  # noqa: SIM115
            1, "w", buffering=1, encoding=sys.stdout.encoding, closefd=False
        )
    if sys.stderr is None:
        sys.stderr = open(2, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    for stream, errors in ((sys.stdout, "replace"), (sys.stderr, "backslashreplace")):
        # Streams that stand in for them, as in tests, take every character.
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors=errors)


def _has_no_buffer(stream: TextIO) -> bool:
    return isinstance(getattr(stream, "buffer", None), io.RawIOBase)


class _Stdout:
    """Stdout whose errors say that they are its: those of the system name no file, and
    of a text that is longer than its buffer nothing is left to try again."""

    def __init__(self, stream: TextIO):
        self._stream = stream

    def __getattr__(self, name):
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        with self._named_errors():
            return self._stream.write(text)

    def flush(self) -> None:
        with self._named_errors():
            self._stream.flush()

    @contextlib.contextmanager
    def _named_errors(self):
        try:
            yield
        except OSError as error:
            forget(self._stream)
            what = f"stdout cannot be written: {error.strerror}"
            raise type(error)(what) from error


def _stdout_problem() -> str | None:
    """Why stdout cannot be written to; None if it can."""
    try:
        _Stdout(sys.stdout).flush()
    except OSError as error:
        return str(error)
    return None


@contextlib.contextmanager
def _warnings_in_one_line():
    """Warnings are a line on stderr each, of unusual values one for each quantity."""
    warned = set()

    def show(message, category, filename, lineno, file=None, line=None):
        quantity = getattr(message, "quantity", None)
        if issubclass(category, UnusualValueWarning) and quantity in warned:
            return
        warned.add(quantity)
        say(f"warning: {message}")

    with warnings.catch_warnings():
        warnings.showwarning = show
        yield

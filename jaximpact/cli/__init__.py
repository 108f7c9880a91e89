"""The command `jaximpact`.

One module a command; each has `add_parser(commands)`, which names its function `run`.
What needs JAX is imported by `run`.
"""

import argparse
import os
import sys
from collections.abc import Sequence

from ..errors import IncompleteError, InputError
from ..formats.provenance import version_of
from . import (
    batch,
    benchmark,
    calibrate,
    figures,
    predict,
    runout,
    sensitivity,
    simulate,
    sweep,
    tabulate,
    validate,
)
from .progress import forget, say
from .streams import prepare_streams, stdout_problem, warnings_in_one_line

USER_ERROR = 2
SYSTEM_ERROR = 1
INTERRUPTED = 130
BROKEN_PIPE = 141


class _Parser(argparse.ArgumentParser):
    """Reports a wrong argument like any other wrong input: in one line."""

    def format_help(self) -> str:
        # Texts that are read off the laws need JAX, which takes a second to load: they
        # are functions, called where help is asked for.
        for name in ("description", "epilog"):
            text = getattr(self, name)
            setattr(self, name, text() if callable(text) else text)
        return super().format_help()

    def error(self, message):
        raise InputError(f"{message}; see {self.prog} --help")

    def _print_message(self, message, file=None):
        # argparse passes over help that cannot be written.
        (file or sys.stderr).write(message)


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command and return its exit code.

    0: done. 1: the system refused, for example a full disk, or something could not be
    computed. 2: wrong arguments or input. 130: interrupted from the keyboard. Whatever
    went wrong is one line on stderr. Sets JAX to float64, and to keep compiled programs
    in the package's cache if `JAX_COMPILATION_CACHE_DIR` does not say where.
    """
    prepare_streams()
    try:
        with warnings_in_one_line():
            _run(argv)
    except InputError as error:
        return _report(f"error: {error}", USER_ERROR)
    except KeyboardInterrupt as error:
        return _report("; ".join(("interrupted", *error.args)), INTERRUPTED)
    except BrokenPipeError:
        # The reader of stdout has left (`| head`).
        forget(sys.stdout)
        return BROKEN_PIPE
    except (OSError, IncompleteError) as error:
        return _report(f"error: {stdout_problem() or error}", SYSTEM_ERROR)
    except MemoryError as error:
        return _report(f"error: out of memory: {error}", SYSTEM_ERROR)
    return 0


def _run(argv: Sequence[str] | None) -> None:
    if any("\0" in text for text in argv or ()):
        raise InputError("an argument holds a null character, which no name may hold")
    try:
        arguments = _parser().parse_args(argv)
    except SystemExit:  # --help and --version are done
        sys.stdout.flush()
        raise
    _set_up_jax()
    os.environ["MPLBACKEND"] = "agg"  # drawings go to files
    arguments.run(arguments)
    sys.stdout.flush()


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="jaximpact",
        description="Impacts of rock blocks on deformable ground.",
        allow_abbrev=False,
    )
    parser.add_argument(
        "--version", action="version", version=f"%(prog)s {version_of('jaximpact')}"
    )
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    for command in (
        simulate,
        batch,
        sweep,
        runout,
        tabulate,
        figures,
        sensitivity,
        calibrate,
        predict,
        validate,
        benchmark,
    ):
        command.add_parser(commands)
    return parser


def _set_up_jax() -> None:
    try:
        import jax

        from ..engines.kept_programs import keep_programs
    except ValueError as error:  # of a setting in the environment
        raise InputError(f"JAX cannot be set up: {error}") from None

    jax.config.update("jax_enable_x64", True)
    _check_platforms(jax)
    keep_programs()


def _check_platforms(jax) -> None:
    """Raise InputError where JAX was told to compute on what is not there."""
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

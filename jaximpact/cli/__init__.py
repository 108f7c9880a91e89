"""The command `jaximpact`.

One module a command; each has `add_parser(commands)`, which names its function `run`.
What needs JAX is imported by `run`.
"""

import argparse
import os
import sys
import warnings
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
from .progress import say

USER_ERROR = 2
SYSTEM_ERROR = 1
INTERRUPTED = 130
BROKEN_PIPE = 141


class _Parser(argparse.ArgumentParser):
    """Reports a wrong argument like any other wrong input: in one line."""

    def error(self, message):
        raise InputError(f"{message}; see {self.prog} --help")


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command and return its exit code.

    0: done. 1: the system refused, for example a full disk, or something could not be
    computed. 2: wrong arguments or input. 130: interrupted from the keyboard. Whatever
    went wrong is one line on stderr. Sets JAX to float64, and to keep compiled programs
    in the package's cache if `JAX_COMPILATION_CACHE_DIR` does not say where.
    """
    try:
        arguments = _parser().parse_args(argv)
        _set_up_jax()
        arguments.run(arguments)
        sys.stdout.flush()
    except InputError as error:
        return _report(f"error: {error}", USER_ERROR)
    except KeyboardInterrupt as error:
        return _report("; ".join(("interrupted", *error.args)), INTERRUPTED)
    except BrokenPipeError:
        # The reader of stdout has left (`| head`); Python must not write at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE
    except (OSError, IncompleteError) as error:
        return _report(f"error: {error}", SYSTEM_ERROR)
    return 0


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
    import jax

    jax.config.update("jax_enable_x64", True)
    _keep_programs()


def _keep_programs() -> None:
    from ..engines.kept_programs import keep_programs

    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        keep_programs()
    for warning in found:
        say(f"warning: {warning.message}")


def _report(message: str, code: int) -> int:
    say(message)
    return code

"""The command line as a program: `python -m jaximpact`, and the script `jaximpact`.

Signals are served before anything is imported that takes its time.
"""
# PYTHON_ARGCOMPLETE_OK

import sys

from .interruption import ending_on_signals


def main() -> int:
    """Run the command that the process was started with, and return its exit code."""
    with ending_on_signals():
        from . import cli

        return cli.main()


if __name__ == "__main__":
    sys.exit(main())

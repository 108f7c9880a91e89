"""Progress of long work, on a terminal and elsewhere."""

import io
import sys

from jaximpact.cli.progress import ProgressLines


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_progress_on_a_terminal_overwrites_itself(monkeypatch):
    monkeypatch.setattr(sys, "stderr", Terminal())
    with ProgressLines() as progress:
        progress("impacts", 1, 3)
        progress("impacts", 3, 3)
    assert sys.stderr.getvalue() == (
        "\r1 of 3 impacts (33 %)\r3 of 3 impacts (100 %)\n"
    )


def test_progress_elsewhere_is_a_line_every_tenth(monkeypatch):
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    with ProgressLines() as progress:
        for done in range(101):
            progress("impacts", done, 100)
    lines = sys.stderr.getvalue().splitlines()
    assert lines == [f"{n} of 100 impacts ({n} %)" for n in range(0, 101, 10)]

"""Progress is told to whoever listens, and to the log."""

import logging
import sys

import pytest

from jaximpact.backend.native_backend import _telling_how_long
from jaximpact.backend.simd import Mode
from jaximpact.progress import reporting_to, tell, within
from jaximpact.progress_lines import say, showing


def test_steps_and_counts_are_in_the_log(caplog):
    told = []
    with caplog.at_level(logging.DEBUG, "jaximpact"):
        tell("compiling once")
        with reporting_to(told.append), within("profiles, "):
            tell("impacts", 3, 10)
    assert [(r.levelname, r.getMessage()) for r in caplog.records] == [
        ("INFO", "compiling once"),
        ("DEBUG", "3 of 10 profiles, impacts"),
    ]
    assert told == ["3 of 10 profiles, impacts"]


def test_who_waits_for_the_compiler_is_told_so_once(capsys):
    """On stderr where nobody listens, also of kernels that are compiled at once; to the
    listener where there is one; to nobody where silence was asked for."""
    line = "compiling machine code for derivatives, once: 3 to 6 s on two idle cores"
    with _telling_how_long(Mode.FORWARD, False), _telling_how_long(Mode.VALUES, False):
        pass
    assert capsys.readouterr().err == f"{line}\n"
    told = []
    with reporting_to(told.append), _telling_how_long(Mode.VALUES, True):
        pass
    assert told == [line.replace("derivatives", "values").replace("3 to 6", "1 to 4")]
    with showing(False), _telling_how_long(Mode.FORWARD, False):
        pass
    with pytest.raises(ZeroDivisionError), _telling_how_long(Mode.FORWARD, False):
        1 / 0  # noqa: B018
    # What failed tells the next one.
    with _telling_how_long(Mode.FORWARD, False):
        pass
    assert capsys.readouterr().err == 2 * f"{line}\n"


class _WriteAlone:
    """What a graphical program may put in the place of stderr."""

    def __init__(self):
        self.written = ""

    def write(self, text):
        self.written += text


class _Full:
    def write(self, text):
        raise OSError(28, "No space left on device")


@pytest.mark.parametrize("kind", ["none", "closed", "write alone", "full"])
def test_who_has_no_stderr_computes_all_the_same(kind, monkeypatch):
    """There is none under pythonw.exe, for one."""
    closed = open(__file__)  # noqa: SIM115
    closed.close()
    streams = {"none": None, "closed": closed, "full": _Full()}
    stream = streams.get(kind, _WriteAlone())
    monkeypatch.setattr(sys, "stderr", stream)
    with showing(None, delay=0.0):
        tell("impacts", 1, 2)
    say("done")
    if isinstance(stream, _WriteAlone):
        assert stream.written == "1 of 2 impacts (50 %)\njaximpact: done\n"

"""Checks of error messages, one line each, in Python and on the command line; and of
warnings."""

import contextlib
import re
import warnings


def assert_one_line(error, *parts):
    """The message of an error is one line, with every part in it."""
    message = str(error)
    assert "\n" not in message
    for part in parts:
        assert part in message


def assert_one_line_error(capsys, *parts):
    """What went wrong is one line on stderr, and nothing is on stdout."""
    out, err = capsys.readouterr()
    assert out == ""
    last = err.splitlines()[-1]
    assert last.startswith("jaximpact: ")
    assert "Traceback" not in err
    for part in parts:
        assert part in last
    return err


@contextlib.contextmanager
def warned_once(kind, said):
    """One warning of a kind is given, which a pattern matches; none for None."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield
    assert [warning.category for warning in caught] == [kind] * (said is not None)
    assert said is None or re.search(said, str(caught[0].message))

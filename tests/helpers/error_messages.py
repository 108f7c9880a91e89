"""Checks of error messages: one line each, in Python and on the command line."""


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

"""What the tests of the command line share."""


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

"""What the tests of refused input share."""


def assert_one_line(error, *parts):
    """The message of an error is one line, with every part in it."""
    message = str(error)
    assert "\n" not in message
    for part in parts:
        assert part in message

"""Progress is told to whoever listens, and to the log."""

import logging

from jaximpact.progress import reporting_to, tell, within


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

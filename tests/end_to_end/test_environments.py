"""Streams that are closed or full, encodings and settings of JAX: a command does its
work, or says in one line what is wrong. In processes of their own."""

import os
import subprocess
import sys

import pytest

SCENE = 'accuracy = "fast"\n'
STUDY = """
title = '$_{ \\frac $ ^ 30° \u263a'
count = 2
[profile]
points_m = [[0, 100], [200, 0]]
[release]
x_m = 2
clearance_m = 1
[[contacts]]
law = "constant coefficients"
name = '$x^$ a'
e_n = 0.3
e_t = 0.8
[[contacts]]
law = "constant coefficients"
name = 'b $\\no$'
e_n = 0.4
e_t = 0.8
"""


@pytest.mark.parametrize(
    ("command", "settings", "code", "said"),
    [
        ("--version >&-", {}, 1, "error: stdout cannot be written: Bad file"),
        ("--help >/dev/full", {}, 1, "error: stdout cannot be written: No space left"),
        (
            "--help >/dev/full",
            {"PYTHONUNBUFFERED": "1"},
            1,
            "error: stdout cannot be written: No space left",
        ),
        (  # longer than the buffer of stdout
            "schema simulate >/dev/full",
            {},
            1,
            "error: stdout cannot be written: No space left",
        ),
        (
            "simulate s.toml >/dev/full",
            {},
            1,
            "stdout cannot be written: No space left",
        ),
        ("simulate none.toml 2>&-", {}, 2, ""),
        ("simulate none.toml 2>/dev/full >&- <&-", {}, 2, ""),
        (
            "simulate \u263a.toml >/dev/null",
            {"PYTHONIOENCODING": "ascii:strict"},
            2,
            "\\u263a.toml: cannot be read",
        ),
        (
            "simulate s.toml",
            {"JAX_PLATFORMS": "abacus"},
            2,
            "JAX_PLATFORMS asks for 'abacus', which JAX cannot use here; there is",
        ),
        (
            "simulate s.toml",
            {"JAX_ENABLE_X64": "maybe"},
            2,
            "JAX cannot be set up: invalid truth value 'maybe'",
        ),
        pytest.param(
            "runout slope.toml --out out >/dev/null",
            {"PYTHONIOENCODING": "latin-1:strict", "MPLBACKEND": "none"},
            0,
            "jaximpact: tables and drawings written to out",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_environments(folder, command, settings, code, said):
    (folder / "s.toml").write_text(SCENE)
    (folder / "slope.toml").write_text(STUDY, encoding="utf-8")
    finished = subprocess.run(
        ["bash", "-c", f"{sys.executable} -m jaximpact {command}"],
        env=os.environ | {"PYTHONUNBUFFERED": ""} | settings,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        timeout=120,
    )
    err = finished.stderr.decode(errors="replace")
    assert finished.returncode == code, err
    assert "Traceback" not in err
    assert "Exception ignored" not in err
    assert said in (err.splitlines() or [""])[-1]

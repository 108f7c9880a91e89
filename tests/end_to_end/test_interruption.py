"""Ctrl-C, SIGTERM and SIGHUP: nothing is lost, no file is half-written, one line is
said."""

import os
import random
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest

from jaximpact.cli import main
from jaximpact.interruption import ENDINGS

GOES_ON = "the same command goes on from here"
SITUATIONS = {
    "weakref callback": """
        import weakref

        class Thing: ...

        thing = Thing()
        reference = weakref.ref(thing, lambda _: ready_and_busy())
        del thing
        """,
    "garbage collector": """
        import gc
        gc.callbacks.append(lambda *_: ready_and_busy())
        gc.collect()
        """,
    "callback of ctypes": """
        import ctypes
        ctypes.CFUNCTYPE(None)(ready_and_busy)()
        """,
    "import": """
        open("slow.py", "w").write("import __main__; __main__.ready_and_busy()")
        sys.path.insert(0, ".")
        try:
            import slow
        except BaseException:
            pass
        """,
    "native code": """
        import ctypes
        print("ready", flush=True)
        ctypes.CDLL(None).sleep(60)
        """,
    "waiting for threads": """
        import threading
        threading.Thread(target=ready_and_busy, daemon=True).start()
        threading.Event().wait()
        """,
    "work that goes on": """
        with resumable():
            ready_and_busy()
        """,
    "file being written": """
        with replacing(Path("out")) as temporary:
            temporary.write_text("half")
            ready_and_busy()
        """,
    "file about to be written by a thread": """
        import threading
        def work():
            while True:
                with replacing(Path("whole")) as temporary:
                    time.sleep(0.001)
                    temporary.write_text("all of it")
                    if not Path("whole").exists():
                        print("ready", flush=True)
        threading.Thread(target=work, daemon=True).start()
        threading.Event().wait()
        """,
}
PREAMBLE = """
import sys, time
from pathlib import Path
from jaximpact.io.files import replacing
from jaximpact.interruption import ending_on_signals, resumable

def ready_and_busy():
    print("ready", flush=True)
    while True:
        pass

with ending_on_signals():
"""


@pytest.fixture(autouse=True)
def _interrupts():
    """Commands do not ignore signals, even where the tests do: in the background."""
    usual = {number: signal.SIG_DFL for number in ENDINGS}
    usual[signal.SIGINT] = signal.default_int_handler
    before = {number: signal.signal(number, usual[number]) for number in ENDINGS}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


def start_script(script, folder):
    """A process that serves signals, once it has said that it is ready."""
    run = subprocess.Popen(
        [sys.executable, "-c", script],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert run.stdout.readline() == "ready\n", run.stderr.read()
    return run


@pytest.mark.parametrize("situation", SITUATIONS)
def test_an_interrupt_is_served_wherever_it_comes(folder, situation):
    code = SITUATIONS[situation]
    prospect = f"; {GOES_ON}" if "resumable" in code else ""
    script = PREAMBLE + textwrap.indent(textwrap.dedent(code), "    ")
    run = start_script(script, folder)
    run.send_signal(signal.SIGINT)
    run.send_signal(signal.SIGINT)
    _, errors = run.communicate(timeout=60)
    assert (run.returncode, errors) == (130, f"jaximpact: interrupted{prospect}\n")
    for path in set(folder.iterdir()) - {folder / "slow.py", folder / "__pycache__"}:
        assert (path.name, path.read_text()) == ("whole", "all of it")


@pytest.mark.parametrize("number", ENDINGS)
def test_each_signal_has_its_word_and_code(folder, number):
    run = start_script(PREAMBLE + "    ready_and_busy()", folder)
    run.send_signal(number)
    code, word = ENDINGS[number]
    assert run.communicate(timeout=60)[1] == f"jaximpact: {word}\n"
    assert run.returncode == code == 128 + number


STORE = """
    import dask.array, xarray
    from jaximpact import write_zarr
    from jaximpact.lazy import zarr_store

    def cut_short(*arguments, **_):
        inner = next(a for a in arguments if isinstance(a, Path)) / "inner"
        inner.mkdir(parents=True)
        (inner / "0.0123456789abcdef.partial").write_text("half")
        ready_and_busy()

    {patched} = cut_short
    write_zarr("o.zarr", xarray.Dataset({{"y": ("x", dask.array.ones(3, chunks=1))}}))
"""


@pytest.mark.parametrize(
    ("patched", "left"),
    [("xarray.Dataset.to_zarr", []), ("zarr_store._finish", ["o.zarr"])],
    ids=["as it is begun", "as it is finished"],
)
def test_nothing_half_written_is_left_of_a_store(folder, patched, left):
    run = start_script(PREAMBLE + STORE.format(patched=patched), folder)
    run.send_signal(signal.SIGSTOP)
    run.send_signal(signal.SIGTERM)
    run.send_signal(signal.SIGCONT)
    assert run.communicate(timeout=60)[1] == "jaximpact: terminated\n"
    assert run.returncode == 143
    assert [path.name for path in folder.iterdir()] == left
    assert not [*folder.rglob("*partial*")]


def test_a_law_is_no_interrupt(folder):
    """A KeyboardInterrupt that no signal has raised."""
    (folder / "law.py").write_text("raise KeyboardInterrupt")
    (folder / "scene.toml").write_text("flow = 'law.py:Law'")
    command = [sys.executable, "-m", "jaximpact", "simulate", "scene.toml"]
    run = subprocess.run(command, stderr=subprocess.PIPE, text=True, check=False)
    assert run.returncode == 2
    assert "law.py: cannot be run as the file of a law" in run.stderr
    assert run.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("", "print('ready', flush=True); time.sleep(0.3)"),
        ("print('ready', flush=True); time.sleep(0.3)", ""),
    ],
    ids=["once the work is done", "ignored from the start, as by nohup"],
)
def test_an_interrupt_that_is_to_be_ignored(folder, before, after):
    if before:
        # What is started inherits this.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    run = start_script(f"{PREAMBLE}    {before or 'pass'}\n{after}\n", folder)
    run.send_signal(signal.SIGINT)
    assert run.communicate(timeout=60)[1] == ""
    assert run.returncode == 0


def test_python_keeps_its_own_interrupts(folder):
    assert main(["simulate", "none.toml"]) == 2
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL


def _wait_for_its_watcher(run):
    """Until a process has the thread that watches for signals: Python itself may take
    long to start beside others, and ends otherwise by then."""
    threads = Path(f"/proc/{run.pid}/task")
    if not threads.is_dir():  # not on Linux
        time.sleep(0.5)
        return
    while run.poll() is None and len(os.listdir(threads)) < 2:
        time.sleep(0.002)


@pytest.mark.slow
def test_a_batch_that_is_interrupted_again_and_again_ends_as_one_in_one_go(folder):
    rng = random.Random(7)
    rows = [f"{rng.uniform(1, 90)},{rng.uniform(0, 80)}\n" for _ in range(20_000)]
    (folder / "scenes.csv").write_text("mass_kg,angle_deg\n" + "".join(rows))
    command = ["batch", "scenes.csv", "--accuracy", "fast", "--out"]
    served = 0
    # From where signals are served, over imports and compiling, to the writing.
    for moment in (0.0, 0.4, 0.8, 1.3, 1.8):
        run = subprocess.Popen(
            [sys.executable, "-m", "jaximpact", *command, "cut.csv"],
            env=os.environ | {"JAXIMPACT_CACHE_DIR": str(folder / "cache")},
            stderr=subprocess.PIPE,
            text=True,
        )
        _wait_for_its_watcher(run)
        time.sleep(moment)
        was_done = os.path.exists("cut.csv")
        run.send_signal(signal.SIGINT)
        errors = run.communicate(timeout=60)[1].splitlines()
        told = "%)", "two idle cores"  # progress, and that it compiles
        said = [line for line in errors if not line.endswith(told)]
        assert not [*folder.rglob("*partial*"), *folder.rglob("*lock")]
        if was_done:
            break
        assert run.returncode == 130
        assert len(said) == 1
        assert said[0].startswith("jaximpact: interrupted")
        served += 1
    assert served >= 3
    assert main([*command, "cut.csv"]) == 0
    assert main([*command, "whole.csv"]) == 0
    assert (folder / "cut.csv").read_bytes() == (folder / "whole.csv").read_bytes()

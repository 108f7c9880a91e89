"""What a first use costs: each in a process of its own, with an empty cache of compiled
programs and with a filled one."""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from jaximpact.plotting.style import (
    BLUE,
    GREY,
    SKY,
    in_style,
    legend_outside,
    panels,
)

from .section import Bench, Row, Section, Table, table_of


def measure(bench: Bench) -> list[Row]:
    """A row for each use, cold and warm."""
    here = {name: "" for name in bench.settings.first_uses}
    known = {method.name for method in bench.methods}
    peers = {n: bench.peers for n in bench.settings.first_uses_of_peers if n in known}
    rows = []
    with tempfile.TemporaryDirectory(prefix="jaximpact-benchmark-") as cache:
        for name, directory in (here | peers).items():
            for state in ("cold", "warm"):
                bench.say(f"{name}, {state}")
                place = Path(cache) / name.replace(" ", "-")
                seconds = _in_a_process(name, directory, place)
                shown = f"{name}, without import" if directory else name
                rows.append({"use": shown, "cache": state, **seconds})
    return rows


def _in_a_process(name: str, directory: str, cache: Path) -> dict[str, float]:
    root = Path(__file__).parents[2]
    environment = os.environ | {
        "JAXIMPACT_CACHE_DIR": str(cache / "jaximpact"),
        "JAX_COMPILATION_CACHE_DIR": str(cache / "jax"),
        "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0.5",
        "NUMBA_CACHE_DIR": str(cache / "numba"),
        "PYTHONPATH": os.pathsep.join(
            [str(root), *filter(None, [os.environ.get("PYTHONPATH")])]
        ),
    }
    started = repr(time.time())
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.first_use", started, name, directory],
        env=environment,
        capture_output=True,
        text=True,
    )
    if done.returncode:
        last = (done.stderr.strip() or "no message").splitlines()[-1]
        raise RuntimeError(f"the first use of {name} failed: {last}")
    return json.loads(done.stdout.splitlines()[-1])


@in_style
def draw(rows: Table) -> Figure:
    """Bars of import and first use, cold over warm."""
    uses = list(rows["use"].unique())
    figure, (axes,) = panels(height=1.2 + 0.45 * len(uses))
    for state, shift, colour in (("cold", -0.19, BLUE), ("warm", 0.19, SKY)):
        own = rows[rows["cache"] == state]
        places = np.array([uses.index(use) for use in own["use"]]) + shift
        start, first = own["import_s"], own["first_s"]
        axes.barh(places, start, 0.36, color=GREY, label="import" if shift < 0 else "")
        bars = axes.barh(
            places, first, 0.36, left=start, color=colour, label=f"first use, {state}"
        )
        axes.bar_label(bars, [f"{total:.1f} s" for total in start + first], padding=4)
    axes.set_yticks(range(len(uses)), uses)
    axes.invert_yaxis()
    axes.margins(x=0.1)
    axes.set_xlabel("time from the start of the process [s]")
    legend_outside(figure, place="upper center")
    return figure


def table(rows: Table) -> list[tuple[str, ...]]:
    """Seconds by use and cache."""
    return table_of(
        rows,
        {
            "use": "{use}",
            "cache": "{cache}",
            "import, s": "{import_s:.2f}",
            "first use, s": "{first_s:.2f}",
            "second use, s": "{second_s:.2f}",
        },
    )


COMPILE_TIME = Section("compile-time", measure, draw, table)

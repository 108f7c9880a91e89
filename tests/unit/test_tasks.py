"""Tasks for other processes: what can be sent, what runs them, and workers that die."""

import concurrent.futures
import importlib
import multiprocessing
import sys
import threading
import types
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from jaximpact import Block, Impact, Soil, simulate_batch, tasks
from jaximpact.backend.threads import thread_count
from jaximpact.errors import IncompleteError, InputError
from jaximpact.progress import tell
from jaximpact.tasks import (
    WAITING,
    Task,
    call_each,
    check_executor,
    computing,
    run_in_threads,
    run_tasks,
)

BLOCK = Block(mass=np.linspace(50.0, 500.0, 300))


def test_a_task_computes_on_one_thread(monkeypatch):
    monkeypatch.setenv("JAXIMPACT_THREADS", "3")
    assert thread_count() == 3
    assert Task(thread_count)() == 1
    assert thread_count() == 3


def test_what_stands_in_a_function_cannot_be_sent():
    with pytest.raises(InputError, match=r"cannot be sent to another process.*module"):
        Task(lambda: 1)


def test_a_task_does_not_end_its_worker():
    with pytest.raises(InputError, match=r"SystemExit \(which would end .*: 3"):
        Task(sys.exit, 3)()


def test_a_worker_with_another_law_says_so(tmp_path, monkeypatch):
    """As one that had imported its module before an edit."""
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "law_of_a_task.py").write_text(
        "from jaximpact.laws import Vesic\nFACTOR = 1.0\n"
        "class Strong(Vesic):\n    def factors(self, friction):\n"
        "        return super().factors(FACTOR * friction)\n"
    )
    module = importlib.import_module("law_of_a_task")
    task = Task(str, Soil(bearing=module.Strong()))
    assert "Strong" in task()
    tasks._unpickled.cache_clear()
    module.FACTOR = 0.9
    with pytest.raises(InputError, match=r"another Strong .*FACTOR=0.9.*anew"):
        task()


def test_a_law_of_a_notebook_is_for_workers_in_its_process_alone(monkeypatch):
    """Such as threads. Other processes have another `__main__`."""
    notebook = types.ModuleType("__main__")
    monkeypatch.setitem(sys.modules, "__main__", notebook)
    exec("from jaximpact.laws import Vesic\nclass Weak(Vesic): pass", vars(notebook))
    task = Task(str, Soil(bearing=notebook.Weak()))
    with ThreadPoolExecutor(1) as pool:
        assert "Weak" in pool.submit(task).result()
    tasks._unpickled.cache_clear()
    monkeypatch.setitem(sys.modules, "__main__", types.ModuleType("__main__"))
    expected = "no class Weak in __main__; put it into a module or a file"
    with pytest.raises(InputError, match=expected):
        task()


def test_results_come_with_their_places_and_few_tasks_wait():
    made, most, found = [], [], {}

    def tasks():
        for number in range(3 * WAITING):
            made.append(number)
            yield lambda number=number: number**2

    def take(place, result):
        found[place] = result
        most.append(len(made) - len(found))

    with ThreadPoolExecutor(2) as pool:
        run_tasks(pool, tasks(), take)
    assert found == {number: number**2 for number in range(3 * WAITING)}
    assert max(most) <= WAITING


def test_an_error_of_a_task_ends_the_work():
    with ThreadPoolExecutor(1) as pool, pytest.raises(ZeroDivisionError):
        run_tasks(pool, [lambda: 1, lambda: 1 // 0], lambda *_: None)


def test_results_of_threads_stand_in_the_order_of_the_items():
    first_waits = threading.Event()

    def work(item):
        if item == 0:
            assert first_waits.wait(10.0)
        first_waits.set()
        return item * 10

    assert run_in_threads(work, [0, 1]) == [0, 10]


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
def test_a_thread_that_fails_ends_the_others(error):
    both_run, turns, lines = threading.Barrier(2, timeout=10.0), [], []

    def work(item):
        both_run.wait()
        if item == 1:
            raise error("enough")
        for turn in range(10_000):
            turns.append(turn)
            tell("still here")
            threading.Event().wait(1e-3)

    with pytest.raises(error, match="enough"), computing(progress=lines.append):
        run_in_threads(work, [0, 1])
    assert len(turns) < 10_000
    assert set(lines) <= {"still here"}


def test_work_tells_who_listens_and_nobody_else():
    lines = []
    with computing(progress=lines.append):
        tell("step")
        with computing():
            tell("of another computation")
        call_each(tell, [("impacts", 1, 3)], lambda *_: None)
    tell("afterwards")
    assert lines == ["step", "1 of 3 impacts"]


def test_a_worker_with_other_versions_or_without_packages_is_told(monkeypatch):
    task = Task(int)
    here = tasks.versions()
    monkeypatch.setattr(tasks, "_versions", lambda: here | {"jax": "0.0.1"})
    expected = f"has jax 0.0.1 in place of {here['jax']}, .* install the same"
    with pytest.raises(InputError, match=expected):
        task()

    def missing():
        raise ModuleNotFoundError("No module named 'jaximpact'", name="jaximpact")

    def missing_in_the_scheduler():
        try:
            missing()
        except ModuleNotFoundError as error:
            raise RuntimeError("Error during deserialization") from error

    for fails in (missing, missing_in_the_scheduler):
        with (
            ThreadPoolExecutor(1) as pool,
            pytest.raises(InputError, match="no module jaximpact; install"),
        ):
            run_tasks(pool, [fails], lambda *_: None)


class Gone(ThreadPoolExecutor):
    """A client of Dask whose scheduler has died: it cancels all futures."""

    def submit(self, task):
        future = concurrent.futures.Future()
        future.cancel()
        future.set_running_or_notify_cancel()
        return future


def test_a_scheduler_that_dies_is_a_loss():
    with Gone(1) as pool, pytest.raises(IncompleteError, match="1 parts lost"):
        run_tasks(pool, [int], lambda *_: None)


@pytest.mark.parametrize(
    ("executor", "message"),
    [("dask", "must have the interface"), (4, "must have the interface")],
)
def test_what_is_no_executor_is_refused(executor, message):
    with pytest.raises(InputError, match=message):
        simulate_batch(BLOCK, Soil(), Impact(), executor=executor)


@pytest.mark.skipif(
    "fork" not in multiprocessing.get_all_start_methods(), reason="no forks here"
)
def test_forks_are_refused():
    fork = multiprocessing.get_context("fork")
    with (
        concurrent.futures.ProcessPoolExecutor(1, mp_context=fork) as pool,
        pytest.raises(InputError, match="by fork, in which JAX hangs"),
    ):
        check_executor(pool)


def test_a_batch_on_an_executor_has_the_same_bits_and_timing():
    timing = {}
    expected = simulate_batch(BLOCK, Soil(), Impact(), ledger=True)
    with ThreadPoolExecutor(2) as pool:
        received = simulate_batch(
            BLOCK, Soil(), Impact(), ledger=True, executor=pool, timing=timing
        )
    assert received.e_n.tobytes() == expected.e_n.tobytes()
    assert received.energy.residual.tobytes() == expected.energy.residual.tobytes()
    assert timing["engine"] == "executor"
    assert timing["impacts"] == 300

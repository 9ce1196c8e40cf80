"""BLAS runs on one thread while a graph runs, whenever it was loaded; afterwards all is as before."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading

import numpy as np  # noqa: F401 - brings a BLAS
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from visint.engine.one_thread import ONE_THREAD

LATE = """
import json, os, sys
import numpy
from threadpoolctl import threadpool_info, threadpool_limits
from visint.engine.one_thread import ONE_THREAD
threads = lambda: [one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"]
threadpool_limits(2, user_api="blas")
before = threads()
with ONE_THREAD:
    import scipy.linalg
    during = threads()
print(json.dumps([before, during, threads()]))
"""


def blas():
    return {one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"}


@pytest.fixture
def two_threads():
    with threadpool_limits(limits=2, user_api="blas"):
        if blas() != {2}:
            pytest.skip("this BLAS does not take two threads")
        yield


def test_one_inside_and_what_it_was_outside(two_threads):
    """Also after an error."""
    inside = []

    def fails():
        with ONE_THREAD:
            inside.append(blas())
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fails()
    assert inside == [{1}]
    assert blas() == {2}


def test_from_any_thread(two_threads):
    """Not only from the one that limited BLAS first."""
    inside = []

    def run():
        with ONE_THREAD:
            inside.append(blas())

    with ONE_THREAD:
        pass
    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    assert inside == [{1}]
    assert blas() == {2}


def test_runs_may_overlap(two_threads):
    """The first to leave does not let go for the others."""
    entered, leave = threading.Event(), threading.Event()

    def other():
        with ONE_THREAD:
            entered.set()
            leave.wait(10)

    thread = threading.Thread(target=other)
    with ONE_THREAD:
        thread.start()
        entered.wait(10)
    assert blas() == {1}
    leave.set()
    thread.join()
    assert blas() == {2}


def test_a_library_loaded_while_a_module_runs_has_one_thread_too():
    """It reads the environment when it is loaded; a first run would differ from the second in its last bits."""
    surroundings = {key: value for key, value in os.environ.items() if not key.endswith("_NUM_THREADS")}
    surroundings["PYTHONPATH"] = os.pathsep.join(path for path in sys.path if path)
    command = [sys.executable, "-c", LATE]
    done = subprocess.run(command, capture_output=True, text=True, env=surroundings, check=True)
    before, during, after = json.loads(done.stdout)
    assert set(during) == {1}
    assert len(during) >= len(before)
    assert after[-1] in (1, *before)


def test_the_environment_is_given_back(monkeypatch):
    """Python's view of it never changes."""
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "3")
    monkeypatch.delenv("MKL_NUM_THREADS", raising=False)
    told = "import os; print(os.environ.get('OPENBLAS_NUM_THREADS'), os.environ.get('MKL_NUM_THREADS'))"
    shown = [sys.executable, "-c", told]
    with ONE_THREAD:
        inside = subprocess.run(shown, capture_output=True, text=True, check=True).stdout.split()
        assert os.environ["OPENBLAS_NUM_THREADS"] == "3"
    outside = subprocess.run(shown, capture_output=True, text=True, check=True).stdout.split()
    assert inside == ["1", "1"]
    assert outside == ["3", "None"]

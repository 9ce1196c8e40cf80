"""One BLAS and OpenCV thread while anything runs: other numbers of threads give other last bits."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from threading import Lock
from types import TracebackType
from typing import Any

__all__ = ["ONE_THREAD"]

_VARIABLES = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS", "OPENCV_FOR_THREADS_NUM")


class _OpenCV:
    """OpenCV, spoken to as threadpoolctl speaks to a BLAS."""

    def get_num_threads(self) -> int:
        return int(sys.modules["cv2"].getNumThreads())

    def set_num_threads(self, count: int) -> None:
        sys.modules["cv2"].setNumThreads(count)


class _OneThread:
    """A context that runs may share: the first to enter limits the libraries, the last to leave lets go.

    Libraries that are there are told; those loaded by a module while it runs read the environment, and stay
    at one thread. Looking for libraries takes a millisecond, so it is done only when Python modules have
    been imported since the last time: nothing else brings a BLAS.
    """

    def __init__(self) -> None:
        self._lock = Lock()
        self._runs = 0
        self._imported = 0
        self._libraries: list[Any] = []
        self._limited: list[tuple[Any, int]] = []
        self._variables: Mapping[str, str | None] = {}

    def __enter__(self) -> None:
        with self._lock:
            self._runs += 1
            if self._runs == 1:
                before = ((name, os.environ.get(name)) for name in _VARIABLES)
                self._variables = {name: value for name, value in before if value != "1"}
                for name in self._variables:
                    os.putenv(name, "1")  # what a library sees; Python's own view of it stays
                self._look()
                threads = ((library, library.get_num_threads()) for library in self._libraries)
                self._limited = [(library, count) for library, count in threads if count != 1]
                for library, _ in self._limited:
                    _set_threads(library, 1)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with self._lock:
            self._runs -= 1
            if self._runs == 0:
                for library, threads in self._limited:
                    _set_threads(library, threads)
                for name, value in self._variables.items():
                    if value is None:
                        os.unsetenv(name)
                    else:
                        os.putenv(name, value)

    def _look(self) -> None:
        from threadpoolctl import ThreadpoolController

        if self._imported != len(sys.modules):
            self._libraries = ThreadpoolController().select(user_api="blas").lib_controllers
            if "cv2" in sys.modules:
                self._libraries.append(_OpenCV())
            self._imported = len(sys.modules)


def _set_threads(library: Any, count: int) -> None:
    """Sets the threads of a library, from whatever thread the run is on.

    threadpoolctl heeds only the Python thread that was the first to set them, as long as that lives.
    """
    release = getattr(library, "clear_controlling_thread", None)
    if release is not None:
        release(force=True)
    library.set_num_threads(count)
    if release is not None:
        release(force=True)


ONE_THREAD = _OneThread()

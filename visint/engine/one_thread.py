"""One BLAS thread while anything runs: other numbers of threads give other last bits."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from threading import Lock
from types import TracebackType
from typing import Any

__all__ = ["ONE_THREAD"]

_VARIABLES = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS", "OPENCV_FOR_THREADS_NUM")


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
        self._controller: Any = None
        self._limits: Any = None
        self._variables: Mapping[str, str | None] = {}

    def __enter__(self) -> None:
        with self._lock:
            self._runs += 1
            if self._runs == 1:
                self._variables = {name: os.environ.get(name) for name in _VARIABLES}
                for name in _VARIABLES:
                    os.putenv(name, "1")  # what a library sees; Python's own view of it stays
                self._limits = self._found().limit(limits=1, user_api="blas")

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with self._lock:
            self._runs -= 1
            if self._runs == 0:
                self._limits.restore_original_limits()
                for name, value in self._variables.items():
                    if value is None:
                        os.unsetenv(name)
                    else:
                        os.putenv(name, value)

    def _found(self) -> Any:
        from threadpoolctl import ThreadpoolController

        if self._controller is None or self._imported != len(sys.modules):
            self._controller = ThreadpoolController()
            self._imported = len(sys.modules)
        return self._controller


ONE_THREAD = _OneThread()

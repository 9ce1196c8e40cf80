"""Start-up times, each in a fresh process, beside the imports that visint puts off."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time
from collections.abc import Mapping

from visint.errors import ModuleError
from visint_lab.engines.contest import Spread

__all__ = ["STARTS", "starts"]

STARTS: Mapping[str, tuple[str, ...]] = {
    "python": ("-c", "pass"),
    "import numpy, pydantic": ("-c", "import numpy, pydantic"),
    "import visint": ("-c", "import visint"),
    "visint --help": ("-m", "visint", "--help"),
    "visint check stereo_sgm": ("-m", "visint", "check", "stereo_sgm"),
}
"""What is started, by how it is told."""


def starts(repeats: int = 7) -> dict[str, Spread]:
    """Milliseconds from start to end, in turn so that all meet the same weather; one round is not counted.

    Raises
    ------
    ModuleError
        If one of them fails.
    """
    each: dict[str, list[float]] = {name: [] for name in STARTS}
    for _ in range(repeats + 1):
        for name, words in STARTS.items():
            each[name].append(_milliseconds(name, words))
    return {name: Spread(statistics.median(ms[1:]), min(ms[1:]), repeats) for name, ms in each.items()}


def _milliseconds(name: str, words: tuple[str, ...]) -> float:
    surroundings = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    begun = time.perf_counter()
    done = subprocess.run(  # noqa: S603 - our own words
        [sys.executable, *words], capture_output=True, text=True, env=surroundings, check=False
    )
    spent = (time.perf_counter() - begun) * 1e3
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["no word"])[-1]
        raise ModuleError.of("VI401", f"{name} failed: {last}")
    return spent

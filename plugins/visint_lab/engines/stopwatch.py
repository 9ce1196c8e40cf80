"""What is timed, in the same way for every engine; it knows numpy alone, for it runs beside each of them.

* **chain**: N nodes, each giving on the float32 image it gets; **loop**: 4 such nodes, round and round.
* Graphs are built, compiled and run a few times before the clock starts; then whole runs are timed, from the
  call with the image to the result in hand, and divided by nodes or turns. An engine without loops is called
  once a turn with the result of the turn before.
* The median says what to expect, the least what the engine costs where nothing else wants the processor.
* **import**: all that building and running takes, numpy apart, which they all need.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

__all__ = ["NODES", "Asked", "asked", "image_of", "measured", "seconds", "told"]

NODES = 4
"""Of the loop."""

Run = Callable[[], object]
Build = Callable[..., Run]


class Asked(NamedTuple):
    """Lengths of the chain, turns of the loop, rows and columns of the image, seconds to spend on each."""

    chains: tuple[int, ...] = (25, 100, 400)
    turns: int = 1000
    size: int = 512
    budget: float = 2.0


def asked(words: list[str]) -> Asked:
    """What stands on the command line."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--chains", type=int, nargs="+", default=Asked().chains)
    parser.add_argument("--turns", type=int, default=Asked().turns)
    parser.add_argument("--size", type=int, default=Asked().size)
    parser.add_argument("--budget", type=float, default=Asked().budget)
    found = parser.parse_args(words)
    return Asked(tuple(found.chains), found.turns, found.size, found.budget)


def image_of(size: int) -> Any:
    """The float32 image that goes round; nobody looks into it."""
    return np.zeros((size, size), np.float32)


def seconds(run: Run, budget: float) -> list[float]:
    """Of each of 3 to 300 runs, as many as the budget allows, after two that do not count."""
    run()
    begun = time.perf_counter()
    run()
    most = int(min(300, max(3, budget / max(time.perf_counter() - begun, 1e-9))))
    return [_one(run) for _ in range(most)]


def _one(run: Run) -> float:
    begun = time.perf_counter()
    run()
    return time.perf_counter() - begun


def measured(chain: Build, loop: Build, wanted: Asked) -> dict[str, Any]:
    """Microseconds a node by length of the chain, and a turn: the median and the least.

    ``chain(nodes, image)`` and ``loop(turns, image)`` build a graph and give a function that runs it once
    and returns the image that came out.
    """
    image = image_of(wanted.size)
    found: dict[str, Any] = {"node": {}, "turn": None}
    for nodes in wanted.chains:
        found["node"][str(nodes)] = _spread(_sound(chain(nodes, image), image), nodes, wanted.budget)
    found["turn"] = _spread(_sound(loop(wanted.turns, image), image), wanted.turns, wanted.budget)
    return found


def _sound(run: Run, image: Any) -> Run:
    """``run``, if the image goes through it whole: a graph that does less would be quick."""
    given: Any = run()
    if np.shape(given) != image.shape or not np.array_equal(given, image):
        raise ValueError("the image did not come out as it went in")
    return run


def _spread(run: Run, parts: int, budget: float) -> dict[str, float]:
    each = [one / parts * 1e6 for one in seconds(run, budget)]
    return {"median": statistics.median(each), "least": min(each), "runs": len(each)}


def told(load: Callable[[], str], chain: Build, loop: Build) -> None:
    """The whole of a peer's script: imports, measures, prints JSON. ``load`` gives the version."""
    begun = time.perf_counter()
    version = load()
    imported = (time.perf_counter() - begun) * 1e3
    found = measured(chain, loop, asked(sys.argv[1:]))
    sys.stdout.write(json.dumps({"version": version, "import": imported, **found}) + "\n")

"""What is timed, in the same way for every engine; it knows numpy alone, for it runs beside each of them.

* **chain**: N nodes, each giving on the float32 image it gets; **loop**: 4 such nodes, round and round.
* Graphs are built, compiled and run a few times before the clock starts; then whole runs are timed, from the
  call with the image to the result in hand, and divided by nodes or turns. An engine without loops is called
  once a turn with the result of the turn before.
* Each is given the same seconds, in three rounds. The median says what to expect, the least what the engine
  costs where nothing else wants the processor.
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

__all__ = ["Asked", "asked", "image_of", "measured", "seconds", "told"]

ROUNDS = 3

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
    """Of each of three runs or more, as many as fit into ``budget`` seconds, after one that does not count."""
    run()
    each: list[float] = []
    ends = time.perf_counter() + budget
    while len(each) < 3 or time.perf_counter() < ends:
        begun = time.perf_counter()
        run()
        each.append(time.perf_counter() - begun)
    return each


def measured(chain: Build, loop: Build, wanted: Asked) -> dict[str, Any]:
    """Microseconds a node by length of the chain, and a turn: the median and the least.

    ``chain(nodes, image)`` and ``loop(turns, image)`` build a graph and give a function that runs it once
    and returns the image that came out. They are timed in three rounds, for a machine has its moods.
    """
    image = image_of(wanted.size)
    runs = {str(nodes): (nodes, _sound(chain(nodes, image), image)) for nodes in wanted.chains}
    runs["turn"] = wanted.turns, _sound(loop(wanted.turns, image), image)
    each: dict[str, list[float]] = {name: [] for name in runs}
    for _ in range(ROUNDS):
        for name, (parts, run) in runs.items():
            each[name] += [one / parts * 1e6 for one in seconds(run, wanted.budget / ROUNDS)]
    spread = {
        name: {"median": statistics.median(all_), "least": min(all_), "runs": len(all_)}
        for name, all_ in each.items()
    }
    return {"turn": spread.pop("turn"), "node": spread}


def _sound(run: Run, image: Any) -> Run:
    """``run``, if the image goes through it whole: a graph that does less would be quick."""
    given: Any = run()
    if np.shape(given) != image.shape or not np.array_equal(given, image):
        raise ValueError("the image did not come out as it went in")
    return run


def told(load: Callable[[], str], chain: Build, loop: Build) -> None:
    """The whole of a peer's script: imports, measures, prints JSON. ``load`` gives the version."""
    begun = time.perf_counter()
    version = load()
    imported = (time.perf_counter() - begun) * 1e3
    found = measured(chain, loop, asked(sys.argv[1:]))
    sys.stdout.write(json.dumps({"version": version, "import": imported, **found}) + "\n")

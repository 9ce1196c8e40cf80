"""The engine of visint, by its public interface: ports checked, every call timed, events sent to an observer.

Besides what is measured of all engines it tells, in milliseconds, of a chain of 100 nodes: **read** (graph
file to spec and bound graph), **bind** (spec to bound graph, every rule checked) and **prepare** (what the
first run of a new graph takes more than the next one).
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

__all__ = ["chain", "load", "loop", "preparation"]

Run = Callable[[], Any]


def load() -> str:
    """All that building, running and a module's models take."""
    import visint
    import visint_lab.engines.relay  # noqa: F401 - timed

    for lazy in ("run", "Builder", "Options"):
        getattr(visint, lazy)
    return visint.__version__


def _chain_of(nodes: int) -> Callable[[], Any]:
    """A function that binds and checks a chain."""
    import visint

    builder = visint.Builder("chain", image="Image")
    last = builder.image
    for i in range(nodes):
        last = builder.add(f"n{i}", "lab.relay", image=last).image
    return lambda: builder.outputs(image=last)


def _looped(turns: int) -> Any:
    import visint

    builder = visint.Builder("loop", image="Image")
    inside = {"loop": builder.loop("turns", times=turns)}
    back = {"image": {"from": "n3.image", "start": "inputs.image"}}
    last = builder.add("n0", "lab.relay", feedback=back, options=inside).image
    for i in range(1, 4):
        last = builder.add(f"n{i}", "lab.relay", image=last, options=inside).image
    return builder.outputs(image=last)


def _running(graph: Any, image: Any) -> Run:
    import visint
    from visint.events import RunFinished

    last = deque[object](maxlen=1)  # an observer that costs next to nothing
    options = visint.Options(observers=(last.append,))

    def run() -> Any:
        result = visint.run(graph, image=image, options=options)
        return result["image"]

    run()
    assert isinstance(last[0], RunFinished)
    return run


def chain(nodes: int, image: Any) -> Run:
    """Built in code."""
    return _running(_chain_of(nodes)(), image)


def loop(turns: int, image: Any) -> Run:
    """Three edges on, and one feedback edge."""
    return _running(_looped(turns), image)


def preparation(image: Any, nodes: int = 100, budget: float = 1.0) -> dict[str, float]:
    """The least milliseconds of read, bind and prepare."""
    import visint
    from visint.io import write_text
    from visint_lab.engines.stopwatch import seconds

    bind = _chain_of(nodes)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "chain.yaml"
        write_text(path, bind().to_yaml())
        read = seconds(lambda: visint.load(path), budget)
    first: list[float] = []
    again: list[float] = []
    for _ in range(10):
        graph = bind()
        for times in (first, again):
            begun = time.perf_counter()
            visint.run(graph, image=image)
            times.append(time.perf_counter() - begun)
    least = {"read": min(read), "bind": min(seconds(bind, budget)), "prepare": min(first) - min(again)}
    return {name: 1e3 * value for name, value in least.items()}


def _tell() -> None:
    import json
    import sys

    begun = time.perf_counter()
    version = load()
    imported = (time.perf_counter() - begun) * 1e3
    from visint_lab.engines.stopwatch import asked, image_of, measured

    wanted = asked(sys.argv[1:])
    found = measured(chain, loop, wanted)
    found |= {
        "version": version,
        "import": imported,
        **preparation(image_of(wanted.size), budget=wanted.budget),
    }
    sys.stdout.write(json.dumps(found) + "\n")


if __name__ == "__main__":
    import numpy  # noqa: F401 - as beside the peers, it does not count as import

    _tell()

"""Kedro: nodes between named datasets, here in memory and not copied. It has no loop: a turn is a run."""

# mypy: disable-error-code="import-not-found"
from __future__ import annotations

import logging
import os
from collections.abc import Callable
from typing import Any


def load() -> str:
    """Pipelines, datasets in memory and the sequential runner; its log of every node is turned off."""
    os.environ["DO_NOT_TRACK"] = "1"
    import kedro
    from kedro.io import DataCatalog, MemoryDataset  # noqa: F401 - timed
    from kedro.pipeline import node, pipeline  # noqa: F401 - timed
    from kedro.runner import SequentialRunner  # noqa: F401 - timed

    logging.getLogger("kedro").setLevel(logging.ERROR)
    return str(kedro.__version__)


def relay(image: Any) -> Any:
    """A node."""
    return image


def _prepared(nodes: int) -> Callable[[Any], Any]:
    from kedro.io import DataCatalog, MemoryDataset
    from kedro.pipeline import node, pipeline
    from kedro.runner import SequentialRunner

    steps = pipeline([node(relay, f"d{i}", f"d{i + 1}", name=f"n{i}") for i in range(nodes)])
    names = [f"d{i}" for i in range(nodes + 1)]
    runner = SequentialRunner()

    def run(image: Any) -> Any:
        catalog = DataCatalog({name: MemoryDataset(copy_mode="assign") for name in names})
        catalog["d0"].save(image)
        given = runner.run(steps, catalog)[names[-1]]
        return given.load() if hasattr(given, "load") else given

    return run


def chain(nodes: int, image: Any) -> Callable[[], Any]:
    """A node, a dataset, a node."""
    run = _prepared(nodes)
    return lambda: run(image)


def loop(turns: int, image: Any) -> Callable[[], Any]:
    """Four nodes, run once a turn."""
    once = _prepared(4)

    def run() -> Any:
        value = image
        for _ in range(turns):
            value = once(value)
        return value

    return run


if __name__ == "__main__":
    from stopwatch import told

    told(load, chain, loop)

"""Haystack: components joined by typed sockets. Loops are connections that lead back."""

# mypy: disable-error-code="import-not-found, untyped-decorator"
from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any


def load() -> str:
    """Pipelines and components; nothing is sent home."""
    os.environ["HAYSTACK_TELEMETRY_ENABLED"] = "False"
    import haystack
    from haystack.core.component.types import GreedyVariadic  # noqa: F401 - timed

    return str(haystack.version.__version__)


def _components() -> tuple[Any, Any, Any]:
    """A node; one that takes the image from outside or from the turn before; one that ends a turn."""
    from haystack import component
    from haystack.core.component.types import GreedyVariadic

    def relay(self: Any, image: Any) -> dict[str, Any]:  # noqa: ARG001 - a method
        return {"image": image}

    def begin(self: Any, image: Any) -> dict[str, Any]:  # noqa: ARG001 - a method
        return {"image": image[0]}

    def end(self: Any, image: Any) -> dict[str, Any]:
        self.turn += 1
        return {"done" if self.turn >= self.turns else "again": image}

    def made(name: str, run: Any, takes: Any, **gives: Any) -> Any:
        run.__name__ = "run"
        run.__annotations__ = {"image": takes, "return": dict}
        return component(type(name, (), {"run": component.output_types(**gives)(run)}))

    import numpy as np

    return (
        made("Relay", relay, np.ndarray, image=np.ndarray),
        made("Begin", begin, GreedyVariadic[np.ndarray], image=np.ndarray),
        made("End", end, np.ndarray, again=np.ndarray, done=np.ndarray),
    )


def chain(nodes: int, image: Any) -> Callable[[], Any]:
    """Connections from component to component."""
    from haystack import Pipeline

    relay, _, _ = _components()
    pipeline, last = Pipeline(), f"n{nodes - 1}"
    for i in range(nodes):
        pipeline.add_component(f"n{i}", relay())
    for i in range(1, nodes):
        pipeline.connect(f"n{i - 1}.image", f"n{i}.image")
    return lambda: pipeline.run({"n0": {"image": image}})[last]["image"]


def loop(turns: int, image: Any) -> Callable[[], Any]:
    """Three connections on, and one back."""
    from haystack import Pipeline

    relay, begin, end = _components()
    pipeline, gate = Pipeline(max_runs_per_component=turns + 1), end()
    for name, node in (("n0", begin()), ("n1", relay()), ("n2", relay()), ("n3", gate)):
        pipeline.add_component(name, node)
    for before, after in (("n0.image", "n1"), ("n1.image", "n2"), ("n2.image", "n3"), ("n3.again", "n0.image")):
        pipeline.connect(before, after)

    def run() -> Any:
        gate.turn, gate.turns = 0, turns
        return pipeline.run({"n0": {"image": image}})["n3"]["done"]

    return run


if __name__ == "__main__":
    from stopwatch import told

    told(load, chain, loop)

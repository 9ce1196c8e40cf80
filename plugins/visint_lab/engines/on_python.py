"""No engine: a loop over functions. What Python itself takes, and what no engine can go below."""

# mypy: disable-error-code="import-not-found"
from __future__ import annotations

import platform
from collections.abc import Callable
from typing import Any


def load() -> str:
    """Nothing to import."""
    return platform.python_version()


def relay(image: Any) -> Any:
    """A node."""
    return image


def chain(nodes: int, image: Any) -> Callable[[], Any]:
    """One call after the other."""
    steps = [relay] * nodes

    def run() -> Any:
        value = image
        for step in steps:
            value = step(value)
        return value

    return run


def loop(turns: int, image: Any) -> Callable[[], Any]:
    """Four calls a turn."""
    steps = [relay] * 4

    def run() -> Any:
        value = image
        for _ in range(turns):
            for step in steps:
                value = step(value)
        return value

    return run


if __name__ == "__main__":
    from stopwatch import told

    told(load, chain, loop)

"""Dask's scheduler without threads on a graph of tasks. It has no loop: a turn is a graph."""

# mypy: disable-error-code="import-not-found, import-untyped"
from __future__ import annotations

from collections.abc import Callable
from typing import Any


def load() -> str:
    """The synchronous scheduler."""
    import dask
    from dask.local import get_sync  # noqa: F401 - timed

    return str(dask.__version__)


def relay(image: Any) -> Any:
    """A node."""
    return image


def _tasks(nodes: int) -> dict[str, Any]:
    return {f"n{i}": (relay, f"n{i - 1}" if i else "given") for i in range(nodes)}


def chain(nodes: int, image: Any) -> Callable[[], Any]:
    """A task a node."""
    from dask.local import get_sync

    tasks, last = {"given": image, **_tasks(nodes)}, f"n{nodes - 1}"
    return lambda: get_sync(tasks, last)


def loop(turns: int, image: Any) -> Callable[[], Any]:
    """Four tasks, got once a turn."""
    from dask.local import get_sync

    tasks = _tasks(4)

    def run() -> Any:
        value = image
        for _ in range(turns):
            value = get_sync({"given": value, **tasks}, "n3")
        return value

    return run


if __name__ == "__main__":
    from stopwatch import told

    told(load, chain, loop)

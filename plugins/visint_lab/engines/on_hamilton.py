"""Hamilton: functions whose parameters name other functions. It has no loop: a turn is an execution."""

# mypy: disable-error-code="import-not-found"
from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any


def load() -> str:
    """The driver, its decorators, and the adapter that gives a plain dict."""
    os.environ["HAMILTON_TELEMETRY_ENABLED"] = "false"
    from hamilton import ad_hoc_utils, base, driver, function_modifiers, version  # noqa: F401 - timed

    return ".".join(str(part) for part in version.VERSION)


def _driver(nodes: int, name: str) -> Any:
    from hamilton import ad_hoc_utils, base, driver
    from hamilton.function_modifiers import parameterize, source

    given = {f"n{i}": {"image": source(f"n{i - 1}" if i else "given")} for i in range(nodes)}

    def relay(image: object) -> object:
        """A node."""
        return image

    relay.__annotations__ = {"image": object, "return": object}
    module = ad_hoc_utils.create_temporary_module(parameterize(**given)(relay), module_name=name)
    adapter = base.SimplePythonGraphAdapter(base.DictResult())
    return driver.Builder().with_modules(module).with_adapter(adapter).build()


def chain(nodes: int, image: Any) -> Callable[[], Any]:
    """One parameterised function."""
    built, last = _driver(nodes, f"chain_{nodes}"), f"n{nodes - 1}"
    return lambda: built.execute([last], inputs={"given": image})[last]


def loop(turns: int, image: Any) -> Callable[[], Any]:
    """Four nodes, executed once a turn."""
    built = _driver(4, "loop")

    def run() -> Any:
        value = image
        for _ in range(turns):
            value = built.execute(["n3"], inputs={"given": value})["n3"]
        return value

    return run


if __name__ == "__main__":
    from stopwatch import told

    told(load, chain, loop)

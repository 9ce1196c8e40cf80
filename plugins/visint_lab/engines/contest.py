"""The contest: every engine in a fresh process, one after the other, and what each said."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from visint.errors import ModuleError, UsageError
from visint_lab.engines.stopwatch import Asked
from visint_lab.peers.running import ONE_THREAD, PATIENCE, available

__all__ = ["OURS", "PEERS", "PYTHON", "Heat", "Spread", "heats", "run_engine"]

OURS, PYTHON = "visint", "python"
PEERS = ("hamilton", "dask", "kedro", "langgraph", "haystack")
FOLDER = Path(__file__).parent


class Spread(NamedTuple):
    """Microseconds: the median of ``runs`` and the least."""

    median: float
    least: float
    runs: int


@dataclass(frozen=True)
class Heat:
    """What one engine took.

    Attributes
    ----------
    engine, version
        Which.
    node
        Microseconds a node by length of the chain.
    turn
        Microseconds a turn of the loop of four.
    imported
        Milliseconds of its imports, numpy apart.
    preparation
        Milliseconds of read, bind and prepare; of this engine alone.
    failure
        Why there is nothing of all this.
    """

    engine: str
    version: str = ""
    node: Mapping[int, Spread] = field(default_factory=dict)
    turn: Spread | None = None
    imported: float = float("nan")
    preparation: Mapping[str, float] = field(default_factory=dict)
    failure: str = ""


def heats(asked: Asked, peers: Sequence[str] = PEERS) -> Iterator[Heat]:
    """Ours, bare Python, then the peers that are installed, each as soon as it is done."""
    for engine in (OURS, PYTHON, *peers):
        try:
            yield run_engine(engine, asked)
        except (ModuleError, UsageError) as error:
            if engine == OURS:
                raise
            yield Heat(engine, failure=error.problems[0].found)


def run_engine(engine: str, asked: Asked) -> Heat:
    """One engine in a process of its own: ours and none with this Python, all others with that of the peers.

    Raises
    ------
    UsageError
        If there is no such engine, or the peers' environment is missing.
    ModuleError
        If it fails; with its last line.
    """
    if engine not in (OURS, PYTHON, *PEERS):
        raise UsageError.of("VI701", f"no engine is named {engine!r}", choices=", ".join(PEERS))
    python = Path(sys.executable) if engine in (OURS, PYTHON) else available()
    script = ["-m", f"visint_lab.engines.on_{engine}"] if engine == OURS else [FOLDER / f"on_{engine}.py"]
    words: list[object] = ["--chains", *map(str, asked.chains), "--turns", asked.turns, "--size", asked.size]
    words += ["--budget", asked.budget]
    told = _told(engine, [str(word) for word in (python, *script, *words)])
    return Heat(
        engine,
        told["version"],
        {int(nodes): Spread(**spread) for nodes, spread in told["node"].items()},
        Spread(**told["turn"]),
        told["import"],
        {name: told[name] for name in ("read", "bind", "prepare") if name in told},
    )


def _told(engine: str, command: list[str]) -> dict[str, Any]:
    surroundings = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    surroundings |= dict.fromkeys(ONE_THREAD, "1")
    if engine == OURS:
        surroundings["PYTHONPATH"] = os.pathsep.join(path for path in sys.path if path)
    try:
        done = subprocess.run(  # noqa: S603 - our own script
            command, capture_output=True, text=True, env=surroundings, timeout=PATIENCE, check=False
        )
    except subprocess.TimeoutExpired:
        raise ModuleError.of("VI401", f"{engine} took longer than {PATIENCE:.0f} s") from None
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["no word"])[-1]
        raise ModuleError.of("VI401", f"{engine} failed: {last}")
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return found

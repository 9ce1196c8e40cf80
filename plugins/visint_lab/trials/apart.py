"""Running a system in a fresh process, so that its time and peak memory are its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import visint
from visint.errors import ModuleError
from visint_lab.datasets.pair import Pair
from visint_lab.peers import Cost
from visint_lab.peers.running import ONE_THREAD, PATIENCE
from visint_lab.trials.reconstruction import Reconstruction
from visint_lab.trials.systems import SystemVariant

__all__ = ["reconstruct_apart"]


def reconstruct_apart(variant: SystemVariant, pair: Pair, light: visint.Light | None = None) -> Reconstruction:
    """As :func:`~visint_lab.trials.systems.reconstruct`, with one thread and the peak memory known.

    Raises
    ------
    ModuleError
        If the process fails; with its last line.
    """
    from visint.io import encode_npz, read_npz, write_bytes, write_text

    with tempfile.TemporaryDirectory() as name:
        asked, images, out = (Path(name) / file for file in ("asked.json", "pair.npz", "maps.npz"))
        write_text(asked, _asked(variant, pair, light))
        known = {"left": pair.left, "right": pair.right, "depth": pair.depth}
        write_bytes(images, encode_npz({key: value for key, value in known.items() if value is not None}))
        told = _told(str(variant), [str(path) for path in (asked, images, out)])
        maps = read_npz(out)
    cost = Cost(**told["cost"])
    found = Reconstruction.of(
        str(variant),
        maps["disparity"],
        pair,
        cost,
        normals=maps["normals"],
        confidence=maps.get("confidence"),
        seconds=told["seconds"],
    )
    return replace(found, density=told["density"])


def _asked(variant: SystemVariant, pair: Pair, light: visint.Light | None) -> str:
    words: dict[str, Any] = {"graph": variant.graph, "control": variant.control, "without": variant.without}
    words |= {"camera": pair.camera.model_dump(), "light": light.model_dump() if light else None}
    return json.dumps(words)


def _told(name: str, arguments: list[str]) -> dict[str, Any]:
    surroundings = {**os.environ, **dict.fromkeys(ONE_THREAD, "1"), "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-m", "visint_lab.trials.child", *arguments]
    done = subprocess.run(  # noqa: S603 - our own module
        command, capture_output=True, text=True, env=surroundings, timeout=PATIENCE, check=False
    )
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["no word"])[-1]
        raise ModuleError.of("VI401", f"{name} failed: {last}")
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return found

"""Starting a peer on a pair, and what it gave and cost."""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from visint.arrays import Array
from visint.errors import ModuleError, UsageError
from visint_lab.datasets.pair import Pair

__all__ = ["NAMES", "Cost", "PeerRun", "available", "run_peer", "stored"]

NAMES = ("StereoBM", "SGBM 3WAY", "SGBM HH", "SGBM 3WAY + WLS", "Pandora", "ELAS")
SCRIPT = Path(__file__).with_name("child.py")
PATIENCE = 600.0
ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


class Cost(NamedTuple):
    """CPU and wall seconds of matching alone, and the process's peak memory in MB."""

    cpu: float
    wall: float
    peak_mb: float


@dataclass(frozen=True, eq=False)
class PeerRun:
    """What a peer gave for a pair: ``disparity`` float32 (H, W), NaN unknown."""

    name: str
    disparity: Array
    cost: Cost


def available() -> Path:
    """The Python of the peers' environment: ``.venv-peers`` here, or what ``VISINT_PEERS`` names.

    Raises
    ------
    UsageError
        If there is none.
    """
    python = Path(os.environ.get("VISINT_PEERS", ".venv-peers")) / "bin" / "python"
    if not python.exists():
        raise UsageError.of("VI701", "the peers are not installed", write="make peers")
    return python


def stored(image: Array) -> Array:
    """uint8 (H, W): a linear image as an 8-bit file holds it, which is what peers are made for."""
    from visint.io import srgb_from_linear

    return srgb_from_linear(image)


def run_peer(name: str, pair: Pair) -> PeerRun:
    """Peer ``name`` on ``pair``, one thread, over the camera's search range (0 to 64 px if it has none).

    Raises
    ------
    UsageError
        If there is no such peer, or the environment is missing.
    ModuleError
        If the peer fails.
    """
    if name not in NAMES:
        raise UsageError.of("VI701", f"no peer is named {name!r}", choices=", ".join(NAMES))
    low, high = pair.camera.disparity_range or (0.0, 64.0)
    with tempfile.TemporaryDirectory() as folder:
        return _started(name, pair, (low, high), Path(folder))


def _started(name: str, pair: Pair, span: tuple[float, float], folder: Path) -> PeerRun:
    from visint.io import encode_npy, read, write_bytes

    files = [folder / f"{part}.npy" for part in ("left", "right", "disparity")]
    for path, image in zip(files, (pair.left, pair.right), strict=False):
        write_bytes(path, encode_npy(stored(image)))
    words = [available(), SCRIPT, name, files[0], files[1], span[0], span[1], files[2]]
    told = _told(name, [str(word) for word in words])
    return PeerRun(name, read(files[2], "Disparity"), Cost(**told))


def _told(name: str, command: list[str]) -> dict[str, float]:
    """What the process says of its costs."""
    surroundings = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    surroundings |= dict.fromkeys(ONE_THREAD, "1")
    try:
        done = subprocess.run(  # noqa: S603 - our own script
            command, capture_output=True, text=True, env=surroundings, timeout=PATIENCE, check=False
        )
    except subprocess.TimeoutExpired:
        raise ModuleError.of("VI401", f"{name} took longer than {PATIENCE:.0f} s") from None
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["no word"])[-1]
        raise ModuleError.of("VI401", f"{name} failed: {last}")
    found: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return found

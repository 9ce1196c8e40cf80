"""One of visint's own systems on one pair, in a process of its own, as the peers run.

``python -m visint_lab.trials.child VARIANT.json PAIR.npz OUT.npz``; says on stdout what it cost.
"""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

import visint
from visint.io import encode_npz, read_json, read_npz, write_bytes
from visint_lab.datasets.pair import Pair
from visint_lab.peers.child import peak_memory
from visint_lab.trials.reconstruction import Reconstruction
from visint_lab.trials.systems import SystemVariant, reconstruct

WARM_ROWS = 48


def main(arguments: list[str]) -> None:
    """The command line."""
    import cv2

    cv2.setNumThreads(1)
    asked, images, out = read_json(arguments[0]), read_npz(arguments[1]), Path(arguments[2])
    variant = SystemVariant(asked["graph"], asked["control"], tuple(asked["without"]))
    camera = visint.Camera(**asked["camera"])
    light = visint.Light(**asked["light"]) if asked["light"] else None
    pair = Pair("apart", images["left"], images["right"], camera, depth=images.get("depth"))
    reconstruct(variant, _top(pair), light)  # imports and compilation are nobody's matching
    found = reconstruct(variant, pair, light)
    write_bytes(out, encode_npz(_maps(found)))
    cost = {**found.cost._asdict(), "peak_mb": peak_memory()}
    sys.stdout.write(
        json.dumps({"cost": cost, "seconds": dict(found.seconds), "density": found.density}) + "\n"
    )


def _top(pair: Pair) -> Pair:
    """The upper rows of a pair: the same arrays' types, little work."""
    rows = min(WARM_ROWS, len(pair.left))
    camera = pair.camera.model_copy(update={"height": rows})
    left, right = (np.ascontiguousarray(image[:rows]) for image in (pair.left, pair.right))
    return replace(pair, left=left, right=right, camera=camera, depth=None)


def _maps(found: Reconstruction) -> dict[str, np.ndarray]:
    maps = {"disparity": found.disparity, "normals": found.normals}
    return maps if found.confidence is None else {**maps, "confidence": found.confidence}


if __name__ == "__main__":
    main(sys.argv[1:])

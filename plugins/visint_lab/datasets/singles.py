"""Single images and surfaces for cues that need no pair: shading, texture, photometric stereo.

Found under ``VISINT_DATA``. Vectors in the files have y up and z towards the viewer; here, as everywhere, y
points down and z away.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from visint.arrays import Array
from visint.errors import InputError, UsageError
from visint.fields import Camera, Light
from visint_lab.datasets.places import data_folder

__all__ = ["Single", "read_single", "single_names"]

TOWARDS_US = np.array([1.0, -1.0, -1.0])


@dataclass(frozen=True, eq=False)
class Single:
    """One object or texture.

    Parameters
    ----------
    images
        float32 (H, W), linear, one for each of ``lights``; empty where there is no photograph.
    mask
        bool (H, W): the object.
    normals, depth
        float32, NaN outside the mask; None if not known.
    """

    name: str
    images: tuple[Array, ...]
    mask: Array
    lights: tuple[Light, ...] = ()
    normals: Array | None = None
    depth: Array | None = None
    camera: Camera | None = None


def single_names() -> tuple[str, ...]:
    """Every name :func:`read_single` knows."""
    return tuple(_KNOWN)


def read_single(name: str) -> Single:
    """The object or texture ``name``: ``texture/brick``, ``photometric/buddha``, ``shading/vase``, …

    Raises
    ------
    UsageError
        If there is no such name.
    InputError
        If the data is not there, or broken.
    """
    if name not in _KNOWN:
        raise UsageError.of("VI701", f"nothing is named {name!r}", choices=", ".join(_KNOWN))
    reader, folder = _KNOWN[name]
    return reader(name, data_folder(folder))


def _texture(name: str, folder: Path) -> Single:
    """A Brodatz texture seen square on; its files are TIFF, which visint itself does not read."""
    import cv2

    from visint.io import linear_from_srgb, read_bytes

    path = folder / f"{name.split('/')[1]}.000.tiff"
    samples = cv2.imdecode(np.frombuffer(read_bytes(path), np.uint8), cv2.IMREAD_GRAYSCALE)
    if samples is None:
        raise InputError.of("VI302", "is no readable TIFF file", where=path.name)
    image = linear_from_srgb(samples.astype(np.float32) / np.float32(255))
    return Single(name, (image,), np.ones(image.shape, dtype=bool))


def _photometric(name: str, folder: Path) -> Single:
    """A statue under some of twelve known lights."""
    from visint.io import read_image, read_text

    rows = read_text(folder.parent / "lights.txt").splitlines()[1:]
    directions = [np.array(row.split(), dtype=float) * TOWARDS_US for row in rows if row.strip()]
    numbers = sorted(int(path.name.split(".")[1]) for path in folder.glob("*.[0-9]*.png"))
    images = tuple(read_image(folder / f"{folder.name}.{number}.png") for number in numbers)
    lights = tuple(Light.distant(*map(float, directions[number])) for number in numbers)
    return Single(name, images, _mask(folder / f"{folder.name}.mask.png"), lights)


def _bunny(name: str, folder: Path) -> Single:
    """A rendered Lambertian bunny with its first light and true normals."""
    image, normals, lights = (_floats(folder / f"{part}.npy") for part in ("image000", "gt_normal", "lights"))
    mask = _mask(folder / "mask.png")
    light = Light.distant(*map(float, lights[0] * TOWARDS_US))
    return Single(name, (image[..., 0].astype(np.float32),), mask, (light,), _normals(normals, mask))


def _gradients(name: str, folder: Path) -> Single:
    """A surface given by a 16-bit normal map alone."""
    from visint.io import read_raster

    stored = read_raster(folder / "normal_map.png")
    mask = _mask(folder / "mask.png")
    return Single(name, (), mask, normals=_normals(stored.samples / stored.top * 2.0 - 1.0, mask))


def _vase(name: str, folder: Path) -> Single:
    """A vase with its rendered depth."""
    from visint.io import read_image

    mask = _mask(folder / "vase_mask.png")
    depth = np.where(mask, _matlab(folder / "vase_depth.mat")["z0"], np.nan).astype(np.float32)
    f, cx, cy = (float(_matlab(folder / "vase_K.mat")["K"][at]) for at in ((0, 0), (0, 2), (1, 2)))
    size = {"width": mask.shape[1], "height": mask.shape[0]}
    camera = Camera(focal_length=f, cx=cx, cy=cy, baseline=1.0, unit="relative", **size)
    return Single(name, (read_image(folder / "vase.png"),), mask, depth=depth, camera=camera)


def _mask(path: Path) -> Array:
    from visint.io import read_raster

    samples = read_raster(path).samples
    return np.asarray((samples if samples.ndim == 2 else samples[..., 0]) > 0)


def _floats(path: Path) -> NDArray[np.float64]:
    """Any array of numbers in an npy file."""
    from visint.io import read_bytes

    loaded: NDArray[np.float64] = np.load(BytesIO(read_bytes(path)), allow_pickle=False)
    return loaded


def _matlab(path: Path) -> Mapping[str, Any]:
    from scipy.io import loadmat

    from visint.io import read_bytes

    found: Mapping[str, Any] = loadmat(BytesIO(read_bytes(path)))
    return found


def _normals(stored: NDArray[np.float64], mask: Array) -> Array:
    turned = stored * TOWARDS_US
    length = np.linalg.norm(turned, axis=-1, keepdims=True)
    seen = mask[..., None] & (length > 0.5)
    return np.where(seen, turned / np.maximum(length, 1e-9), np.nan).astype(np.float32)


_KNOWN: Mapping[str, tuple[Callable[[str, Path], Single], str]] = {
    **{
        f"texture/{n}": (_texture, "extra/texture_brodatz")
        for n in ("brick", "grass", "raffia", "straw", "weave")
    },
    **{f"photometric/{n}": (_photometric, f"extra/psm_uw/{n}") for n in ("buddha", "cat")},
    "shading/bunny": (_bunny, "extra/rps_bunny"),
    "shading/vase": (_vase, "extra/sfs_classic/queau_sfs"),
    **{
        f"gradients/{n}": (_gradients, f"extra/bini_synth/{n}")
        for n in ("Fig4_stripes", "supp_tent", "supp_vase")
    },
    **{f"gradients/{n}": (_gradients, f"extra/diligent_gt/{n}") for n in ("bear", "buddha", "cat", "pot1")},
    "gradients/reading": (_gradients, "extra/diligent_gt/reading"),
}

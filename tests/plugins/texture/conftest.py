"""Textures and planes with known truth for the texture tests."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from visint.arrays import Array
from visint.fields import Camera


@dataclass(frozen=True)
class Plate:
    """A slanted plate: its image, its camera and its unit normal."""

    image: Array
    camera: Camera
    normal: Array


def _unit(slant: float, tilt: float) -> Array:
    return np.array([np.sin(slant) * np.cos(tilt), np.sin(slant) * np.sin(tilt), -np.cos(slant)])


def _frame(normal: Array) -> Array:
    """Rows: two directions in the plane, the image's axes by the shortest turn."""
    x, y, z = -normal
    return np.array([[1 - x * x / (1 + z), -x * y / (1 + z), -x], [-x * y / (1 + z), 1 - y * y / (1 + z), -y]])


@pytest.fixture(scope="session")
def slanted() -> Callable[..., Plate]:
    """(texture, slant, tilt, size, noise) -> the texture seen on a plane, one texel a pixel at the middle."""
    import cv2

    def make(texture: Array, slant: float, tilt: float, size: int = 256, noise: float = 0.01) -> Plate:
        focal, normal, fine = 1.8 * size, _unit(slant, tilt), 3
        line = ((np.arange(size * fine) + 0.5) / fine - size / 2) / focal
        u, v = np.meshgrid(line, line)
        facing = np.minimum(normal[0] * u + normal[1] * v + normal[2], -1e-3)
        depth = normal[2] / facing
        points = np.stack([depth * u, depth * v, depth - 1], axis=-1) * focal
        place = points @ _frame(normal).T + np.array(texture.shape[::-1]) / 2
        sides = 2 * np.array(texture.shape[::-1])
        place = np.mod(place, sides)
        place = np.where(place < sides / 2, place, sides - place).astype(np.float32)
        seen = cv2.remap(texture, place[..., 0], place[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT)
        seen = cv2.resize(seen, (size, size), interpolation=cv2.INTER_AREA)
        seen = seen + noise * np.random.default_rng(0).standard_normal(seen.shape)
        middle = (size - 1) / 2
        camera = Camera(focal_length=focal, cx=middle, cy=middle, baseline=1, width=size, height=size)
        return Plate(np.clip(seen, 0, 1).astype(np.float32), camera, normal)

    return make


@pytest.fixture(scope="session")
def blobs() -> Callable[..., Array]:
    """(seed, frequency) -> an isotropic texture (512, 512) around that frequency, cycles a pixel."""

    def make(seed: int, frequency: float = 0.08) -> Array:
        rng = np.random.default_rng(seed)
        u = np.fft.fftfreq(512)
        distance = np.hypot(u[None, :], u[:, None])
        ring = np.exp(-0.5 * ((distance - frequency) / (0.4 * frequency)) ** 2)
        field = np.fft.ifft2(np.fft.fft2(rng.standard_normal((512, 512))) * ring).real
        return np.clip(0.5 + 0.2 * field / field.std(), 0.02, 1).astype(np.float32)

    return make


@pytest.fixture(scope="session")
def synthetic(blobs: Callable[..., Array]) -> dict[str, Array]:
    """Three textures: a checker, blobs and discs."""
    import cv2

    y, x = np.mgrid[:512, :512]
    checker = np.where((x // 12 + y // 12) % 2, 0.9, 0.3).astype(np.float32)
    rng, discs = np.random.default_rng(102), np.full((512, 512), 0.15, np.float32)
    for left, top, radius, light in rng.uniform((0, 0, 4, 0.55), (512, 512, 8, 0.95), (700, 4)):
        cv2.circle(discs, (int(left * 16), int(top * 16)), int(radius * 16), float(light), -1, cv2.LINE_AA, 4)
    return {"checker": checker, "blobs": blobs(101), "discs": discs}


@pytest.fixture(scope="session")
def brodatz() -> dict[str, Array]:
    """The five Brodatz textures, linear; skips where the data is absent."""
    import cv2

    folder = Path(os.environ.get("VISINT_DATA", Path(__file__).parents[3] / "../shared/data"))
    files = sorted((folder / "extra/texture_brodatz").glob("*.tiff"))
    if not files:
        pytest.skip("extra/texture_brodatz is not among the data; set VISINT_DATA")
    grades = {file.name.split(".")[0]: cv2.imread(str(file), cv2.IMREAD_GRAYSCALE) / 255.0 for file in files}
    return {
        name: np.where(g <= 0.04045, g / 12.92, ((g + 0.055) / 1.055) ** 2.4).astype(np.float32)
        for name, g in grades.items()
    }

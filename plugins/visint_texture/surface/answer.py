"""The answer: what the patches said, put together."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint.fields import NormalsEvidence
from visint_texture.surface.estimate import Estimate
from visint_texture.surface.judgement import judged, tested
from visint_texture.surface.patches import Box
from visint_texture.surface.sites import Sites, spread_out

__all__ = ["Answer"]


class Answer:
    """What the regions said, put together at the sites."""

    def __init__(self, normals: Array, sigma: Array, reliability: Array, clarity: Array) -> None:
        self.normals = normals
        self.sigma = sigma
        self.reliability = reliability
        self.clarity = clarity
        self.patch: Array = np.zeros(clarity.shape, np.int32)
        self.premises: list[dict[str, bool]] = []

    @classmethod
    def empty(cls, shape: tuple[int, int]) -> Answer:
        """Silence at sites of ``shape`` (R, C)."""
        facing = np.broadcast_to(np.array([0.0, 0.0, -1.0]), (*shape, 3)).copy()
        return cls(facing, np.ones(shape), np.zeros(shape), np.zeros(shape))

    def take(self, sites: Sites, estimate: Estimate, box: Box, inside: Array) -> None:
        """One patch's estimate, where it is ``inside`` its box."""
        sigma, reliability = judged(sites, estimate)
        self.premises.append(tested(sites, estimate))
        self.patch[box][inside] = len(self.premises)
        self.normals[box][inside] = estimate.normals[inside]
        self.sigma[box][inside] = sigma[inside]
        self.reliability[box][inside] = reliability[inside]
        self.clarity[box][inside] = estimate.clarity[inside]

    def found(self, name: str, size: tuple[int, int]) -> tuple[Array, Array]:
        """Whether the assumption ``name`` held, bool by label, and the patches int32 (H, W) it is said of."""
        rows = np.arange(size[0]) * self.patch.shape[0] // size[0]
        columns = np.arange(size[1]) * self.patch.shape[1] // size[1]
        held = np.array([False, *(each[name] for each in self.premises)])
        return held, self.patch[rows[:, None], columns[None, :]]

    def over(self, size: tuple[int, int], texture: Array) -> tuple[NormalsEvidence, Array]:
        """Evidence and ambiguity (H, W) over an image of ``size``; silent where ``texture`` is 0."""
        normals = spread_out(self.normals, size)
        x, y, z = (normals[..., k] for k in range(3))
        normals /= np.maximum(np.sqrt(x * x + y * y + z * z), np.float32(1e-6))[..., None]
        reliability = spread_out(self.reliability, size) * (texture > 0)
        evidence = NormalsEvidence.of(normals, spread_out(self.sigma, size), reliability)
        return evidence, np.clip(1 - spread_out(self.clarity, size), 0, 1)

"""What the map knows at the sites."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["Known"]


class Known:
    """The map's normals and confidence at the sites; NaN and 0 where there are none."""

    def __init__(self, normals: Array, confidence: Array) -> None:
        self.normals = normals
        self.confidence = confidence

    @classmethod
    def of(cls, normals: Array | None, confidence: Array | None, shape: tuple[int, int]) -> Known:
        """From the map's normals (H, W, 3) and confidence (H, W), to sites of ``shape``; none give none."""
        import cv2

        if normals is None:
            return cls(np.full((*shape, 3), np.nan), np.zeros(shape))
        size = shape[::-1]
        has = np.isfinite(normals[..., 0]) & np.isfinite(normals[..., 1]) & np.isfinite(normals[..., 2])
        sure: Array = has.astype(np.float32)
        if confidence is not None:
            sure = np.where(has, confidence, 0).astype(np.float32)
        # A site leans on its surest pixels.
        pull = sure + has * np.float32(1e-6)
        layers = [np.where(has, normals[..., k], 0) * pull for k in range(3)]
        pulled = cv2.merge([layer.astype(np.float32, copy=False) for layer in layers])
        total = cv2.resize(pulled, size, interpolation=cv2.INTER_AREA)
        length = np.linalg.norm(total, axis=-1, keepdims=True)
        with np.errstate(divide="ignore", invalid="ignore"):
            mean = np.where(length > 0, total / length, np.nan).astype(np.float64)
        share = cv2.resize(sure, size, interpolation=cv2.INTER_AREA)
        return cls(mean.reshape(*shape, 3), share.reshape(shape).astype(np.float64))

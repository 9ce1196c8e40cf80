"""Signs by which candidates are told apart without the truth."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint_bayes.joint.energy import bends_of, slopes_of
from visint_bayes.joint.photometry import GRADES, masked_blur, views_of
from visint_bayes.joint.pool import Pool
from visint_bayes.joint.setting import Pair, blur_for
from visint_bayes.joint.slant import lighting

__all__ = ["SIGNS", "signs_of"]

SIGNS = (
    "photometric residual",
    "shading residual",
    "shading residual in the right view",
    "change",
    "roughness",
    "distance from the median",
    "outside",
)
"""One candidate's own, less those of the stereo; then come those of the scene."""
BLUR = 1.8
"""The views are compared at another blur than the one the candidates were fitted at."""


def signs_of(pool: Pool, pair: Pair) -> Array:
    """float64 (K, F): a row a candidate, its own signs followed by those of the scene.

    Not finite where something could not be measured; such a candidate is not to be chosen.
    """
    stereo = pool.setting.stereo.astype(np.float64)
    judge = _Judge(pool, pair)
    before = judge.measured(stereo)
    middle = np.median(np.stack(list(pool.surfaces.values())), axis=0)
    rows = []
    for surface in pool.surfaces.values():
        own = judge.measured(surface)
        change, apart = judge.distance(surface, stereo), judge.distance(surface, middle)
        rows.append([*(own[:3] - before[:3]), change, own[3] - before[3], apart, own[4] - before[4]])
    about = [*before[:4], *_of_scene(pool, judge)]
    return np.array([[*row, *about] for row in rows])


def _of_scene(pool: Pool, judge: _Judge) -> list[float]:
    """Noise, size, classes of albedo, parts that shine or are hidden, and how far the candidates differ."""
    inside, setting = pool.setting.domain.inside, pool.setting
    found = pool.reflectance if setting.brightness is not None else None
    first = pool.surfaces["plate"]
    others = [pool.surfaces.get(name, first) for name in ("loose", "bright", "round")]
    return [
        np.log(pool.noise + 0.003),
        np.log(setting.zoom),
        float(len(found.albedo)) if found else 0.0,
        np.log(found.misfit + 0.02) if found else 0.0,
        float(found.shine[inside].mean()) if found else 0.0,
        float(setting.hidden[inside].mean()),
        *(judge.distance(other, first) for other in others),
    ]


class _Judge:
    """Measures surfaces on one pair."""

    def __init__(self, pool: Pool, pair: Pair) -> None:
        masks = (pair.inside, pair.inside_right)
        self.views = views_of((pair.left, pair.right), masks, pool.noise, BLUR)
        self.setting, self.light = pool.setting, pair.light
        self.inside = pair.inside
        self.right = _brightness(pair, max(blur_for(pool.noise), 1.2))
        self.albedo = _albedo(pool)

    def distance(self, one: Array, other: Array) -> float:
        """Log of the rms difference inside the mask, px."""
        return float(np.log(np.sqrt(np.mean((one - other)[self.inside] ** 2)) + 0.02))

    def measured(self, surface: Array) -> Array:
        """Photometric residual, shading residuals left and right, roughness, part outside the right mask."""
        photometric, outside = self._photometric(surface)
        bends = bends_of(self.setting.domain, surface)[self.inside]
        rough = 0.5 * np.log(np.mean((bends**2).sum(axis=-1)) + 1e-6)
        return np.array([photometric, *self._shading(surface), rough, outside])

    def _photometric(self, surface: Array) -> tuple[float, float]:
        met, residual = self._warped(self.views.inside_right, surface), None
        residual = self._warped(self.views.right, surface) - self.views.left
        there = self.inside & (met > 0.6)
        squared = residual[there] ** 2
        bad = squared / (squared + 9 * self.views.variance)
        return float(bad.mean()) if bad.size else np.nan, float(1 - there.sum() / self.inside.sum())

    def _shading(self, surface: Array) -> tuple[float, float]:
        known = self.setting.brightness
        if known is None or self.light is None:
            return 0.0, 0.0
        slopes = slopes_of(self.setting.domain, surface)
        cosine = lighting(surface, slopes, self.setting.camera, self.light).cosine
        seen = self._warped(self.right, surface) / self.albedo
        return _misfit(known.incidence - cosine), _misfit(
            np.where(np.isfinite(known.incidence), seen, np.nan) - cosine
        )

    def _warped(self, image: Array, surface: Array) -> Array:
        from visint_bayes.joint.matching import _kernels

        value, spare = np.empty_like(surface), np.empty_like(surface)
        _kernels.warp(image, surface, -1.0, value, spare)
        return value


def _misfit(difference: Array) -> float:
    """Mean of a robust measure of differences of n·l."""
    squared = difference[np.isfinite(difference)] ** 2
    return float(np.mean(squared / (squared + 0.1**2))) if squared.size else np.nan


def _brightness(pair: Pair, blur: float) -> Array:
    image = GRADES * np.nan_to_num(pair.right)
    return masked_blur(image, pair.inside_right.astype(np.float32), blur) / np.float32(GRADES)


def _albedo(pool: Pool) -> Array:
    found = pool.reflectance
    if found is None:
        return np.ones(pool.setting.stereo.shape)
    return np.concatenate([[np.nan], found.albedo])[found.labels]

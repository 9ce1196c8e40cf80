"""How far off the blend may be, pixel by pixel: signs of doubt, and the sigma they were found to mean."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from visint.arrays import Array
from visint_bayes.joint.energy import Recipe, data_precision, slopes_of
from visint_bayes.joint.pool import Pool
from visint_bayes.joint.slant import normals_of_slopes

__all__ = ["SIGNS", "Doubt", "doubts_of", "shipped_doubt"]

SIGNS = ("disagreement", "disagreement of normals", "plate", "hidden", "slant", "rim")
FILE = "doubt.json"


@dataclass(frozen=True, slots=True)
class Doubt:
    """Log sigma as a linear function of the signs: of disparity and of normals, (F + 1,), constant last."""

    disparity: Array
    normals: Array

    def sigma(self, doubts: Array) -> tuple[Array, Array]:
        """Sigma of disparity (px) and of the normals' angle (radians), float32 (H, W), from (H, W, F)."""
        found = [
            np.exp(np.clip(doubts @ one[:-1] + one[-1], -9, 5)).astype(np.float32)
            for one in (self.disparity, self.normals)
        ]
        return found[0], np.minimum(found[1], np.float32(np.pi / 2))


@cache
def shipped_doubt(which: str) -> Doubt:
    """The one fitted for ``lit`` or ``dark`` scenes; without a fit what the signs say by themselves."""
    from json import loads

    from visint.io import resource_text

    known: dict[str, Any] = loads(resource_text("visint_bayes", "joint", FILE))
    if which not in known:
        return Doubt(np.eye(len(SIGNS) + 1)[0], np.eye(len(SIGNS) + 1)[1])
    return Doubt(*(np.asarray(known[which][name], float) for name in ("disparity", "normals")))


def doubts_of(pool: Pool, parts: Array, blend: Array) -> Array:
    """float32 (H, W, F): the logs of three standard deviations, and signs of where they are too small.

    Disagreement of the weighted candidates (px, radians); the standard deviation a plate would have that rests
    on this much data, 1/√(8 √(P λ)), the biharmonic Green's function at its source; whether the right view
    sees it; slant; nearness of the rim.
    """
    setting = pool.setting
    slopes = slopes_of(setting.domain, blend)
    normals = normals_of_slopes(blend, slopes, setting.camera)
    around = _around(data_precision(setting, blend), 4 * setting.zoom)
    recipe = Recipe(0.003)
    plate = 1 / np.sqrt(8 * np.sqrt((around + recipe.anchor) * recipe.plate * setting.zoom**2))
    apart, turned = _disagreement(pool, parts, blend, normals)
    signs = [
        np.log(apart + 0.02),
        np.log(turned + 0.01),
        np.log(plate),
        setting.hidden,
        np.log(_facing(normals)),
    ]
    return np.stack([*signs, _rim(setting.domain.inside, 3 * setting.zoom)], axis=-1).astype(np.float32)


def _disagreement(pool: Pool, parts: Array, blend: Array, normals: Array) -> tuple[Array, Array]:
    """Weighted rms difference of candidates and stereo from the blend: of disparity, and of normals."""
    setting = pool.setting
    surfaces = [*pool.surfaces.values(), setting.stereo.astype(np.float64)]
    weights = np.append(parts, 1 - parts.sum()) + 0.1 / len(surfaces)
    far, turned = np.zeros(blend.shape), np.zeros(blend.shape)
    for weight, surface in zip(weights, surfaces, strict=True):
        other = normals_of_slopes(surface, slopes_of(setting.domain, surface), setting.camera)
        far += weight * (surface - blend) ** 2
        turned += weight * ((other - normals) ** 2).sum(axis=-1)
    return np.sqrt(_around(far, 1.5)), np.sqrt(_around(np.nan_to_num(turned), 1.5))


def _around(values: Array, reach: float) -> Array:
    import cv2

    return np.maximum(np.asarray(cv2.GaussianBlur(values.astype(np.float32), (0, 0), max(reach, 0.5))), 0)


def _facing(normals: Array) -> Array:
    return np.asarray(np.clip(np.nan_to_num(-normals[..., 2], nan=0.05), 0.05, 1))


def _rim(inside: Array, reach: float) -> Array:
    """1 at the rim of the mask, falling to 0 within some pixels."""
    return np.asarray(np.clip(2 * (1 - _around(inside.astype(np.float32), reach)), 0, 1) * inside)

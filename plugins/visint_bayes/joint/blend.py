"""From a pair to one surface with its uncertainty: the candidates, weighed."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint_bayes.joint.choice import shipped, weights_of
from visint_bayes.joint.doubt import doubts_of, shipped_doubt
from visint_bayes.joint.energy import slopes_of
from visint_bayes.joint.pool import Pool, candidates
from visint_bayes.joint.scales import LARGEST, enlarged, halved
from visint_bayes.joint.setting import Pair
from visint_bayes.joint.signs import signs_of
from visint_bayes.joint.slant import normals_of_slopes

__all__ = ["Blend", "blended"]


class Blend(NamedTuple):
    """The surface inside the foreground, (H, W) float32: disparity and its sigma, px; normals (H, W, 3) and
    their sigma, radians. ``parts`` (K,) of the candidates, ``pool`` and ``signs`` (K, F) behind them.
    """

    disparity: Array
    sigma: Array
    normals: Array
    turned: Array
    parts: Array
    pool: Pool
    signs: Array


def blended(pair: Pair, amplitude: float = 1.0) -> Blend:
    """The blend of the candidates, solved at no more than :data:`~visint_bayes.joint.scales.LARGEST` px a side.

    Parameters
    ----------
    amplitude
        Of shading: 0 takes it out of the energy and keeps everything else.
    """
    if max(pair.left.shape) > LARGEST:
        small = halved(pair)
        return _enlarged(blended(small, amplitude), small.inside, pair.left.shape)
    pool = candidates(pair, amplitude)
    signs = signs_of(pool, pair)
    which = "dark" if pool.setting.brightness is None else "lit"
    parts = weights_of(shipped(which), signs)
    stereo = pool.setting.stereo.astype(np.float64)
    surface = stereo + sum(
        part * (one - stereo) for part, one in zip(parts, pool.surfaces.values(), strict=True)
    )
    surface = _with_hidden(surface, pool)
    normals = normals_of_slopes(surface, slopes_of(pool.setting.domain, surface), pair.camera)
    sigma, turned = shipped_doubt(which).sigma(doubts_of(pool, parts, surface))
    return Blend(surface.astype(np.float32), sigma, normals, turned, parts, pool, signs)


def _with_hidden(surface: Array, pool: Pool) -> Array:
    """What the right view does not see follows brightness where one albedo explains it, else stereo."""
    import cv2

    setting, found = pool.setting, pool.reflectance
    one = found is not None and len(found.albedo) == 1
    filling = pool.surfaces.get("round", setting.stereo) if one else setting.stereo
    strip = (setting.hidden & ~setting.adrift & ~setting.unseen).astype(np.float32)
    part = cv2.GaussianBlur(strip, (0, 0), max(setting.zoom, 0.7))
    return np.asarray(surface + np.minimum(1.5 * part, 1) * (filling - surface))


def _enlarged(small: Blend, inside: Array, size: tuple[int, ...]) -> Blend:
    """The blend at twice its size: what it knows ``inside`` goes up linearly, the image decides the mask."""
    disparity, sigma, turned = (
        enlarged(one, inside, size) for one in (small.disparity, small.sigma, small.turned)
    )
    normals = enlarged(np.nan_to_num(small.normals), inside, size)
    with np.errstate(invalid="ignore", divide="ignore"):
        normals = normals / np.linalg.norm(normals, axis=-1, keepdims=True)
    return small._replace(disparity=2 * disparity, sigma=2 * sigma, normals=normals, turned=turned)

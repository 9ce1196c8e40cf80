"""Several textures in one field of moments: split where one smooth law does not explain it."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["split"]

FEWEST = 24
"""Sites that a part must have: six numbers describe its law."""


def split(logs: Array, weight: Array, labels: Array, jump: float, depth: int = 3) -> Array:
    """Labels int (R, C) from 1, each part of ``labels`` split in two as long as that explains much more.

    ``logs`` (R, C, 3) log moments, which change smoothly (here: quadratically) over one texture, whatever its
    surface; ``jump`` by how much two textures must differ where they meet.
    """
    found, count = np.zeros_like(labels), 0
    for label in range(1, int(labels.max(initial=0)) + 1):
        for part in _parts(logs, weight, labels == label, jump, depth):
            count += 1
            found[part] = count
    return found


def _parts(logs: Array, weight: Array, inside: Array, jump: float, depth: int) -> list[Array]:
    if depth == 0 or np.count_nonzero(inside) < 2 * FEWEST:
        return [inside]
    design, rows = _design(inside), logs[inside]
    mass = weight[inside]
    second = _two_laws(design, rows, mass)
    halves = [_tidied(inside, second == k) for k in (False, True)]
    if min(np.count_nonzero(half) for half in halves) < FEWEST or _gap(design, rows, mass, second) < jump:
        return [inside]
    return [part for half in halves for part in _parts(logs, weight, half, jump, depth - 1)]


def _two_laws(design: Array, rows: Array, mass: Array) -> Array:
    """Bool (N,): which of two laws explains each site; begun from the two sides of the strongest direction."""
    centred = rows - np.average(rows, axis=0, weights=mass)
    _, _, axes = np.linalg.svd(centred * np.sqrt(mass)[:, None], full_matrices=False)
    score = centred @ axes[0]
    second = score > np.median(score)
    for _ in range(12):
        # Few coefficients first: two curved laws could share out one texture between them.
        laws = [_law(design[:, :3], rows, mass * (second == k)) for k in (False, True)]
        misfit = [((rows - design[:, :3] @ law) ** 2).sum(axis=1) for law in laws]
        changed = misfit[1] < misfit[0]
        if (changed == second).all():
            break
        second = changed
    return np.asarray(second)


def _gap(design: Array, rows: Array, mass: Array, second: Array) -> float:
    """How far the sites are from one common curved law, over how far from two straight ones, as a jump.

    The root mean square that one law leaves, if two leave less than half of it; else 0.
    """
    whole = rows - design @ _law(design, rows, mass)
    apart = np.empty_like(rows)
    for k in (False, True):
        law = _law(design[:, :3], rows, mass * (second == k))
        apart[second == k] = (rows - design[:, :3] @ law)[second == k]
    one, two = (np.average((r**2).sum(axis=1), weights=mass) for r in (whole, apart))
    return float(2 * np.sqrt(one)) if two < 0.4 * one else 0.0


def _law(design: Array, rows: Array, mass: Array) -> Array:
    held = design * mass[:, None]
    return np.asarray(np.linalg.solve(held.T @ design + 1e-6 * np.eye(design.shape[1]), held.T @ rows))


def _design(inside: Array) -> Array:
    """(N, 6): 1, x, y, x², xy, y² of the sites, x and y within ±1."""
    y, x = (
        2.0 * index / max(size - 1, 1) - 1 for index, size in zip(np.nonzero(inside), inside.shape, strict=True)
    )
    return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=1)


def _tidied(inside: Array, chosen: Array) -> Array:
    """One law's sites as an area: the majority among neighbours, its largest connected part."""
    import cv2
    from scipy.ndimage import label

    here = np.zeros(inside.shape, np.float32)
    here[inside] = np.where(chosen, 1, -1)
    area = (cv2.boxFilter(here, -1, (3, 3), borderType=cv2.BORDER_CONSTANT) > 0) & inside
    parts, count = label(area)
    if count < 2:
        return area
    return np.asarray(parts == np.bincount(parts[parts > 0]).argmax())

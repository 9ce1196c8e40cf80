# mypy: ignore-errors
# ruff: noqa: PLR0917 - kernels take what they need
"""Compiled loops of the shading plugin: noise, means inside regions, directions, and sums by region.

All arrays are C-contiguous and read-only unless named ``out``; labels are int32 (H, W), 0 takes no part.
"""

import numpy as np
from numba import njit

__all__ = ["agreement_sums", "cosines", "directions", "evened", "fine_responses", "fitted"]
__all__ += ["normals_of_slopes", "planes", "relative_slopes", "turned"]


@njit(cache=True, nogil=True, error_model="numpy")
def evened(joined, decay, out):
    """Recursive mean along columns, down and up, that stops where ``joined`` is 0.

    Parameters: ``joined`` float32 (H, W), 1 where a pixel belongs with the one above it. ``decay`` is what a
    neighbour keeps (Gastal and Oliveira 2011, doi:10.1145/2010324.1964964, Eq. 21, label changes as edges of
    infinite height). ``out`` float32 (C, H, W) is changed in place; a constant stays what it is.
    """
    channels, rows, columns = out.shape
    for k in range(channels):
        plane = out[k]
        for y in range(1, rows):
            above, here, together = plane[y - 1], plane[y], joined[y]
            for x in range(columns):
                here[x] += decay * together[x] * (above[x] - here[x])
        for y in range(rows - 2, -1, -1):
            below, here, together = plane[y + 1], plane[y], joined[y + 1]
            for x in range(columns):
                here[x] += decay * together[x] * (below[x] - here[x])


@njit(cache=True, nogil=True, error_model="numpy")
def fine_responses(image, out):
    """Sizes of the response to the outer product of (1, −2, 1) with itself, where all nine lie inside (0, 1).

    ``out`` float32 (H W,); how many there are is returned.
    """
    rows, columns = image.shape
    two, four = np.float32(2), np.float32(4)  # integers would make it float64
    count = 0
    for y in range(1, rows - 1):
        a, b, c = image[y - 1], image[y], image[y + 1]
        for x in range(1, columns - 1):
            low = min(a[x - 1], a[x], a[x + 1], b[x - 1], b[x], b[x + 1], c[x - 1], c[x], c[x + 1])
            high = max(a[x - 1], a[x], a[x + 1], b[x - 1], b[x], b[x + 1], c[x - 1], c[x], c[x + 1])
            total = a[x - 1] - two * a[x] + a[x + 1] - two * b[x - 1] + four * b[x] - two * b[x + 1]
            response = abs(total + c[x - 1] - two * c[x] + c[x + 1])
            out[count] = response
            if low > 0.0 and high < 1.0 and response < 1e9:
                count += 1
    return count


@njit(cache=True, nogil=True, error_model="numpy")
def directions(vector, near, depth, across, down, focal, out):
    """Unit vectors from the surface at ``depth`` to a light at the point ``vector`` (``near``), or so far away.

    Parameters: ``across`` (W,) and ``down`` (H,), pixels from the principal point. ``out`` float32 (H, W, 3).
    """
    rows, columns = depth.shape
    for y in range(rows):
        for x in range(columns):
            if near:
                z = depth[y, x]
                a = vector[0] - z * across[x] / focal
                b = vector[1] - z * down[y] / focal
                c = vector[2] - z
                size = 1.0 / np.sqrt(a * a + b * b + c * c)
                out[y, x, 0], out[y, x, 1], out[y, x, 2] = a * size, b * size, c * size
            else:
                out[y, x, 0], out[y, x, 1], out[y, x, 2] = vector[0], vector[1], vector[2]


@njit(cache=True, nogil=True, error_model="numpy")
def normals_of_slopes(slopes, across, down, focal, out):
    """n ∝ (f p, f q, −(1 + x p + y q)) of slopes (2, H, W) of ln Z a pixel; ``out`` float32 (H, W, 3)."""
    rows, columns = slopes.shape[1:]
    for y in range(rows):
        for x in range(columns):
            p, q = slopes[0, y, x], slopes[1, y, x]
            a, b = focal * p, focal * q
            c = -max(1.0 + across[x] * p + down[y] * q, 1e-3)
            size = 1.0 / np.sqrt(a * a + b * b + c * c)
            if not np.isfinite(p + q):
                size = np.nan
            out[y, x, 0], out[y, x, 1], out[y, x, 2] = a * size, b * size, c * size


@njit(cache=True, nogil=True, error_model="numpy")
def cosines(normals, light, out):
    """n·l: (H, W, 3) and (H, W, 3) to float32 (H, W)."""
    rows, columns = out.shape
    for y in range(rows):
        for x in range(columns):
            out[y, x] = (
                normals[y, x, 0] * light[y, x, 0]
                + normals[y, x, 1] * light[y, x, 1]
                + normals[y, x, 2] * light[y, x, 2]
            )


@njit(cache=True, nogil=True, error_model="numpy")
def turned(normals, light, cosine, out, clear):
    """Normals turned in the plane they span with the light until their cosine is ``cosine``.

    ``out`` float32 (H, W, 3), NaN where that faces away from the camera; ``clear`` (H, W): the sine between the
    given normal and the light.
    """
    rows, columns = cosine.shape
    for y in range(rows):
        for x in range(columns):
            i, j, k = light[y, x, 0], light[y, x, 1], light[y, x, 2]
            a, b, c = normals[y, x, 0], normals[y, x, 1], normals[y, x, 2]
            towards = a * i + b * j + c * k
            a, b, c = a - towards * i, b - towards * j, c - towards * k
            aside = np.sqrt(a * a + b * b + c * c)
            clear[y, x] = aside
            wanted = min(max(cosine[y, x], -1.0), 1.0)
            lean = np.sqrt(1.0 - wanted * wanted) / aside if aside > 1e-6 else 0.0
            a, b, c = wanted * i + lean * a, wanted * j + lean * b, wanted * k + lean * c
            size = 1.0 / np.sqrt(a * a + b * b + c * c)
            if not c < 0.0 or not np.isfinite(aside + cosine[y, x]):
                size = np.nan
            out[y, x, 0], out[y, x, 1], out[y, x, 2] = a * size, b * size, c * size


@njit(cache=True, nogil=True, error_model="numpy")
def planes(nearness, labels, flat, tolerance, rounds, sums, out):
    """The plane nearness = a u + b v + c of each region that ``flat`` names, by reweighted least squares.

    Parameters: ``nearness`` float32 (H, W), NaN unknown; ``tolerance`` in parts of nearness, beyond which a
    pixel counts little; ``sums`` float64 (N + 1, 10), work space; ``out`` float64 (N + 1, 4): a, b, c and 1 if
    found. u and v count from the image's middle in its widths.
    """
    rows, columns = nearness.shape
    for turn in range(rounds):
        sums[:] = 0.0
        for y in range(rows):
            v = (y - 0.5 * rows) / columns
            for x in range(columns):
                label = labels[y, x]
                if label == 0 or not flat[label]:
                    continue
                z = nearness[y, x]
                if not z > 0.0:
                    continue
                u = x / columns - 0.5
                w = 1.0
                if turn > 0:
                    o = out[label]
                    r = ((o[0] * u + o[1] * v + o[2]) / z - 1.0) / tolerance
                    w = 1.0 / (1.0 + r * r) ** 2
                s = sums[label]
                s[0] += w * u * u
                s[1] += w * u * v
                s[2] += w * u
                s[3] += w * v * v
                s[4] += w * v
                s[5] += w
                s[6] += w * u * z
                s[7] += w * v * z
                s[8] += w * z
                s[9] += 1.0
        for label in range(1, out.shape[0]):
            s, o = sums[label], out[label]
            if s[9] < 12.0 or not s[5] > 1e-9:
                o[3] = 0.0
                continue
            n = s[5]
            mu, mv, mz = s[2] / n, s[4] / n, s[8] / n
            uu, uv, vv = s[0] / n - mu * mu + 1e-9, s[1] / n - mu * mv, s[3] / n - mv * mv + 1e-9
            uz, vz = s[6] / n - mu * mz, s[7] / n - mv * mz
            det = uu * vv - uv * uv
            o[0] = (vv * uz - uv * vz) / det
            o[1] = (uu * vz - uv * uz) / det
            o[2] = mz - o[0] * mu - o[1] * mv
            o[3] = 1.0


@njit(cache=True, nogil=True, error_model="numpy")
def relative_slopes(nearness, weight, labels, out):
    """Slopes of ln Z a pixel from ``nearness`` 1/Z (NaN unknown), inside regions only.

    ``out`` float32 (3, H, W): weighted p = ∂lnZ/∂u, q = ∂lnZ/∂v, and the weight; 0 where nothing is known.
    """
    rows, columns = nearness.shape
    for y in range(rows):
        for x in range(columns):
            here = nearness[y, x]
            out[0, y, x] = out[1, y, x] = out[2, y, x] = 0.0
            label = labels[y, x]
            if label == 0 or not here > 0.0:
                continue
            known = True
            for axis in range(2):
                total, count = 0.0, 0
                for side in (-1, 1):
                    j, i = (y, x + side) if axis == 0 else (y + side, x)
                    if 0 <= j < rows and 0 <= i < columns and labels[j, i] == label:
                        there = nearness[j, i]
                        if there > 0.0:
                            total += side * (there - here)
                            count += 1
                if count == 0:
                    known = False
                else:
                    out[axis, y, x] = -total / count / here * weight[y, x]
            if known:
                out[2, y, x] = weight[y, x]
            else:
                out[0, y, x] = out[1, y, x] = 0.0


@njit(cache=True, nogil=True, error_model="numpy")
def fitted(brightness, cosine, weight, labels, tolerance, rounds, out):
    """Albedo a region by robust regression of brightness on ``cosine`` through the origin.

    ``out`` float64 (N + 1,): start (0: least squares) and result. Geman-McClure weights with residuals of
    ``tolerance`` times the albedo.
    """
    top = np.zeros(out.size)
    bottom = np.zeros(out.size)
    rows, columns = labels.shape
    for _ in range(rounds):
        top[:] = 0.0
        bottom[:] = 0.0
        for y in range(rows):
            for x in range(columns):
                label = labels[y, x]
                w = weight[y, x]
                if label == 0 or not w > 0.0:
                    continue
                c = cosine[y, x]
                e = brightness[y, x]
                if out[label] > 0.0:
                    r = (e / out[label] - c) / tolerance
                    w /= (1.0 + r * r) ** 2
                top[label] += w * e * c
                bottom[label] += w * c * c
        for label in range(out.size):
            if bottom[label] > 0.0:
                out[label] = top[label] / bottom[label]


@njit(cache=True, nogil=True, error_model="numpy")
def agreement_sums(even, wide, cosine, shade, labels, least, out):
    """Sums a region for the test of the model, over pixels whose ``cosine`` is at least ``least``.

    Parameters: ``even`` brightness, ``wide`` the same evened as widely as the normals behind ``cosine`` (both
    NaN unknown), ``shade`` cosine and ambient. ``out`` float64 (N + 1, 9): pixels, sums of E, E², c, c², E·c,
    of r and r² with r = E/shade, and of the squared difference of ``even`` and E; E is ``wide``.
    """
    rows, columns = labels.shape
    for y in range(rows):
        for x in range(columns):
            label = labels[y, x]
            c = cosine[y, x]
            if label == 0 or not c >= least:
                continue
            e = wide[y, x]
            if not e > 0.0:
                continue
            r = e / shade[y, x]
            d = even[y, x] - e
            row = out[label]
            row[0] += 1.0
            row[1] += e
            row[2] += e * e
            row[3] += c
            row[4] += c * c
            row[5] += e * c
            row[6] += r
            row[7] += r * r
            row[8] += d * d

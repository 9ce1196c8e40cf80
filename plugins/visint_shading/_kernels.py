# mypy: ignore-errors
# ruff: noqa: PLR0917 - kernels take what they need
"""Compiled loops of the shading plugin: means inside regions, sums by region, and heights along least cost.

All arrays are C-contiguous and read-only unless named ``out``; labels are int32 (H, W), 0 takes no part.
"""

import numpy as np
from numba import njit

__all__ = ["agreement_sums", "conics", "cosines", "directions", "evened", "fitted", "heights"]
__all__ += ["normals_of_slopes", "planes", "relative_slopes", "turned"]


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
def conics(cosine, light, across, down, focal, margin, out):
    """A, B, C, D, E of the ellipse of gradients at each pixel: see ``heights.gradients``; ``out`` (5, H, W)."""
    rows, columns = cosine.shape
    for y in range(rows):
        v = down[y]
        for x in range(columns):
            u = across[x]
            i, j, k = light[y, x, 0], light[y, x, 1], light[y, x, 2]
            facing = min((i * u + j * v) / focal + k, -1e-3)
            size = -1.0 / facing
            a, b = i * focal - k * u, j * focal - k * v
            oblique = 1.0 - facing * facing / ((u * u + v * v) / (focal * focal) + 1.0)
            c = cosine[y, x]
            squared = c * c if c > 0.0 else 0.0
            squared = min(max(squared, min(oblique + margin, 0.98)), 1.0 - 1e-6)
            scale = 1.0 / (size * size * (1.0 - squared))
            out[0, y, x] = (squared * (focal * focal + u * u) - a * a) * scale
            out[1, y, x] = (squared * u * v - a * b) * scale
            out[2, y, x] = (squared * (focal * focal + v * v) - b * b) * scale
            out[3, y, x] = -a / size
            out[4, y, x] = -b / size


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
def heights(conic, labels, seeds, tolerance, rounds, cost, sign):
    """Least cost from the seeds, each pixel's gradient lying on its conic; fast sweeping of right triangles.

    The Hamilton-Jacobi equation A p² + 2B pq + C q² + 2D p + 2E q = 1 (an ellipse around 0 in the gradient
    (p, q)), solved as in Qian, Zhang and Zhao 2007 (doi:10.1137/050627083): of each pair of a horizontal and a
    vertical neighbour the larger root counts if its characteristic comes from between them, else the better of
    the two straight steps. Where the surface bends towards the viewer costs are heights the other way round:
    the conic is then mirrored (D and E change sign).

    Parameters: ``conic`` float32 (5, H, W): A, B, C, D, E. ``seeds`` int8 (H, W): +1 convex, −1 concave, 0 no
    seed. ``cost`` float32 (H, W), changed: the seeds' own at the seeds, large elsewhere. ``sign`` int8 (H, W),
    changed: which kind of seed a pixel was reached from; 0 not reached. Ends when no cost falls by more than
    ``tolerance``, or after ``rounds`` rounds of four sweeps.
    """
    rows, columns = labels.shape
    fresh = np.zeros(rows, np.int64)  # the sweep in which a row last changed
    sweep = 0
    for _ in range(rounds):
        changed = 0.0
        for way in range(4):
            sweep += 1
            dy = 1 if way < 2 else -1
            dx = 1 if way % 2 == 0 else -1
            y0, y1 = (0, rows) if dy > 0 else (rows - 1, -1)
            x0, x1 = (0, columns) if dx > 0 else (columns - 1, -1)
            for y in range(y0, y1, dy):
                before = fresh[y - dy] if 0 <= y - dy < rows else 0
                if sweep - max(fresh[y], before) > 4:
                    continue  # the last sweep this way has seen all there is
                for x in range(x0, x1, dx):
                    label = labels[y, x]
                    if label == 0 or seeds[y, x] != 0:
                        continue
                    across = 0 <= x - dx < columns and labels[y, x - dx] == label and sign[y, x - dx] != 0
                    down = 0 <= y - dy < rows and labels[y - dy, x] == label and sign[y - dy, x] != 0
                    best = cost[y, x]
                    # steps cost something: only a cheaper neighbour can better a pixel
                    if not ((across and cost[y, x - dx] < best) or (down and cost[y - dy, x] < best)):
                        continue
                    a, b, c = conic[0, y, x], conic[1, y, x], conic[2, y, x]
                    kind = sign[y, x]
                    det = a * c - b * b
                    if across:
                        s = sign[y, x - dx]
                        d, e = s * conic[3, y, x], s * conic[4, y, x]
                        # support of the ellipse along the step: centre plus half width
                        m = (b * e - c * d) / det
                        n = (b * d - a * e) / det
                        size = 1.0 + a * m * m + 2 * b * m * n + c * n * n
                        step = dx * m + np.sqrt(max(size * c / det, 0.0))
                        value = cost[y, x - dx] + max(step, 0.0)
                        if value < best:
                            best, kind = value, s
                    if down:
                        s = sign[y - dy, x]
                        d, e = s * conic[3, y, x], s * conic[4, y, x]
                        m = (b * e - c * d) / det
                        n = (b * d - a * e) / det
                        size = 1.0 + a * m * m + 2 * b * m * n + c * n * n
                        step = dy * n + np.sqrt(max(size * a / det, 0.0))
                        value = cost[y - dy, x] + max(step, 0.0)
                        if value < best:
                            best, kind = value, s
                    if across and down and sign[y, x - dx] == sign[y - dy, x]:
                        s = sign[y, x - dx]
                        d, e = s * conic[3, y, x], s * conic[4, y, x]
                        u, v = cost[y, x - dx], cost[y - dy, x]
                        bb = b * dx * dy
                        dd, ee = d * dx, e * dy
                        # p = dx (t - u), q = dy (t - v): a quadratic in t
                        qa = a + 2 * bb + c
                        qb = -(a * u + bb * (u + v) + c * v) + dd + ee
                        qc = a * u * u + 2 * bb * u * v + c * v * v - 2 * dd * u - 2 * ee * v - 1.0
                        disc = qb * qb - qa * qc
                        if disc >= 0.0:
                            t = (-qb + np.sqrt(disc)) / qa
                            along = a * (t - u) + bb * (t - v) + dd
                            beside = bb * (t - u) + c * (t - v) + ee
                            if along >= 0.0 and beside >= 0.0 and t < best:
                                best, kind = t, s
                    if best < cost[y, x]:
                        changed = max(changed, cost[y, x] - best)
                        cost[y, x] = best
                        sign[y, x] = kind
                        fresh[y] = sweep
        if changed <= tolerance:
            break

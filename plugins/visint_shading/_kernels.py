# mypy: ignore-errors
# ruff: noqa: PLR0917 - kernels take what they need
"""Compiled loops of the shading plugin: means inside regions, sums by region, and heights along least cost.

All arrays are C-contiguous and read-only unless named ``out``; labels are int32 (H, W), 0 takes no part.
"""

import numpy as np
from numba import njit

__all__ = ["agreement_sums", "conics", "cosines", "directions", "evened", "fine_responses", "fitted"]
__all__ += ["bends", "heights", "normals_of_slopes", "planes", "relative_slopes", "turned"]


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
def bends(labels, slopes, middles, reach, out):
    """Sums for how ``slopes`` (H, W, 2) change around each of ``middles`` (G, 2), rows and columns.

    Over pixels of the middle's region within ``reach``. ``out`` float64 (G, 10): pixels, means of column and
    row, second moments about them (columns, mixed, rows), and those of columns and rows with either slope.
    """
    rows, columns = labels.shape
    for g in range(middles.shape[0]):
        s = out[g]
        s[:] = 0.0
        cy, cx = middles[g, 0], middles[g, 1]
        label = labels[int(cy), int(cx)]
        top, left = max(0, int(cy - reach)), max(0, int(cx - reach))
        bottom, right = min(rows, int(cy + reach) + 2), min(columns, int(cx + reach) + 2)
        p0, q0 = 0.0, 0.0
        for y in range(top, bottom):
            for x in range(left, right):
                p, q = slopes[y, x, 0], slopes[y, x, 1]
                if labels[y, x] != label or not np.isfinite(p + q):
                    continue
                u, v = x - cx, y - cy
                s[0] += 1.0
                s[1] += u
                s[2] += v
                s[3] += u * u
                s[4] += u * v
                s[5] += v * v
                s[6] += u * p
                s[7] += v * p
                s[8] += u * q
                s[9] += v * q
                p0 += p
                q0 += q
        if s[0] > 0.0:
            u, v = s[1] / s[0], s[2] / s[0]
            s[3] -= u * s[1]
            s[4] -= u * s[2]
            s[5] -= v * s[2]
            s[6] -= u * p0
            s[7] -= v * p0
            s[8] -= u * q0
            s[9] -= v * q0


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
def conics(cosine, light, across, down, focal, margin, out):
    """The ellipse of gradients at each pixel, see ``heights.gradients``, and the steps it allows.

    ``out`` (H, W, 11): A, B, C, D, E, its centre (m, n), half its widths along columns and rows, and the
    inverses of A + 2B + C and A − 2B + C.
    """
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
            aa = (squared * (focal * focal + u * u) - a * a) * scale
            ab = (squared * u * v - a * b) * scale
            bb = (squared * (focal * focal + v * v) - b * b) * scale
            d, e = -a / size, -b / size
            det = aa * bb - ab * ab
            m, n = (ab * e - bb * d) / det, (ab * d - aa * e) / det
            wide = (1.0 + aa * m * m + 2 * ab * m * n + bb * n * n) / det
            here = out[y, x]
            here[0], here[1], here[2], here[3], here[4] = aa, ab, bb, d, e
            here[5], here[6] = m, n
            here[7], here[8] = np.sqrt(max(wide * bb, 0.0)), np.sqrt(max(wide * aa, 0.0))
            here[9], here[10] = 1.0 / (aa + 2 * ab + bb), 1.0 / (aa - 2 * ab + bb)


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


@njit(cache=True, nogil=True, error_model="numpy")
def heights(conic, labels, seeds, tolerance, rounds, cost, sign):
    """Least cost from the seeds, each pixel's gradient lying on its conic; fast sweeping of right triangles.

    The Hamilton-Jacobi equation A p² + 2B pq + C q² + 2D p + 2E q = 1 (an ellipse around 0 in the gradient
    (p, q)), solved as in Qian, Zhang and Zhao 2007 (doi:10.1137/050627083): of each pair of a horizontal and a
    vertical neighbour the larger root counts if its characteristic comes from between them, else the better of
    the two straight steps. Where the surface bends towards the viewer costs are heights the other way round:
    the conic is then mirrored (D and E change sign).

    Parameters: ``conic`` float64 (H, W, 11) as ``conics`` leaves it. ``seeds`` int8 (H, W): +1 convex, −1
    concave, 0 no seed. ``cost`` float64 (H, W), changed: the seeds' own at the seeds, large elsewhere. ``sign``
    int8 (H, W), changed: which kind of seed a pixel was reached from; 0 not reached. Ends when no cost falls by
    more than ``tolerance``, or after ``rounds`` rounds of four sweeps.
    """
    rows, columns = labels.shape
    fresh = np.ones(rows, np.int64)  # the sweep in which a row last changed, and a pixel (one wider all around)
    last = np.full((rows + 2, columns + 2), -4, np.int32)
    for y in range(rows):
        for x in range(columns):
            if sign[y, x] != 0:
                last[y + 1, x + 1] = 1
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
                if sweep - max(fresh[y], before) >= 4:
                    continue
                for x in range(x0, x1, dx):
                    # the last sweep this way has seen neighbours that have not changed since
                    if sweep - max(last[y + 1, x + 1 - dx], last[y + 1 - dy, x + 1]) >= 4:
                        continue
                    label = labels[y, x]
                    if label == 0 or seeds[y, x] != 0:
                        continue
                    across = 0 <= x - dx < columns and labels[y, x - dx] == label and sign[y, x - dx] != 0
                    down = 0 <= y - dy < rows and labels[y - dy, x] == label and sign[y - dy, x] != 0
                    best = cost[y, x]
                    # steps cost something: only a cheaper neighbour can better a pixel
                    if not ((across and cost[y, x - dx] < best) or (down and cost[y - dy, x] < best)):
                        continue
                    here = conic[y, x]
                    kind = sign[y, x]
                    if across:
                        s = sign[y, x - dx]
                        # support of the ellipse along the step: centre plus half width
                        step = dx * s * here[5] + here[7]
                        value = cost[y, x - dx] + max(step, 0.0)
                        if value < best:
                            best, kind = value, s
                    if down:
                        s = sign[y - dy, x]
                        step = dy * s * here[6] + here[8]
                        value = cost[y - dy, x] + max(step, 0.0)
                        if value < best:
                            best, kind = value, s
                    if across and down and sign[y, x - dx] == sign[y - dy, x]:
                        s = sign[y, x - dx]
                        a, c = here[0], here[2]
                        u, v = cost[y, x - dx], cost[y - dy, x]
                        bb = here[1] * dx * dy
                        dd, ee = s * here[3] * dx, s * here[4] * dy
                        # p = dx (t - u), q = dy (t - v): a quadratic in t - u
                        apart = v - u
                        middle = (bb + c) * apart - dd - ee
                        disc = middle * middle - (a + 2 * bb + c) * ((c * apart - 2 * ee) * apart - 1.0)
                        if disc >= 0.0:
                            rise = (middle + np.sqrt(disc)) * here[9 if dx == dy else 10]
                            along = a * rise + bb * (rise - apart) + dd
                            beside = bb * rise + c * (rise - apart) + ee
                            t = u + rise
                            if along >= 0.0 and beside >= 0.0 and t < best:
                                best, kind = t, s
                    if best < cost[y, x]:
                        changed = max(changed, cost[y, x] - best)
                        cost[y, x] = best
                        sign[y, x] = kind
                        fresh[y] = last[y + 1, x + 1] = sweep
        if changed <= tolerance:
            break

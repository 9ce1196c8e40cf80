# mypy: ignore-errors
# ruff: noqa: PLR0917 - kernels take what they need
"""Compiled loops of the heights: how surfaces bend, which gradients brightness allows, and ways of least cost.

All arrays are C-contiguous and read-only unless named ``out``; labels are int32 (H, W), 0 takes no part.
"""

import numpy as np
from numba import njit

__all__ = ["bends", "conics", "heights"]


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

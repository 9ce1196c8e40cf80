"""The catalogue derived: octants around a point, occlusion, and a curved patch cut by a plane."""

from __future__ import annotations

from itertools import product
from math import atan2, pi, tau

import numpy as np
import pytest

from visint_lines.catalogue import FLIP, LABELS, catalogue, legal, slots

AXES = [(axis, sign) for axis in range(3) for sign in (1, -1)]
TURNS = np.random.default_rng(5).normal(size=(40, 3))


def edge(axis, sign):
    out = np.zeros(3)
    out[axis] = sign
    return out


def around(filled, axis, sign):
    """The four octants around half an axis, in order round it, each with whether it is filled."""
    one, two = (axis + 1) % 3, (axis + 2) % 3
    found = []
    for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1)):
        octant = [0, 0, 0]
        octant[axis], octant[one], octant[two] = sign, a, b
        found.append((tuple(octant), filled[tuple(octant)]))
    return found


def faces(filled, axis, sign):
    """(direction from the edge into the face, outward normal) of the faces at half an axis."""
    ring = around(filled, axis, sign)
    made = []
    for (one, here), (two, there) in zip(ring, ring[1:] + ring[:1], strict=True):
        if here != there:
            into = (np.array(one) + np.array(two)) / 2
            into[axis] = 0
            normal = (np.array(two) - np.array(one)) / 2 * (1 if here else -1)
            made.append((into, normal))
    return made


def manifold(filled, axis, sign):
    """1 for a convex edge, 3 for a concave one, 0 for none, None where it is no surface."""
    ring = [solid for _, solid in around(filled, axis, sign)]
    count = sum(ring)
    if count == 2 and ring[0] == ring[2]:
        return None
    return count if count in (1, 3) else 0


def seen(filled, view):
    """((angle, label), ...) of a corner's visible edges from direction ``view``, counter-clockwise."""
    eye = tuple(int(s) for s in np.sign(view))
    if filled[eye]:
        return None
    up = np.array([0.3, 0.5, 0.8])
    x = np.cross(up, view)
    y = np.cross(view, x)
    lines = []
    for axis, sign in AXES:
        kind = manifold(filled, axis, sign)
        if not kind:
            continue
        before = list(eye)
        before[axis] = sign
        if filled[tuple(before)]:
            continue
        out = edge(axis, sign)
        flat = np.array([out @ x / np.linalg.norm(x), out @ y / np.linalg.norm(y)])
        visible = [into for into, normal in faces(filled, axis, sign) if normal @ view > 0]
        if kind == 3:
            label = "-"
        elif len(visible) == 2:
            label = "+"
        else:
            side = np.array([visible[0] @ x / np.linalg.norm(x), visible[0] @ y / np.linalg.norm(y)])
            label = "<" if flat[0] * side[1] - flat[1] * side[0] > 0 else ">"
        lines.append((atan2(flat[1], flat[0]), label))
    return sorted(lines)


def corners():
    """Every filling of the octants around a point at which exactly three manifold edges meet."""
    places = list(product((1, -1), repeat=3))
    for bits in product((False, True), repeat=8):
        filled = dict(zip(places, bits, strict=True))
        kinds = [manifold(filled, axis, sign) for axis, sign in AXES]
        if None not in kinds and sum(bool(kind) for kind in kinds) == 3:
            yield filled


def rows_seen():
    rows = {"L": set(), "Y": set(), "W": set()}
    for filled in corners():
        for view in TURNS:
            lines = seen(filled, view)
            if lines is None or len(lines) < 2:
                continue
            angles = [angle for angle, _ in lines]
            gaps = [(b - a) % tau for a, b in zip(angles, angles[1:] + angles[:1], strict=True)]
            kind = "L" if len(lines) == 2 else "W" if max(gaps) > pi else "Y"
            rows[kind].add(tuple(lines[i][1] for i in slots(kind, angles)))
    return rows


def test_sixty_four_corners_have_three_edges():
    """1, 3, 5 and 7 filled octants: 8, 24, 24 and 8 ways."""
    counts = [sum(filled.values()) for filled in corners()]
    assert [counts.count(n) for n in (1, 3, 5, 7)] == [8, 24, 24, 8]
    assert len(counts) == 64


def test_polyhedral_rows_are_what_octants_show():
    """Seen from generic directions the 64 corners show six L, five Y (three but for rotation), three arrows."""
    rows = rows_seen()
    for kind, count in (("L", 6), ("Y", 5), ("W", 3)):
        assert rows[kind] == legal(kind)
        assert len(catalogue()[kind]) == count
    assert len({min(row[i:] + row[:i] for i in range(3)) for row in rows["Y"]}) == 3


def test_tangent_rows_follow_from_occlusion():
    """The bar hides the stem: an edge or a limb of the thing on the far side; the stem can be any line."""
    stems = [label for label in LABELS if label != "x"]
    assert legal("T") == {(bar, stem, FLIP[bar]) for bar in (">", ">>") for stem in stems}
    polyhedral = [row for row in legal("T") if not any(len(label) == 2 for label in row)]
    assert len(polyhedral) == 4
    assert len(polyhedral) + sum(len(catalogue()[kind]) for kind in "LYW") == 18


def cut_patch(rng, convex):
    """What shows at a point of an edge where a patch is seen edge-on: ((x side, height, label), ...).

    The patch is z = q(x, y) with the body below it, the viewer far out along y, the image (x, z) with z up. A
    plane through the origin with outward normal m cuts the body (convex) or adds a half-space (concave).
    """
    a, b, c = rng.normal(size=3)
    m = rng.normal(size=3)
    x = 1e-3

    def q(u, v):
        return 0.5 * (a * u * u + 2 * b * u * v + c * v * v)

    lines = []
    for side in (1, -1):
        u = side * x
        v = -m[0] * u / m[1]  # the edge, to first order
        patch, plane = -(b * u + c * v) > 0, m[1] > 0
        away, back = (">", "<") if side > 0 else ("<", ">")  # bodies lie below: on the right, walking to +x
        del back
        if convex and (patch or plane):
            lines.append((side, q(u, v), "+" if patch and plane else away))
        if not convex and patch and plane:
            lines.append((side, q(u, v), "-"))
        on = m[0] * u - m[1] * b * u / c  # the limb's point lies inside the cut body, or outside the added one
        if c < 0 and (on < 0 if convex else on > 0):
            lines.append((side, q(u, -b * u / c), away * 2))
    return c, m, lines


def as_rows(lines):
    """Type and row of lines that share the tangent z = 0: by their sides and heights."""
    angles = [(side, z) for side, z, _ in lines]
    away = [atan2(1e-4 * z, 1e-3 * side) for side, z in angles]
    order = sorted(range(len(lines)), key=lambda i: away[i])
    kind = {1: "E", 2: "C", 3: "R"}[len(lines)]
    turned = [away[i] for i in order]
    return kind, tuple(lines[order[i]][2] for i in slots(kind, turned))


def test_three_tangents_where_a_plane_cuts_a_patch_that_curves_away():
    """Both faces seen on one side, the plane alone on the other, the limb beside the crease: R, and only R."""
    rng, met = np.random.default_rng(1), set()
    for _ in range(3000):
        c, m, lines = cut_patch(rng, convex=True)
        if c < 0 and m[1] > 0:
            kind, row = as_rows(lines)
            assert kind == "R"
            met.add(row)
    assert met == legal("R")


@pytest.mark.parametrize("convex", [True, False])
def test_curvature_l_where_the_limb_passes_into_the_edge(convex):
    """The plane hidden behind a cut, or a half-space added in front: a limb and one more line, a row of C."""
    rng, met = np.random.default_rng(2), set()
    for _ in range(3000):
        c, m, lines = cut_patch(rng, convex)
        if c < 0 and (m[1] < 0 if convex else m[1] > 0) and len(lines) == 2:
            met.add(tuple(label for _, _, label in lines))
    rows = {row for row in legal("C") if ("-" in row) != convex}
    assert met | {row[::-1] for row in met} == rows


def test_a_hollow_patch_has_no_junction():
    """The crease turns into its own occluding edge without a sign in the image: a row of P."""
    rng, met = np.random.default_rng(3), set()
    for _ in range(3000):
        c, m, lines = cut_patch(rng, convex=True)
        if c > 0 and m[1] > 0:
            assert len(lines) == 2
            met.add(tuple(label for _, _, label in lines))
    assert met | {row[::-1] for row in met} == {r for r in legal("P") if FLIP[r[0]] != r[1]}


def test_the_mirror_image_of_a_row_is_a_row():
    """Seen in a mirror, order and directions turn round, and what is possible stays so."""
    for kind in catalogue():
        for row in legal(kind):
            mirrored = tuple(FLIP[label] for label in row[::-1])
            if kind == "R":
                mirrored = (mirrored[2], mirrored[0], mirrored[1])
            assert mirrored in legal(kind)

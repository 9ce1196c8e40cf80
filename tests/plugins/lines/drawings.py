"""The classic line drawings, with clean geometry and known labellings. Coordinates have y up; images do not."""

from __future__ import annotations

import numpy as np

from visint_lines.diagram import Arc, assembled

SIZE = (200, 200)


def straight(one, two):
    return np.linspace(one, two, 24)


def bent(centre, radii, start, end):
    """Part of an ellipse from angle ``start`` to ``end``, degrees."""
    t = np.radians(np.linspace(start, end, 40))
    return np.stack([centre[0] + radii[0] * np.cos(t), centre[1] + radii[1] * np.sin(t)], axis=-1)


def drawing(spots, lines, outside):
    """A diagram: ``lines`` are (start, end[, curve]), ``outside`` the lines with the background on their left
    (``"left"``) or right.
    """
    arcs, angles = [], []
    for number, (start, end, *curve) in enumerate(lines):
        points = curve[0] if curve else straight(spots[start], spots[end])
        first, last = points[1] - points[0], points[-2] - points[-1]
        angles.append((np.arctan2(first[1], first[0]), np.arctan2(last[1], last[0])))
        image = np.stack([20 + 50 * points[:, 0], 180 - 50 * points[:, 1]], axis=-1)
        arcs.append(Arc(start, end, 1, 2, image, outside.get(number, "")))
    places = np.array([(20 + 50 * x, 180 - 50 * y) for x, y in spots])
    return assembled(SIZE, places, arcs, angles, np.zeros(len(spots), bool))


def outline(lines, path):
    """Which lines have the background on their left as one walks the outline ``path`` counter-clockwise."""
    found = {}
    ring = list(zip(path, path[1:] + path[:1], strict=True))
    for number, (start, end, *_) in enumerate(lines):
        if (start, end) in ring:
            found[number] = "right"
        elif (end, start) in ring:
            found[number] = "left"
    return found


def cube():
    hexagon = [(1 + np.cos(t), 1 + np.sin(t)) for t in np.radians(np.arange(30, 390, 60))]
    lines = [(i, (i + 1) % 6) for i in range(6)] + [(6, 1), (6, 3), (6, 5)]
    truth = ["<"] * 6 + ["+"] * 3
    return [*hexagon, (1, 1)], lines, outline(lines, list(range(6))), truth


def block():
    """An L of three cubes: the front is an L, tops and right sides are seen."""
    front = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    back = [(x + 0.7, y + 0.5) for x, y in front[1:]]
    lines = [(i, (i + 1) % 6) for i in range(6)] + [(i, i + 5) for i in range(1, 6)]
    lines += [(6, 7), (7, 8), (8, 9), (9, 10)]
    truth = ["<", "+", "+", "+", "+", "<", "<", "+", "-", "+", ">", "<", "<", "<", "<"]
    return front + back, lines, outline(lines, [0, 1, 6, 7, 8, 9, 10, 5]), truth


def house():
    front = [(0, 0), (1.2, 0), (1.2, 1), (0.6, 1.7), (0, 1)]
    back = [(x + 1.1, y + 0.35) for x, y in front[1:4]]
    lines = [(i, (i + 1) % 5) for i in range(5)] + [(1, 5), (2, 6), (3, 7), (5, 6), (6, 7)]
    truth = ["<", "+", "+", "<", "<", "<", "+", ">", "<", "<"]
    return front + back, lines, outline(lines, [0, 1, 5, 6, 7, 3, 4]), truth


def cylinder():
    spots = [(0.3, 2), (1.7, 2), (0.3, 0.5), (1.7, 0.5)]
    back = bent((1, 2), (0.7, 0.25), 0, 180)
    front = bent((1, 2), (0.7, 0.25), 180, 360)
    foot = bent((1, 0.5), (0.7, 0.25), 180, 360)
    lines = [(1, 0, back), (0, 1, front), (0, 2), (1, 3), (2, 3, foot)]
    truth = ["<", "+", "<<", ">>", "<"]
    return spots, lines, {0: "right", 2: "right", 3: "left", 4: "right"}, truth


def cone():
    spots = [(1, 2), (0.3, 0.5), (1.7, 0.5)]
    foot = bent((1, 0.5), (0.7, 0.25), 180, 360)
    lines = [(0, 1), (0, 2), (1, 2, foot)]
    return spots, lines, {0: "right", 1: "left", 2: "right"}, None


TYPES = {"cylinder": "R R C C", "cone": "L C C"}
"""Of curved bodies, whose junctions are known by their tangents."""

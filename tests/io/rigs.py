"""A rig whose every number is known, and what its cameras see of a textured wall."""

from __future__ import annotations

import cv2
import numpy as np

ROWS, COLUMNS, DISTANCE = 96, 128, 2000.0
K1 = np.array([[150.0, 0, 62], [0, 151, 49], [0, 0, 1]])
K2 = np.array([[147.0, 0, 66], [0, 148, 46], [0, 0, 1]])
D1 = np.array([-0.12, 0.03, 0.001, -0.0005, 0.0])
D2 = np.array([-0.10, 0.02, -0.0007, 0.0008, 0.0])
R = cv2.Rodrigues(np.array([0.02, -0.05, 0.03]))[0]
T = -R @ np.array([100.0, 3.0, -4.0])  # the right camera stands 100 mm to the right
ENTRIES = {"M1": K1, "D1": D1, "M2": K2, "D2": D2, "R": R, "T": T}


def texture(x, y):
    """Intensity of the wall at (x, y) mm, smooth."""
    waves = ((0.021, 0.008, 0.3), (-0.007, 0.026, 1.1), (0.015, -0.017, 2.0), (0.031, 0.012, 4.0))
    return (0.5 + 0.11 * sum(np.sin(a * x + b * y + c) for a, b, c in waves)).astype(np.float32)


def rays(size=(ROWS, COLUMNS)):
    """Pixel coordinates (N, 2) of an image."""
    y, x = np.mgrid[: size[0], : size[1]]
    return np.stack([x, y], -1).reshape(-1, 2).astype(np.float64)


def straight(matrix, distortion, pixels):
    """Normalised coordinates of ``pixels`` without the lens' distortion (Brown's model), by iteration."""
    k1, k2, p1, p2, _ = distortion
    bent = (pixels - matrix[:2, 2]) / np.diag(matrix)[:2]
    found = bent.copy()
    for _ in range(100):
        x, y = found.T
        square = x * x + y * y
        radial = 1 + k1 * square + k2 * square**2
        shift = np.stack(
            [2 * p1 * x * y + p2 * (square + 2 * x * x), p1 * (square + 2 * y * y) + 2 * p2 * x * y]
        )
        found = (bent - shift.T) / radial[:, None]
    return found


def seen(matrix, distortion, rotation, centre, size=(ROWS, COLUMNS)):
    """(intensity, depth) of the wall Z = DISTANCE of the first camera's frame, each pixel's ray followed.

    ``rotation`` leads from the first camera's frame to this camera's, which stands at ``centre``.
    """
    points = straight(matrix, distortion, rays(size))
    own = np.column_stack([points, np.ones(len(points))])
    directions = own @ rotation
    scale = (DISTANCE - centre[2]) / directions[:, 2]
    at = centre + directions * scale[:, None]
    return texture(at[:, 0], at[:, 1]).reshape(size), (own[:, 2] * scale).reshape(size)


def taken():
    """The left and the right image as the cameras take them, linear float32."""
    left, _ = seen(K1, D1, np.eye(3), np.zeros(3))
    right, _ = seen(K2, D2, R, -R.T @ T)
    return left, right


def opencv_yaml(entries, head="%YAML:1.0\n---\n", **plain):
    """A file as cv::FileStorage writes it."""
    text = head
    for name, value in plain.items():
        text += f"{name}: {value}\n"
    for name, value in entries.items():
        matrix = np.atleast_2d(value) if value.ndim > 1 or name[0] == "D" else value[:, None]
        data = ", ".join(f"{one:.17g}" if one % 1 else f"{one:.0f}." for one in matrix.ravel())
        rows, columns = matrix.shape
        text += f"{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n   data: [ {data} ]\n"
    return text

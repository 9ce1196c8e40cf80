"""Which side of a boundary a pixel belongs to: what is known on the boundary is not lost to both."""

from __future__ import annotations

import cv2
import numpy as np

from visint.module import Context
from visint_stereo.descent.sides import LOOSE, seen_in_the_other_view, sides_of
from visint_stereo.weng import Weng, WengInputs, WengParams


def test_boundary_pixels_join_the_region_they_look_like():
    """Dark | wall of two columns, one dark and one bright | bright: each column goes with its like."""
    brightness = np.repeat(np.float32([0, 0, 0, 0, 1, 1, 1, 1])[None], 6, axis=0)
    walls = np.zeros(brightness.shape, bool)
    walls[:, 3:5] = True
    sides = sides_of(walls, brightness)
    assert len(np.unique(sides)) == 2
    assert (sides[:, :4] == sides[0, 0]).all()
    assert (sides[:, 4:] == sides[0, 7]).all()


def test_loose_ends_part_nothing_but_stay_apart_themselves():
    """A line that ends inside the image: one region around it, the line a side of its own."""
    walls = np.zeros((20, 20), bool)
    walls[10, :12] = True
    sides = sides_of(walls, np.zeros(walls.shape, np.float32))
    assert (sides[walls] == LOOSE).all()
    assert len(np.unique(sides[~walls])) == 1


def test_a_view_that_is_all_boundary_is_one_side():
    """Nothing closed to join: all pixels are alike."""
    assert len(np.unique(sides_of(np.ones((5, 7), bool), np.zeros((5, 7), np.float32)))) == 1


def test_sides_move_with_the_field_of_the_other_view():
    """The right view's pixel x shows the left view's x + d; what lies outside is LOOSE."""
    sides = np.repeat(np.int32([1, 1, 1, 2, 2, 2])[None], 3, axis=0)
    seen = seen_in_the_other_view(sides, np.full(sides.shape, 2.0, np.float32))
    assert (seen == np.int32([1, 2, 2, 2, LOOSE, LOOSE])).all()


def test_texture_on_a_boundary_reaches_the_region_inside():
    """A plain face whose only texture lies on its outline gets the outline's disparity, not the start's."""
    rows, columns, shift = 40, 60, 2
    face = np.zeros((rows, columns), np.float32)
    face[10:30, 20:40] = 100.0
    face = cv2.GaussianBlur(face, (0, 0), 1.2)
    right = np.roll(face, -shift, axis=1)
    views = tuple(np.repeat(view[..., None], 4, axis=-1) for view in (face, right))
    walls = np.zeros(face.shape, bool)
    walls[10:30, [19, 20, 39, 40]] = walls[[9, 10, 29, 30], 20:40] = True
    matcher = Weng(WengParams(iterations=400, weights=(1.0, 0.0, 0.0, 0.0), reach=0.5))
    start = np.full(face.shape, 1.5, np.float32)
    found = matcher.run(
        WengInputs(attributes=views, disparity=start, right_disparity=start, boundaries=walls), Context()
    )
    assert np.abs(found.left[12:28, 22:38] - shift).max() < 0.3

"""Neighbourhoods end at boundaries: links, means and bends against what geometry says."""

from __future__ import annotations

import numpy as np

from visint.fields import barriers


def test_a_line_has_no_neighbours_and_is_nobodys():
    """Every link of a pixel in the open, none of a line, none to it, none off the image."""
    line = np.zeros((7, 9), bool)
    line[:, 4] = True
    found = barriers.links(line, line.shape)
    assert found[3, 1] == 255
    assert (found[:, 4] == 0).all()
    assert not (found[:, 3] >> 1 & 1).any()
    assert (found[1:-1, 3] >> 3 & 1).all()
    assert not (found[0] & 1).any()
    assert found.dtype == np.uint8


def test_a_diagonal_line_is_closed():
    """A step between the pixels of a diagonal line is barred; past the end of a line it is open."""
    line = np.eye(6, dtype=bool)[:, ::-1]
    found = barriers.links(line, line.shape)
    inside, outside = (2, 2), (3, 3)
    assert line[2, 3]
    assert line[3, 2]
    assert not found[inside] >> barriers.AROUND.index((1, 1)) & 1
    assert not found[outside] >> barriers.AROUND.index((-1, -1)) & 1
    line[3, 2] = False
    assert barriers.links(line, line.shape)[inside] >> barriers.AROUND.index((1, 1)) & 1


def test_the_mean_is_of_the_known_on_ones_own_side():
    values = np.tile(np.float32([0, 1, 2, 50, 60]), (5, 1))
    line = np.zeros(values.shape, bool)
    line[:, 2] = True
    values[2, 0] = np.nan
    average, count = barriers.mean(values, barriers.links(line, line.shape))
    assert average[2, 1] == 1
    assert count[2, 1] == 2
    assert np.isnan(average[2, 2])
    assert np.isclose(average[2, 3], (50 + 50 + 60) / 3)
    whole, eight = barriers.mean(values, barriers.links(None, line.shape), barriers.EIGHT)
    assert eight[3, 3] == 8
    assert np.isclose(whole[3, 3], (3 * 2 + 2 * 50 + 3 * 60) / 8)


def test_a_plane_has_no_bend_and_a_parabola_its_own():
    """x² + ½y² rises by (1 + ½)/2 from a pixel to the mean of its neighbours, x² alone by 1 along a wall."""
    y, x = np.mgrid[:8, :9].astype(np.float32)
    free = barriers.links(None, y.shape)
    assert np.allclose(barriers.bend(3 * x - 2 * y + 1, free), 0, atol=1e-5)
    assert np.allclose(barriers.bend(x**2 + y**2 / 2, free)[1:-1, 1:-1], 0.75)
    assert np.allclose(barriers.bend(x**2 + y**2 / 2, free)[0, 1:-1], 1.0)


def test_slopes_imply_the_same_bend():
    """From the exact slopes of the parabola; NaN where nothing is known."""
    y, x = np.mgrid[:8, :9].astype(np.float32)
    slopes = np.stack([2 * x, y], axis=-1)
    free = barriers.links(None, y.shape)
    assert np.allclose(barriers.bend_of_slopes(slopes, free)[1:-1, 1:-1], 0.75)
    slopes[3, 4] = np.nan
    found = barriers.bend_of_slopes(slopes, free)
    assert np.isclose(found[3, 5], 0.5)
    assert np.isnan(found[0, 0])


def test_a_line_belongs_to_the_side_it_is_like():
    """Depth 1 on the left, 5 on the right, the line itself 4: it is the right side's; loose ends bar none."""
    depth = np.tile(np.float32([1, 1, 1, 4, 5, 5, 5]), (6, 1))
    line = np.zeros(depth.shape, bool)
    line[:, 3] = True
    found = barriers.links_within(line, depth)
    assert (found[:, 3] >> 1 & 1).all()
    assert not (found[:, 3] >> 3 & 1).any()
    assert not (found[:, 2] >> 1 & 1).any()
    average, _ = barriers.mean(depth, found)
    assert (average[:, 2] == 1).all()
    line[3:, 3] = False
    assert np.array_equal(barriers.links_within(line, depth), barriers.links(None, line.shape))

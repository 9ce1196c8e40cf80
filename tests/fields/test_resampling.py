"""Going down and up a level: centres map by (x + ½)/2 − ½, nothing thin or small is lost, NaN stays honest."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from visint.fields import resampling as rs
from visint.testing import strategies

NAN = np.float32(np.nan)


def ramp(rows, columns, a=2.0, b=-3.0, c=5.0):
    """The plane a·column + b·row + c."""
    v, u = np.mgrid[:rows, :columns]
    return (a * u + b * v + c).astype(np.float32)


def parabola(rows, columns):
    """A paraboloid with mixed term."""
    v, u = np.mgrid[:rows, :columns].astype(float)
    return (0.5 * u**2 - 0.25 * v**2 + 0.125 * u * v + u - v + 3).astype(np.float32)


class TestSizes:
    @pytest.mark.parametrize(("size", "half"), [((4, 6), (2, 3)), ((5, 7), (3, 4)), ((1, 2), (1, 1))])
    def test_smaller(self, size, half):
        assert rs.smaller(size) == half

    @pytest.mark.parametrize(
        ("size", "coarsest", "levels"),
        [((512, 512), 8, 7), ((512, 512), 9, 6), ((8, 100), 8, 1), ((7, 7), 8, 1), ((1, 1), 1, 1)],
    )
    def test_levels_down_to(self, size, coarsest, levels):
        """The coarsest level's shorter side is still at least `coarsest`; there is always one level."""
        assert rs.levels_down_to(size, coarsest) == levels

    @given(strategies.sizes(200), st.integers(1, 50))
    def test_levels_down_to_is_the_most(self, size, coarsest):
        count = rs.levels_down_to(size, coarsest)
        for _ in range(count - 1):
            size = rs.smaller(size)
        assert count == 1 or min(size) >= coarsest
        assert min(rs.smaller(size)) < coarsest or rs.smaller(size) == size

    @given(strategies.sizes(), st.sampled_from([rs.block_mean, rs.any_down, rs.most_frequent_down]))
    def test_every_rule_down_halves_and_pads(self, size, rule):
        assert rule(np.zeros(size, np.int32)).shape == rs.smaller(size)

    @given(strategies.sizes(), st.sampled_from([rs.nearest_up, rs.linear_up, rs.quadratic_up]))
    def test_every_rule_up_cuts_to_the_size(self, size, rule):
        raised = rule(np.ones(rs.smaller(size), np.float32), size)
        assert raised.shape == size
        assert raised.flags.c_contiguous
        assert (raised == 1).all()


class TestCentres:
    def test_the_centre_of_a_block_is_half_way(self):
        """Pixels 0 and 1 meet at 0: (0.5 + 0.5)/2 − 0.5; the mean of the coordinates says so itself."""
        u = np.tile(np.arange(8, dtype=np.float32), (8, 1))
        coarse = rs.block_mean(u)
        np.testing.assert_array_equal((coarse[0] + 0.5) / 2 - 0.5, np.arange(4))

    def test_linear_is_exact_on_planes(self):
        """Up again, a plane is itself wherever both neighbours exist."""
        plane = ramp(12, 16)
        raised = rs.linear_up(rs.block_mean(plane), (12, 16))
        np.testing.assert_allclose(raised[1:-1, 1:-1], plane[1:-1, 1:-1], atol=1e-5)

    def test_quadratic_is_exact_on_planes_to_the_border(self):
        plane = ramp(12, 16)
        raised = rs.quadratic_up(rs.block_mean(plane), (12, 16))
        np.testing.assert_allclose(raised, plane, atol=1e-5)

    def test_quadratic_undoes_the_mean_of_a_parabola(self):
        """Inside, where both neighbours exist, the fine samples come back exactly."""
        fine = parabola(16, 20)
        raised = rs.quadratic_up(rs.block_mean(fine), (16, 20))
        np.testing.assert_allclose(raised[2:-2, 2:-2], fine[2:-2, 2:-2], atol=1e-4)

    def test_quadratic_after_the_mean_is_the_identity_of_the_mean(self):
        """The mean of the four children is their parent: nothing drifts over many levels."""
        coarse = np.random.default_rng(0).random((6, 7)).astype(np.float32)
        np.testing.assert_allclose(rs.block_mean(rs.quadratic_up(coarse, (12, 14))), coarse, atol=1e-6)

    def test_nearest(self):
        raised = rs.nearest_up(np.array([[1, 2], [3, 4]], np.int32), (3, 4))
        assert raised.tolist() == [[1, 1, 2, 2], [1, 1, 2, 2], [3, 3, 4, 4]]
        assert raised.dtype == np.int32

    def test_channels(self):
        """Any number of channels goes along."""
        value = np.stack([ramp(6, 8), ramp(6, 8, 1, 1)], axis=-1)
        raised = rs.linear_up(rs.block_mean(value), (6, 8))
        assert raised.shape == (6, 8, 2)
        np.testing.assert_allclose(raised[1:-1, 1:-1], value[1:-1, 1:-1], atol=1e-5)


class TestOddSizes:
    def test_the_last_row_and_column_are_repeated(self):
        """A block half outside the image is the mean of what lies inside."""
        coarse = rs.block_mean(ramp(3, 3, 1, 10, 0))
        assert coarse.tolist() == [[5.5, 7], [20.5, 22]]

    def test_one_pixel(self):
        one = np.full((1, 1), 3, np.float32)
        assert rs.block_mean(one).tolist() == [[3]]
        assert rs.linear_up(one, (1, 1)).tolist() == rs.quadratic_up(one, (1, 2))[:, :1].tolist() == [[3]]

    @given(strategies.arrays("Depth"))
    def test_down_and_up_keeps_the_size_and_the_range(self, depth):
        """Means and linear interpolation never leave the range of the known."""
        raised = rs.linear_up(rs.block_mean(depth), depth.shape)
        assert raised.shape == depth.shape
        assert raised.dtype == np.float32
        known = np.isfinite(depth)
        if known.any():
            low, high = depth[known].min(), depth[known].max()
            assert np.nanmin(raised) >= low * (1 - 1e-6)
            assert np.nanmax(raised) <= high * (1 + 1e-6)
        else:
            assert np.isnan(raised).all()


class TestUnknown:
    def test_the_mean_is_of_the_known(self):
        value = np.array([[1, NAN, NAN, NAN], [3, NAN, NAN, NAN]], np.float32)
        np.testing.assert_array_equal(rs.block_mean(value), [[2, NAN]])

    def test_infinity_counts_as_unknown(self):
        value = np.array([[1, np.inf], [3, -np.inf]], np.float32)
        assert rs.block_mean(value).tolist() == [[2]]

    @pytest.mark.parametrize("rule", [rs.linear_up, rs.quadratic_up])
    def test_a_hole_keeps_its_place_going_up(self, rule):
        """The four children of an unknown pixel are unknown, but for a corner half filled from two sides."""
        value = np.ones((5, 5), np.float32)
        value[2, 2] = NAN
        raised = rule(value, (10, 10))
        assert np.isfinite(np.delete(np.delete(raised, [4, 5], 0), [4, 5], 1)).all()
        known = raised[np.isfinite(raised)]
        np.testing.assert_allclose(known, 1)

    @pytest.mark.parametrize("rule", [rs.linear_up, rs.quadratic_up])
    def test_an_island_does_not_spread(self, rule):
        """One known pixel among unknown ones has four known children and no more."""
        value = np.full((5, 5), NAN)
        value[2, 2] = 7
        raised = rule(value, (10, 10))
        assert np.isfinite(raised).sum() == 4
        assert (raised[4:6, 4:6] == 7).all()

    def test_quadratic_is_linear_beside_a_hole(self):
        """Where a neighbour is unknown the step is the linear one, and a hole harms nobody further off."""
        value = rs.block_mean(ramp(12, 12))
        value[3, 3] = NAN
        raised = rs.quadratic_up(value, (12, 12))
        far = np.ones((12, 12), bool)
        far[4:10, 4:10] = False
        np.testing.assert_allclose(raised[far], ramp(12, 12)[far], atol=1e-4)

    def test_inputs_may_be_read_only_and_stay(self):
        value = ramp(5, 5)
        value[1, 1] = NAN
        value.flags.writeable = False
        before = value.tobytes()
        for rule in (rs.block_mean, rs.any_down, rs.region_boundaries, rs.renormalised):
            rule(value)
        for rule in (rs.nearest_up, rs.linear_up, rs.quadratic_up):
            rule(value, (9, 10))
        assert value.tobytes() == before


def seven_levels(value, rule):
    for _ in range(7):
        value = rule(value)
    return value


class TestThinAndSmall:
    @pytest.mark.parametrize("at", range(0, 256, 17))
    def test_a_thin_line_survives_seven_levels(self, at):
        """A boundary one pixel wide, wherever it runs, is still one whole line on a grid of 2 × 2."""
        lines = np.zeros((256, 256), bool)
        lines[:, at] = True
        coarse = seven_levels(lines, rs.any_down)
        assert coarse.shape == (2, 2)
        assert coarse.all(axis=0).sum() == 1

    @pytest.mark.parametrize("corner", [(0, 0), (1, 1), (127, 127), (126, 130), (200, 3), (253, 253)])
    def test_a_small_region_survives_seven_levels(self, corner):
        """3 × 3 pixels of 256 × 256 with a label of their own, wherever they lie."""
        regions = np.ones((256, 256), np.int32)
        regions[corner[0] : corner[0] + 3, corner[1] : corner[1] + 3] = 2
        for level in range(1, 8):
            regions = rs.most_frequent_down(regions)
            assert 2 in regions, f"lost at level {level}"
            assert 1 in regions
        assert regions.shape == (2, 2)
        assert regions.dtype == np.int32

    def test_many_small_regions_survive_while_there_is_room(self):
        """Sixteen regions of 3 × 3 in 128 × 128 are all there at 16 × 16."""
        regions = np.ones((128, 128), np.int32)
        for label in range(16):
            v, u = 32 * (label // 4) + 7 * (label % 3), 32 * (label % 4) + 5 * (label % 5)
            regions[v : v + 3, u : u + 3] = label + 2
        for _ in range(3):
            regions = rs.most_frequent_down(regions)
        assert set(np.unique(regions)) == set(range(1, 18))

    def test_a_region_boundary_one_pixel_wide_survives(self):
        """Label 0 counts as a label: the line between two regions stays closed."""
        regions = np.ones((64, 64), np.int32)
        regions[:, 33:] = 2
        regions[:, 32] = 0
        for _ in range(3):
            regions = rs.most_frequent_down(regions)
        assert (regions == 0).any(axis=1).all()
        assert {1, 2} <= set(np.unique(regions))

    def test_the_most_frequent_wins(self):
        regions = np.array([[5, 5, 7, 7], [5, 9, 7, 8]], np.int32)
        assert rs.most_frequent_down(np.tile(regions, (1, 1)))[0, 0] in (5, 9)
        large = np.array([[5, 5, 9, 9], [5, 9, 9, 9]], np.int32)
        assert rs.most_frequent_down(large).tolist() == [[5, 9]]

    def test_no_order_of_labels_changes_the_shape(self):
        """Renaming labels one to one renames the result where no tie has to be cut by the name."""
        rng = np.random.default_rng(3)
        regions = (np.add.outer(np.arange(40), np.arange(40)) // 13 + 1).astype(np.int32)
        name = np.concatenate([[0], 1 + rng.permutation(regions.max())]).astype(np.int32)
        down, renamed = rs.most_frequent_down(regions), rs.most_frequent_down(name[regions])
        same = name[down] == renamed
        assert same.mean() > 0.95

    @given(strategies.arrays("Regions"))
    def test_labels_are_never_invented(self, regions):
        assert set(np.unique(rs.most_frequent_down(regions))) <= set(np.unique(regions))

    @given(strategies.arrays("Boundaries"))
    def test_any_pixel_of_the_block(self, lines):
        coarse = rs.any_down(lines)
        assert coarse.dtype == bool
        assert (rs.nearest_up(coarse, lines.shape) >= lines).all()
        assert coarse.any() == lines.any()


class TestMostSignificant:
    def test_the_smallest_number_of_a_block_that_is_not_0(self):
        """A limb (1) goes before a crease (3), and any kind before none; odd sides repeat their last."""
        kinds = np.array([[0, 5, 3, 0, 4], [0, 0, 1, 0, 0], [2, 0, 0, 0, 0]], np.uint8)
        assert rs.most_significant_down(kinds).tolist() == [[5, 1, 4], [2, 0, 0]]

    @given(strategies.arrays("BoundaryKinds"))
    def test_no_line_is_lost_or_invented(self, kinds):
        coarse = rs.most_significant_down(kinds)
        np.testing.assert_array_equal(coarse > 0, rs.any_down(kinds > 0))
        assert set(np.unique(coarse)) <= set(np.unique(kinds))


class TestNormalsAndRegions:
    def test_renormalised(self):
        vectors = np.array([[[3, 0, -4], [0, 0, 0], [NAN, 0, 1]]], np.float32)
        found = rs.renormalised(vectors)
        np.testing.assert_allclose(found[0, 0], [0.6, 0, -0.8], rtol=1e-6)
        assert np.isnan(found[0, 1:]).all()

    def test_boundaries_between_regions(self):
        regions = np.array([[1, 1, 2], [1, 1, 2], [3, 3, 0]], np.int32)
        assert rs.region_boundaries(regions).tolist() == [
            [False, True, False],
            [True, True, True],
            [False, True, True],
        ]

    def test_one_region_has_none(self):
        assert not rs.region_boundaries(np.ones((4, 1), np.int32)).any()

"""The intrinsic map: immutable, its derived fields computed once, each field with its writer and confidence."""

from __future__ import annotations

import dataclasses
import threading

import numpy as np
import pytest

from visint.fields import KINDS, Camera, geometry
from visint.fields.kinds import down, up
from visint.fields.snapshot import MapSnapshot, Writer

SIZE = (9, 14)
CAMERA = Camera(focal_length=20.0, cx=6.5, cy=4.0, baseline=5.0, width=14, height=9)
FIELDS = {"depth": KINDS["Depth"], "boundaries": KINDS["Boundaries"]}
DEPTH = np.linspace(4, 5, 9 * 14, dtype=np.float32).reshape(SIZE)
ME = Writer("me", 2, 3)


def snapshot(depth=DEPTH, boundaries=None):
    sure = None if depth is None else np.zeros(SIZE, np.float32)
    values = {"depth": depth, "boundaries": boundaries}
    return MapSnapshot(CAMERA, FIELDS, values, {"depth": sure, "boundaries": None})


class TestReading:
    def test_stored_fields_and_their_confidence(self):
        """`depth` is the very array, `depth_confidence` how sure of it; `map` is the snapshot itself."""
        one = snapshot()
        assert one.read("depth") is DEPTH
        np.testing.assert_array_equal(one.read("depth_confidence"), 0)
        assert one.read("map") is one

    def test_what_is_not_there_yet_is_none(self):
        one = snapshot(depth=None)
        for name in ("depth", "depth_confidence", "boundaries", "boundaries_confidence", "regions"):
            assert one.read(name) is None
        for name in ("disparity", "normals", "slopes"):
            assert one.read(name) is None

    def test_derived_fields_follow_from_depth(self):
        """d = fB/Z, unit normals, slopes per pixel; all read-only."""
        one = snapshot()
        np.testing.assert_allclose(one.read("disparity"), 100 / DEPTH, rtol=1e-6)
        np.testing.assert_array_equal(one.read("normals"), geometry.normals_from_depth(DEPTH, CAMERA))
        np.testing.assert_array_equal(one.read("slopes"), geometry.slopes_from_depth(DEPTH))
        for name in ("disparity", "normals", "slopes"):
            assert not one.read(name).flags.writeable

    def test_regions_follow_from_boundaries(self):
        """4-connected: two regions that touch at a corner only are two."""
        boundaries = np.ones(SIZE, bool)
        boundaries[0, 0] = boundaries[1, 1] = boundaries[5:7, 5:7] = False
        regions = snapshot(boundaries=boundaries).read("regions")
        assert regions.dtype == np.int32
        assert not regions.flags.writeable
        np.testing.assert_array_equal(regions == 0, boundaries)
        assert len({regions[0, 0], regions[1, 1], regions[5, 5]}) == 3

    def test_derived_fields_are_computed_once(self, monkeypatch):
        seen = []
        real = geometry.disparity_from_depth
        monkeypatch.setattr(geometry, "disparity_from_depth", lambda *a: seen.append(1) or real(*a))
        one = snapshot()
        assert one.read("disparity") is one.read("disparity")
        assert len(seen) == 1

    def test_an_unknown_field_is_a_key_error(self):
        for name in ("dpeth", "texture_confidence", ""):
            for depth in (DEPTH, None):
                with pytest.raises(KeyError):
                    snapshot(depth).read(name)

    def test_many_readers_at_once_get_one_array(self):
        """Threads that read a derived field together all get the same values."""
        one, found = snapshot(), []
        threads = [threading.Thread(target=lambda: found.append(one.read("normals"))) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for each in found:
            np.testing.assert_array_equal(each, found[0])


class TestWriting:
    def test_gives_a_new_snapshot(self):
        """The old one keeps its field, its writer and what was derived from it."""
        one = snapshot()
        before = one.read("disparity")
        two = one.with_field("depth", 2 * DEPTH, None, ME)
        assert one.read("depth") is DEPTH
        assert one.read("disparity") is before
        assert dict(one.writers) == {}
        np.testing.assert_array_equal(two.read("depth"), 2 * DEPTH)
        np.testing.assert_allclose(two.read("disparity"), 50 / DEPTH, rtol=1e-6)
        assert dict(two.writers) == {"depth": ME}

    def test_keeps_the_confidence_that_is_not_given(self):
        sure = np.full(SIZE, 0.25, np.float32)
        one = snapshot().with_field("depth", DEPTH, sure, ME)
        two = one.with_field("depth", 2 * DEPTH, None, Writer("you", 0, 0))
        np.testing.assert_array_equal(two.read("depth_confidence"), sure)
        assert two.writers["depth"] == Writer("you", 0, 0)

    def test_a_first_field_without_confidence_is_not_sure(self):
        one = snapshot(depth=None).with_field("depth", DEPTH, None, ME)
        np.testing.assert_array_equal(one.read("depth_confidence"), np.zeros(SIZE, np.float32))

    def test_everything_is_read_only(self):
        """Neither what is read nor the snapshot can be changed; the array that was given stays the giver's."""
        mine = DEPTH.copy()
        one = snapshot().with_field("depth", mine, np.ones(SIZE, np.float32), ME)
        for name in ("depth", "depth_confidence"):
            with pytest.raises(ValueError, match="read-only"):
                one.read(name)[0, 0] = 1
        with pytest.raises(dataclasses.FrozenInstanceError):
            one.values = {}
        assert mine.flags.writeable

    def test_other_fields_are_shared_not_copied(self):
        boundaries = np.zeros(SIZE, bool)
        one = snapshot(boundaries=boundaries)
        two = one.with_field("depth", 2 * DEPTH, None, ME)
        assert two.read("boundaries") is boundaries


class TestLevels:
    def test_coarser_follows_each_fields_rule(self):
        """Depth is averaged, a boundary any of its block, confidence averaged, the camera halved."""
        boundaries = np.zeros(SIZE, bool)
        boundaries[:, 5] = True
        sure = np.linspace(0, 1, 9 * 14, dtype=np.float32).reshape(SIZE)
        one = snapshot(boundaries=boundaries).with_field("depth", DEPTH, sure, ME)
        small = one.coarser()
        np.testing.assert_array_equal(small.read("depth"), down(DEPTH, KINDS["Depth"]))
        np.testing.assert_array_equal(small.read("boundaries")[:, 2], True)
        np.testing.assert_array_equal(small.read("depth_confidence"), down(sure, KINDS["Confidence"]))
        assert small.read("boundaries_confidence") is None
        assert small.camera == CAMERA.halved()
        assert small.writers == one.writers
        np.testing.assert_allclose(small.read("disparity"), 50 / small.read("depth"), rtol=1e-6)

    @pytest.mark.parametrize("how", ["replicate", "linear", "quadratic"])
    def test_finer_by_the_rule_asked_for(self, how):
        """`between` chooses by kind; boundaries keep theirs; the camera doubles to the very size."""
        boundaries = np.zeros(SIZE, bool)
        boundaries[4] = True
        large = snapshot(boundaries=boundaries).finer((18, 27), {"Depth": how})
        np.testing.assert_array_equal(large.read("depth"), up(DEPTH, KINDS["Depth"], (18, 27), how))
        assert large.read("boundaries")[8:10].all()
        assert large.read("boundaries").shape == (18, 27)
        assert large.camera.size == (18, 27)
        np.testing.assert_allclose(large.read("disparity"), 200 / large.read("depth"), rtol=1e-6)

    def test_down_and_up_keeps_a_plane_of_disparity_in_full_pixels(self):
        """5 px at full size are 2.5 px below, and 5 px again above: the map stores depth."""
        flat = np.full(SIZE, 20.0, np.float32)
        one = snapshot(depth=flat)
        np.testing.assert_allclose(one.read("disparity"), 5)
        small = one.coarser()
        np.testing.assert_allclose(small.read("disparity"), 2.5)
        np.testing.assert_allclose(small.finer(SIZE, {}).read("disparity"), 5)

    def test_another_camera_derives_anew(self):
        """Seen by a camera of another baseline the depth is the same, the disparity is not."""
        one = snapshot()
        one.read("disparity")
        other = one.seen_by(CAMERA.model_copy(update={"baseline": 10.0}))
        assert other.read("depth") is DEPTH
        np.testing.assert_allclose(other.read("disparity"), 200 / DEPTH, rtol=1e-6)


def test_two_equal_snapshots_are_told_apart_by_identity():
    """Snapshots hold arrays: they are compared and hashed as objects, not value by value."""
    one, two = snapshot(), snapshot()
    assert one == one  # noqa: PLR0124
    assert one != two
    assert len({one, two}) == 2

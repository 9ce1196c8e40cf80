"""The table of field kinds: as documented, and each rule on values whose next level is known."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from visint.arrays import SPECS, ArraySpec
from visint.fields import KINDS, Camera, DepthEvidence, DisparityEvidence, FieldKind, Light, down, kinds, up
from visint.fields import resampling as rs
from visint.fields.evidence import Evidence, known
from visint.testing import strategies
from visint.testing.samples import evidence_class

ARRAYS = [kind for kind in KINDS.values() if kind.array is not None and kind.array.dims != ("N",)]
IMAGES = [kind.name for kind in ARRAYS]


def table():
    """The rows of the table in the docstring of kinds.py: name → (array, unit, down, up, constrains)."""
    text = kinds.__doc__.splitlines()
    rules = [i for i, line in enumerate(text) if line.startswith("====")]
    starts = [match.start() for match in re.finditer(r"=+", text[rules[0]])]
    rows = {}
    for line in text[rules[1] + 1 : rules[2]]:
        ends = [*starts[1:], None]
        name, *cells = [line[a:b].strip() for a, b in zip(starts, ends, strict=True)]
        rows[name] = tuple(cells)
    return rows


class TestTable:
    def test_the_documented_kinds_are_the_kinds(self):
        """Same names, in the same order."""
        assert list(table()) == list(KINDS)

    @pytest.mark.parametrize("name", KINDS)
    def test_array_unit_and_constrained_field(self, name):
        array, unit, _, _, constrains = table()[name]
        kind = KINDS[name]
        assert constrains == kind.constrains
        if kind.array is None:
            assert not unit
        else:
            assert array == f"{kind.array.dtype} {' '.join(map(str, kind.array.dims))}"
            assert unit == kind.array.unit

    @pytest.mark.parametrize("name", KINDS)
    def test_the_rules_are_what_the_words_say(self, name):
        """The words of the table against what the kind does to a value."""
        _, _, downwards, upwards, _ = table()[name]
        kind = KINDS[name]
        rules = {
            "any pixel": rs.any_down,
            "most frequent": rs.most_frequent_down,
            "most significant": rs.most_significant_down,
            "mean": rs.block_mean,
            "mean of known": rs.block_mean,
        }
        words = downwards.split(",")[0]
        if words in rules and name != "Normals":
            assert kind.down is rules[words]
        assert (kind.up is rs.linear_up) == upwards.startswith("linear") == kind.interpolated
        assert (kind.up is rs.nearest_up) == (upwards == "nearest")
        assert (words, upwards).count("same") in (0, 2)
        factor = {"halved": 2.0, "×2": 0.5}.get(downwards.split(", ")[-1], 1.0) if kind.array else 1.0
        assert kind.finer == factor
        assert {2.0: "×2", 0.5: "½", 1.0: "linear"}[kind.finer] in upwards or not kind.interpolated

    def test_the_table_cannot_be_changed(self):
        with pytest.raises(TypeError):
            KINDS["Depth"] = None

    def test_every_array_kind_is_a_kind(self):
        assert {kind.name: kind.array for kind in KINDS.values() if kind.array} == dict(SPECS)

    def test_every_kind_of_evidence_constrains_a_field(self):
        """And every class of evidence carries the kind it measures."""
        for evidence in Evidence.__subclasses__():
            if evidence.__module__ == "visint.fields.evidence":
                assert KINDS[evidence.measures].constrains


class TestDownAndUp:
    @given(st.data(), strategies.sizes(20), st.sampled_from(IMAGES))
    def test_dtype_size_and_read_only(self, data, size, name):
        """Going down and up again gives an array of the same spec and size, read-only."""
        kind = KINDS[name]
        value = data.draw(strategies.arrays(name, size))
        coarse = down(value, kind)
        fine = up(coarse, kind, size)
        assert coarse.shape[:2] == rs.smaller(size)
        assert fine.shape == value.shape
        assert fine.dtype == coarse.dtype == value.dtype
        assert not coarse.flags.writeable
        assert not fine.flags.writeable
        kind.array.check(fine)

    @given(st.data(), st.sampled_from(IMAGES))
    def test_a_constant_stays_one(self, data, name):
        """A field of one value has, down and up again, that value (in its unit of the level)."""
        kind = KINDS[name]
        value = data.draw(strategies.arrays(name, (1, 1)))
        value = np.broadcast_to(value, (6, 10, *value.shape[2:]))
        coarse = down(value, kind)
        np.testing.assert_allclose(coarse[0, 0], value[0, 0] / np.float32(kind.finer), rtol=1e-5)
        np.testing.assert_allclose(up(coarse, kind, (6, 10)), value, rtol=1e-5)

    def test_disparity_scales_depth_does_not(self):
        value = np.full((4, 4), 8, np.float32)
        assert (down(value, KINDS["Disparity"]) == 4).all()
        assert (up(value, KINDS["Disparity"], (8, 8)) == 16).all()
        assert (down(value, KINDS["Depth"]) == 8).all()

    def test_slopes_are_per_pixel_of_the_level(self):
        """A pixel twice as wide has twice the rise."""
        value = np.full((4, 4, 2), 8, np.float32)
        assert (down(value, KINDS["Slopes"]) == 16).all()
        assert (up(value, KINDS["Slopes"], (8, 8)) == 4).all()

    def test_normals_are_unit_vectors_again(self):
        left, right = np.float32([-0.6, 0, -0.8]), np.float32([0.6, 0, -0.8])
        value = np.stack([left, right, left, left])[None].repeat(2, axis=0)
        coarse = down(value, KINDS["Normals"])
        np.testing.assert_allclose(coarse[0], [[0, 0, -1], left], atol=1e-6)
        fine = up(coarse, KINDS["Normals"], (2, 4))
        np.testing.assert_allclose(np.linalg.norm(fine, axis=-1), 1, rtol=1e-6)

    def test_scalars_cameras_and_lights(self):
        light = Light.distant(0, 0, -1)
        assert down(light, KINDS["Light"]) is up(light, KINDS["Light"], (4, 4)) is light
        assert down(0.5, KINDS["Scalar"]) == up(0.5, KINDS["Scalar"], (4, 4)) == 0.5
        assert down(True, KINDS["Flag"]) is True
        camera = Camera.uncalibrated(9, 7, (0, 8))
        coarse = down(camera, KINDS["Camera"])
        assert coarse.size == (4, 5)
        assert up(coarse, KINDS["Camera"], (7, 9)) == camera

    @pytest.mark.parametrize("name", KINDS)
    def test_none_and_lists(self, name):
        """An optional value that is not there stays so; a list goes item by item."""
        kind = KINDS[name]
        assert down(None, kind) is up(None, kind, (4, 4)) is None
        assert down((), kind) == up((), kind, (4, 4)) == ()

    def test_a_list_of_images(self):
        one = np.ones((4, 4), np.float32)
        coarse = down((one, 3 * one), KINDS["Image"])
        assert [image.mean() for image in coarse] == [1, 3]
        assert [image.shape for image in up(coarse, KINDS["Image"], (3, 4))] == [(3, 4)] * 2

    def test_between_overrides_only_what_can_be_interpolated(self):
        parabola = (np.arange(16, dtype=np.float32) ** 2)[None].repeat(16, axis=0)
        depth, lines = KINDS["Depth"], KINDS["Boundaries"]
        coarse = down(parabola, depth)
        smooth = up(coarse, depth, (16, 16), "quadratic")
        np.testing.assert_allclose(smooth[2:-2, 2:-2], parabola[2:-2, 2:-2], atol=1e-3)
        stairs = up(coarse, depth, (16, 16), "replicate")
        assert (stairs[:, ::2] == stairs[:, 1::2]).all()
        some = parabola > 30
        np.testing.assert_array_equal(
            up(down(some, lines), lines, (16, 16), "quadratic"), up(down(some, lines), lines, (16, 16))
        )

    @pytest.mark.parametrize("how", ["replicate", "linear", "quadratic"])
    def test_disparity_scales_however_it_goes_up(self, how):
        raised = up(np.full((2, 2), 3, np.float32), KINDS["Disparity"], (4, 4), how)
        assert (raised == 6).all()


class TestEvidence:
    def test_sigma_scales_with_the_value(self):
        """A pixel of sigma is half a pixel one level coarser, and two one level finer."""
        ones = np.ones((4, 4), np.float32)
        evidence = DisparityEvidence.of(8 * ones, 1.0, 0.5)
        coarse, fine = (
            down(evidence, KINDS["Disparity"]),
            up(evidence, KINDS["Disparity"], (8, 8)),
        )
        assert (coarse.sigma == 0.5).all()
        assert (fine.sigma == 2).all()
        assert (coarse.reliability == 0.5).all()
        assert (fine.reliability == 0.5).all()

    def test_half_a_block_is_half_as_reliable(self):
        """Reliability averages, what abstains included: a block that mostly abstains is hardly sure."""
        value = np.float32([[1, np.nan], [3, np.nan]])
        coarse = down(DepthEvidence.of(value, 0.2, 1.0), KINDS["Depth"])
        assert coarse.value.tolist() == [[2]]
        assert coarse.reliability.tolist() == [[0.5]]
        assert coarse.sigma[0, 0] == pytest.approx(0.2)

    @given(st.data(), strategies.sizes(16), st.sampled_from([k.name for k in ARRAYS if k.constrains]))
    def test_stays_consistent_down_and_up(self, data, size, name):
        """NaN value ⇔ reliability 0 at every level: the class itself checks it as it is built."""
        if name == "Regions":  # no evidence is about regions: they follow from boundaries
            return
        kind = KINDS[name]
        evidence = data.draw(strategies.evidence(name, size))
        coarse = down(evidence, kind)
        fine = up(coarse, kind, size)
        for each in (coarse, fine):
            assert type(each) is evidence_class(name)
            speaks = each.reliability > 0
            if each.value.dtype != bool:
                np.testing.assert_array_equal(speaks, known(each.value))
        assert fine.value.shape == evidence.value.shape


class TestStrangersKind:
    flow = FieldKind(
        "flow.Flow",
        ArraySpec("flow.Flow", "float32", ("H", "W", 2), "px"),
        rs.block_mean,
        rs.linear_up,
        finer=2.0,
        interpolated=True,
    )

    def test_flow_scales_like_disparity(self):
        value = np.full((5, 6, 2), 8, np.float32)
        coarse = down(value, self.flow)
        assert coarse.shape == (3, 3, 2)
        assert (coarse == 4).all()
        np.testing.assert_array_equal(up(coarse, self.flow, (5, 6)), value)
        assert (up(coarse, self.flow, (5, 6), "replicate") == 8).all()

    @pytest.mark.parametrize("dtype", ["float64", "float16"])
    def test_arrays_keep_their_dtype(self, dtype):
        """The shipped rules calculate in float32, but the kind's dtype is what comes out."""
        spec = ArraySpec("own.Precise", dtype, ("H", "W"))
        kind = FieldKind("own.Precise", spec, rs.block_mean, rs.linear_up, 2.0, True)
        value = np.full((4, 4), 8, dtype)
        coarse = down(value, kind)
        assert coarse.dtype == up(coarse, kind, (4, 4)).dtype == dtype
        assert up(coarse, kind, (4, 4), "quadratic").dtype == dtype

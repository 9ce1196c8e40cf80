"""Inputs of a run: missing, unknown, of another kind, type, shape or size; all problems together."""

from __future__ import annotations

import numpy as np
import pytest

from visint.errors import InputError, ModuleError
from visint.fields import Light

SEE = """
inputs: {left: Image}
nodes: {see: {uses: toy.image, in: {image: inputs.left}}}
outputs: {image: see.image}
"""
COLOR = SEE.replace("left: Image", "left: Color")
PAIR = """
inputs: {left: Image, camera: Camera}
nodes: {see: {uses: toy.image, in: {image: inputs.left}}, f: {uses: toy.focal, in: {camera: inputs.camera}}}
outputs: {image: see.image, f: f.value}
"""
LISTED = """
inputs: {images: [Image], lights: [Light]}
nodes: {depth: {uses: toy.photometric, in: {images: inputs.images, lights: inputs.lights}}}
outputs: {depth: depth.evidence}
"""


def scalar(kind, declared=None):
    declared = declared or kind
    return f"""
inputs: {{x: {declared}}}
nodes: {{add: {{uses: toy.add, in: {{a: inputs.x}}}}}}
outputs: {{sum: add.sum}}
"""


class TestNames:
    def test_missing(self, stage):
        with pytest.raises(InputError, match=r"VI304: the input 'left' \(Image\) is missing"):
            stage.run(SEE)

    def test_unknown_with_the_near_one(self, stage, image):
        with pytest.raises(InputError, match=r"no input 'lift'.*\n.*inputs: left: Image.*Write: left="):
            stage.run(SEE, {"left": image, "lift": image})

    def test_all_problems_together(self, stage):
        """Each input that is wrong is told in one go."""
        with pytest.raises(InputError) as caught:
            stage.run(PAIR, {"left": "left.png", "rigth": 1})
        assert [problem.code for problem in caught.value.problems] == ["VI304", "VI305", "VI304"]
        assert {problem.fault for problem in caught.value.problems} == {"input"}
        assert caught.value.exit_code == 3

    def test_optional_may_be_missing_or_none(self, stage):
        assert stage.run(scalar("Scalar?"))["sum"] == 0
        assert stage.run(scalar("Scalar?"), {"x": None})["sum"] == 0


class TestArrays:
    def test_float64_is_taken(self, stage, image):
        """Another float becomes float32: it means the same."""
        result = stage.run(SEE, {"left": image.astype(np.float64)})
        assert result["image"].dtype == np.float32
        np.testing.assert_array_equal(result["image"], image)

    def test_any_layout_is_taken(self, stage, image):
        """Transposed, reversed and sliced views are images like any other."""
        for view in (image.T, image[::-1], image[:, ::2], np.asfortranarray(image)):
            np.testing.assert_array_equal(stage.run(SEE, {"left": view})["image"], view)

    @pytest.mark.parametrize("color", [False, True])
    def test_uint8_is_refused_with_a_hint(self, stage, color):
        """Nobody knows the scale of whole numbers, nor their curve: gray and colour alike."""
        value = np.full((6, 5, 3) if color else (6, 5), 200, np.uint8)
        with pytest.raises(InputError, match=r"VI305.*uint8.*\n.*astype\(np.float32\) / 255"):
            stage.run(SEE, {"left": value})

    @pytest.mark.parametrize("shape", [(4,), (2, 3, 4), (4, 5, 4), (4, 5, 2)])
    def test_other_shapes_are_refused(self, stage, shape):
        with pytest.raises(InputError, match=r"VI305: the input 'left'.*this array has shape"):
            stage.run(SEE, {"left": np.zeros(shape, np.float32)})

    def test_colour_feeds_an_image_by_its_luminance(self, stage):
        """0.2126 R + 0.7152 G + 0.0722 B of linear intensities, be the input declared Image or Color."""
        color = np.random.default_rng(1).random((5, 7, 3), dtype=np.float32)
        wanted = color @ np.array([0.2126, 0.7152, 0.0722])
        for text in (SEE, COLOR):
            np.testing.assert_allclose(stage.run(text, {"left": color})["image"], wanted, atol=1e-6)
            np.testing.assert_allclose(
                stage.run(text, {"left": color.astype(float)})["image"], wanted, atol=1e-6
            )

    @pytest.mark.parametrize("shape", [(0, 5), (5, 0), (0, 0)])
    def test_an_empty_image_is_refused(self, stage, shape):
        with pytest.raises(InputError, match=r"VI305.*empty"):
            stage.run(SEE, {"left": np.zeros(shape, np.float32)})

    def test_one_pixel_is_an_image(self, stage):
        assert stage.run(SEE, {"left": np.ones((1, 1), np.float32)})["image"].shape == (1, 1)

    def test_lists_of_numbers_are_told_what_is_wanted(self, stage):
        """A nested list is float64 numbers: taken. Text is not."""
        assert stage.run(SEE, {"left": [[0.0, 1.0]]})["image"].tolist() == [[0, 1]]
        with pytest.raises(InputError, match=r"VI305.*this is a str"):
            stage.run(SEE, {"left": "left.png"})


class TestCamera:
    def test_of_another_size(self, stage, image, camera_for):
        with pytest.raises(InputError, match="VI307: the camera is of 13 × 11 pixels, the images of 13 × 21"):
            stage.run(PAIR, {"left": image, "camera": camera_for(image[:11])})

    def test_is_no_dictionary(self, stage, image):
        with pytest.raises(InputError, match=r"VI305: the input 'camera' wants Camera; this is dict"):
            stage.run(PAIR, {"left": image, "camera": {"focal_length": 1}})

    def test_arrives_as_it_is(self, stage, image, camera_for):
        assert stage.run(PAIR, {"left": image, "camera": camera_for(image)})["f"] == 40.0


class TestNumbers:
    @pytest.mark.parametrize("x", [2, 2.0, np.float32(2), np.float64(2), np.int64(2)])
    def test_any_number_is_a_scalar(self, stage, x):
        """Python's numbers and numpy's; the result is a plain one."""
        result = stage.run(scalar("Scalar"), {"x": x})
        assert result["sum"] == 2
        assert type(result.inputs["x"]) in (int, float)

    @pytest.mark.parametrize("x", [True, "2", [2], np.zeros(1)])
    def test_other_things_are_not(self, stage, x):
        with pytest.raises(InputError, match="VI305: the input 'x' wants Scalar"):
            stage.run(scalar("Scalar"), {"x": x})


class TestLists:
    def lights(self, n):
        return [Light.distant(0, 0, -1)] * n

    def test_images_and_lights(self, stage, image):
        """Photometric stereo from a list of images: 1 + their mean, reliability n/(n + 1)."""
        result = stage.run(LISTED, {"images": [image, 3 * image], "lights": self.lights(2)})
        np.testing.assert_allclose(result["depth"], 1 + 2 * image, rtol=1e-6)
        np.testing.assert_allclose(result.confidence["depth"], 2 / 3, rtol=1e-6)
        assert stage.calls == [("depth", 0, 0)]

    def test_one_is_no_list(self, stage, image):
        with pytest.raises(
            InputError, match=r"VI305: the input 'images' is a list, \[Image\]; this is a ndarray"
        ):
            stage.run(LISTED, {"images": image, "lights": self.lights(1)})

    def test_a_wrong_member_is_named(self, stage, image):
        with pytest.raises(InputError, match=r"VI305: the input 'images\[1\]'.*float32"):
            stage.run(LISTED, {"images": [image, image > 0.5], "lights": self.lights(2)})

    def test_an_empty_member_is_refused(self, stage, image):
        with pytest.raises((InputError, ModuleError)):
            stage.run(LISTED, {"images": [image, image[:0]], "lights": self.lights(2)})

    def test_of_colours(self, stage, image):
        """Each member of a list of colours is read by its luminance where images are wanted."""
        color = np.stack([image] * 3, axis=-1)
        for text in (LISTED, LISTED.replace("images: [Image]", "images: [Color]")):
            result = stage.run(text, {"images": [color, color], "lights": self.lights(1)})
            np.testing.assert_allclose(result["depth"], 1 + image, rtol=1e-5)

    def test_goes_through_levels_member_by_member(self, stage, image):
        text = LISTED.replace("nodes: {depth: {", "nodes: {depth: {loop: levels, ").replace(
            "nodes:", "loops: {levels: {over: pyramid, levels: 3}}\nnodes:"
        )
        result = stage.run(text, {"images": [image, image], "lights": self.lights(1)})
        np.testing.assert_allclose(result["depth"], 1 + image, rtol=1e-6)
        assert stage.calls == [("depth", level, 0) for level in (2, 1, 0)]

    def test_built_in_the_graph(self, stage, image):
        """`in: [a.image, b.image]` makes a list of several nodes' outputs, in the order written."""
        result = stage.run(
            """
inputs: {left: Image}
nodes:
  dark: {uses: toy.image, with: {gain: 0.5}, in: {image: inputs.left}}
  light: {uses: toy.image, with: {offset: 1.0}, in: {image: inputs.left}}
  mean: {uses: toy.stack, in: {images: [dark.image, light.image]}}
outputs: {mean: mean.image}
""",
            {"left": image},
        )
        np.testing.assert_allclose(result["mean"], 0.75 * image + 0.5, rtol=1e-5)

"""Whose word the surface is."""

from __future__ import annotations

import numpy as np

import visint
from visint_bayes.joint.credit import of_objects, of_photographs
from visint_lab.render.rendering import render
from visint_lab.scenes import scene


def test_on_photographs_the_last_that_speaks_has_all_of_a_pixel():
    """Two cues of disparity, one of depth: disparity overrules depth, the second overrules the first."""
    first, second, deep = (np.float32([row]) for row in ([0.5, 0.5, 0.0, 0.0], [0.9, 0, 0, 0], [1, 1, 1, 0]))
    shares = of_photographs([deep], [first, second], 1)
    assert [share.tolist() for share in shares] == [[[0, 1, 0, 0]], [[1, 0, 0, 0]], [[0, 0, 1, 0]], [[0] * 4]]


def test_before_a_void_brightness_has_the_parts_it_took_part_in():
    """0.2 of a plate, 0.5 of brightness, the rest stereo's; around the object all is stereo's."""
    inside = np.array([[True, False]])
    stereo, planes, bright = of_objects({"plate": 0.2, "bright": 0.5}, inside, (2, 0, 1))
    assert stereo.tolist() == [[0.5, 1.0]]
    assert planes.tolist() == [[0.0, 0.0]]
    assert bright.tolist() == [[0.5, 0.0]]


def test_a_run_says_that_shading_decided_a_shaded_sphere():
    """More of the object than where no light is given, which is none."""
    sphere = render(scene("a/sphere/lambertian+2%", 96, 77), seed=77)
    given = {"left": sphere.left, "right": sphere.right, "camera": sphere.camera, "light": sphere.light}
    found = visint.run("joint", given, options=visint.Options(attribution=True))
    shares = found.attribution["depth"]
    inside = sphere.truth.foreground
    assert shares["shading"][inside].mean() > 0.2
    assert not shares["planes"][inside].any()

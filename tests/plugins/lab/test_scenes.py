"""The sets by name, and the surfaces that are data."""

import numpy as np
import pytest

import visint
from visint_lab.datasets.places import data_folder
from visint_lab.render.rendering import render
from visint_lab.scenes import names, scene


def have(part):
    try:
        return bool(data_folder(part))
    except visint.InputError:
        return False


def test_the_sets_hold_what_the_tables_need():
    """Six primitives in both materials with two noises in A; checker and five Mozarts with three in B."""
    assert len(names("a")) == 6 * 2 * 2
    assert len(names("b")) == (6 + 5) * 3


@pytest.mark.parametrize("name", [n for n in names() if "+" not in n])
def test_every_object_is_in_view_of_both_cameras(name):
    """The whole object is inside both images, with room around it, and hardly any of it is half-occluded."""
    try:
        pair = render(scene(name, 64), samples=1)
    except visint.InputError:
        pytest.skip("its range data is not there")
    for depth in (pair.truth.depth, pair.truth.depth_right):
        seen = np.isfinite(depth)
        assert not seen[[0, -1]].any()
        assert not seen[:, [0, -1]].any()
    seen = pair.truth.foreground
    assert 0.08 < seen.mean() < 0.6
    assert pair.truth.visible[seen].mean() > 0.85
    low, high = pair.camera.disparity_range
    assert low < np.nanmin(pair.truth.disparity) <= np.nanmax(pair.truth.disparity) < high


def test_seeds_give_other_poses_of_the_same_object():
    """Equal seeds repeat to the bit, others differ; without a seed the pose is the chosen one."""
    one, again, other, chosen = (render(scene("a/torus/lambertian", 48, s), 1).left for s in (7, 7, 8, None))
    np.testing.assert_array_equal(one, again)
    assert not np.array_equal(one, other)
    assert not np.array_equal(one, chosen)


@pytest.mark.parametrize(
    "name", [n for n in names() if "+" not in n and "mozart" not in n and "range" not in n]
)
def test_random_poses_stay_in_view(name):
    """Whatever the seed, the object leaves the border of the left image free."""
    for seed in range(4):
        seen = render(scene(name, 32, seed), samples=1).truth.foreground
        assert not seen[[0, -1]].any()
        assert not seen[:, [0, -1]].any()


@pytest.mark.parametrize("seed", range(3))
def test_a_paraboloid_keeps_its_apex_in_view(seed):
    """Its axis stays within 50° of the line of sight, so its mantle is what is seen."""
    axis = np.asarray(scene("b/paraboloid/checker", 48, seed).things[0].rotation)[:, 2]
    assert axis[2] > np.cos(np.radians(71))  # two tilts of at most 50° together


def test_size_changes_the_sampling_and_nothing_else():
    """Half as many pixels see the same depth: the focal length scales with the image."""
    large, small = (render(scene("a/sphere/lambertian", n), 1) for n in (96, 48))
    half = large.camera.halved()
    for name in ("focal_length", "cx", "cy", "baseline", "doffs", "width"):
        assert getattr(small.camera, name) == pytest.approx(getattr(half, name), abs=1e-9)
    assert np.nanmin(small.truth.depth) == pytest.approx(np.nanmin(large.truth.depth), abs=0.05)


def test_an_unknown_name_lists_the_known_ones():
    """The error names what was asked for and every scene there is."""
    with pytest.raises(visint.UsageError, match=r"a/cube/lambertian.*[\s\S]*a/sphere/lambertian"):
        scene("a/cube/lambertian")


@pytest.mark.skipif(not have("extra/mozart_range"), reason="the Mozart range image is not there")
def test_mozart_has_depth_normals_and_the_asked_textures():
    """The bust renders with smooth normals that agree with its depth, textured on one side where asked."""
    from visint.fields.geometry import normals_from_depth

    pair = render(scene("b/mozart/partial", 128), samples=2)
    truth = pair.truth
    assert 0.2 < truth.foreground.mean() < 0.6
    rough = normals_from_depth(truth.depth, pair.camera)
    inner = np.isfinite(rough[..., 0]) & truth.foreground
    cosine = (rough * truth.normals).sum(-1)[inner]
    assert np.median(np.degrees(np.arccos(np.clip(cosine, -1, 1)))) < 5.0
    middle = int(np.round(pair.camera.cx + 128 * 1280 / 512 * 9 / 90))
    spread = [
        np.std(truth.albedo[:, part][truth.foreground[:, part]]) for part in np.s_[: middle - 8, middle + 8 :]
    ]
    assert spread[0] > 0.05
    assert spread[1] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.skipif(not have("extra/diligent_gt"), reason="the scanned figures are not there")
def test_a_scanned_figure_becomes_a_surface():
    """The foreground is as large as asked, and its relief has the scan's proportion."""
    from visint_lab.scenes.surfaces import diligent

    shape = diligent("bear", 20.0)
    seen = np.isfinite(shape.heights)
    assert max(seen.any(axis=0).sum(), seen.any(axis=1).sum()) * shape.pitch == pytest.approx(20.0, rel=0.02)
    assert 2.0 < np.nanmax(shape.heights) - np.nanmin(shape.heights) < 15.0

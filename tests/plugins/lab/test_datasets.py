"""Pairs read from folders as data sets lay them out."""

import numpy as np
import pytest

import visint
from visint.io import encode_kitti, encode_pfm, encode_png
from visint_lab.datasets import REAL, data_folder, pairs_in
from visint_lab.datasets.pair import Pair
from visint_lab.render.rendering import render
from visint_lab.scenes import scene

CALIB = (
    "cam0=[50 0 10; 0 50 6; 0 0 1]\ncam1=[50 0 12; 0 50 6; 0 0 1]\n"
    "doffs=2\nbaseline=10\nwidth=20\nheight=12\nndisp=8\nvmin=1\nvmax=6\n"
)


def write_bytes(path, data):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)


GREY = np.full((12, 20), 128, np.uint8)
TRUTH = np.full((12, 20), 4.0, np.float32)
TRUTH[0, 0] = np.nan


def have(part):
    try:
        return bool(data_folder(part))
    except visint.InputError:
        return False


@pytest.mark.parametrize("mask", ["mask0nocc.png", None])
def test_middlebury_2014_and_eth3d(tmp_path, mask):
    """im0, im1, disp0GT.pfm, calib.txt: truth in pixels, inf unknown, the search range from the calibration."""
    folder = tmp_path / "delivery"
    for name in ("im0.png", "im1.png"):
        write_bytes(folder / name, encode_png(GREY))
    write_bytes(folder / "disp0GT.pfm", encode_pfm(TRUTH))
    write_bytes(folder / "calib.txt", CALIB.encode())
    if mask:
        write_bytes(folder / mask, encode_png(np.where(TRUTH > 0, 255, 128).astype(np.uint8)))
    (files,) = pairs_in(tmp_path)
    pair = files.read()
    assert pair.name.endswith("/delivery")
    assert pair.camera.doffs == 2
    assert pair.camera.disparity_range == (1, 6)
    np.testing.assert_array_equal(pair.disparity, TRUTH)
    assert (pair.visible is None) == (mask is None)


def test_middlebury_2006_third_size(tmp_path):
    """view1 and view5 with disparities times three; visible where both truths agree."""
    folder = tmp_path / "ThirdSize" / "Aloe"
    for name in ("view1.png", "view5.png"):
        write_bytes(folder / name, encode_png(GREY))
    for name in ("disp1.png", "disp5.png"):
        write_bytes(folder / name, encode_png(np.full((12, 20), 12, np.uint8)))
    (files,) = pairs_in(tmp_path)
    pair = files.read()
    assert (pair.disparity == 4.0).all()
    assert not pair.camera.calibrated
    np.testing.assert_array_equal(pair.visible[0], np.arange(20) >= 4)


def test_kitti_2015(tmp_path):
    """image_2, image_3 and disp_occ_0: 16-bit disparities times 256, 0 unknown."""
    for folder in ("image_2", "image_3"):
        write_bytes(tmp_path / folder / "000007_10.png", encode_png(GREY))
        write_bytes(tmp_path / folder / "000007_11.png", encode_png(GREY))
    write_bytes(tmp_path / "disp_occ_0" / "000007_10.png", encode_kitti(TRUTH))
    (files,) = pairs_in(tmp_path)
    pair = files.read()
    assert pair.name == "kitti/000007_10"
    np.testing.assert_allclose(pair.disparity, TRUTH, atol=1 / 256)


def test_an_empty_folder_says_which_layouts_are_known(tmp_path):
    """One line: what was looked for."""
    with pytest.raises(visint.InputError, match=r"im0\.png"):
        pairs_in(tmp_path)


def test_a_rendering_is_a_pair_with_exact_normals():
    """Depth from its true disparity is its true depth; normals from it are near the exact ones."""
    pair = Pair.of(render(scene("a/sphere/lambertian", 64), samples=1))
    depth, normals = pair.geometry(pair.disparity)
    np.testing.assert_allclose(depth, pair.depth, rtol=1e-5)
    assert np.nanmedian(np.linalg.norm(normals - pair.normals, axis=-1)) < 0.05


@pytest.mark.skipif(not have("mb2001"), reason="the real pairs are not there")
def test_the_26_real_pairs_are_found_and_their_truth_fits():
    """Every pair reads; truth lies within its search range; images match best by the truth."""
    files = [pair for part in REAL for pair in pairs_in(data_folder(part))]
    assert len(files) == 26
    for one in (files[0], files[1], files[6], files[12], files[-4]):
        pair = one.read()
        assert pair.visible is None or pair.visible.shape == pair.left.shape == pair.disparity.shape
        low, high = pair.camera.disparity_range
        assert low - 1 <= np.nanmin(pair.disparity) <= np.nanmax(pair.disparity) <= high + 1
        off = [warp_error(pair, shift) for shift in (-3, 0, 3)]
        assert off[1] < 0.75 * min(off[0], off[2]), one.name


def warp_error(pair, shift):
    rows, columns = np.nonzero(np.isfinite(pair.disparity))
    place = np.round(columns - pair.disparity[rows, columns] - shift).astype(int)
    inside = (place >= 0) & (place < pair.left.shape[1])
    rows, columns, place = rows[inside], columns[inside], place[inside]
    return np.mean(np.abs(pair.left[rows, columns] - pair.right[rows, place]))

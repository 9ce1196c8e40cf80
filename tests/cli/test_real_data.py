"""A real pair against OpenCV's own matcher, measured side by side."""

from __future__ import annotations

import os
from pathlib import Path

import cv2
import numpy as np
import pytest

CHANNELS, BLOCK = 1, 3


@pytest.fixture
def piano(files):
    folder = Path(os.environ.get("VISINT_DATA", files.root / "../shared/data")) / "mb2014q" / "Piano"
    if not folder.is_dir():
        pytest.skip("no real data: set VISINT_DATA")
    return folder.resolve()


def filled(disparity):
    """Holes take the smaller of the two nearest known values in their row: what lies behind."""
    known = np.isfinite(disparity)
    columns = np.arange(disparity.shape[1])
    left = np.maximum.accumulate(np.where(known, columns, -1), axis=1)
    right = np.minimum.accumulate(np.where(known, columns, columns.size)[:, ::-1], axis=1)[:, ::-1]
    rows = np.arange(disparity.shape[0])[:, None]
    before = np.where(left >= 0, disparity[rows, np.maximum(left, 0)], np.inf)
    after = np.where(right < columns.size, disparity[rows, np.minimum(right, columns.size - 1)], np.inf)
    return np.minimum(before, after)


def opencvs(left, right, levels):
    """StereoSGBM in full (MODE_HH) with the parameters of OpenCV's own sample."""
    matcher = cv2.StereoSGBM_create(
        minDisparity=0,
        numDisparities=-(-levels // 16) * 16,
        blockSize=BLOCK,
        P1=8 * CHANNELS * BLOCK**2,
        P2=32 * CHANNELS * BLOCK**2,
        disp12MaxDiff=1,
        preFilterCap=63,
        uniquenessRatio=10,
        speckleWindowSize=100,
        speckleRange=32,
        mode=cv2.STEREO_SGBM_MODE_HH,
    )
    disparity = matcher.compute(left, right).astype(np.float32) / 16
    return np.where(disparity >= 0, disparity, np.nan)


def test_piano(visint, piano, tmp_path, files):
    """bad-2.0 against the truth is no worse than StereoSGBM's, holes of both filled alike."""
    inputs = ["--left", piano / "left.png", "--right", piano / "right.png", "--calib", piano / "calib.txt"]
    assert visint("run", "stereo_sgm", *inputs, "--out", "out").code == 0
    truth = files.pfm(piano / "disp_left.pfm")
    known = np.isfinite(truth)

    def bad(disparity):
        return np.mean(~(np.abs(filled(disparity) - truth)[known] <= 2))

    ours = files.pfm(tmp_path / "out/disparity.pfm")
    grey = [cv2.imread(str(piano / name), cv2.IMREAD_GRAYSCALE) for name in ("left.png", "right.png")]
    theirs = opencvs(*grey, levels=65)
    told = f"ours {bad(ours):.1%}, StereoSGBM {bad(theirs):.1%}"
    print(told)
    assert bad(np.where(np.isfinite(ours), ours, np.nan)) <= bad(theirs), told

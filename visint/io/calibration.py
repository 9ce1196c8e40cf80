"""Calibrations: Middlebury's ``calib.txt``, OpenCV's stereo YAML and KITTI's, told apart by content."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from visint.arrays import Array
from visint.errors import InputError
from visint.fields.camera import Camera
from visint.io.files import shown
from visint.io.kitti_calibration import kitti_calibration
from visint.io.middlebury import middlebury_camera
from visint.io.opencv_calibration import opencv_calibration
from visint.io.rectification import View, rectified
from visint.io.text import read_text

__all__ = ["Calibration", "read_calibration", "read_camera"]

Size = tuple[int, int]

_MOST = 1 << 16
_OPENCV = re.compile(r"\A\s*%YAML|!!opencv-(?:nd-)?matrix")
_KITTI = re.compile(r"^(?:P[0-3]|P_rect_0[0-3]|K_0[0-3]|S_0[0-3]|calib_time)\s*:", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Calibration:
    """What a calibration file says of a pair.

    Parameters
    ----------
    camera
        Of the pair once it is rectified.
    views
        How the left and the right image are to be rectified; None if they are already.
    remarks
        What should be said to whoever gave the file, one sentence each.
    """

    camera: Camera
    views: tuple[View, View] | None = None
    remarks: tuple[str, ...] = ()

    def rectify(self, image: Array, side: int) -> Array:
        """``image`` as the rectified camera sees it.

        Parameters
        ----------
        image
            float32 (H, W) or (H, W, 3) of the size that was calibrated.
        side
            0 for the left image, 1 for the right one.

        Returns
        -------
        float32 of the camera's size, bicubic within the range of ``image``; NaN where the lens did not look.

        Raises
        ------
        InputError
            VI307 if the image has another size.
        """
        return image if self.views is None else rectified(image, self.views[side], self.camera.size)


def read_calibration(path: str | Path, size: Size | None = None) -> Calibration:
    """The calibration in a file.

    Parameters
    ----------
    path
        Middlebury's ``calib.txt``; OpenCV's YAML with M1, D1, M2, D2, R, T (as its sample ``stereo_calib``
        names them, or K1, cameraMatrix1, …), of an unrectified rig, or P1, P2 of a rectified one; KITTI's
        ``calib.txt`` (P0 … P3) or ``calib_cam_to_cam.txt``.
    size
        (rows, columns) of the images: for files that do not say, and for KITTI's, which holds a size for the
        pair as taken and one for it rectified.

    Raises
    ------
    InputError
        VI301 to VI303 if the file cannot be read; VI306 with what is wrong in it and what it should say.
    """
    name, text = shown(path), read_text(path, most=_MOST)
    if text.lstrip().startswith("<"):
        found = "is XML; of OpenCV's files YAML is read: cv::FileStorage writes it to a name that ends in .yml"
        raise InputError.of("VI306", found, where=name)
    if _OPENCV.search(text):
        return Calibration(*opencv_calibration(text, name, size))
    if _KITTI.search(text):
        return Calibration(*kitti_calibration(text, name, size))
    return Calibration(middlebury_camera(text, name))


def read_camera(path: str | Path, size: Size | None = None) -> Camera:
    """The camera of a rectified pair; arguments as :func:`read_calibration` has them.

    Raises
    ------
    InputError
        As there; VI306 too if the calibration is of an unrectified rig, whose images must be warped.
    """
    calibration = read_calibration(path, size)
    if calibration.views is not None:
        found = "is of a pair that is not rectified; read_calibration gives what its images are warped by"
        write = "visint.io.read_calibration(path, size).rectify(image, side)"
        raise InputError.of("VI306", found, where=shown(path), write=write)
    return calibration.camera

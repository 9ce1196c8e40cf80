"""Files in and out, checked: the only place in visint that opens files.

Readers hold every header against the limits before anything is decoded, and turn every failure into one
:class:`~visint.errors.InputError`. Encoders return bytes, and take only arrays that the format holds
exactly. Writers leave a whole file or none. Each name is imported when it is first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from visint.io.calibration import Calibration as Calibration
    from visint.io.calibration import read_calibration as read_calibration
    from visint.io.calibration import read_camera as read_camera
    from visint.io.curves import linear_from_srgb as linear_from_srgb
    from visint.io.curves import luminance as luminance
    from visint.io.curves import srgb_from_linear as srgb_from_linear
    from visint.io.files import digest as digest
    from visint.io.files import files_in as files_in
    from visint.io.files import read_bytes as read_bytes
    from visint.io.folder import OutputFolder as OutputFolder
    from visint.io.folder import is_run as is_run
    from visint.io.glb import encode_glb as encode_glb
    from visint.io.inputs import read as read
    from visint.io.inputs import read_color as read_color
    from visint.io.inputs import read_image as read_image
    from visint.io.kitti import encode_kitti as encode_kitti
    from visint.io.kitti import fits_kitti as fits_kitti
    from visint.io.limits import LIMITS as LIMITS
    from visint.io.limits import Limits as Limits
    from visint.io.npy import encode_npy as encode_npy
    from visint.io.npz import encode_npz as encode_npz
    from visint.io.npz import read_npz as read_npz
    from visint.io.pfm import encode_pfm as encode_pfm
    from visint.io.ply import encode_ply as encode_ply
    from visint.io.png import encode_png as encode_png
    from visint.io.raster import Raster as Raster
    from visint.io.raster import read_raster as read_raster
    from visint.io.resources import resource_bytes as resource_bytes
    from visint.io.resources import resource_text as resource_text
    from visint.io.resources import shipped_folder as shipped_folder
    from visint.io.text import read_json as read_json
    from visint.io.text import read_text as read_text
    from visint.io.write import make_folder as make_folder
    from visint.io.write import write_bytes as write_bytes
    from visint.io.write import write_text as write_text

_HOME = {
    "Calibration": "calibration",
    "LIMITS": "limits",
    "Limits": "limits",
    "OutputFolder": "folder",
    "Raster": "raster",
    "digest": "files",
    "encode_glb": "glb",
    "encode_kitti": "kitti",
    "encode_npy": "npy",
    "encode_npz": "npz",
    "encode_pfm": "pfm",
    "encode_ply": "ply",
    "encode_png": "png",
    "files_in": "files",
    "fits_kitti": "kitti",
    "is_run": "folder",
    "linear_from_srgb": "curves",
    "luminance": "curves",
    "make_folder": "write",
    "read": "inputs",
    "read_bytes": "files",
    "read_calibration": "calibration",
    "read_camera": "calibration",
    "read_color": "inputs",
    "read_image": "inputs",
    "read_json": "text",
    "read_npz": "npz",
    "read_raster": "raster",
    "read_text": "text",
    "resource_bytes": "resources",
    "resource_text": "resources",
    "shipped_folder": "resources",
    "srgb_from_linear": "curves",
    "write_bytes": "write",
    "write_text": "write",
}

__all__ = sorted(_HOME)  # noqa: PLE0605 - the table is the list


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'visint.io' has no attribute {name!r}")
    return getattr(importlib.import_module(f"visint.io.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return __all__

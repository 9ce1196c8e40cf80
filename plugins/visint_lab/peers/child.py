"""One peer on one pair, in a process of its own; it runs in the peers' environment and knows no visint.

``python child.py PEER LEFT.npy RIGHT.npy LOW HIGH OUT.npy``: images uint8 (H, W) as files hold them, the
search range in pixels. Writes float32 (H, W), NaN unknown, and says on stdout what it cost. Parameters are
those of each vendor's own sample for pairs of this kind.
"""

# mypy: disable-error-code="attr-defined, import-not-found"
from __future__ import annotations

import json
import resource
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

Images = tuple[Any, Any]
Range = tuple[int, int]


def block_matching(images: Images, span: Range) -> Any:
    """OpenCV's StereoBM with the parameters of its stereo sample."""
    import cv2

    low, count = span
    matcher = cv2.StereoBM_create(count, 9)
    matcher.setMinDisparity(low)
    matcher.setPreFilterCap(31)
    matcher.setTextureThreshold(10)
    matcher.setUniquenessRatio(15)
    matcher.setSpeckleWindowSize(100)
    matcher.setSpeckleRange(32)
    matcher.setDisp12MaxDiff(1)
    return _sixteenths(matcher.compute(*images), low)


def _semi_global(span: Range, mode: str) -> Any:
    import cv2

    low, count = span
    return cv2.StereoSGBM_create(
        minDisparity=low,
        numDisparities=count,
        blockSize=3,
        P1=8 * 9,
        P2=32 * 9,
        disp12MaxDiff=1,
        preFilterCap=63,
        uniquenessRatio=10,
        speckleWindowSize=100,
        speckleRange=32,
        mode=getattr(cv2, f"StereoSGBM_MODE_{mode}"),
    )


def sgbm_3way(images: Images, span: Range) -> Any:
    """OpenCV's StereoSGBM along three directions, with the parameters of its stereo sample."""
    return _sixteenths(_semi_global(span, "SGBM_3WAY").compute(*images), span[0])


def sgbm_hh(images: Images, span: Range) -> Any:
    """OpenCV's StereoSGBM along eight directions, with the parameters of its stereo sample."""
    return _sixteenths(_semi_global(span, "HH").compute(*images), span[0])


def sgbm_wls(images: Images, span: Range) -> Any:
    """StereoSGBM along three directions and the weighted least squares filter, as in OpenCV's sample."""
    import cv2

    left = _semi_global(span, "SGBM_3WAY")
    left.setP1(24 * 9)
    left.setP2(96 * 9)
    right = cv2.ximgproc.createRightMatcher(left)
    smoother = cv2.ximgproc.createDisparityWLSFilter(left)
    smoother.setLambda(8000.0)
    smoother.setSigmaColor(1.5)
    here, there = left.compute(*images), right.compute(images[1], images[0])
    return _sixteenths(smoother.filter(here, images[0], None, there), span[0])


def _sixteenths(disparity: Any, low: int) -> Any:
    values = disparity.astype(np.float32) / 16
    return np.where(values < low, np.float32(np.nan), values)


def elas(images: Images, span: Range) -> Any:
    """Libelas with its preset for Middlebury."""
    from elas import PRESET_MIDDLEBURY, Elas

    matcher = Elas(PRESET_MIDDLEBURY)
    matcher.disp_min, matcher.disp_max = max(span[0], 0), span[0] + span[1] - 1
    matcher.postprocess_only_left = True
    left, _ = matcher.process(np.ascontiguousarray(images[0]), np.ascontiguousarray(images[1]))
    values = np.asarray(left, dtype=np.float32).reshape(images[0].shape)
    return np.where(values < 0, np.float32(np.nan), values)


PANDORA = {
    "matching_cost": {"matching_cost_method": "census", "window_size": 5, "subpix": 1},
    "optimization": {"optimization_method": "sgm", "overcounting": False},
    "disparity": {"disparity_method": "wta", "invalid_disparity": "NaN"},
    "refinement": {"refinement_method": "vfit"},
    "filter": {"filter_method": "median"},
    "validation": {"validation_method": "cross_checking_accurate"},
    "filter.this": {"filter_method": "median"},
}


def pandora(images: Images, span: Range) -> Any:
    """CNES Pandora: census, semi-global optimisation, V-fit refinement, median, left-right check."""
    import pandora as framework
    import xarray
    from pandora.constants import Criteria
    from pandora.img_tools import add_disparity
    from pandora.state_machine import PandoraMachine

    framework.import_plugin()
    low, high = span[0], span[0] + span[1] - 1

    def view(image: Any, ends: Range) -> Any:
        rows, columns = (np.arange(n) for n in image.shape)
        still = {"no_data_img": 0, "valid_pixels": 0, "no_data_mask": 1, "crs": None, "transform": None}
        data = xarray.Dataset(
            {"im": (["row", "col"], image.astype(np.float32))}, {"row": rows, "col": columns}, still
        )
        return add_disparity(data, ends, None)

    left, right = view(images[0], (-high, -low)), view(images[1], (low, high))
    machine = PandoraMachine()
    checked = _checked_pipeline(machine, left, right)
    found, _ = framework.run(machine, left, right, checked)
    values = -found["disparity_map"].data.astype(np.float32)
    invalid = (found["validity_mask"].data & Criteria.PANDORA_MSK_PIXEL_INVALID.value) != 0
    return np.where(invalid, np.float32(np.nan), values)


def _checked_pipeline(machine: Any, left: Any, right: Any) -> Any:
    from pandora.check_configuration import check_pipeline_section

    described = [view.drop_vars("im").assign_coords(band_im=[None]) for view in (left, right)]
    return check_pipeline_section({"pipeline": PANDORA}, *described, machine)


PEERS: dict[str, Callable[[Images, Range], Any]] = {
    "StereoBM": block_matching,
    "SGBM 3WAY": sgbm_3way,
    "SGBM HH": sgbm_hh,
    "SGBM 3WAY + WLS": sgbm_wls,
    "Pandora": pandora,
    "ELAS": elas,
}


def matched(name: str, images: Images, low: float, high: float) -> tuple[Any, float, float]:
    """(disparity, CPU seconds, wall seconds), the images padded at their left by what the search needs."""
    first = int(np.floor(low))
    count = max(16, -(-(int(np.ceil(high)) - first + 1) // 16) * 16)
    pad = count + max(first, 0)
    rows = min(48, len(images[0]))  # imports and compilation are nobody's matching
    PEERS[name]((images[0][:rows], images[1][:rows]), (first, count))
    padded = tuple(np.ascontiguousarray(np.pad(i, ((0, 0), (pad, 0)), mode="edge")) for i in images)
    cpu, wall = time.process_time(), time.perf_counter()
    disparity = PEERS[name]((padded[0], padded[1]), (first, count))
    cost = time.process_time() - cpu, time.perf_counter() - wall
    return disparity[:, pad:], *cost


def main(arguments: list[str]) -> None:
    """The command line."""
    name, left, right, low, high, out = arguments
    images = np.load(left), np.load(right)
    try:
        import cv2

        cv2.setNumThreads(1)
    except ImportError:
        pass
    disparity, cpu, wall = matched(name, images, float(low), float(high))
    np.save(out, np.ascontiguousarray(disparity, dtype=np.float32))
    sys.stdout.write(json.dumps({"cpu": cpu, "wall": wall, "peak_mb": peak_memory()}) + "\n")


def peak_memory() -> float:
    """The most memory this process held, MB.

    ``ru_maxrss`` begins with what the parent held when it forked; Linux counts anew after exec elsewhere.
    """
    try:
        lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    except OSError:
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return next(float(line.split()[1]) / 1024 for line in lines if line.startswith("VmHWM"))


if __name__ == "__main__":
    main(sys.argv[1:])

"""Pictures inside the page: as data, no larger than they are looked at."""

from __future__ import annotations

import base64

import numpy as np

from visint import io
from visint.arrays import Array
from visint.results.report.markup import Markup, element

__all__ = ["embedded", "reduced"]

_LOSSLESS = 48_000
_QUALITY = 88


def embedded(picture: Array, alt: str, side: int, name: str | None = None) -> Markup:
    """An ``<img>`` that holds ``picture``.

    Parameters
    ----------
    picture
        uint8 (H, W, 3), RGB; or (H, W, 4), what is transparent apart.
    alt
        What is said in its place.
    side
        The longest side in pixels; a larger picture is reduced.
    name
        Its ``id``, where the script needs to find it.
    """
    small = reduced(picture, side)
    height, width = small.shape[:2]
    return element(
        "img",
        id=name,
        src=_data(small),
        alt=alt,
        width=width,
        height=height,
        class_="pixels" if max(width, height) < 320 else None,
    )


def reduced(picture: Array, side: int) -> Array:
    """``picture`` with its longest side at most ``side`` pixels, averaged; as it is if it is no larger."""
    import cv2

    height, width = picture.shape[:2]
    scale = side / max(height, width)
    if scale >= 1:
        return picture
    size = max(1, round(width * scale)), max(1, round(height * scale))
    return np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA))


def _data(picture: Array) -> str:
    """PNG where it is small, as lines and labels are; else JPEG with whole colours, if that is smaller."""
    png = io.encode_png(picture) if picture.shape[2] == 3 else _transparent(picture)
    jpeg = _jpeg(picture) if len(png) > _LOSSLESS and picture.shape[2] == 3 else png
    if len(jpeg) < len(png):
        return "data:image/jpeg;base64," + base64.b64encode(jpeg).decode()
    return "data:image/png;base64," + base64.b64encode(png).decode()


def _jpeg(picture: Array) -> bytes:
    import cv2

    whole = cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444
    how = [cv2.IMWRITE_JPEG_QUALITY, _QUALITY, cv2.IMWRITE_JPEG_SAMPLING_FACTOR, whole]
    done, data = cv2.imencode(".jpg", np.ascontiguousarray(picture[..., ::-1]), how)
    assert done, "uint8 (H, W, 3) is what JPEG holds"
    return bytes(data.tobytes())


def _transparent(picture: Array) -> bytes:
    import cv2

    done, data = cv2.imencode(".png", np.ascontiguousarray(picture[..., [2, 1, 0, 3]]))
    assert done, "uint8 (H, W, 4) is what PNG holds"
    return bytes(data.tobytes())

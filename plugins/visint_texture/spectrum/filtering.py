"""Filtering in the plane of frequencies: each filter at the resolution that its band needs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from visint.arrays import Array
from visint_texture.spectrum.bank import Channel

__all__ = ["Responses", "Spectrum"]

REACH = 2.6
"""How many spreads of a Gaussian are kept on each side."""


@dataclass(frozen=True, slots=True)
class Responses:
    """What one filter says, (R, C) complex64: itself and its derivatives across and down over 2πi.

    The carrier is taken off, so a narrow band needs few samples; moduli and products are not changed by it.
    """

    plain: Array
    across: Array
    down: Array

    def products(self) -> Array:
        """float32 (R, C, 4): energy, and energy times u_x², 2 u_x u_y and u_y² of the local spectrum."""
        import cv2

        p, a, d = self.plain, self.across, self.down
        cross = 2 * (a.real * d.real + a.imag * d.imag)
        squares = [z.real**2 + z.imag**2 for z in (p, a, d)]
        merged: Array = cv2.merge([squares[0], squares[1], cross, squares[2]])
        return merged


class Spectrum:
    """The transform of one image, mirrored by ``margin`` px around so that its sides do not wrap.

    Parameters
    ----------
    image
        float32 (H, W).
    margin
        Pixels added on every side at least: the widest filter's reach.
    """

    def __init__(self, image: Array, margin: int) -> None:
        import cv2
        from scipy.fft import fft2, next_fast_len

        rows, columns = image.shape
        whole = [int(next_fast_len(side + 2 * margin)) for side in (rows, columns)]
        border = (margin, whole[0] - rows - margin, margin, whole[1] - columns - margin)
        self.image_size = (rows, columns)
        self.size = (whole[0], whole[1])
        self.margin = margin
        self._transform = fft2(cv2.copyMakeBorder(image, *border, cv2.BORDER_REFLECT))

    def responses(self, channel: Channel) -> Responses:
        """The filter's response and those of its derivatives, at the centres of even cells of the whole."""
        from scipy.fft import ifft2

        v, rows, gain_v = self._band(0, channel.down, channel.spread)
        u, columns, gain_u = self._band(1, channel.across, channel.spread)
        block = self._transform[rows[:, None], columns[None, :]]
        block *= (gain_v[:, None] * gain_u[None, :]).astype(np.complex64)
        return Responses(ifft2(block), ifft2(block * u[None, :]), ifft2(block * v[:, None]))

    def _band(self, axis: int, centre: float, spread: float) -> tuple[Array, Array, Array]:
        """Frequencies (n,) of a band around ``centre``, their places in the transform, and their gains.

        The gains' phase moves the samples from the corners of n even cells to their centres.
        """
        from scipy.fft import next_fast_len

        size = self.size[axis]
        count = min(size, int(next_fast_len(int(np.ceil(2 * REACH * spread * size)) + 1)))
        places = round(centre * size) - count // 2 + np.arange(count)
        frequencies = places / size
        gain = np.exp(-0.5 * ((frequencies - centre) / spread) ** 2) * (count / size)
        shift = (size / count - 1) / 2
        return frequencies.astype(np.float32), places % size, gain * np.exp(2j * np.pi * frequencies * shift)

    def cut(self, field: Array, shape: tuple[int, int]) -> Array:
        """What lies over the image of a field over the whole, brought to ``shape`` (rows, columns)."""
        import cv2

        cells = [n / whole for n, whole in zip(field.shape[:2], self.size, strict=True)]
        steps = [side / n for side, n in zip(self.image_size, shape, strict=True)]
        matrix = np.array(
            [
                [steps[1] * cells[1], 0, (self.margin + steps[1] / 2) * cells[1] - 0.5],
                [0, steps[0] * cells[0], (self.margin + steps[0] / 2) * cells[0] - 0.5],
            ]
        )
        flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
        inner: Array = cv2.warpAffine(field, matrix, shape[::-1], flags=flags, borderMode=cv2.BORDER_REFLECT)
        return inner

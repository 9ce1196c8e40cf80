"""Second moments of the local spectrum by a bank of Gabor filters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from visint.arrays import Array
from visint_texture.spectrum.bank import Bank, Channel
from visint_texture.spectrum.filling import WHITE, filling
from visint_texture.spectrum.filtering import Spectrum
from visint_texture.spectrum.local import LocalMoments

__all__ = ["Weighing", "gabor_moments"]

LEAST = np.float32(1e-20)


@dataclass(frozen=True, slots=True)
class Weighing:
    """How the filters' energies are weighed: energyᵖᵒʷᵉʳ / frequencyᵈᵉᶜᵃʸ.

    Step edges have no highest frequency: their plain second moments (power 1, decay 0) measure the blur of
    the image, not the texture. A power above 1 lets the dominant band speak, and the law of transformation
    stays, because the filters of all rings have one shape.
    """

    power: float = 2.0
    decay: float = 0.0


@dataclass(frozen=True, slots=True)
class _Ring:
    """One ring's filters over the mirrored image.

    ``products`` a filter, each (R, C, 4) and smoothed over the window: energy, and energy times u_x², 2 u_x u_y
    and u_y².
    """

    channels: list[Channel]
    products: list[Array]

    @property
    def density(self) -> Array:
        """(R, C): energy over the area of the band, the same for all rings if the image is white noise."""
        total = sum(product[..., 0] for product in self.products)
        return np.asarray(np.maximum(total, LEAST) / np.float32(self.channels[0].spread ** 2))


@dataclass(slots=True)
class _Sums:
    """What the rings have said so far."""

    moments: Array
    weight: Array
    energy: Array
    white: Array

    @classmethod
    def empty(cls, shape: tuple[int, int]) -> _Sums:
        return cls(np.zeros((*shape, 3), np.float32), *(np.zeros(shape, np.float32) for _ in range(3)))

    def add(self, ring: _Ring, noise: Array, weighing: Weighing) -> None:
        white = np.minimum(noise / ring.density, 1)
        for channel, product in zip(ring.channels, ring.products, strict=True):
            energy = np.maximum(product[..., 0], LEAST)
            trust = energy**weighing.power * np.float32(channel.frequency**-weighing.decay)
            self.moments += product[..., 1:] * (trust / energy)[..., None]
            self.white += trust * white
            self.weight += trust
            self.energy += energy


def gabor_moments(
    image: Array, bank: Bank, window: float, step: int, weighing: Weighing, check: Callable[[], None]
) -> LocalMoments:
    """Moments (g_x, 2E[u_x u_y], g_y) of contrast ``image`` (H, W), one sample every ``step`` px.

    Each filter's own mean of u uᵀ comes from its derivative filters, so the bank's spacing is not felt.
    B. J. Super and A. C. Bovik, Shape from texture using local spectral moments, PAMI 17(4), 1995.
    """
    import cv2

    spectrum = Spectrum(image, margin=int(np.ceil(1.2 / bank.lowest)))
    shape = (max(1, spectrum.size[0] // step), max(1, spectrum.size[1] // step))
    spread = [max(window * n / whole, 0.3) for n, whole in zip(shape, spectrum.size, strict=True)]

    def smooth(field: Array) -> Array:
        blurred: Array = cv2.GaussianBlur(field, (0, 0), sigmaX=spread[1], sigmaY=spread[0])
        return blurred

    sums, rings = _Sums.empty(shape), bank.ring_list()
    noise = np.zeros(shape, np.float32)
    for channels in reversed(rings):
        ring = _heard(spectrum, channels, shape, smooth, check)
        noise = ring.density if channels is rings[-1] else noise
        sums.add(ring, noise, weighing)
    moments, energy, white, noise = _over_the_image(sums, noise, spectrum, step)
    noise = noise * np.float32(WHITE / (np.pi * bank.orientations))
    return LocalMoments(moments, energy, filling(image, window, noise), white)


def _heard(
    spectrum: Spectrum,
    channels: list[Channel],
    shape: tuple[int, int],
    smooth: Callable[[Array], Array],
    check: Callable[[], None],
) -> _Ring:
    products = []
    for channel in channels:
        check()
        products.append(smooth(_resized(spectrum.responses(channel).products(), shape)))
    return _Ring(channels, products)


def _resized(field: Array, shape: tuple[int, int]) -> Array:
    import cv2

    shrinks = field.shape[0] > shape[0] and field.shape[1] > shape[1]
    how = cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR
    sized: Array = cv2.resize(field, shape[::-1], interpolation=how)
    return sized


def _over_the_image(sums: _Sums, noise: Array, spectrum: Spectrum, step: int) -> list[Array]:
    """Moments, energy, whiteness and the noise's density, over the image alone."""
    weight = np.maximum(sums.weight, np.float32(1e-37))
    shape = tuple(max(1, -(-side // step)) for side in spectrum.image_size)
    parts = (sums.moments / weight[..., None], sums.energy, sums.white / weight, noise)
    return [spectrum.cut(part, (shape[0], shape[1])) for part in parts]

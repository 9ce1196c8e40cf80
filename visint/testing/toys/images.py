"""Toy modules on images: what goes through levels, lists and relaxation."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array, Boundaries, Image, Regions
from visint.fields import Camera
from visint.module import Context, Module, Params, Ports
from visint.testing.toys.scalars import Value

__all__ = ["Edges", "Focal", "ImagePorts", "Picture", "Smooth", "Stack"]


class ImagePorts(Ports):
    """One image."""

    image: Image[Array, "H W"]


class PictureParams(Params):
    """``gain`` and ``offset`` of the intensities."""

    gain: float = 1.0
    offset: float = 0.0


class Picture(Module[PictureParams, ImagePorts, ImagePorts]):
    """The image, brighter or darker."""

    name = "image"

    def run(self, inputs: ImagePorts, ctx: Context) -> ImagePorts:
        """``gain image + offset``."""
        ctx.check()
        gain, offset = np.float32(self.params.gain), np.float32(self.params.offset)
        return ImagePorts(image=inputs.image * gain + offset)


class SmoothInputs(Ports):
    """The image so far, and the right-hand side of ΔI = s (0 if there is none)."""

    image: Image[Array, "H W"]
    source: Image[Array, "H W"] | None = None


class Smooth(Module[Params, SmoothInputs, ImagePorts]):
    """One Jacobi step towards ΔI = s, the border held fixed: a relaxation whose end is known."""

    name = "smooth"

    def run(self, inputs: SmoothInputs, ctx: Context) -> ImagePorts:
        """The mean of the four neighbours inside, less s/4; the border as it was."""
        ctx.check()
        old = inputs.image
        new = old.copy()
        inside = new[1:-1, 1:-1]
        inside[:] = (old[:-2, 1:-1] + old[2:, 1:-1] + old[1:-1, :-2] + old[1:-1, 2:]) / 4
        if inputs.source is not None:
            inside -= inputs.source[1:-1, 1:-1] / 4
        return ImagePorts(image=new)


class StackInputs(Ports):
    """A list of images of one size."""

    images: tuple[Image[Array, "H W"], ...]


class Stack(Module[Params, StackInputs, ImagePorts]):
    """The mean of a list of images."""

    name = "stack"

    def run(self, inputs: StackInputs, ctx: Context) -> ImagePorts:
        """Their mean."""
        ctx.check()
        return ImagePorts(image=mean(inputs.images))


def mean(images: tuple[Array, ...]) -> Array:
    """The mean of at least one image, float32."""
    return np.asarray(np.stack(images).mean(axis=0, dtype=np.float32))


class EdgesParams(Params):
    """``at``: the step of intensity from which on there is an edge."""

    at: float = 0.1


class EdgesOutputs(Ports):
    """Where the intensity steps, and what lies darker (1) or brighter (2) than the middle of the range."""

    boundaries: Boundaries[Array, "H W"]
    regions: Regions[Array, "H W"]


class Edges(Module[EdgesParams, ImagePorts, EdgesOutputs]):
    """Steps of intensity to the left or upper neighbour."""

    name = "edges"

    def run(self, inputs: ImagePorts, ctx: Context) -> EdgesOutputs:
        """Boundaries and two regions between them."""
        ctx.check()
        boundaries, regions = steps(inputs.image, self.params.at)
        return EdgesOutputs(boundaries=boundaries, regions=regions)


def steps(image: Array, at: float) -> tuple[Array, Array]:
    """(bool boundaries, int32 regions) of an image: steps above ``at``; 1 dark, 2 bright, 0 boundary."""
    across = np.abs(np.diff(image, axis=1, prepend=image[:, :1])) > at
    down = np.abs(np.diff(image, axis=0, prepend=image[:1])) > at
    boundaries = across | down
    regions = np.where(image > 0.5, 2, 1).astype(np.int32)
    return boundaries, np.where(boundaries, np.int32(0), regions)


class FocalInputs(Ports):
    """A camera."""

    camera: Camera


class Focal(Module[Params, FocalInputs, Value]):
    """The camera's focal length: what a camera is at a level."""

    name = "focal"

    def run(self, inputs: FocalInputs, ctx: Context) -> Value:
        """Pixels of the level."""
        return Value(value=inputs.camera.focal_length)

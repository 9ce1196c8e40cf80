"""Toy cues: evidence whose every number is known beforehand."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array, Boundaries, Image, Regions
from visint.fields import BoundariesEvidence, DepthEvidence, DisparityEvidence, Light
from visint.module import Context, Module, Params, Ports
from visint.testing.toys.images import ImagePorts, mean, steps

__all__ = ["BoundaryCue", "Cue", "DisparityCue", "Photometric"]


class CueParams(Params):
    """Depth of black (``far``) and white (``near``), ``sigma`` of the depth, and ``reliability`` in [0, 1]."""

    near: float = 1.0
    far: float = 2.0
    sigma: float = 0.1
    reliability: float = 1.0


class CueInputs(Ports):
    """An image; where there are boundaries the cue abstains."""

    image: Image[Array, "H W"]
    boundaries: Boundaries[Array, "H W"] | None = None


class CueOutputs(Ports):
    """Evidence on depth, and a plain port that never enters the map."""

    evidence: DepthEvidence
    sharpness: Image[Array, "H W"]


class Cue(Module[CueParams, CueInputs, CueOutputs]):
    """Depth from brightness: white is near, black is far. Dark pixels are not wrong, only far."""

    name = "cue"

    def run(self, inputs: CueInputs, ctx: Context) -> CueOutputs:
        """``far − (far − near) image``."""
        ctx.check()
        p, image = self.params, inputs.image
        depth = np.float32(p.far) - np.float32(p.far - p.near) * image
        trust = np.full(image.shape, p.reliability, np.float32)
        if inputs.boundaries is not None:
            trust = np.where(inputs.boundaries, np.float32(0), trust)
        return CueOutputs(evidence=DepthEvidence.of(depth, p.sigma, trust), sharpness=image)


class DisparityCueParams(Params):
    """``disparity`` of white and its ``sigma``, full-size pixels; black has 0; ``reliability`` in [0, 1]."""

    disparity: float = 8.0
    sigma: float = 0.5
    reliability: float = 1.0


class DisparityCueOutputs(Ports):
    """Evidence on disparity."""

    evidence: DisparityEvidence


class DisparityCue(Module[DisparityCueParams, ImagePorts, DisparityCueOutputs]):
    """Disparity from brightness: bright is near. Its parameters are in full-size pixels."""

    name = "disparity_cue"

    def run(self, inputs: ImagePorts, ctx: Context) -> DisparityCueOutputs:
        """``disparity image / ctx.scale``, pixels of the level."""
        ctx.check()
        p = self.params
        disparity = inputs.image * np.float32(p.disparity / ctx.scale)
        return DisparityCueOutputs(evidence=DisparityEvidence.of(disparity, p.sigma / ctx.scale, p.reliability))


class BoundaryCueParams(Params):
    """``at``: the step of intensity from which on there is a boundary."""

    at: float = 0.1


class BoundaryCueOutputs(Ports):
    """Evidence on boundaries, and the regions between them."""

    evidence: BoundariesEvidence
    regions: Regions[Array, "H W"]


class BoundaryCue(Module[BoundaryCueParams, ImagePorts, BoundaryCueOutputs]):
    """Boundaries where the intensity steps. Assumes regions of one brightness each, and says where they are."""

    name = "boundary_cue"
    assumptions = ("opacity", "homogeneity")

    def run(self, inputs: ImagePorts, ctx: Context) -> BoundaryCueOutputs:
        """Sure of every pixel."""
        ctx.check()
        boundaries, regions = steps(inputs.image, self.params.at)
        ctx.assumed("homogeneity", even(inputs.image, regions), regions)
        return BoundaryCueOutputs(evidence=BoundariesEvidence.of(boundaries, 1.0, 1.0), regions=regions)


def even(image: Array, regions: Array) -> Array:
    """Bool (3,) by label: whether the intensity in a region stays within 0.1."""
    inside = [image[regions == label] for label in range(3)]
    return np.array([one.size == 0 or bool(np.ptp(one) <= 0.1) for one in inside])


class PhotometricInputs(Ports):
    """A list of images and of the lights they were taken under."""

    images: tuple[Image[Array, "H W"], ...]
    lights: tuple[Light, ...]


class PhotometricOutputs(Ports):
    """Evidence on depth."""

    evidence: DepthEvidence


class Photometric(Module[Params, PhotometricInputs, PhotometricOutputs]):
    """Depth 1 + the mean image; the more lights, the surer. Lists of two kinds, one beside the other."""

    name = "photometric"

    def run(self, inputs: PhotometricInputs, ctx: Context) -> PhotometricOutputs:
        """Reliability n/(n + 1) for n lights."""
        ctx.check()
        depth = 1 + mean(inputs.images)
        lights = len(inputs.lights)
        return PhotometricOutputs(evidence=DepthEvidence.of(depth, 0.1, lights / (lights + 1)))

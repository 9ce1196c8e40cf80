"""``bayes.joint``: the surface that all evidence of a sweep can give together."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from pydantic import Field

from visint.arrays import Array, Confidence, Depth, Disparity, Image, Mask, Normals, Scalars, Sigma
from visint.fields import Camera, DepthEvidence, DisparityEvidence, IncidenceEvidence, Light
from visint.fields.geometry import depth_from_disparity, disparity_evidence, normals_from_depth
from visint.module import Context, Module, Params, Ports
from visint_bayes.joint.blend import Blend, blended
from visint_bayes.joint.credit import of_objects, of_photographs
from visint_bayes.joint.objects import pair_of
from visint_bayes.joint.photographs import preferred
from visint_bayes.joint.setting import Pair

__all__ = ["Joint"]


class JointParams(Params):
    """Parameters of ``bayes.joint``.

    Parameters
    ----------
    shading
        Amplitude of brightness in the energy; 0 is the control: shading says nothing, all else stays.
    """

    shading: float = Field(default=1.0, ge=0)


class JointInputs(Ports):
    """All evidence of the sweep, the images, and what the matcher by descent found, complete.

    Brightness counts only in graphs that have a cue of incidence, and with a light. How bright surfaces are
    that face it is found here, in classes, so that painted things have their shading too. Without ``matched``
    and both images nothing but the evidence itself counts; without a camera 53° of view.
    """

    disparity_evidence: tuple[DisparityEvidence, ...] = ()
    depth_evidence: tuple[DepthEvidence, ...] = ()
    incidence_evidence: tuple[IncidenceEvidence, ...] = ()
    depth: Depth[Array, "H W"]
    left: Image[Array, "H W"] | None = None
    right: Image[Array, "H W"] | None = None
    matched: Disparity[Array, "H W"] | None = None
    camera: Camera | None = None
    light: Light | None = None


class JointOutputs(Ports):
    """The surface, how sure it is, and what it was made from.

    ``depth_confidence`` is 1/(1 + variance of the disparity, px²); on photographs the reliability of what was
    taken. ``depth_sigma`` is in the unit of the baseline, ``normals_sigma`` in radians. ``foreground`` is what
    stands before a void, everything where there is none. ``weights`` are the candidates' parts in the blend,
    empty where there were none. ``depth_weights`` are what each evidence has decided of every pixel, in the
    order of the input ports.
    """

    depth: Depth[Array, "H W"]
    depth_confidence: Confidence[Array, "H W"]
    depth_sigma: Sigma[Array, "H W"]
    normals: Normals[Array, "H W 3"]
    normals_sigma: Sigma[Array, "H W"]
    foreground: Mask[Array, "H W"]
    weights: Scalars[Array, "N"]
    depth_weights: tuple[Confidence[Array, "H W"], ...]


class _Surface(NamedTuple):
    """Disparity and sigma (px), how sure it is, normals or None, their sigma, mask, weights, credit."""

    disparity: Array
    sigma: Array
    sure: Array
    normals: Array | None
    turned: Array
    foreground: Array
    weights: Array
    credit: tuple[Array, ...] = ()


class Joint(Module[JointParams, JointInputs, JointOutputs]):
    """The surface that explains both images, with brightness as far as it has earned it.

    Before a void: a maximum a posteriori estimate of disparity. The photometric residual linearised at the
    current surface, n·l against brightness as a constraint on slopes, a robust thin plate that gives way at
    creases, a weak anchor to the stereo; cut at depth edges that brightness shows and the surfaces on both
    sides confirm; albedo in classes and highlights found on the way. Several minima under different trust
    in stereo and brightness are blended with weights learned from signs that do not look at the truth:
    residuals in the view they were not fitted to, roughness, how far they differ. Without a void the last
    cue that speaks is taken: nothing is claimed of photographs beyond their evidence.

    Solved by Gauss-Newton and conjugate gradients with a Galerkin multigrid, linear in pixels. Assumes one
    light, Lambertian surfaces of few albedos but for highlights. The linearised data term follows section 5.3.2
    (Eqs. 5.100 to 5.102), the plate W. E. L. Grimson, From Images to Surfaces, 1981.
    """

    name = "joint"
    assumptions = (
        "brightness_constancy",
        "lambertian_reflectance",
        "piecewise_constant_albedo",
        "single_light_source",
        "no_interreflection",
        "smoothness",
        "opacity",
    )

    def run(self, inputs: JointInputs, ctx: Context) -> JointOutputs:
        """One estimate; it needs no other."""
        ctx.check()
        rows, columns = inputs.depth.shape
        camera = inputs.camera or Camera.uncalibrated(columns, rows)
        pair = _pair(inputs, camera)
        if pair is None:
            if inputs.light is not None and inputs.light.place != "unknown":
                ctx.warn("no void", "brightness is not used: no object stands out of a dark, even surround")
            return _told(self._of_evidence(inputs, camera), inputs, camera)
        blend = blended(pair, self.params.shading)
        ctx.check()
        _report(blend, ctx)
        return _told(_of_objects(blend, pair, inputs), inputs, camera)

    @staticmethod
    def _of_evidence(inputs: JointInputs, camera: Camera) -> _Surface:
        shape = inputs.depth.shape
        said = [*(disparity_evidence(one, camera) for one in inputs.depth_evidence), *inputs.disparity_evidence]
        everywhere, unknown = np.ones(shape, bool), np.full(shape, np.nan, np.float32)
        if not said:
            return _Surface(
                unknown, unknown, np.zeros(shape, np.float32), None, unknown, everywhere, np.zeros(0)
            )
        disparity, sigma, trust = preferred(said)
        with np.errstate(divide="ignore", invalid="ignore"):
            wide = sigma / np.sqrt(trust)
        deep, shifted = (
            [one.reliability for one in each] for each in (inputs.depth_evidence, inputs.disparity_evidence)
        )
        credit = of_photographs(deep, shifted, len(inputs.incidence_evidence))
        return _Surface(disparity, wide, trust, None, unknown, everywhere, np.zeros(0), credit)


def _pair(inputs: JointInputs, camera: Camera) -> Pair | None:
    """What the energy wants; None where there is no void, or not enough is given."""
    if inputs.left is None or inputs.right is None or inputs.matched is None:
        return None
    light = inputs.light if inputs.incidence_evidence else None
    return pair_of((inputs.left, inputs.right), inputs.matched, camera, light)


def _report(blend: Blend, ctx: Context) -> None:
    found = blend.pool.reflectance
    ctx.measure("stereo's part", float(1 - blend.parts.sum()))
    for name, part in zip(blend.pool.surfaces, blend.parts, strict=True):
        ctx.measure(f"{name}'s part", float(part))
    if found is not None:
        ctx.measure("albedos", float(len(found.albedo)))
        ctx.assumed("lambertian_reflectance", not bool(found.shine.any()))


def _of_objects(blend: Blend, pair: Pair, inputs: JointInputs) -> _Surface:
    """The blend inside the foreground, the stereo around it, of which nothing is known."""
    inside = pair.inside
    disparity = np.where(inside, blend.disparity, pair.stereo).astype(np.float32)
    sigma = np.where(inside, blend.sigma, np.float32(np.nan))
    normals = np.where(inside[..., None], blend.normals, np.float32(np.nan))
    sure = np.where(inside, 1 / (1 + sigma**2), np.float32(0)).astype(np.float32)
    turned = np.where(inside, blend.turned, np.nan)
    given = (inputs.disparity_evidence, inputs.depth_evidence, inputs.incidence_evidence)
    parts = dict(zip(blend.pool.surfaces, blend.parts.tolist(), strict=True))
    credit = of_objects(parts, inside, (len(given[0]), len(given[1]), len(given[2])))
    return _Surface(disparity, sigma, sure, normals, turned, inside, blend.parts, credit)


def _told(surface: _Surface, inputs: JointInputs, camera: Camera) -> JointOutputs:
    depth = depth_from_disparity(surface.disparity, camera)
    depth = np.where(np.isfinite(depth), depth, inputs.depth).astype(np.float32)
    own = normals_from_depth(depth, camera)
    given = own if surface.normals is None else surface.normals
    normals = np.where(np.isfinite(given).all(axis=-1, keepdims=True), given, own)
    with np.errstate(invalid="ignore"):
        deep = depth**2 * surface.sigma / np.float32(camera.focal_length * camera.baseline)
    return JointOutputs(
        depth=depth,
        depth_confidence=surface.sure,
        depth_sigma=deep.astype(np.float32),
        normals=normals.astype(np.float32),
        normals_sigma=surface.turned.astype(np.float32),
        foreground=surface.foreground,
        weights=np.asarray(surface.weights, np.float64),
        depth_weights=surface.credit,
    )

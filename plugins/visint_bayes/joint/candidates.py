"""``bayes.candidates``: what ``bayes.joint`` chooses from, for fitting the choice."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array, Disparity, Features, Image, Scalars
from visint.fields import Camera, Light
from visint.module import Context, Module, Params, Ports
from visint_bayes.joint.objects import pair_of
from visint_bayes.joint.pool import candidates
from visint_bayes.joint.signs import signs_of

__all__ = ["Candidates"]


class CandidatesInputs(Ports):
    """A pair, its complete matched disparity, and perhaps a light; without a camera 53° of view."""

    left: Image[Array, "H W"]
    right: Image[Array, "H W"]
    matched: Disparity[Array, "H W"]
    camera: Camera | None = None
    light: Light | None = None


class CandidatesOutputs(Ports):
    """``surfaces``: K disparity maps, px, outside the foreground the matched one; ``signs``: K times F numbers.

    Both of no candidates (K = 0) where the scene does not stand before a void.
    """

    surfaces: Features[Array, "H W K"]
    signs: Scalars[Array, "N"]


class Candidates(Module[Params, CandidatesInputs, CandidatesOutputs]):
    """The minima of the joint energy under different trust in stereo and brightness, and their signs.

    The same computation as in ``bayes.joint``, before the choice; ``visint tune`` learns the choice from it.
    Assumes one light and Lambertian surfaces of few albedos, before a void.
    """

    name = "candidates"
    assumptions = ("brightness_constancy", "lambertian_reflectance", "single_light_source", "smoothness")

    def run(self, inputs: CandidatesInputs, ctx: Context) -> CandidatesOutputs:
        """All candidates at the size of the images."""
        ctx.check()
        rows, columns = inputs.left.shape
        camera = inputs.camera or Camera.uncalibrated(columns, rows)
        pair = pair_of((inputs.left, inputs.right), inputs.matched, camera, inputs.light)
        if pair is None:
            return CandidatesOutputs(surfaces=np.zeros((rows, columns, 0), np.float32), signs=np.zeros(0))
        pool = candidates(pair)
        ctx.check()
        surfaces = np.stack(list(pool.surfaces.values()), axis=-1).astype(np.float32)
        return CandidatesOutputs(surfaces=surfaces, signs=signs_of(pool, pair).ravel())

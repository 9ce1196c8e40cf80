"""Scenes by name: set A and set B of the dissertation's experiments, and any number of unseen poses.

Focal lengths, sizes, poses and materials are not in the dissertation: those here are choices. Names read
``set/object/surface`` and perhaps a noise: ``a/sphere/lambertian``, ``b/mozart/two+10%``. Random poses are
asked for by a seed.
"""

from __future__ import annotations

from visint_lab.scenes.catalogue import NOISES, names, scene

__all__ = ["NOISES", "names", "scene"]

"""Stereo: a semi-global matcher, the matcher of Weng, Ahuja and Huang (1992), and disparity to depth."""

from __future__ import annotations

from typing import Any

from visint.hookspecs import hookimpl

visint_contract = 1


@hookimpl
def visint_modules() -> list[Any]:
    """The modules of this plugin; imported here so that finding the plugin costs nothing."""
    from visint_stereo.attributes import Attributes
    from visint_stereo.conversions import DepthFromDisparity, DisparityFromDepth, NormalsFromDepth
    from visint_stereo.residual import Residual
    from visint_stereo.sgm import SemiGlobal
    from visint_stereo.weng import Weng

    return [Attributes, DepthFromDisparity, DisparityFromDepth, NormalsFromDepth, Residual, SemiGlobal, Weng]

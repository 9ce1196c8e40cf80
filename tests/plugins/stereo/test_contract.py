"""Each module of the plugin keeps the contract."""

from __future__ import annotations

from visint.testing import ModuleContract
from visint_stereo.attributes import Attributes
from visint_stereo.conversions import DepthFromDisparity, DisparityFromDepth, NormalsFromDepth
from visint_stereo.residual import Residual
from visint_stereo.sgm import SemiGlobal
from visint_stereo.weng import Weng


class TestAttributes(ModuleContract):
    module = Attributes
    instant = True


class TestDepthFromDisparity(ModuleContract):
    module = DepthFromDisparity
    instant = True


class TestDisparityFromDepth(ModuleContract):
    module = DisparityFromDepth
    instant = True


class TestNormalsFromDepth(ModuleContract):
    module = NormalsFromDepth
    instant = True


class TestResidual(ModuleContract):
    module = Residual
    listed = 2


class TestSemiGlobal(ModuleContract):
    module = SemiGlobal


class TestWeng(ModuleContract):
    module = Weng
    listed = 2

"""Texture says where its assumptions hold: region by region, as it tested them."""

from __future__ import annotations

import numpy as np

from visint.module import Context
from visint_texture.super_bovik import SuperBovik


def said_of(moments, regions):
    """What the module says of its assumptions: name → (held by label, patches)."""
    said = {}

    def note(what, name, value):
        if what == "assumed":
            said[name] = value

    inputs = SuperBovik.Inputs(
        moments=moments.astype(np.float32),
        texture=np.ones(regions.shape, np.float32),
        regions=regions,
    )
    SuperBovik().run(inputs, Context(size=regions.shape, note=note))
    return said


def test_stripes_and_mixtures_are_violations():
    """Left: round, even moments, all premises hold. Right: waves along one direction, of any length."""
    rows, columns = 96, 192
    moments = np.zeros((rows, columns, 3))
    moments[..., 0] = moments[..., 2] = 0.01
    regions = np.ones((rows, columns), np.int32)
    regions[:, 96:] = 2
    length = np.exp(np.random.default_rng(3).normal(0, 1.5, (rows // 16, 6))).repeat(16, 0).repeat(16, 1)
    moments[:, 96:, 0] = 0.01 * length
    moments[:, 96:, 2] = 0.0001 * length
    said = said_of(moments, regions)
    for name in ("homogeneity", "sufficient_context"):
        held, patches = said[name]
        assert patches.shape == (rows, columns)
        assert held[patches[48, 40]], name
        assert not held[patches[48, 150]], name


def test_no_texture_no_region():
    """Where there is nothing to test nothing is said."""
    held, patches = said_of(np.zeros((32, 32, 3)), np.ones((32, 32), np.int32))["homogeneity"]
    assert held.tolist() == [False]
    assert not patches.any()

"""The matcher says where there was texture enough, and where both views looked alike."""

from __future__ import annotations

import numpy as np

from visint.module import Context
from visint_stereo.attributes import Attributes
from visint_stereo.weng import Weng


def test_where_texture_ends_and_where_a_view_is_spoilt():
    """Left third flat: too little context. Right third darker in one view: not constant."""
    noise = np.random.default_rng(1).normal(0, 1, (48, 96)).astype(np.float32)
    left = 0.5 + 0.05 * (noise + np.roll(noise, 1, 1) + np.roll(noise, 1, 0))
    left[:, :32] = 0.5
    right = left.copy()
    right[:, 64:] = 1 - right[:, 64:] + 0.2
    attributes = Attributes().run(Attributes.Inputs(left=left, right=right), Context(size=left.shape))
    said = {}
    note = lambda what, name, value: said.update({name: value}) if what == "assumed" else None  # noqa: E731
    start = np.zeros(left.shape, np.float32)
    inputs = Weng.Inputs(attributes=attributes.images, disparity=start, right_disparity=start)
    Weng().run(inputs, Context(size=left.shape, note=note))
    share = {}
    for name, (held, regions) in said.items():
        holds = held[regions]
        share[name] = [float(holds[8:-8, third : third + 16].mean()) for third in (8, 40, 72)]
    assert share["sufficient_context"][0] < 0.1
    assert share["sufficient_context"][1] > 0.9
    assert share["brightness_constancy"][1] > 0.9
    assert share["brightness_constancy"][2] < 0.2

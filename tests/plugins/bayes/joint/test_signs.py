"""What is found in the images without being told: voids, albedo, highlights, depth edges, and the choice."""

from __future__ import annotations

import numpy as np
import pytest

from visint_bayes.joint.choice import Choice, shipped, weights_of
from visint_bayes.joint.cuts import cut_by, patches, standing
from visint_bayes.joint.doubt import SIGNS, shipped_doubt
from visint_bayes.joint.noise import noise_inside
from visint_bayes.joint.outline import LOST, outlined, unmatched
from visint_bayes.joint.reflectance import reflectance
from visint_bayes.joint.scales import enlarged
from visint_bayes.joint.void import foreground

Y, X = np.mgrid[:96, :96].astype(float)
DISC = (Y - 47.5) ** 2 + (X - 47.5) ** 2 < 30**2
BALL = np.sqrt(np.maximum(1 - ((Y - 47.5) ** 2 + (X - 47.5) ** 2) / 31**2, 0.01)) * DISC


@pytest.mark.parametrize("noise", [0.0, 0.02, 0.1])
def test_the_foreground_of_a_ball_before_nothing(noise):
    """Right but for a rim of a pixel or two, whatever the noise."""
    grain = np.random.default_rng(0).standard_normal(BALL.shape)
    found = foreground(np.clip(0.8 * BALL + noise * grain, 0, 1).astype(np.float32))
    assert found is not None
    union = (found | DISC).sum()
    assert (found & DISC).sum() > 0.88 * union


def test_no_foreground_where_the_rim_shows_something():
    """Textured photographs, dark ones too, bright walls and black images have no void."""
    texture = np.random.default_rng(1).random((96, 96)).astype(np.float32)
    dim = (0.05 + 0.1 * (texture > 0.5) * (X // 8 % 2) + 0.8 * DISC).astype(np.float32)
    for image in (texture, dim, np.full((96, 96), 0.7, np.float32), np.zeros((96, 96), np.float32)):
        assert foreground(image) is None


def test_noise_is_measured_inside():
    """Within a tenth of the truth."""
    image = (0.5 + 0.05 * np.random.default_rng(0).standard_normal((96, 96))).astype(np.float32)
    assert noise_inside(image, DISC) == pytest.approx(0.05, rel=0.1)


def test_one_albedo_is_found_beside_a_highlight():
    """0.5 of a ball with a bright spot; the spot is what shines."""
    shine = 0.4 * np.exp(-((Y - 47.5) ** 2 + (X - 47.5) ** 2) / 40)
    found = reflectance((0.5 * BALL + shine * DISC).astype(np.float32), BALL, DISC, 0.0, 0.5)
    assert found.albedo == pytest.approx([0.5], rel=0.04)
    assert found.shine[47, 47]
    assert not found.shine[30, 60]


def test_two_albedos_of_a_checker_are_told_apart():
    """1 and 0.35 in squares of 12 pixels; labels are right away from where they meet."""
    dark = (X // 12 + Y // 12) % 2 > 0
    found = reflectance((np.where(dark, 0.35, 1.0) * BALL).astype(np.float32), BALL, DISC, 0.0, 0.5)
    assert found.albedo == pytest.approx([0.35, 1.0], rel=0.06)
    labelled = (found.labels > 0) & (BALL > 0.4)
    assert ((found.labels == 1) == dark)[labelled].mean() > 0.97


def test_a_depth_edge_stands_and_a_mark_does_not():
    """Brightness changes at both; only where the surface steps is it cut."""
    mark, edge = X > 36, X > 60
    calm = (0.4 + 0.2 * mark + 0.3 * edge).astype(np.float32)
    labels = patches(calm, DISC, 0.0, 0.5)
    assert labels.max() == 3
    assert cut_by(DISC, labels).pieces.max() == 3
    domain = standing(DISC, labels, 40 + 5.0 * edge, 0.5)
    assert domain.pieces.max() == 2
    assert not domain.across[30:60, 60].any()
    assert domain.across[30:60, 36].all()


def test_what_cannot_be_measured_is_not_chosen():
    """A sign that is not finite leaves a candidate out; the rest share with the stereo."""
    ones = np.ones((2, 3))
    choice = Choice(("a", "b"), 0 * ones, ones, np.zeros((2, 4)), np.zeros((2, 4)), np.zeros(2), 0.0, 0.3)
    signs = np.zeros((2, 3))
    assert weights_of(choice, signs) == pytest.approx([1 / 3, 1 / 3])
    signs[1, 2] = np.nan
    assert weights_of(choice, signs) == pytest.approx([0.5, 0.0])


def test_the_shipped_choices_fit_their_pools():
    """Coefficients for lit scenes and for scenes without a light, and a doubt for each."""
    from visint_bayes.joint.pool import NAMES

    for which, names in (("lit", NAMES), ("dark", ("plate", "loose"))):
        choice = shipped(which)
        assert choice is not None
        assert choice.names == tuple(names)
        assert np.isfinite(choice.depth).all()
        assert len(shipped_doubt(which).disparity) == len(SIGNS) + 1


def test_enlarging_keeps_planes():
    """Centres of pixels map by (x + ½)/2 − ½: a plane stays one, away from the rim."""
    plane = 3 + 0.5 * X - 0.25 * Y
    large = enlarged(plane, np.ones((96, 96), bool), (192, 191))
    v, u = np.mgrid[:192, :191]
    wanted = 3 + 0.5 * ((u + 0.5) / 2 - 0.5) - 0.25 * ((v + 0.5) / 2 - 0.5)
    assert large.shape == (192, 191)
    assert np.abs(large - wanted)[2:-2, 2:-2].max() < 1e-9


def test_a_folded_surface_is_known_by_what_it_leaves_unmatched():
    """The disc 10 px to the left in the other view: matched well, everything is met; folded, half is not."""
    right = np.roll(DISC, -10, axis=1)
    flat = np.full(DISC.shape, 10.0, np.float32)
    folded = (10 + 0.8 * (X - 47.5)).astype(np.float32)
    assert unmatched(flat, DISC, right) < 0.02
    assert unmatched(folded, DISC, right) > LOST
    assert np.abs(outlined(DISC, right) - 10)[DISC].max() < 0.01

"""Peers run in processes of their own; the script is also run here with what this environment has."""

import numpy as np
import pytest

import visint
from visint_lab.datasets import REAL, Pair, data_folder, pairs_in
from visint_lab.metrics import disparity_scores, filled_from_rows
from visint_lab.peers import available, child, run_peer
from visint_lab.peers.running import stored
from visint_lab.render.rendering import render
from visint_lab.scenes import scene
from visint_lab.trials.contest import entrants, heats, standings


def installed():
    try:
        return bool(available())
    except visint.UsageError:
        return False


@pytest.fixture(scope="module")
def pair():
    return Pair.of(render(scene("demo", 160), samples=2))


@pytest.mark.parametrize("name", ["StereoBM", "SGBM 3WAY", "SGBM HH"])
def test_a_matcher_finds_the_demo_scene(pair, name):
    """With the vendor's parameters nine in ten visible pixels are within 2 px."""
    images = stored(pair.left), stored(pair.right)
    disparity, cpu, _ = child.matched(name, images, *pair.camera.disparity_range)
    scores = disparity_scores(filled_from_rows(disparity), pair.disparity, pair.visible)
    assert scores["bad2"] < 0.1
    assert 0 < cpu < 5


def test_padding_saves_the_left_border(pair):
    """Columns that the search range would cut off are matched all the same."""
    images = stored(pair.left), stored(pair.right)
    disparity, _, _ = child.matched("SGBM HH", images, *pair.camera.disparity_range)
    low = int(np.nanmin(pair.disparity))
    assert np.isfinite(disparity[:, low + 2 : low + 20]).mean() > 0.4


def test_an_unknown_peer_is_refused(pair):
    """The error lists the peers there are."""
    with pytest.raises(visint.UsageError, match="Pandora"):
        run_peer("MC-CNN", pair)


@pytest.mark.skipif(not installed(), reason="make peers has not been run")
def test_a_peer_runs_in_its_own_process_and_says_what_it_cost(pair):
    """The disparity comes back with CPU time and peak memory."""
    run = run_peer("SGBM 3WAY", pair)
    assert run.disparity.shape == pair.left.shape
    assert 0 < run.cost.cpu < 10
    assert 20 < run.cost.peak_mb < 500


def test_peers_get_what_an_8_bit_file_would_hold():
    """Linear 0, 0.2140 and 1 are stored as 0, 127 or 128, and 255."""
    np.testing.assert_allclose(stored(np.array([[0, 0.2140, 1]], np.float32)), [[0, 127.5, 255]], atol=0.6)


def test_a_flat_image_has_low_texture_and_noise_has_not():
    """Low texture is decided on 8-bit brightness: a flat half and a noisy half are told apart."""
    image = np.full((40, 80), 0.3, np.float32)
    image[:, 40:] += np.random.default_rng(0).normal(0, 0.05, (40, 40)).astype(np.float32)
    low = Pair("x", image, image, visint.Camera.uncalibrated(80, 40)).low_texture
    assert low[:, :34].all()
    assert not low[:, 46:].any()


@pytest.mark.slow
@pytest.mark.skipif(not installed(), reason="make peers has not been run")
def test_on_the_real_pairs_the_peers_come_in_the_known_order(request):
    """Mean bad-2.0 over 26 pairs: Pandora best, then SGBM HH, 3WAY and StereoBM, each near its known figure."""
    if "slow" not in request.config.getoption("markexpr"):
        pytest.skip("takes minutes: ask for it by -m slow")
    known = {"Pandora": 0.111, "SGBM HH": 0.134, "SGBM 3WAY": 0.142, "StereoBM": 0.154}  # of 49 pairs
    try:
        pairs = [(files.read(), None) for part in REAL for files in pairs_in(data_folder(part))]
    except visint.InputError:
        pytest.skip("the real pairs are not there")
    run = list(heats(pairs, entrants([], list(known), floor=False)))
    found = {one.entrant: one.means["bad2"] for one in standings(run, "bad2")}
    assert sorted(found, key=found.__getitem__) == list(known)
    assert found == pytest.approx(known, abs=0.02)

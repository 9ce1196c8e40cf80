"""What a cue contributes: toy cues around a hub, whose errors with and without each are known."""

from __future__ import annotations

import csv

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

import visint
from visint.io import encode_pfm, encode_png
from visint.testing import installed
from visint_lab import ablate
from visint_lab.datasets import pairs_in
from visint_lab.trials.contribution import contributions
from visint_lab.trials.systems import SystemVariant, controls_of, cues_of, reconstruct

CALIB = (
    "cam0=[64 0 32; 0 64 24; 0 0 1]\ncam1=[64 0 32; 0 64 24; 0 0 1]\n"
    "doffs=0\nbaseline=1\nwidth=64\nheight=48\nndisp=8\nvmin=1\nvmax=6\n"
)
"""Depth is 64 / disparity."""

HUB = """
visint: 1
name: two_cues
inputs: {left: Image, camera: Camera}
loops: {sweeps: {times: 1}}
hub:
  uses: toy.even
  loop: sweeps
  start: {depth: 32.0}
  order: [honest, liar]
  spokes:
    honest: {uses: toy.cue, in: {image: inputs.left}, with: {near: 16.0, far: 16.0}}
    liar: {uses: toy.cue, in: {image: inputs.left}, with: {near: 32.0, far: 32.0}}
controls: {liar: {liar_reconcile.alpha: 0.0}}
outputs: {depth: map.depth}
"""


@pytest.fixture(scope="module")
def toys():
    with installed("toys", plugins={"toy": "visint.testing.plugin"}):
        yield


@pytest.fixture
def pair(tmp_path):
    """A folder with a pair whose true disparity is 4 px, that is depth 16."""
    rng = np.random.default_rng(0)
    folder = tmp_path / "pair"
    folder.mkdir()
    for name in ("im0.png", "im1.png"):
        (folder / name).write_bytes(encode_png(rng.integers(0, 255, (48, 64), dtype=np.uint8)))
    (folder / "disp0GT.pfm").write_bytes(encode_pfm(np.full((48, 64), 4, np.float32)))
    (folder / "calib.txt").write_text(CALIB)
    return folder


@pytest.fixture
def graph(tmp_path, toys):
    path = tmp_path / "two_cues.yaml"
    path.write_text(HUB)
    return str(path)


def called(*words):
    app = typer.Typer()
    app.command()(ablate.command)
    return CliRunner().invoke(app, [str(word) for word in words], catch_exceptions=False)


WHOLE, ALONE, LIES = 4 - 64 / 28, 4 - 64 / 24, 4 - 64 / 32
"""Mean disparity error of the whole (depth 32, 24, 28), of the honest cue alone, of the liar alone."""


def test_leave_one_out_and_the_control(graph, pair):
    """Without the honest cue the error grows; without the liar, or with its amplitude at zero, it shrinks."""
    shown = pairs_in(pair)[0].read()
    whole = SystemVariant(graph)
    variants = [whole, *controls_of(graph), *cues_of(graph)]
    made = {str(one): reconstruct(one, shown, attribution=one == whole) for one in variants}
    assert made[str(whole)].shares == pytest.approx({"honest": 0.25, "liar": 0.5}, rel=1e-5)
    errors = {name: {"mae": float(np.abs(one.disparity - 4).mean())} for name, one in made.items()}
    found = contributions(whole, variants, errors, made[str(whole)].shares)
    told = {one.taken: (one.gains["mae"], one.share) for one in found}
    assert told == {
        "control liar": pytest.approx((100 * (1 - WHOLE / ALONE), 0.5), rel=1e-4),
        "without honest": pytest.approx((100 * (1 - WHOLE / LIES), 0.25), rel=1e-4),
        "without liar": pytest.approx((100 * (1 - WHOLE / ALONE), 0.5), rel=1e-4),
    }


def test_the_command_prints_both_tables(graph, pair, tmp_path):
    """Scores by variant, then what each cue takes away; scores also as CSV."""
    done = called(graph, pair, "--out", tmp_path / "out")
    assert done.exit_code == 0
    lines = {line.split("  ")[0]: line.split() for line in done.stdout.splitlines() if line}
    assert float(lines["without honest"][-1]) == pytest.approx(25.0, abs=0.1)
    mae = done.stdout.split("gains by a cue")[1].splitlines()[1].split().index("mae")
    assert float(lines["without honest"][2 + mae]) == pytest.approx(100 * (1 - WHOLE / LIES), abs=0.1)
    assert float(lines["control liar"][2 + mae]) == pytest.approx(100 * (1 - WHOLE / ALONE), abs=0.1)
    told = list(csv.reader((tmp_path / "out" / "contributions.csv").read_text().splitlines()))
    assert [row[0] for row in told[1:]] == ["control liar", "without honest", "without liar"]
    rows = list(csv.reader((tmp_path / "out" / "ablation.csv").read_text().splitlines()))
    assert [row[0].removeprefix(graph) for row in rows[1:]] == [
        "",
        ", control liar",
        ", without honest",
        ", without liar",
        "stereo_sgm",
    ]


def test_truth_from_another_folder(graph, pair, tmp_path):
    """``--truth``: the pair's own truth is put aside."""
    other = tmp_path / "other"
    other.mkdir()
    for name in ("im0.png", "im1.png", "calib.txt"):
        (other / name).write_bytes((pair / name).read_bytes())
    (other / "disp0GT.pfm").write_bytes(encode_pfm(np.full((48, 64), 2, np.float32)))
    done = called(graph, pair, "--truth", other)
    assert done.exit_code == 0
    row = next(line for line in done.stdout.splitlines() if line.startswith(f"{graph}, without honest"))
    head = done.stdout.splitlines()[0].split()
    assert float(row.split()[3 + head.index("mae")]) == pytest.approx(0, abs=1e-3), "the liar is right here"


def test_a_perfect_variant_and_an_equal_one():
    """No error without a cue: it is infinitely harmful; the same error: it changes nothing."""
    whole = SystemVariant("g")
    variants = [whole, SystemVariant("g", without=("a",)), SystemVariant("g", control="a")]
    scores = {"g": {"mae": 1.0}, "g, without a": {"mae": 0.0}, "g, control a": {"mae": 1.0}}
    found = contributions(whole, variants, scores, {})
    assert [one.gains["mae"] for one in found] == [float("-inf"), 0.0]
    assert all(np.isnan(one.share) for one in found)


@pytest.mark.slow
def test_chapter_fives_graph():
    """Every cue of `uniform_bayesian` has its row, every control too; stereo decides most of the depth."""
    done = called("uniform_bayesian", "a/sphere/lambertian", "--size", 64)
    assert done.exit_code == 0
    told = done.stdout.split("gains by a cue")[1]
    spec = visint.load("uniform_bayesian").spec
    rows = {line.split("  ")[0]: line.split() for line in told.splitlines()[3:]}
    wanted = [f"control {name}" for name in spec.controls] + [f"without {cue}" for cue in spec.hub.order]
    assert list(rows) == wanted
    assert float(rows["without stereo"][-1]) > 50
    assert rows["without diffusion"][-1] == "–", "it knows nothing but the map"

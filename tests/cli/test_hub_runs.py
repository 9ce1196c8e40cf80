"""Options that belong to graphs with a hub: spokes left out, controls, a warm start, evidence on disk."""

from __future__ import annotations

import json

import cv2
import numpy as np
import pytest

HUB = """visint: 1
name: toys
inputs: {image: Image, camera: Camera?}
loops: {sweeps: {times: 1}}
hub:
  uses: toy.even
  loop: sweeps
  start: {depth: plane}
  order: [first, second]
  spokes:
    first: {uses: toy.cue, with: {near: 1.0, far: 2.0}, in: {image: inputs.image}}
    second: {uses: toy.cue, with: {near: 3.0, far: 4.0}, in: {image: inputs.image}}
controls: {silent: {second.reliability: 0}}
outputs: {depth: map.depth}
"""


@pytest.fixture
def hub(toys, tmp_path, visint):
    """Runs the hub on a picture into a folder; gives the depth map and the outcome."""
    (tmp_path / "hub.yaml").write_text(HUB)
    cv2.imwrite(str(tmp_path / "a.png"), np.tile(np.linspace(0, 255, 24, dtype=np.uint8), (16, 1)))

    def call(out, *options, files):
        done = visint("run", "hub.yaml", "--in", "image=a.png", "--out", out, *options)
        assert done.code == 0, done
        return files.pfm(tmp_path / out / "depth.pfm"), done

    return call


def test_spokes_controls_and_repetition(hub, visint, tmp_path, files):
    """Without a spoke the map is another; its control does the same by reliability; each can be repeated."""
    both, done = hub("both", files=files)
    assert "[relative_depth]" in done.err
    alone, _ = hub("alone", "--without", "second", files=files)
    silent, _ = hub("silent", "--control", "silent", files=files)
    assert not np.allclose(both, alone)
    np.testing.assert_allclose(silent, alone, atol=1e-6)
    for name in ("both", "alone", "silent"):
        assert visint("run", f"{name}/run.json", "--out", "again").code == 0
        assert (tmp_path / "again/depth.pfm").read_bytes() == (tmp_path / name / "depth.pfm").read_bytes()


PARTS = ("depth", "sigma", "reliability", "share_of_depth")


def test_evidence_of_every_spoke_is_kept(hub, tmp_path, files):
    hub("out", files=files)
    with np.load(tmp_path / "out/evidence.npz") as stored:
        parts = {f"{spoke}.{part}" for spoke in ("first", "second") for part in PARTS}
        assert {name for name in stored if not name.endswith(".unit")} == parts
        assert all(stored[part].shape == (16, 24) for part in parts)
    record = json.loads((tmp_path / "out/run.json").read_text())
    assert record["outputs"]["depth"]["last_written_by"]["node"]


def test_warm_start(hub, refused, tmp_path, files):
    """``--from`` begins where a former run ended, so it ends elsewhere than a cold start."""
    cold, _ = hub("cold", files=files)
    warm, _ = hub("warm", "--from", "cold", files=files)
    assert not np.array_equal(cold, warm)
    said = refused(3, "run", "hub.yaml", "--in", "image=a.png", "--from", "nowhere", "--out", "x")
    assert "nowhere/depth.pfm" in said


def test_wrong_names(refused, hub):
    """Which spokes and controls there are is told."""
    run = ["run", "hub.yaml", "--in", "image=a.png", "--out", "x"]
    assert "Write: second " in refused(2, *run, "--without", "secnd")
    assert "silent" in refused(2, *run, "--control", "silence")


def test_plain_graph_gives_the_same(hub, visint, tmp_path, files):
    """``show --expand`` prints a graph file with the same results."""
    (tmp_path / "plain.yaml").write_text(visint("show", "hub.yaml", "--expand").out if hub else "")
    assert "hub:" not in (tmp_path / "plain.yaml").read_text()
    hub("out", files=files)
    assert visint("run", "plain.yaml", "--in", "image=a.png", "--out", "plain").code == 0
    assert (tmp_path / "plain/depth.pfm").read_bytes() == (tmp_path / "out/depth.pfm").read_bytes()

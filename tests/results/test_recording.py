"""A recording for the Rerun viewer: which maps at which step, with a stand-in for its library and with it."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import ClassVar

import cv2
import numpy as np
import pytest

import visint
from visint.errors import UsageError
from visint.graph import parse_graph
from visint.results.recording import Recording


class Kept:
    """Stands for a class of the library: keeps what it was made from."""

    def __init__(self, *args, **named):
        self.args, self.named = args, named


class Stream:
    """Stands for a recording stream: a list of (entity, what, times)."""

    made: ClassVar[list[Stream]] = []

    def __init__(self, application):
        self.application, self.logged, self.times = application, [], {}
        Stream.made.append(self)

    def set_time(self, timeline, *, sequence):
        self.times[timeline] = sequence

    def log(self, entity, what):
        self.logged.append((entity, what, dict(self.times)))

    def binary_stream(self):
        return SimpleNamespace(read=lambda: b"RRF2 stand-in")


@pytest.fixture
def library(monkeypatch):
    """The stand-in, importable as ``rerun``."""
    names = ("EncodedImage", "DepthImage", "Pinhole", "Scalars", "TextLog")
    fake = SimpleNamespace(RecordingStream=Stream, **{name: type(name, (Kept,), {}) for name in names})
    monkeypatch.setitem(sys.modules, "rerun", fake)
    return fake


def recorded(toys, size=(24, 32)):
    """The toy hub, recorded."""
    graph = parse_graph(toys.HUB, toys.catalog())
    recording = Recording(graph)
    image = toys.scene(*size)
    inputs = {"left": image, "right": image, "camera": toys.camera(size)}
    result = visint.run(graph, inputs, options=visint.Options(observers=(recording,)))
    return recording, result


@pytest.fixture
def logged(library, toys):
    recorded(toys)
    return Stream.made[-1].logged


def test_every_level_and_turn_is_on_the_timelines(logged, toys):
    """Steps only go up; the levels are those of the pyramid, coarsest first."""
    steps = [times["step"] for _, _, times in logged]
    assert steps == sorted(steps)
    levels = [times["level"] for entity, _, times in logged if entity == "map/depth"]
    assert levels == sorted(levels, reverse=True)
    assert set(levels) == {0, 1}
    assert max(times["turn"] for _, _, times in logged) > 0


def test_the_map_is_recorded_after_each_spoke(logged):
    """Its fields and confidence as pictures of the level's size, its depth before the level's camera."""
    entities = {entity for entity, _, _ in logged}
    assert {"map/depth", "map/depth_confidence", "map/boundaries", "map_shade/depth"} <= entities
    sizes = {}
    for entity, what, times in logged:
        if entity == "map/depth":
            png = np.frombuffer(what.named["contents"], np.uint8)
            sizes[times["level"]] = cv2.imdecode(png, cv2.IMREAD_COLOR).shape
    assert sizes == {0: (24, 32, 3), 1: (12, 16, 3)}
    lens = next(what.named for entity, what, times in logged if entity == "world/map" and times["level"] == 0)
    assert (lens["width"], lens["height"]) == (32, 24)


def test_evidence_is_three_pictures(logged):
    entities = {entity for entity, _, _ in logged}
    assert {f"match/evidence/{part}" for part in ("value", "sigma", "reliability")} <= entities


def test_changes_numbers_and_warnings_are_recorded(logged):
    entities = [entity for entity, _, _ in logged]
    assert "change/sweeps" in entities
    assert any(entity.startswith("measures/") for entity in entities)
    assert any("this is only a toy" in what.args[0] for entity, what, _ in logged if entity == "warnings")


def test_depth_before_a_camera_has_no_nan(logged):
    """The viewer takes 0 for unknown."""
    depths = [what.args[0] for entity, what, _ in logged if entity.endswith("/depth") and "world" in entity]
    assert depths
    assert all(np.isfinite(depth).all() for depth in depths)


def test_large_maps_are_reduced(library, toys):
    recorded(toys, (12, 1400))
    for entity, what, _ in Stream.made[-1].logged:
        if entity == "map/depth":
            picture = cv2.imdecode(np.frombuffer(what.named["contents"], np.uint8), cv2.IMREAD_COLOR)
            assert picture.shape[1] <= 640


def test_without_the_extra_it_says_what_to_install(toys, monkeypatch):
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(UsageError, match=r"VI701.*extra 'rerun'") as caught:
        Recording(parse_graph(toys.SCALARS, toys.catalog()))
    assert "pip install 'visint[rerun]'" in str(caught.value)


def test_watching_changes_nothing(library, toys):
    """The same result as without it, to the bit."""
    _, watched = recorded(toys)
    image = toys.scene(24, 32)
    plain = toys.run(toys.HUB, left=image, right=image, camera=toys.camera((24, 32)))
    for name in ("depth", "normals"):
        np.testing.assert_array_equal(watched[name], plain[name])


def test_the_library_itself_takes_all_of_it(toys):
    """Where it is installed: a file that begins as its format does, and holds more than a head."""
    pytest.importorskip("rerun", reason="the extra rerun is not installed")
    data = recorded(toys)[0].data()
    assert data[:3] == b"RRF"
    assert len(data) > 20_000

"""Events: plain tuples, and a summary that costs nothing until somebody asks."""

from __future__ import annotations

import pickle
import typing

import numpy as np
import pytest

from visint import events
from visint.arrays import Array, Boundaries, Depth, Image, Regions
from visint.events import NodeFinished, NodeStarted
from visint.fields import Camera, DepthEvidence, Light
from visint.module import Ports


class Many(Ports):
    depth: Depth[Array, "H W"] | None = None
    lines: Boundaries[Array, "H W"] | None = None
    regions: Regions[Array, "H W"] | None = None
    images: tuple[Image[Array, "H W"], ...] | None = None
    evidence: DepthEvidence | None = None
    camera: Camera | None = None
    light: Light | None = None
    number: float | None = None
    flag: bool | None = None


def summary(**values):
    """Of one port of a finished node."""
    finished = NodeFinished("match", 0, 0, 0.0, 0.1, Many(**values).__dict__)
    ((name, _),) = values.items()
    return finished.summary()[name]


class TestSummary:
    def test_of_a_map(self):
        """dtype, shape and the range of what is known."""
        assert summary(depth=np.array([[1, 2.5], [np.nan, -3]], np.float32)) == "float32 (2, 2) -3..2.5"

    def test_of_nothing_known(self):
        assert summary(depth=np.full((2, 3), np.nan, np.float32)) == "float32 (2, 3) nothing known"
        assert summary(depth=np.zeros((0, 3), np.float32)) == "float32 (0, 3) nothing known"

    def test_of_boundaries(self):
        """Booleans have no range: how many are set."""
        assert summary(lines=np.array([[True, False], [True, True]])) == "bool (2, 2) 3 set"
        assert summary(lines=np.zeros((2, 2), bool)) == "bool (2, 2) 0 set"

    def test_of_labels(self):
        assert summary(regions=np.array([[0, 7]], np.int32)) == "int32 (1, 2) 0..7"

    def test_of_a_list(self):
        """How many, and the first."""
        one = np.ones((2, 3), np.float32)
        assert summary(images=(one, one)) == "2 × float32 (2, 3) 1..1"
        assert summary(images=()) == "0 values"

    def test_of_evidence(self):
        evidence = DepthEvidence.of(np.array([[4, np.nan]], np.float32), 1.0, 1.0)
        assert summary(evidence=evidence) == "float32 (1, 2) 4..4"

    def test_of_what_is_no_array(self):
        assert summary(camera=Camera.uncalibrated(4, 3)) == "Camera"
        assert summary(light=Light.unknown()) == "Light"
        assert summary(number=2.5) == "2.5"
        assert summary(flag=True) == "True"
        assert summary(number=None) == "none"

    def test_every_port_is_in_it(self):
        assert list(NodeFinished("a", 0, 0, 0.0, 0.1, Many().__dict__).summary()) == list(Many.specs)


class TestTuples:
    def test_the_union_is_complete(self):
        """Every event class is in `Event` and in `__all__`, so that a match over it is whole."""
        classes = {
            each
            for each in vars(events).values()
            if isinstance(each, type) and issubclass(each, tuple) and each.__module__ == "visint.events"
        }
        assert set(typing.get_args(events.Event)) == classes
        assert {each.__name__ for each in classes} | {"Event", "Observer"} == set(events.__all__)
        assert all(each.__doc__ for each in classes)

    @pytest.mark.parametrize("event", typing.get_args(events.Event), ids=lambda each: each.__name__)
    def test_they_travel(self, event):
        """To another process and back, whatever they hold, in the order of declaration."""
        one = event(*range(len(event._fields)))
        assert pickle.loads(pickle.dumps(one)) == one

    def test_what_a_node_says_carries_where(self):
        """Node, level and turn lead every event of a node."""
        for event in typing.get_args(events.Event):
            if "node" in event._fields:
                assert event._fields[:3] == ("node", "level", "turn")
        assert NodeStarted("match", 1, 2, 0.5).turn == 2

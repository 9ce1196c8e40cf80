"""Partial runs: up to a node, with other parameters, without a spoke, by a control."""

from __future__ import annotations

import numpy as np
import pytest

from visint.errors import GraphError
from visint.graph import alter
from visint.results import Stop

LINE = """
inputs: {x: Scalar}
loops: {turns: {times: 3}, later: {times: 2}}
nodes:
  before: {uses: toy.scale, with: {factor: 2.0}, in: {value: inputs.x}}
  count: {uses: toy.counter, loop: turns, feedback: {value: {from: count.value, start: before.value}}}
  within: {uses: toy.diverge, loop: turns, in: {value: count.value}}
  after: {uses: toy.delay, in: {value: within.value}}
  last: {uses: toy.add, loop: later, in: {a: after.value}, feedback: {b: {from: last.sum, start: 0}}}
controls: {still: {before.factor: 0}, loud: {before.factor: 10, before.offset: 1}}
outputs: {before: before.value, within: within.value, after: after.value, last: last.sum}
"""
HUB = """
inputs: {left: Image}
loops: {sweeps: {times: 2}}
hub:
  uses: toy.even
  loop: sweeps
  start: {depth: 5.0}
  order: [a, b, c]
  spokes:
    a: {uses: toy.cue, in: {image: inputs.left}, with: {near: 1.0, far: 1.0}}
    b: {uses: toy.cue, in: {image: inputs.left}, with: {near: 2.0, far: 2.0}}
    c: {uses: toy.cue, in: {image: inputs.left}, with: {near: 3.0, far: 3.0}}
controls: {no_b: {b_reconcile.alpha: 0}}
outputs: {depth: map.depth}
"""


class TestStopAfter:
    @pytest.mark.parametrize(
        ("node", "outputs"),
        [
            ("before", {"before": 4}),
            ("count", {"before": 4, "within": 14, "count_value": 7}),
            ("within", {"before": 4, "within": 14}),
            ("after", {"before": 4, "within": 14, "after": 14}),
            ("last", {"before": 4, "within": 14, "after": 14, "last": 28}),
        ],
    )
    def test_ends_after_the_node_and_its_loops(self, stage, node, outputs):
        """The outputs there are by then; a node in a loop has its loop run to the end."""
        result = stage.run(LINE, {"x": 2.0}, stop_after=node)
        assert dict(result) == outputs
        loops = {"count": ["turns"], "within": ["turns"], "after": ["turns"], "last": ["turns", "later"]}
        assert [stop.loop for stop in result.stops] == loops.get(node, [])

    def test_what_the_node_gives_is_among_the_outputs(self, stage, image):
        """Each of its ports, though the graph itself does not give them; a spoke's evidence too."""
        result = stage.run(LINE, {"x": 2.0}, stop_after="count")
        assert result.kinds["count_value"] == "Scalar"
        result = stage.run(HUB, {"left": image}, stop_after="a")
        np.testing.assert_allclose(result["a_evidence"], 1.0)
        assert result.kinds["a_evidence"] == "Depth"

    def test_runs_nothing_more(self, stage):
        stage.run(LINE, {"x": 2.0}, stop_after="within")
        assert {name for name, _, _ in stage.calls} == {"before", "count", "within"}

    @pytest.mark.parametrize("threads", [1, 2])
    def test_a_spoke(self, stage, image, threads):
        """A spoke lies in the sweeps: they run to their end."""
        result = stage.run(HUB, {"left": image}, stop_after="a", threads=threads)
        assert result.stops == [Stop("sweeps", 0, 2, "times")]
        assert "depth" in result

    @pytest.mark.parametrize(("node", "calls"), [("before", 1), ("within", 7), ("after", 8), ("last", 10)])
    def test_progress_counts_what_will_be_called(self, stage, node, calls):
        """What remains is told of the part that runs, not of the whole graph."""
        seen = []
        stage.run(LINE, {"x": 2.0}, stop_after=node, observers=(seen.append,))
        assert next(event.calls for event in seen if type(event).__name__ == "RunStarted") == calls
        assert sum(type(event).__name__ == "NodeStarted" for event in seen) == calls

    def test_an_unknown_node_is_refused(self, stage):
        with pytest.raises(GraphError, match=r"VI219.*no node 'wihtin'(.|\n)*Write: within"):
            stage.run(LINE, {"x": 2.0}, stop_after="wihtin")
        assert stage.calls == []


class TestVariants:
    def test_settings(self, stage):
        """`node.param` → value; the graph itself stays as it is."""
        graph = stage.graph(LINE)
        assert stage.run(alter(graph, settings={"before.factor": 5.0}), {"x": 1.0})["before"] == 5
        assert stage.run(graph, {"x": 1.0})["before"] == 2

    def test_control(self, stage):
        graph = stage.graph(LINE)
        assert stage.run(alter(graph, control="still"), {"x": 3.0})["before"] == 0
        assert stage.run(alter(graph, control="loud"), {"x": 3.0})["before"] == 31

    def test_settings_beat_the_control(self, stage):
        graph = stage.graph(LINE)
        altered = alter(graph, control="loud", settings={"before.factor": 1.0})
        assert stage.run(altered, {"x": 3.0})["before"] == 4

    def test_without_a_spoke(self, stage, image):
        """What is left out leaves the map as it was before it; the rest goes on as by hand."""
        graph = stage.graph(HUB)
        for gone in ([], ["b"], ["a", "c"], ["a", "b", "c"], ["c"]):
            result = stage.run(alter(graph, without=gone), {"left": image})
            z = 5.0
            for _ in range(2):
                for spoke, target in (("a", 1.0), ("b", 2.0), ("c", 3.0)):
                    z += 0.0 if spoke in gone else 0.5 * (target - z)
            np.testing.assert_allclose(result["depth"], z, rtol=1e-6)
            assert set(result.evidence) == {"a", "b", "c"} - set(gone)

    def test_an_amplitude_of_zero_is_the_map_untouched(self, stage, image):
        """The control α = 0 runs the spoke, and leaves the map where leaving it out does."""
        graph = stage.graph(HUB)
        by_control = stage.run(alter(graph, control="no_b"), {"left": image})
        assert ("b", 0, 0) in stage.calls
        left_out = stage.run(alter(graph, without=["b"]), {"left": image})
        np.testing.assert_array_equal(by_control["depth"], left_out["depth"])

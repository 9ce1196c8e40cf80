"""Where a result comes from: the same run gives the same text, whatever the values are."""

from __future__ import annotations

import dataclasses
import hashlib
import json

import numpy as np
import pytest
from pydantic import BaseModel, ConfigDict

import visint
from visint.graph import parse_graph
from visint.results import Source
from visint.results.provenance import array_digest, installed_version, provenance
from visint.testing.toys import TOYS

INNER = """
visint: 1
name: inner
inputs: {value: Scalar}
loops: {turns: {times: 3}}
nodes: {grow: {uses: toy.diverge, loop: turns, feedback: {value: {from: grow.value, start: inputs.value}}}}
outputs: {value: grow.value}
"""

OUTER = """
visint: 1
name: outer
inputs: {value: Scalar}
loops: {sweeps: {times: 2}}
nodes:
  call: {uses: "graph:inner", in: {value: inputs.value}}
  count: {uses: toy.counter, loop: sweeps, feedback: {value: {from: count.value, start: call.value}}}
outputs: {value: count.value}
"""

RECORDED = """
visint: 1
name: recorded
inputs: {value: Scalar}
nodes:
  measured: {uses: toy.measure, in: {value: inputs.value}}
  line: {uses: toy.scale, with: {factor: inf}, in: {value: measured.value}}
outputs: {value: measured.value}
"""


def text(result, sources=None):
    return json.dumps(provenance(result, sources or {}), allow_nan=False)


def test_the_same_run_gives_the_same_text(toys, met):
    """Timings are no part of it."""
    assert text(toys.meeting()) == text(met)


def test_it_tells_what_was_run_on_what(met):
    told = json.loads(text(met, {"left": Source(("a.png",), gamma=1.0)}))
    assert told["visint"] == installed_version("visint")
    assert told["graph"]["name"] == "meeting"
    assert told["graph_hash"] == hashlib.sha256(met.graph.to_yaml().encode()).hexdigest()
    assert told["inputs"]["left"] == {
        "sha256": array_digest(met.inputs["left"]),
        "paths": ["a.png"],
        "gamma": 1.0,
    }
    assert told["inputs"]["camera"]["value"]["width"] == 64
    assert told["outputs"]["depth"]["shape"] == [48, 64]
    assert told["outputs"]["depth"]["last_written_by"]["node"] == met.writers["depth"].node
    assert told["outputs"]["count"] == {
        "kind": "Scalar",
        "value": 1.0,
        "sha256": told["outputs"]["count"]["sha256"],
    }
    assert told["parameters"]["shade"]["near"] == 700.0
    assert told["modules"]["toy.cue"] == {"version": "1", "from": "given in code"}
    assert set(told["libraries"]) >= {"python", "numpy", "opencv-python-headless"}
    assert [stop["reason"] for stop in told["stops"] if stop["loop"] == "levels"] == ["times"]
    assert told["warnings"][0]["text"] == "this is only a toy"


def test_nan_and_infinity_are_spelled_out(toys):
    """JSON has neither: they are words wherever they stand, in outputs, parameters, the graph and measures."""
    told = json.loads(text(toys.run(RECORDED, value=float("nan"))))
    assert told["outputs"]["value"]["value"] == "nan"
    assert told["measures"][0]["value"] == "nan"
    assert told["inputs"]["value"]["value"] == "nan"
    assert told["parameters"]["line"]["factor"] == "inf"
    assert told["graph"]["nodes"]["line"]["with"]["factor"] == "inf"


def test_modules_and_loops_of_sub_graphs_are_told_too(toys, tmp_path):
    """2 → 16 in three turns of the inner graph, then two turns of counting."""
    path = tmp_path / "inner.yaml"
    path.write_text(INNER)
    result = visint.run(parse_graph(OUTER, toys.catalog(graphs={"inner": path})), value=2.0)
    assert result["value"] == 18
    assert [stop.loop for stop in result.stops] == ["sweeps", "call.turns"]
    assert set(provenance(result, {})["modules"]) == {"toy.counter", "toy.diverge"}


class Lines(BaseModel):
    """A stranger's value that JSON cannot hold."""

    model_config = ConfigDict(arbitrary_types_allowed=True)
    points: np.ndarray


class Opaque:
    """A stranger's object, whose repr names its address."""


@pytest.mark.parametrize("make", [lambda: Lines(points=np.arange(3.0)), Opaque, lambda: (1.0, None)])
def test_strangers_values_have_digests_that_stay(met, make):
    """Two equal values have one digest, wherever in memory they lie."""

    def told():
        outputs = {**met.outputs, "lines": make()}
        result = dataclasses.replace(
            met, outputs=outputs, kinds={**met.kinds, "lines": "x.Lines"}, inputs={**met.inputs, "left": make()}
        )
        return text(result)

    assert told() == told()


def test_digests_tell_arrays_apart_by_type_shape_and_value():
    zeros = np.zeros((2, 3), np.float32)
    others = (zeros.reshape(3, 2), zeros.astype(np.int32), zeros + 1)
    assert len({array_digest(one) for one in (zeros, *others)}) == 4
    assert array_digest(zeros) == array_digest(np.asfortranarray(zeros))


def test_every_toy_is_known():
    """The toys' versions stand in the records of these tests."""
    assert all(toy.version == "1" for toy in TOYS)

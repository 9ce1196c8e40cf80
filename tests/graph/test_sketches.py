"""The shapes of all planned systems, rebuilt out of toy modules: they bind, run, and mean what they say."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

import visint
import visint.testing.plugin
from visint.events import NodeStarted
from visint.fields import Camera, Light
from visint.graph import Graph, alter, load, parse_graph
from visint.registry import Catalog

FOLDER = Path(__file__).parent / "graphs_toys"
NAMES = sorted(path.stem for path in FOLDER.glob("*.yaml"))
HUBS = ["focus", "joint", "monocular", "photometric", "uniform_bayesian"]
CATALOG = Catalog({"toy": visint.testing.plugin}, {})
SIZE = (18, 21)


def image(seed: int) -> np.ndarray:
    return np.random.default_rng(seed).random(SIZE, dtype=np.float32)


GIVEN = {
    "left": image(1),
    "right": image(2),
    "image": image(1),
    "guess": None,
    "images": [image(3), image(4)],
    "stack": [image(5), image(6)],
    "lights": [Light.distant(0, 0, -1), Light.distant(0, 0.6, -0.8)],
    "light": Light.distant(0, 0, -1),
    "distances": np.array([1.0, 2.0]),
    "camera": Camera(
        width=SIZE[1],
        height=SIZE[0],
        focal_length=20.0,
        cx=10.0,
        cy=8.5,
        baseline=0.1,
        disparity_range=(0.0, 8.0),
    ),
}


def graph(name: str) -> Graph:
    return load(FOLDER / f"{name}.yaml", CATALOG)


def run(which: Graph) -> tuple[visint.Result, list[tuple[str, int, int]]]:
    calls: list[tuple[str, int, int]] = []

    def note(event: object) -> None:
        if isinstance(event, NodeStarted):
            calls.append((event.node, event.level, event.turn))

    inputs = {name: GIVEN[name] for name in which.inputs}
    return visint.run(which, inputs, options=visint.Options(observers=(note,))), calls


def same(one: visint.Result, other: visint.Result) -> bool:
    def equal(a: object, b: object) -> bool:
        return np.array_equal(a, b, equal_nan=np.asarray(a).dtype.kind == "f")

    return set(one.outputs) == set(other.outputs) and all(equal(one[name], other[name]) for name in one.outputs)


@pytest.mark.parametrize("name", NAMES)
def test_it_runs_and_gives_every_output(name):
    """Every output is there, at full size where it has one."""
    which = graph(name)
    result, _ = run(which)
    assert set(which.outputs) <= set(result.outputs)
    for output in which.outputs:
        value = np.asarray(result[output])
        assert value.ndim == 0 or value.shape[:2] == SIZE


@pytest.mark.parametrize("name", NAMES)
def test_text_of_a_graph_reads_back_equal(name):
    """``to_yaml`` loses nothing, and ``expanded`` is a plain graph that binds to the same nodes."""
    which = graph(name)
    assert parse_graph(which.to_yaml(), CATALOG) == which
    plain = parse_graph(which.expanded(), CATALOG)
    assert plain.spec.hub is None
    assert plain.nodes == which.nodes


@pytest.mark.parametrize("name", HUBS)
def test_the_expanded_text_runs_to_identical_results(name):
    """Outputs, confidence, evidence and who wrote what: all as the hub graph has them."""
    which = graph(name)
    (hub, calls), (plain, plain_calls) = run(which), run(parse_graph(which.expanded(), CATALOG))
    assert same(hub, plain)
    assert calls == plain_calls
    assert set(hub.evidence) == set(plain.evidence) == {*which.spec.hub.spokes} & set(hub.evidence)
    for spoke, evidence in hub.evidence.items():
        np.testing.assert_array_equal(evidence.value, plain.evidence[spoke].value)
    for field, sure in hub.confidence.items():
        np.testing.assert_array_equal(sure, plain.confidence[field])


@pytest.mark.parametrize(
    ("name", "spoke"), [(name, spoke) for name in HUBS for spoke in graph(name).spec.hub.order]
)
def test_leaving_a_spoke_out_means_the_same_in_both_texts(name, spoke):
    """``without`` on the hub graph and on its expanded text: identical results, the spoke never called."""
    which = graph(name)
    less = alter(which, without=[spoke])
    plain = alter(parse_graph(which.expanded(), CATALOG), without=[spoke])
    assert less.plain_spec.nodes == plain.plain_spec.nodes
    (one, calls), (other, plain_calls) = run(less), run(plain)
    assert same(one, other)
    assert calls == plain_calls
    assert spoke not in {node for node, _, _ in calls}
    assert parse_graph(less.to_yaml(), CATALOG) == less


@pytest.mark.parametrize("name", HUBS)
def test_without_any_spoke_the_map_keeps_its_start(name):
    """A hub whose spokes are all gone gives the plane it started from, unsure everywhere."""
    which = graph(name)
    result, _ = run(alter(which, without=which.spec.hub.order))
    assert np.ptp(result["depth"]) == 0
    assert not result.confidence["depth"].any()


@pytest.mark.parametrize("name", ["non_uniform", "uniform_bayesian"])
def test_a_control_is_its_settings(name):
    """The amplitude-zero control by name, by its settings, and on the expanded text agree."""
    which = graph(name)
    by_name = alter(which, control="shading")
    by_setting = alter(which, settings=which.spec.controls["shading"])
    expanded = alter(parse_graph(which.expanded(), CATALOG), control="shading")
    assert by_name == by_setting
    assert by_name != which
    assert by_name.nodes == expanded.nodes
    assert same(run(by_name)[0], run(expanded)[0])
    assert not same(run(by_name)[0], run(which)[0])


def test_settings_reach_nodes_spokes_steps_and_fields():
    """``node.param``, ``spoke.param``, ``spoke_reconcile.param``: each lands in the node of that name."""
    which = graph("monocular")
    changed = alter(which, settings={"shading.near": 1.25, "texture_reconcile.alpha": 0.75})
    assert changed.nodes["shading"].params.near == 1.25
    assert changed.nodes["texture_reconcile"].params.alpha == 0.75
    assert which.nodes["shading"].params.near == 1.0
    assert alter(which) is which


def test_chapter_four_counts_its_calls():
    """Full-size nodes run once, level nodes once a level, sweeps 4 times; what they feed nothing is lifted."""
    _, calls = run(graph("non_uniform"))
    counts = Counter(node for node, _, _ in calls)
    assert counts == {
        **dict.fromkeys(["attributes", "grouping", "normals"], 1),
        **dict.fromkeys(["barriers", "focal", "features", "label", "albedo"], 3),
        **dict.fromkeys(["match", "depth", "couple", "back"], 12),
        "shade": 8,
    }
    assert {level for node, level, _ in calls if node == "shade"} == {0, 1}
    at = {call: i for i, call in enumerate(calls)}
    assert at["normals", 0, 0] > at["couple", 0, 3]
    for level in (2, 1, 0):
        assert at["barriers", level, 0] < at["features", level, 0] < at["label", level, 0]
        assert at["couple", level, 3] < at["features", level, 0]
    assert at["label", 2, 0] < at["match", 1, 0]


def test_spokes_commit_in_order():
    """Each sweep goes through the spokes in ``order``, each commit before the next spoke's estimate."""
    which = graph("uniform_bayesian")
    _, calls = run(which)
    turn = [node for node, level, at in calls if (level, at) == (2, 1)]
    spokes = [node for node in turn if node in which.spec.hub.order]
    lifted = {node for node in which.spec.hub.order if node not in spokes}
    assert spokes == [spoke for spoke in which.spec.hub.order if spoke not in lifted]
    commits = [node for node in turn if node.startswith("map_") or node == "map"]
    assert commits == ["map_begin", "map_grouping", "map_diffusion", "map_stereo", "map_shading", "map"]


def test_fibonacci_by_two_feedback_edges():
    """1, 2, 3, 5, 8, 13, 21, 34, 55, 89."""
    assert run(graph("fibonacci"))[0]["value"] == 89


def test_the_relaxation_starts_anew_each_round():
    """The inner loop converges in each round in equally many turns; the outer ends when its flag holds."""
    result, calls = run(graph("relaxation"))
    assert result["rounds"] == 2
    turns = Counter(node for node, _, _ in calls)["relax"]
    stops = [stop for stop in result.stops if stop.loop == "sweeps"]
    assert [stop.reason for stop in stops] == ["converged"] * 2
    assert turns == sum(stop.turns for stop in stops) == 2 * stops[0].turns

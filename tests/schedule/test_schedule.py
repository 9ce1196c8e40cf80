"""The schedule: its order follows from the graph alone, nodes run as far out as they may, slots are let go."""

from __future__ import annotations

import random
import weakref
from pathlib import Path

import networkx as nx
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import visint
import visint.testing.plugin
from visint.events import NodeFinished, NodeStarted
from visint.graph import Graph, load, parse_graph
from visint.graph.read import parse
from visint.graph.rewire import moved, rewired
from visint.graph.write import to_yaml
from visint.registry import Catalog
from visint.schedule import Pyramid, Repeat, Step, compile_graph
from visint.schedule.order import effective_loops, wires

CATALOG = Catalog({"toy": visint.testing.plugin}, {})
TOYS = sorted((Path(__file__).parents[1] / "graph" / "graphs_toys").glob("*.yaml"))
IMAGE = np.random.default_rng(0).random((12, 14), dtype=np.float32)


def bound(nodes: str, loops: str = "{}", outputs: str = "{a: a.value}", inputs: str = "{}") -> Graph:
    text = f"visint: 1\nname: g\ninputs: {inputs}\nloops: {loops}\nnodes:\n{nodes}\noutputs: {outputs}\n"
    return parse_graph(text, CATALOG)


def shuffled(graph: Graph, seed: int) -> tuple[Graph, dict[str, str]]:
    """The same plain graph with keys in another order and nodes under other names; old name by new."""
    rng = random.Random(seed)
    spec = parse(graph.expanded()).spec
    names = list(spec.nodes)
    fresh = [f"x{i}" for i in rng.sample(range(10 * len(names)), len(names))]
    renamed = {old: new for old, new in zip(names, fresh, strict=True) if old != "map"}
    order = rng.sample(names, len(names))

    def mixed(mapping: dict) -> dict:
        return dict(rng.sample(list(mapping.items()), len(mapping)))

    def node(old: str) -> object:
        new = rewired(spec.nodes[old], renamed)
        mixes = {"in_": mixed(new.in_), "feedback": mixed(new.feedback), "with_": mixed(new.with_)}
        return new.model_copy(update=mixes)

    loops = {
        name: loop.model_copy(update={"until": loop.until and _watching(loop.until, renamed)})
        for name, loop in mixed(spec.loops).items()
    }
    changed = spec.model_copy(
        update={
            "nodes": {renamed.get(old, old): node(old) for old in order},
            "loops": loops,
            "inputs": mixed(spec.inputs),
            "controls": {},
            "outputs": {name: moved(ref, renamed) for name, ref in mixed(spec.outputs).items()},
        }
    )
    return parse_graph(to_yaml(changed), CATALOG), {renamed.get(old, old): old for old in names}


def _watching(until: object, renamed: dict[str, str]) -> object:
    ends = {"change_of": until.change_of, "holds": until.holds}
    return until.model_copy(update={key: ref and moved(ref, renamed) for key, ref in ends.items()})


def calls(graph: Graph, **inputs: object) -> tuple[visint.Result, list[tuple[str, int, int]]]:
    seen: list[tuple[str, int, int]] = []

    def note(event: object) -> None:
        if isinstance(event, NodeStarted):
            seen.append((event.node, event.level, event.turn))

    return visint.run(graph, inputs, options=visint.Options(observers=(note,))), seen


@pytest.mark.parametrize("path", TOYS, ids=lambda path: path.stem)
@pytest.mark.parametrize("seed", range(4))
def test_names_and_key_order_change_nothing(path, seed):
    """Structural keys, and the order of calls told by them, are the same under any names and order of keys."""
    graph = load(path, CATALOG)
    other, old = shuffled(graph, seed)
    steps, others = list(compile_graph(graph).root.steps()), list(compile_graph(other).root.steps())
    assert {step.node.name: step.key for step in steps} == {old[step.node.name]: step.key for step in others}
    assert [step.key for step in steps] == [step.key for step in others]


@st.composite
def dags(draw: st.DrawFn) -> str:
    """A random graph of sums and straight lines, some of it in a loop and going round."""
    count = draw(st.integers(2, 12))
    lines = []
    for i in range(count):
        sources = draw(st.lists(st.integers(0, i - 1), max_size=2, unique=True)) if i else []
        loop = ", loop: turns" if i >= count // 2 else ""
        wires = ", ".join(f"{port}: n{s}.sum" for port, s in zip("ab", sources, strict=False))
        again = i >= count // 2 and len(sources) < 2 and draw(st.booleans())
        source = draw(st.integers(count // 2, count - 1))
        start = draw(st.sampled_from(["none", "1", "-2.5"]))
        feedback = f", feedback: {{b: {{from: n{source}.sum, start: {start}}}}}" if again else ""
        lines.append(f"  n{i}: {{uses: toy.add{loop}, in: {{{wires}}}{feedback}}}")
    lines.append(f"  one: {{uses: toy.constant, with: {{value: {draw(st.integers(-3, 3))}}}}}")
    lines.append("  seed: {uses: toy.scale, in: {value: one.value}}")
    outputs = ", ".join(f"o{i}: n{i}.sum" for i in range(count))
    body = "\n".join(lines)
    return f"visint: 1\nname: g\nloops: {{turns: {{times: 3}}}}\nnodes:\n{body}\noutputs: {{{outputs}}}\n"


@given(dags(), st.integers(0, 1000))
@settings(max_examples=50, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
def test_random_graphs_mean_the_same_under_other_names(text, seed):
    """The same numbers come out, and as many calls are made, whatever the names and the order of keys."""
    graph = parse_graph(text, CATALOG)
    other, old = shuffled(graph, seed)
    (one, seen), (two, also) = calls(graph), calls(other)
    assert dict(one.outputs) == dict(two.outputs)
    keys = {step.node.name: step.key for step in compile_graph(graph).root.steps()}
    assert [keys[node] for node, _, _ in seen] == [keys[old[node]] for node, _, _ in also]


LIFTED = """
  base: {uses: toy.constant}
  source: {uses: toy.constant, loop: inner}
  still: {uses: toy.scale, loop: inner, in: {value: source.value}}
  outer: {uses: toy.counter, loop: outer, feedback: {value: {from: outer.value}}}
  between: {uses: toy.scale, loop: inner, in: {value: outer.value}}
  count: {uses: toy.counter, loop: inner, feedback: {value: {from: count.value}}}
  after: {uses: toy.add, loop: inner, in: {a: count.value, b: between.value}}
  turn: {uses: toy.turn, loop: inner}
  noise: {uses: toy.noise, loop: inner, in: {value: source.value}}
  begun: {uses: toy.counter, loop: inner, feedback: {value: {from: begun.value, start: base.value}}}
  slow: {uses: toy.counter, loop: inner, feedback: {value: {from: outer.value}}}
  level: {uses: toy.level, loop: levels}
  deep: {uses: toy.level, loop: sweeps}
  free: {uses: toy.scale, in: {value: count.value}}
"""


def test_nodes_run_as_far_out_as_they_may():
    """Out of turn loops that feed them nothing; never out of a pyramid, nor if they ask for turn or chance."""
    loops = "{outer: {times: 2}, inner: {inside: outer, times: 3}, levels: {over: pyramid, levels: 2}, sweeps: {inside: levels, times: 4}}"  # noqa: E501
    graph = bound(LIFTED, loops, "{a: free.value}", "{image: Image}")
    found = effective_loops(graph, nx.topological_sort(wires(graph)))
    assert found == {
        **dict.fromkeys(["base", "source", "still", "free"], None),
        **dict.fromkeys(["outer", "between", "slow"], "outer"),
        **dict.fromkeys(["count", "after", "turn", "noise", "begun"], "inner"),
        **dict.fromkeys(["level", "deep"], "levels"),
    }
    _, seen = calls(graph, image=IMAGE)
    per_node = {name: sum(node == name for node, _, _ in seen) for name in graph.nodes}
    times = {None: 1, "outer": 2, "inner": 6, "levels": 2}
    assert per_node == {name: times[loop] for name, loop in found.items()}


def test_a_loop_is_one_step_of_what_is_around_it():
    """Blocks hold steps and loops in order; a pyramid is a Pyramid, a turn loop a Repeat."""
    graph = load(next(path for path in TOYS if path.stem == "non_uniform"), CATALOG)
    root = compile_graph(graph).root
    kinds = [type(item) for item in root.items]
    assert sorted(kind.__name__ for kind in kinds) == ["Pyramid", "Step", "Step", "Step"]
    (pyramid,) = (item for item in root.items if isinstance(item, Pyramid))
    (sweeps,) = (item for item in pyramid.body.items if isinstance(item, Repeat))
    inside = {step.node.name for step in sweeps.body.items if isinstance(step, Step)}
    assert inside == {"match", "depth", "shade", "couple", "back"}
    for block in (root, pyramid.body, sweeps.body):
        assert all(before < i for i, waits in enumerate(block.after) for before in waits)


def alive_during(graph: Graph, **inputs: object) -> int:
    """The most arrays made by nodes that were alive at the end of any call."""
    made: list[weakref.ref] = []
    most = 0

    def note(event: object) -> None:
        nonlocal most
        if isinstance(event, NodeFinished):
            made.extend(weakref.ref(value) for value in event.outputs.values() if isinstance(value, np.ndarray))
            most = max(most, len({id(one()) for one in made if one() is not None}))

    visint.run(graph, inputs, options=visint.Options(observers=(note,)))
    return most


def chain(count: int, loop: str = "") -> str:
    lines = [f"  n0: {{uses: toy.image{loop}, in: {{image: inputs.image}}}}"]
    lines += [f"  n{i}: {{uses: toy.image{loop}, in: {{image: n{i - 1}.image}}}}" for i in range(1, count)]
    return "\n".join(lines)


def test_a_chain_of_fifty_keeps_three_arrays_at_most():
    """Each value is let go after its last reader."""
    graph = bound(chain(50), outputs="{a: n49.image}", inputs="{image: Image}")
    assert alive_during(graph, image=IMAGE) <= 3


def test_a_chain_inside_a_loop_is_let_go_of_too():
    """Also where the chain goes round: the value carried on comes on top."""
    nodes = chain(20, ", loop: turns").replace(
        "in: {image: inputs.image}", "feedback: {image: {from: n19.image, start: 0}}"
    )
    graph = bound(nodes, "{turns: {times: 4}}", "{a: n19.image}", "{image: Image}")
    assert alive_during(graph, image=IMAGE) <= 4


def test_every_slot_is_let_go_once_but_what_is_kept():
    """Outputs, evidence and maps stay; everything else is freed exactly once, after all that read it."""
    for path in TOYS:
        schedule = compile_graph(load(path, CATALOG))
        freed = [slot for block in _blocks(schedule.root) for slots in block.frees for slot in slots]
        kept = {*schedule.outputs.values(), *schedule.kept.values(), *schedule.maps.values()}
        assert len(freed) == len({*freed})
        assert not kept & {*freed}
        assert kept | {*freed} == set(range(schedule.slots))


def _blocks(block: object) -> list:
    inner = [_blocks(item.body) for item in block.items if not isinstance(item, Step)]
    return [block, *(one for blocks in inner for one in blocks)]


def test_compiling_hundred_nodes_is_quick():
    """A schedule of 100 nodes takes milliseconds: some 10 on a quiet machine."""
    import time

    graph = bound(chain(100), outputs="{a: n99.image}", inputs="{image: Image}")
    compile_graph(graph)
    best = 1.0
    for _ in range(5):
        started = time.process_time()
        compile_graph(graph)
        best = min(best, time.process_time() - started)
    assert best < 0.04

"""Memory: what nobody reads any more is let go; a long loop does not grow; a result holds its outputs alone."""

from __future__ import annotations

import gc
import tracemalloc
import weakref

import numpy as np
import pytest

from visint.arrays import Array, Image
from visint.module import Module, Params, Ports


class Frames(Ports):
    image: Image[Array, "H W"]


class Link(Module[Params, Frames, Frames]):
    """The image plus 1; counts how many of its outputs are alive at each call."""

    name = "link"
    alive: weakref.WeakSet = weakref.WeakSet()  # noqa: RUF012
    most: list = []  # noqa: RUF012

    def run(self, inputs, ctx):
        fresh = inputs.image + np.float32(1)
        owner = _Owner(fresh)
        Link.alive.add(owner)
        Link.most.append(len(Link.alive))
        return Frames(image=np.asarray(owner))


class _Owner:
    """Owns an array: as long as any view of it lives, so does this."""

    def __init__(self, array):
        self._array = array
        self.__array_interface__ = array.__array_interface__


@pytest.fixture
def links(stage):
    stage.modules(own=[Link])
    Link.alive.clear()
    Link.most.clear()
    return stage


def chain(length, loop=""):
    lines = [f"  n0: {{uses: own.link{loop}, in: {{image: inputs.left}}}}"]
    lines += [f"  n{i}: {{uses: own.link{loop}, in: {{image: n{i - 1}.image}}}}" for i in range(1, length)]
    return "inputs: {left: Image}\nnodes:\n" + "\n".join(lines) + f"\noutputs: {{last: n{length - 1}.image}}\n"


def test_a_chain_of_fifty_keeps_three_arrays_at_most(links, image):
    """A value lives until its last reader has run: the one read, the one made, and one on its way."""
    result = links.run(chain(50), {"left": image}, watch=False)
    np.testing.assert_allclose(result["last"], image + 50, rtol=1e-6)
    assert len(Link.most) == 50
    assert max(Link.most) <= 3


def test_only_outputs_survive(links, image):
    """After the run one array is alive, the output; without the result none."""
    result = links.run(chain(20), {"left": image}, watch=False)
    gc.collect()
    assert len(Link.alive) == 1
    del result
    gc.collect()
    assert len(Link.alive) == 0


def test_a_failure_keeps_nothing_either(links, image):
    text = chain(10).replace("outputs:", "  pen: {uses: toy.scribble, in: {image: n9.image}}\noutputs:")
    text = text.replace("last: n9.image", "last: pen.image")
    try:
        links.run(text, {"left": image}, watch=False)
    except Exception as error:
        del error
    gc.collect()
    assert len(Link.alive) == 0


def test_a_loop_keeps_what_goes_round_and_no_more(links, image):
    """Turn by turn: the cell, the value being made, and the one before it where the change is measured."""
    text = """
inputs: {{left: Image}}
loops: {{turns: {{times: 40{until}}}}}
nodes: {{go: {{uses: own.link, loop: turns, feedback: {{image: {{from: go.image, start: inputs.left}}}}}}}}
outputs: {{last: go.image}}
"""
    links.run(text.format(until=""), {"left": image}, watch=False)
    assert max(Link.most) <= 2
    Link.most.clear()
    links.run(text.format(until=", until: {change_of: go.image, below: 1.0e-9}"), {"left": image}, watch=False)
    assert max(Link.most) <= 3


def test_levels_keep_one_value_a_cell(links, image):
    text = """
inputs: {left: Image}
loops: {levels: {over: pyramid, levels: 4}, turns: {inside: levels, times: 5}}
nodes: {go: {uses: own.link, loop: turns, feedback: {image: {from: go.image, start: inputs.left}}}}
outputs: {last: go.image}
"""
    links.run(text, {"left": image}, watch=False)
    assert max(Link.most) <= 2


def test_a_thousand_turns_do_not_grow(stage):
    """The second thousand turns of a loop of four nodes need no more memory than the first hundred."""
    rng = np.random.default_rng(3)
    left = rng.random((64, 64), dtype=np.float32)
    text = """
inputs: {{left: Image}}
loops: {{turns: {{times: {times}}}}}
nodes:
  a: {{uses: toy.smooth, loop: turns, feedback: {{image: {{from: d.image, start: inputs.left}}}}}}
  b: {{uses: toy.image, loop: turns, in: {{image: a.image}}}}
  c: {{uses: toy.stack, loop: turns, in: {{images: [a.image, b.image]}}}}
  d: {{uses: toy.image, loop: turns, in: {{image: c.image}}}}
outputs: {{last: d.image}}
"""
    short, long = (stage.graph(text.format(times=times)) for times in (100, 1000))
    stage.run(short, {"left": left}, watch=False)
    tracemalloc.start()
    try:
        stage.run(short, {"left": left}, watch=False)
        _, hundred = tracemalloc.get_traced_memory()
        tracemalloc.reset_peak()
        stage.run(long, {"left": left}, watch=False)
        _, thousand = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert thousand < hundred + 2 * left.nbytes


def test_the_callers_inputs_are_not_held(stage, image):
    """The result holds the inputs for the record; when it goes, so do they."""
    left = image.copy()
    gone = weakref.ref(left)
    result = stage.run(chain(2).replace("own.link", "toy.image"), {"left": left}, watch=False)
    del result, left
    gc.collect()
    assert gone() is None


def test_a_graph_that_is_dropped_is_let_go(stage):
    """Kept schedules are few: a thousand graphs bound and run one after the other do not pile up."""
    text = "nodes: {{one: {{uses: toy.constant, with: {{value: {}}}}}}}\noutputs: {{one: one.value}}\n"
    alive = []
    for i in range(80):
        graph = stage.graph(text.format(float(i)))
        stage.run(graph, watch=False)
        alive.append(weakref.ref(graph.catalog))
        del graph
    gc.collect()
    assert sum(ref() is not None for ref in alive) <= 64

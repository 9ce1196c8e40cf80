"""Graphs wired at random, most of them wrong: each is drawn, whole and without one thing upon another."""

from __future__ import annotations

import itertools
import math
import random

import pytest

from visint.graph import drawing
from visint.graph.drawing.compose import compose
from visint.graph.drawing.geometry import Leg, Rect
from visint.graph.drawing.layout import lay_out
from visint.graph.spec import FeedbackSpec, GraphSpec, HubSpec, LoopSpec, NodeSpec, SpokeSpec


class Chance:
    """Draws the parts of a graph: references may point anywhere, loops may lie in a circle."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.nodes = [f"n{i}" for i in range(self.random.randint(0, 12))]
        self.spokes = [f"s{i}" for i in range(self.random.randint(0, 7))]
        self.loops = [f"l{i}" for i in range(self.random.randint(0, 4))]

    def ref(self) -> str:
        name = self.random.choice([*self.nodes, *self.spokes, "map", "inputs"])
        return f"{name}.p{self.random.randint(0, 2)}"

    def loop(self) -> str | None:
        return self.random.choice([None, *self.loops])

    def ins(self) -> dict[str, str]:
        return {f"a{j}": self.ref() for j in range(self.random.randint(0, 3))}

    def feedback(self) -> dict[str, FeedbackSpec]:
        return {f"f{j}": FeedbackSpec(from_=self.ref()) for j in range(self.random.choice([0, 0, 1, 2]))}

    def hub(self) -> HubSpec | None:
        spokes = {name: SpokeSpec(uses="x.y", in_=self.ins(), feedback=self.feedback()) for name in self.spokes}
        start = {"depth": self.random.choice(["plane", self.ref()])}
        hub = HubSpec(loop=self.loop(), start=start, order=tuple(spokes), spokes=spokes)
        return hub if self.random.random() < 0.6 else None

    def graph(self) -> GraphSpec:
        nodes = {
            name: NodeSpec(uses="x.y", loop=self.loop(), in_=self.ins(), feedback=self.feedback())
            for name in self.nodes
        }
        return GraphSpec(
            visint=1, name="random", inputs={"p0": "Image", "p1": "Image"}, nodes=nodes, hub=self.hub(),
            loops={name: LoopSpec(times=2, inside=self.loop()) for name in self.loops},
            outputs={"o": self.ref(), "q": self.ref()},
        )  # fmt: skip


@pytest.mark.parametrize("seed", range(80))
def test_a_random_graph_is_drawn_whole(seed: int) -> None:
    """Every edge has a way between its two boxes, boxes are apart, and no straight piece runs through one."""
    spec = Chance(seed).graph()
    layout = lay_out(compose(spec))
    rects = {one.box.key: one.rect for one in layout.placed}
    assert {edge for edge, _ in layout.ways} == {*compose(spec).edges}
    assert not [1 for one, other in itertools.combinations(rects.values(), 2) if one.overlaps(other)]
    for edge, legs in layout.ways:
        assert all(math.dist(a.points[-1], b.points[0]) < 0.01 for a, b in itertools.pairwise(legs))
        assert legs[0].points[0].y == pytest.approx(rects[edge.source].bottom)
        assert legs[-1].points[-1].y == pytest.approx(rects[edge.target].y)
        assert not [
            edge for leg in legs for piece in _straight(leg) for r in rects.values() if piece.overlaps(r)
        ]
    drawing.to_dot(spec)


def _straight(leg: Leg) -> list[Rect]:
    """The upright and level pieces of ``leg``, drawn in by a pixel at their ends."""
    return [
        Rect(min(a.x, b.x) + 1, min(a.y, b.y) + 1, max(abs(a.x - b.x) - 2, 0), max(abs(a.y - b.y) - 2, 0))
        for a, b in itertools.pairwise(leg.points)
        if leg.square or abs(a.x - b.x) < 0.1
    ]

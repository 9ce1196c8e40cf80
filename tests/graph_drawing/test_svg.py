"""The drawing itself, read back: everything is there, in its place, and nothing lies on anything else."""

from __future__ import annotations

import functools
import itertools
import math
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
import shapes

from visint.graph import drawing
from visint.graph.drawing.compose import compose
from visint.graph.drawing.layout import Layout, lay_out
from visint.graph.spec import GraphSpec

SKETCHES = Path(__file__).parents[2].parent / "shared" / "graph-sketches"
NAMES = ("focus", "joint", "monocular", "non_uniform", "photometric", "uniform_bayesian")
EMPTY = "visint: 1\nname: empty\nloops: {idle: {times: 2}}\noutputs: {o: inputs.none}\n"
WRONG = (
    "visint: 1\nname: wrong\nloops: {l: {times: 2}, m: {times: 3}}\nnodes:\n"
    "  a: {uses: x.y, loop: l, in: {p: b.q, s: a.q}}\n  b: {uses: x.y, loop: m, in: {p: a.q}}\n"
    "  c: {uses: x.y, in: {p: d.q, self: c.q}}\n  d: {uses: x.y, in: {p: c.q, z: zero.q}}\noutputs: {o: c.q}\n"
)
TEXTS = {
    "recurrent": shapes.RECURRENT,
    "hub": shapes.HUB,
    "empty": EMPTY,
    "circles": WRONG,
    "chain of 60": shapes.chain(60),
    "fan of 60": shapes.fan(60),
    **{f"hub of {count}": shapes.hub_of(count) for count in (0, 1, 2, 3, 4, 5, 6, 7, 10, 13, 20)},
}


def sketch(name: str) -> GraphSpec:
    path = SKETCHES / f"{name}.yaml"
    if not path.is_file():
        pytest.skip("the sketches of graphs are not beside the project")
    return drawing.spec_of(str(path))


@functools.cache
def drawn(name: str) -> ET.Element:
    return shapes.tree(graph(name))


@functools.cache
def laid_out(name: str) -> Layout:
    return lay_out(compose(graph(name)))


@functools.cache
def graph(name: str) -> GraphSpec:
    return shapes.spec(TEXTS[name]) if name in TEXTS else sketch(name)


every_graph = pytest.mark.parametrize("name", [*TEXTS, *NAMES])


@every_graph
def test_every_box_and_loop_is_drawn_once(name: str) -> None:
    """Inputs, nodes, spokes, outputs and loops, by their names, with tooltips and within reach of Tab."""
    spec = graph(name)
    root = drawn(name)
    hub = spec.hub.spokes if spec.hub else {}
    wanted = (
        [f"input {n}" for n in spec.inputs] + [f"node {n}" for n in spec.nodes] + [f"spoke {n}" for n in hub]
    )
    wanted += [f"output {n}" for n in spec.outputs] + ["map map"] * (spec.hub is not None)
    boxes = [g for g in shapes.groups(root, "box") if "missing" not in g.get("class", "")]
    assert sorted(g.get("aria-label", "").partition(":")[0] for g in boxes) == sorted(wanted)
    assert sorted(shapes.loop_areas(root)) == sorted(spec.loops)
    shown = {text.text for text in root.iter(f"{shapes.SVG}text")}
    assert {*spec.inputs, *spec.nodes, *hub, *spec.outputs} <= shown
    assert all(g.get("tabindex") == "0" and shapes.title(g) for g in boxes)


@every_graph
def test_no_box_lies_on_another(name: str) -> None:
    """Boxes are apart, and all within the page."""
    root = drawn(name)
    areas = shapes.box_areas(root)
    for (one, first), (other, second) in itertools.combinations(areas.items(), 2):
        assert not first.overlaps(second), (one, other)
    page = shapes.Area(0, 0, *map(float, root.get("viewBox", "").split()[2:]))
    assert all(page.holds(area) for area in [*areas.values(), *shapes.loop_areas(root).values()])


@every_graph
def test_every_box_lies_in_its_loop_and_in_no_other(name: str) -> None:
    """A frame holds its own boxes and loops, and stays clear of all others."""
    spec = graph(name)
    root = drawn(name)
    boxes, frames = shapes.box_areas(root), shapes.loop_areas(root)
    homes = {f"node {n}": node.loop for n, node in spec.nodes.items()}
    if spec.hub:
        homes |= dict.fromkeys([f"spoke {n}" for n in spec.hub.spokes] + ["map map"], spec.hub.loop)
    for box, area in boxes.items():
        around = _around(spec, homes.get(box))
        for loop, frame in frames.items():
            assert frame.holds(area) if loop in around else not frame.overlaps(area), (box, loop)
    for one, other in itertools.permutations(frames, 2):
        if spec.loops[one].inside == other:
            assert frames[other].holds(frames[one])
        elif not {one, other} & {
            *_around(spec, spec.loops[one].inside),
            *_around(spec, spec.loops[other].inside),
        }:
            assert not frames[other].overlaps(frames[one])


def _around(spec: GraphSpec, loop: str | None) -> list[str]:
    found: list[str] = []
    while loop is not None:
        found.append(loop)
        loop = spec.loops[loop].inside
    return found


@every_graph
def test_every_edge_runs_whole_from_port_to_port(name: str) -> None:
    """The pieces of an edge join, and it begins below its source and ends above its target, at their ports."""
    layout = laid_out(name)
    placed = {one.box.key: one for one in layout.placed}
    assert {edge for edge, _ in layout.ways} == {*compose(graph(name)).edges}
    for edge, legs in layout.ways:
        for before, after in itertools.pairwise(legs):
            assert before.points[-1] == pytest.approx(after.points[0])
        source, target = placed[edge.source], placed[edge.target]
        assert legs[0].points[0] == pytest.approx((dict(source.outs)[edge.out], source.rect.bottom))
        assert legs[-1].points[-1] == pytest.approx((dict(target.ins)[edge.into], target.rect.y))


@every_graph
def test_no_edge_runs_through_a_box(name: str) -> None:
    """Upright and level pieces, the lines of a hub's spokes and all corners stay clear of every box."""
    layout = laid_out(name)
    for edge, legs in layout.ways:
        for leg in legs:
            for one, other in itertools.pairwise(leg.points):
                spots = _along(one, other) if leg.square else [one, other]
                assert not _hit(layout, spots), edge
    for key, start, end in layout.spokes:
        assert not _hit(layout, _along(start, end)[1:-1]), key


def _along(one: tuple[float, float], other: tuple[float, float]) -> list[tuple[float, float]]:
    count = int(math.dist(one, other) / 8) + 1
    shares = [i / count for i in range(count + 1)]
    return [(one[0] + (other[0] - one[0]) * s, one[1] + (other[1] - one[1]) * s) for s in shares]


def _hit(layout: Layout, spots: list[tuple[float, float]]) -> list[str]:
    """Boxes that hold one of ``spots`` well inside; the map's round ends count as its box's corners do not."""
    return [
        one.box.name
        for one in layout.placed
        for x, y in spots
        if one.rect.x + 1 < x < one.rect.right - 1 and one.rect.y + 1 < y < one.rect.bottom - 1
        if one.box.role != "map" or _in_round_ends(one.rect, x, y)
    ]


def _in_round_ends(rect: shapes.Area, x: float, y: float) -> bool:
    radius, middle = rect.h / 2, rect.x + rect.w / 2
    axis = min(max(x, rect.x + radius), rect.x + rect.w - radius)
    return math.dist((x, y), (axis, rect.y + radius)) < radius - 1 and abs(x - middle) < rect.w


@every_graph
def test_no_edge_enters_a_loop_through_its_caption(name: str) -> None:
    """The words of a loop stand where no edge comes in."""
    layout = laid_out(name)
    for frame in layout.frames:
        doors = [p.x for _, legs in layout.ways for leg in legs for p in leg.points if p.y == frame.rect.y]
        words = max([*frame.group.caption, frame.group.name], key=len)
        assert not [x for x in doors if frame.caption - 4 < x < frame.caption + 5 * len(words)]


def test_in_edges_are_solid_and_feedback_is_dashed() -> None:
    """Two feedback edges, by their tooltips, and the style that dashes them."""
    root = shapes.tree(shapes.spec(shapes.RECURRENT))
    dashed = [shapes.title(g) for g in shapes.groups(root, "feedback")]
    assert dashed == [
        "back.disparity → match.disparity (the turn before)",
        "match.right → match.right (the turn before)",
    ]
    assert len(shapes.groups(root, "edge")) == 11
    style = next(root.iter(f"{shapes.SVG}style")).text or ""
    assert re.search(r"\.feedback \.line\{[^}]*stroke-dasharray", style)
    assert "prefers-color-scheme:dark" in style


def test_data_flow_downwards() -> None:
    """An in-edge ends below where it begins; rows follow the longest path."""
    layout = lay_out(compose(shapes.spec(shapes.RECURRENT)))
    for edge, legs in layout.ways:
        if not edge.feedback:
            assert legs[0].points[0].y < legs[-1].points[-1].y


def test_a_hub_is_drawn_as_a_hub() -> None:
    """Each spoke has a line with a head at both ends to the map; they stand around it clockwise."""
    root = shapes.tree(shapes.spec(shapes.hub_of(6)))
    lines = shapes.groups(root, "spoke")
    lines = [g for g in lines if "box" not in g.get("class", "")]
    heads = [g.findall(f"{shapes.SVG}path")[1].get("d", "").count("Z") for g in lines]
    assert heads == [2] * 6
    areas = shapes.box_areas(root)
    middle = areas["map map"]
    angles = [_turn(middle, areas[f"spoke cue{i}"]) for i in range(6)]
    assert angles == sorted(angles)
    assert all(one.y + one.h < middle.y for one in (areas["spoke cue2"], areas["spoke cue3"]))
    assert all(one.y > middle.y + middle.h for one in (areas["spoke cue0"], areas["spoke cue5"]))


def _turn(middle: shapes.Area, spoke: shapes.Area) -> float:
    """The angle of ``spoke`` seen from the map, clockwise from straight down."""
    x = spoke.x + spoke.w / 2 - middle.x - middle.w / 2
    y = spoke.y + spoke.h / 2 - middle.y - middle.h / 2
    return math.atan2(-x, y) % (2 * math.pi)


def test_only_the_failed_node_is_red() -> None:
    """One box is marked as failed, in its class and in its words; without a failed node none is."""
    graph = shapes.spec(shapes.RECURRENT)
    red = shapes.groups(shapes.tree(graph, "couple"), "failed")
    assert [g.get("aria-label") for g in red] == ["node couple: bayes.pairwise · levels 0–2 (failed)"]
    assert "failed" in shapes.title(red[0])
    assert not shapes.groups(shapes.tree(graph), "failed")


def test_a_page_is_whole_and_has_no_script() -> None:
    """One file: title, about, the drawing; no script, no link, no image, nothing from outside."""
    page = drawing.to_html(shapes.spec(shapes.RECURRENT), "match")
    assert page.startswith("<!DOCTYPE html>\n<html lang")
    assert "<h1>recurrent</h1>\n<p>Two loops, one in the other, and a value that goes round.</p>" in page
    assert drawing.to_svg(shapes.spec(shapes.RECURRENT), "match") in page
    assert not re.search(r"<script|<link|<img|<iframe|\bon\w+=|@import|url\(", page)
    assert set(re.findall(r"https?://[^\"' ]+", page)) == {"http://www.w3.org/2000/svg"}
    body = page.removeprefix("<!DOCTYPE html>\n").replace('charset="utf-8">', 'charset="utf-8"/>')
    body = re.sub(r'(<meta (?:name|http-equiv)[^>]*")>', r"\1/>", body)
    assert ET.fromstring(body).tag == "html"


def test_a_large_graph_is_drawn_quickly_and_keeps_to_a_readable_width() -> None:
    """Sixty nodes side by side are set in several rows."""
    root = shapes.tree(shapes.spec(shapes.fan(60)))
    assert float(root.get("width", "inf")) < 2500

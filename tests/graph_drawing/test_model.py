"""What is drawn: which boxes, in which loops, with which edges."""

from __future__ import annotations

import pytest
import shapes

from visint.errors import UsageError
from visint.graph.drawing.captions import levels_text
from visint.graph.drawing.compose import compose
from visint.graph.drawing.model import Drawing, Edge, Group


def told(drawing: Drawing) -> set[tuple[str, str, str, str, bool]]:
    return {(e.source, e.out, e.target, e.into, e.feedback) for e in drawing.edges}


def nesting(group: Group) -> dict[str, object]:
    return {inner.name: ({box.name for box in inner.own()}, nesting(inner)) for inner in group.groups}


def test_every_in_edge_and_every_feedback_edge_is_drawn_once() -> None:
    """In-edges, feedback edges and the start of a feedback edge from elsewhere; a start of plane is no edge."""
    assert told(compose(shapes.spec(shapes.RECURRENT))) == {
        ("input left", "", "node attributes", "left", False),
        ("input right", "", "node attributes", "right", False),
        ("input left", "", "node barriers", "image", False),
        ("node attributes", "images", "node match", "attributes", False),
        ("node barriers", "boundaries", "node match", "boundaries", False),
        ("node back", "disparity", "node match", "disparity", True),
        ("node match", "right", "node match", "right", True),
        ("node barriers", "first", "node match", "right (start)", False),
        ("node match", "left", "node couple", "depth", False),
        ("node couple", "depth", "node back", "depth", False),
        ("node couple", "depth", "output depth", "", False),
    }


def test_loops_nest_as_their_inside_says() -> None:
    """Sweeps lie inside levels; a node lies in its own loop only."""
    root = compose(shapes.spec(shapes.RECURRENT)).root
    assert nesting(root) == {"levels": ({"barriers"}, {"sweeps": ({"match", "couple", "back"}, {})})}
    assert [box.name for box in root.boxes] == ["left", "right", "light", "depth", "attributes"]


def test_a_loop_says_how_it_ends() -> None:
    """The bound, the condition and what follows when it is exhausted stand in the caption."""
    levels = compose(shapes.spec(shapes.RECURRENT)).root.groups[0]
    assert levels.caption == ("coarse to fine, coarsest 8", "between levels Disparity: replicate")
    assert levels.groups[0].caption == (
        "at most 20 turns",
        "until the change of couple.depth < 0.001, 2 turns running",
        "else warn",
    )


def test_a_hub_is_a_map_with_spokes_in_order() -> None:
    """Spokes stand in the hub's order, not in that of the file, inside the hub's loop."""
    root = compose(shapes.spec(shapes.HUB)).root
    hub = root.groups[0].hub
    assert hub is not None
    assert [(spoke.turn, spoke.name) for spoke in hub.spokes] == [
        (1, "grouping"),
        (2, "stereo"),
        (3, "texture"),
    ]
    assert hub.map.text == "bayes.uniform"
    assert root.hub is None


def test_what_a_hub_binds_by_itself_is_no_edge() -> None:
    """A spoke's reading of the map, and its steps' reading of the spoke, are its line; the rest is drawn."""
    assert told(compose(shapes.spec(shapes.HUB))) == {
        ("input left", "", "node moments", "image", False),
        ("input prior", "", "map", "start depth", False),
        ("node moments", "weight", "map", "depth weight", False),
        ("node moments", "moments", "spoke texture", "moments", False),
        ("input left", "", "spoke grouping", "image", False),
        ("spoke grouping", "regions", "spoke stereo", "regions", False),
        ("node moments", "scale", "spoke stereo", "cohere scale", False),
        ("spoke stereo", "value", "spoke stereo", "old", True),
        ("map", "depth", "output depth", "", False),
        ("spoke grouping", "regions", "output regions", "", False),
    }


def test_a_reference_to_nothing_is_drawn_as_missing() -> None:
    """A graph that is not right yet is drawn all the same."""
    graph = shapes.spec(
        "visint: 1\nname: g\nnodes: {a: {uses: x.y, in: {p: b.q, r: inputs.s}}}\noutputs: {o: nonsense}\n"
    )
    found = {box.name for box in compose(graph).root.boxes if box.role == "missing"}
    assert found == {"b.q", "inputs.s", "nonsense"}


def test_loops_in_a_circle_or_in_nothing_stand_alone() -> None:
    """Loops inside each other in a circle, or inside an unknown one, are drawn at the top, each once."""
    text = "visint: 1\nname: g\nloops: {a: {inside: b}, b: {inside: a}, c: {inside: b}, d: {inside: q}}\n"
    root = compose(
        shapes.spec(text + "nodes: {n: {uses: x.y, loop: a}, m: {uses: x.y, loop: none}}\noutputs: {o: n.p}\n")
    ).root
    assert [group.name for group in root.groups] == ["a", "b", "c", "d"]
    assert [box.name for box in root.groups[0].boxes] == ["n"]
    assert "m" in {box.name for box in root.boxes}


def test_equal_edges_are_one() -> None:
    """A list port fed twice by one port has one edge."""
    nodes = "nodes: {n: {uses: x.y, in: {p: [inputs.i, inputs.i]}}}"
    edges = compose(
        shapes.spec(f"visint: 1\nname: g\ninputs: {{i: Image}}\n{nodes}\noutputs: {{o: n.q}}\n")
    ).edges
    assert edges == (Edge("input i", "", "node n", "p"), Edge("node n", "q", "output o", ""))


@pytest.mark.parametrize(
    ("failed", "box"),
    [
        ("", ""),
        ("moments", "node moments"),
        ("moments.inner", "node moments"),
        ("stereo", "spoke stereo"),
        ("stereo_cohere", "spoke stereo"),
        ("grouping_regions_reconcile", "spoke grouping"),
        ("map", "map"),
        ("map_begin", "map"),
        ("map_texture", "map"),
        ("depth_reconcile", "map"),
    ],
)
def test_the_failed_node_is_found_behind_the_hub(failed: str, box: str) -> None:
    """A node that the hub stands for, or one inside a called graph, marks the box that holds it."""
    assert compose(shapes.spec(shapes.HUB), failed).failed == box


def test_a_failed_node_that_is_none_is_told() -> None:
    """A slip of the pen is not drawn over in silence."""
    with pytest.raises(UsageError, match=r"(?s)no node is named 'sterio'.*Write: stereo"):
        compose(shapes.spec(shapes.HUB), "sterio")


@pytest.mark.parametrize(
    ("levels", "text"),
    [(None, ""), ((0,), "level 0"), ((0, 1, 2, 3), "levels 0–3"), ((0, 2), "levels 0, 2"), ((), "levels none")],
)
def test_levels_are_told_shortly(levels: tuple[int, ...] | None, text: str) -> None:
    assert levels_text(levels) == text

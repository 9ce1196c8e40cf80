"""Graphviz's language: clusters, dashes, red, a hub with lines both ways."""

from __future__ import annotations

import re

import shapes

from visint.graph import drawing


def lines(text: str, failed: str = "") -> list[str]:
    return [line.strip() for line in drawing.to_dot(shapes.spec(text), failed).splitlines()]


def names(found: list[str]) -> dict[str, str]:
    """Node ids by the first line of their labels."""
    matches = (re.match(r'(n\d+) \[label="(.*?)(?:\\n.*?)?"', line) for line in found)
    return {match[2]: match[1] for match in matches if match}


def test_loops_are_nested_clusters() -> None:
    """The inner cluster opens inside the outer one and holds its nodes."""
    found = lines(shapes.RECURRENT)
    outer, inner = (found.index(f'subgraph "cluster_{name}" {{') for name in ("levels", "sweeps"))
    match = next(i for i, line in enumerate(found) if line.startswith(f"{names(found)['match']} ["))
    attributes = next(i for i, line in enumerate(found) if line.startswith(f"{names(found)['attributes']} ["))
    assert (
        attributes
        < outer
        < inner
        < match
        < found.index("}", inner)
        < found.index("}", found.index("}", inner) + 1)
    )


def test_feedback_is_dashed_and_pulls_at_no_rank() -> None:
    """A feedback edge is dashed with constraint=false; an in-edge is neither and bears its port."""
    found = lines(shapes.RECURRENT)
    ids = names(found)
    back = next(line for line in found if line.startswith(f"{ids['back']} -> {ids['match']}"))
    assert "style=dashed" in back
    assert "constraint=false" in back
    there = next(line for line in found if line.startswith(f"{ids['attributes']} -> {ids['match']}"))
    assert "dashed" not in there
    assert 'label="attributes"' in there
    assert sum("style=dashed" in line for line in found) == 2


def test_the_failed_node_is_red() -> None:
    """Only that node is red."""
    found = lines(shapes.RECURRENT, "couple")
    red = [line for line in found if "color=red" in line]
    assert len(red) == 1
    assert red[0].startswith(f"{names(found)['couple']} [")
    assert not [line for line in lines(shapes.RECURRENT) if "red" in line and "color=red" in line]


def test_a_hub_has_a_double_ellipse_and_lines_both_ways() -> None:
    """The map stands out; each spoke is joined to it once, numbered by the order."""
    found = lines(shapes.HUB)
    ids = names(found)
    assert "peripheries=2" in next(line for line in found if line.startswith(f"{ids['map']} ["))
    both = [line.partition(" [")[0] for line in found if "dir=both" in line]
    assert both == [f"{ids['map']} -> {ids[name]}" for name in ("1. grouping", "2. stereo", "3. texture")]

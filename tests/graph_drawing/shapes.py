"""Graphs to draw, written out, and the coordinates read back from a drawing of them."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from typing import NamedTuple

from visint.graph import drawing
from visint.graph.read import parse
from visint.graph.spec import GraphSpec

SVG = "{http://www.w3.org/2000/svg}"

RECURRENT = """
visint: 1
name: recurrent
about: Two loops, one in the other, and a value that goes round.
inputs: {left: Image, right: Image, light: Light?}
loops:
  levels: {over: pyramid, coarsest: 8, between: {Disparity: replicate}}
  sweeps:
    {inside: levels, times: 20, until: {change_of: couple.depth, below: 1.0e-3, patience: 2},
     on_exhausted: warn}
nodes:
  attributes: {uses: stereo.attributes, in: {left: inputs.left, right: inputs.right}}
  barriers: {uses: grouping.edges_of, loop: levels, in: {image: inputs.left}}
  match:
    uses: stereo.weng
    loop: sweeps
    in: {attributes: attributes.images, boundaries: barriers.boundaries}
    feedback:
      disparity: {from: back.disparity, start: plane}
      right: {from: match.right, start: barriers.first}
  couple: {uses: bayes.pairwise, loop: sweeps, levels: [0, 1, 2], in: {depth: match.left}}
  back: {uses: stereo.disparity, loop: sweeps, in: {depth: couple.depth}}
outputs: {depth: couple.depth}
"""

HUB = """
visint: 1
name: hubbed
inputs: {left: Image, prior: Depth?}
loops: {sweeps: {times: 6}}
nodes:
  moments: {uses: texture.moments, in: {image: inputs.left}}
hub:
  uses: bayes.uniform
  loop: sweeps
  start: {depth: inputs.prior, boundaries: none}
  order: [grouping, stereo, texture]
  reconcile: {depth: {uses: bayes.joint, in: {weight: moments.weight}}}
  spokes:
    texture: {uses: texture.super_bovik, in: {moments: moments.moments, depth: map.depth}}
    grouping: {uses: grouping.perceptual, in: {image: inputs.left}}
    stereo: {uses: stereo.weng, in: {regions: grouping.regions}, feedback: {old: {from: stereo.value}},
             cohere: {uses: bayes.near, in: {own: stereo.value, scale: moments.scale}}}
outputs: {depth: map.depth, regions: grouping.regions}
"""


class Area(NamedTuple):
    """A rectangle as drawn."""

    x: float
    y: float
    w: float
    h: float

    def overlaps(self, other: Area) -> bool:
        across = self.x < other.x + other.w and other.x < self.x + self.w
        return across and self.y < other.y + other.h and other.y < self.y + self.h

    def holds(self, other: Area) -> bool:
        across = self.x <= other.x and other.x + other.w <= self.x + self.w
        return across and self.y <= other.y and other.y + other.h <= self.y + self.h


def spec(text: str) -> GraphSpec:
    return parse(text).spec


def chain(count: int) -> str:
    nodes = "\n".join(
        f"  n{i}: {{uses: toy.add, in: {{a: n{i - 1}.sum, b: inputs.x}}}}" for i in range(1, count)
    )
    first = "  n0: {uses: toy.add, in: {a: inputs.x}}"
    head = "visint: 1\nname: chain\ninputs: {x: Number}\nnodes:\n"
    return f"{head}{first}\n{nodes}\noutputs: {{y: n{count - 1}.sum}}\n"


def fan(count: int) -> str:
    nodes = "\n".join(f"  n{i}: {{uses: toy.add, in: {{a: inputs.x}}}}" for i in range(count))
    ends = ", ".join(f"n{i}.sum" for i in range(count))
    last = f"  all: {{uses: toy.sum, in: {{parts: [{ends}]}}}}"
    return f"visint: 1\nname: fan\ninputs: {{x: Number}}\nnodes:\n{nodes}\n{last}\noutputs: {{y: all.sum}}\n"


def hub_of(count: int, *, nodes: str = "") -> str:
    names = [f"cue{i}" for i in range(count)]
    spokes = "".join(f"\n    {name}: {{uses: toy.cue, in: {{image: inputs.x}}}}" for name in names)
    return (
        f"visint: 1\nname: wheel\ninputs: {{x: Image}}\n{nodes}hub:\n  order: [{', '.join(names)}]\n"
        f"  spokes: {spokes or '{}'}\noutputs: {{depth: map.depth, normals: map.normals}}\n"
    )


def tree(graph: GraphSpec, failed: str = "") -> ET.Element:
    return ET.fromstring(drawing.to_svg(graph, failed))


def title(group: ET.Element) -> str:
    found = group.find(f"{SVG}title")
    return (found.text or "") if found is not None else ""


def groups(root: ET.Element, *kinds: str) -> list[ET.Element]:
    return [g for g in root.iter(f"{SVG}g") if set(kinds) & set(g.get("class", "").split())]


def area(group: ET.Element) -> Area:
    rect = group.find(f"{SVG}rect")
    assert rect is not None
    return Area(*(float(rect.get(key, "nan")) for key in ("x", "y", "width", "height")))


def box_areas(root: ET.Element) -> dict[str, Area]:
    """Every box by the first words of its label, such as ``node match``."""
    return {g.get("aria-label", "").partition(":")[0]: area(g) for g in groups(root, "box")}


def loop_areas(root: ET.Element) -> dict[str, Area]:
    found = groups(root, "loop0", "loop1")
    return {title(g).splitlines()[0].removeprefix("loop "): area(g) for g in found}

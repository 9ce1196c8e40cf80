"""From a spec to what is drawn of it: which boxes there are and which loop each lies in."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from visint.errors import UsageError
from visint.graph.drawing import captions
from visint.graph.drawing.model import Box, Drawing, Edge, Group, Hub
from visint.graph.drawing.wires import MISSING, input_key, node_key, output_key, ports, spoke_key, wires
from visint.graph.graph import MAP
from visint.graph.spec import GraphSpec, HubSpec, InputSpec
from visint.names import did_you_mean, listed

__all__ = ["compose"]


def compose(spec: GraphSpec, failed: str = "") -> Drawing:
    """What is drawn of ``spec``, the box of the node ``failed`` marked.

    ``failed`` may also be a node that a hub stands for (``stereo_cohere``, ``map_stereo``) or one inside a
    called graph (``call.inner``): the box that holds it is marked.

    Raises
    ------
    UsageError
        VI701 if ``failed`` names nothing in the graph.
    """
    edges = wires(spec)
    root = _group(spec, edges, None)
    return Drawing(spec.name, spec.about, root, edges, _failed(spec, failed))


def _group(spec: GraphSpec, edges: tuple[Edge, ...], name: str | None) -> Group:
    hub = spec.hub
    inner = [loop for loop in spec.loops if _parent(spec, loop) == name]
    boxes = [*(_ends(spec, edges) if name is None else ()), *_nodes(spec, name)]
    here = hub is not None and _known(spec, hub.loop) == name
    return Group(
        name or "",
        captions.loop_caption(spec.loops[name]) if name is not None else (),
        _wired(boxes, edges),
        tuple(_group(spec, edges, loop) for loop in inner),
        _hub(hub, edges) if here and hub is not None else None,
        framed=name is not None,
    )


def _known(spec: GraphSpec, loop: str | None) -> str | None:
    return loop if loop in spec.loops else None


def _parent(spec: GraphSpec, loop: str) -> str | None:
    """The loop around ``loop``; none where loops lie inside each other in a circle."""
    seen, around = {loop}, _known(spec, spec.loops[loop].inside)
    while around is not None:
        if around in seen:
            return None
        seen.add(around)
        around = _known(spec, spec.loops[around].inside)
    return _known(spec, spec.loops[loop].inside)


def _ends(spec: GraphSpec, edges: Iterable[Edge]) -> Iterator[Box]:
    for name, text in spec.inputs.items():
        kind = str(InputSpec.parse(text))
        yield Box(input_key(name), "input", name, kind, f"input {name}: {kind}")
    for key in dict.fromkeys(edge.source for edge in edges if edge.source.startswith(MISSING)):
        ref = key.removeprefix(MISSING)
        yield Box(key, "missing", ref, "points nowhere", f"{ref} points nowhere")
    for name, ref in spec.outputs.items():
        yield Box(output_key(name), "output", name, ref, f"output {name} < {ref}")


def _nodes(spec: GraphSpec, loop: str | None) -> Iterator[Box]:
    for name, node in spec.nodes.items():
        if _known(spec, node.loop) == loop:
            text, tip = captions.module_text(node), captions.node_tip(name, node)
            yield Box(node_key(name), "node", name, text, tip)


def _hub(hub: HubSpec, edges: tuple[Edge, ...]) -> Hub:
    order = [*dict.fromkeys(name for name in hub.order if name in hub.spokes)]
    order += [name for name in hub.spokes if name not in order]
    spokes = []
    for turn, name in enumerate(order, 1):
        spoke = hub.spokes[name]
        text, tip = captions.module_text(spoke), captions.spoke_tip(name, spoke, turn)
        spokes.append(Box(spoke_key(name), "spoke", name, text, tip, turn=turn))
    middle = Box(MAP, "map", "map", hub.uses or "intrinsic images", captions.hub_tip(hub))
    return Hub(_wired([middle], edges)[0], _wired(spokes, edges))


def _wired(boxes: Iterable[Box], edges: tuple[Edge, ...]) -> tuple[Box, ...]:
    both = ((box, *ports(edges, box.key)) for box in boxes)
    return tuple(replace(box, ins=ins, outs=outs) for box, ins, outs in both)


def _failed(spec: GraphSpec, failed: str) -> str:
    if not failed:
        return ""
    found = _holder(spec, failed) or _holder(spec, failed.partition(".")[0])
    if found is None:
        known = [*spec.nodes, *(spec.hub.spokes if spec.hub else ()), *([MAP] if spec.hub else ())]
        near = did_you_mean(failed, known)
        said = f"no node is named {failed!r}"
        raise UsageError.of("VI701", said, choices="nodes: " + listed(known), write=near or "")
    return found


def _holder(spec: GraphSpec, name: str) -> str | None:
    """The box of the node ``name``, or the one that stands for it when a hub is not spelled out."""
    if name in spec.nodes:
        return node_key(name)
    return _holder_in_hub(spec.hub, name) if spec.hub else None


def _holder_in_hub(hub: HubSpec, name: str) -> str | None:
    if name in hub.spokes:
        return spoke_key(name)
    stem = name.removesuffix("_cohere").removesuffix("_reconcile")
    if name in (MAP, "map_begin") or name.startswith("map_") or (stem in hub.reconcile and stem != name):
        return MAP
    owners = [spoke for spoke in hub.spokes if stem != name and (stem == spoke or stem.startswith(spoke + "_"))]
    return spoke_key(max(owners, key=len)) if owners else None

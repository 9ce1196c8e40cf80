"""A group as a block: its boxes, loops and hub in rows, top to bottom, and a way for every edge.

An edge that goes down passes the rows between its ends by ways of its own; one that comes back, such as a
feedback edge, runs in a lane beside the rows.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

from visint.graph.drawing.boxes import box_block
from visint.graph.drawing.caption import caption_size, caption_spot
from visint.graph.drawing.floor import Floor, floor_of, sort_ports
from visint.graph.drawing.geometry import Block, Frame, Leg, Point, Rect
from visint.graph.drawing.hub import hub_block
from visint.graph.drawing.lattice import Lattice, Link, lattice
from visint.graph.drawing.model import Edge, Group
from visint.graph.drawing.order import reorder
from visint.graph.drawing.place import place
from visint.graph.drawing.returns import TRACK, Lanes, lanes_of, return_leg

__all__ = ["group_block"]

GAP = 42.0
PAD = 18.0


def group_block(group: Group, edges: Sequence[Edge]) -> Block:
    """``group`` laid out with all that is in it; the outermost one has no frame."""
    floor = floor_of([*_blocks(group, edges)], edges)
    found = lattice(floor.cells, floor.routes)
    reorder(found)
    place(found)
    sort_ports(floor, found, group.boxes, edges)
    place(found)
    lanes = lanes_of(floor, found)
    _set_rows(floor, found, lanes, caption_size(group)[1] if group.framed else 0.0)
    return _framed(group, floor, found, _assembled(floor, found, lanes), lanes.right)


def _blocks(group: Group, edges: Sequence[Edge]) -> Iterator[Block]:
    yield from (box_block(box, edges) for box in group.boxes)
    yield from (group_block(inner, edges) for inner in group.groups)
    if group.hub is not None:
        yield hub_block(group.hub, edges)


def _set_rows(floor: Floor, found: Lattice, lanes: Lanes, y: float) -> None:
    """The y of each row, the first at ``y``, with room between rows for curves and for returning edges."""
    between = found.between()
    for index, row in enumerate(found.rows):
        tall = max((cell.block.h for cell in row if cell.block), default=0.0)
        floor.tops.append(y)
        floor.bottoms.append(y + tall)
        tracks = lanes.tracks.get(index, 0)
        y += tall + TRACK * tracks + (_gap(between[index]) if between[index] or tracks else PAD)


def _gap(links: Sequence[Link]) -> float:
    """The further an edge moves aside, the more room it has to do so."""
    steps = (abs(link.upper.x + link.start - link.lower.x - link.end) for link in links)
    return min(GAP + max(steps, default=0.0) / 14, 2 * GAP)


def _assembled(floor: Floor, found: Lattice, lanes: Lanes) -> Block:
    inner = Block(0, 0, floor.keys)
    for cell in floor.cells:
        if cell.block is not None:
            inner.take(cell.block, Point(cell.x, floor.tops[cell.row]))
    inner.legs += [(edge, _down(floor, links)) for edge, links in found.links.items()]
    inner.legs += [(one.edge, return_leg(floor, lanes, one)) for one in floor.returns]
    return inner


def _down(floor: Floor, links: Sequence[Link]) -> Leg:
    first, last = links[0].upper, links[-1].lower
    points = [] if first.block else [Point(first.x, 0.0)]
    for link in links:
        upper, x = link.upper, link.upper.x + link.start
        y = floor.tops[upper.row] + (upper.block.h if upper.block else 0.0)
        points += [Point(x, y), Point(x, floor.bottoms[upper.row])]
        points.append(Point(link.lower.x + link.end, floor.tops[link.lower.row]))
    if not last.block:
        points.append(Point(last.x, floor.bottoms[last.row]))
    return Leg(tuple(one for one, other in pairwise([*points, None]) if one is not None and one != other))


def _framed(group: Group, floor: Floor, found: Lattice, inner: Block, reach: float) -> Block:
    """``inner`` with margins and, for a loop, its frame and a caption that no edge crosses."""
    right = max([cell.x + cell.w for row in found.rows for cell in row] + [reach])
    left, caption = 0.0, 0.0
    if group.framed:
        doors = sorted(cell.x for cell in found.rows[0])
        left, right, caption = caption_spot(group, doors, -PAD, right + PAD)
    block = Block(right - left, floor.bottoms[-1], inner.keys)
    if group.framed:
        block.frames.append(Frame(group, Rect(0, 0, block.w, block.h), caption - left))
    block.take(inner, Point(-left, 0))
    _set_doors(block, floor, found, -left)
    return block


def _set_doors(block: Block, floor: Floor, found: Lattice, by: float) -> None:
    for route in floor.routes:
        links = found.links[route.edge]
        if route.source is None:
            block.top[route.edge] = links[0].upper.x + by
        if route.target is None:
            block.bottom[route.edge] = links[-1].lower.x + by

"""Schedules made ready to run: everything that does not change from run to run is worked out once."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from visint.engine.call import Call, read_as
from visint.engine.executors import Run, in_order, side_by_side
from visint.engine.frame import Frame
from visint.engine.inputs import accept, camera_of, size_of
from visint.engine.invoke import Invoke, Values
from visint.engine.levels import Levels
from visint.engine.loops import Turns
from visint.engine.state import State
from visint.errors import GraphError, Problem
from visint.graph.graph import Node
from visint.module import Context
from visint.names import did_you_mean, listed
from visint.schedule import Block, Repeat, Schedule, Step, compile_graph
from visint.schedule.steps import Item

__all__ = ["execute", "pools_for", "up_to"]


def execute(schedule: Schedule, state: State, values: Mapping[str, Any], stop_after: str | None = None) -> None:
    """Runs ``schedule`` on accepted inputs: side by side where the state has pools, up to ``stop_after``.

    Raises
    ------
    GraphError
        VI219 if there is no node to stop after.
    """
    for name, reader, slot in schedule.inputs:
        state.slots[slot] = read_as(values[name], reader)
    state.root = state.root._replace(size=size_of(schedule.graph, values))
    _ready(schedule, bool(state.pools), stop_after)(state, state.root)


def pools_for(block: Block) -> int:
    """How many pools of threads it takes: one a depth of loops, for a loop waits for its body."""
    return 1 + max((pools_for(item.body) for item in block.items if not isinstance(item, Step)), default=0)


@lru_cache(maxsize=32)
def _ready(schedule: Schedule, threaded: bool, stop_after: str | None) -> Run:
    root = up_to(schedule, stop_after) if stop_after else schedule.root
    return _block(schedule, root, 0 if threaded else None)


def _block(schedule: Schedule, block: Block, pool: int | None) -> Run:
    """``block`` side by side in the state's pool of that number, its loops in the next; in order for None."""
    items = [_item(schedule, item, pool) for item in block.items]
    return in_order(block, items) if pool is None else side_by_side(block, items, pool)


def _item(schedule: Schedule, item: Item, pool: int | None) -> Run:
    if isinstance(item, Step):
        return Call(item, _sub_graph).__call__  # Python calls a method quicker than an object
    body = _block(schedule, item.body, None if pool is None else pool + 1)
    restarts = schedule.restarts.get(item.loop.name, ())
    return Turns(item, body, restarts) if isinstance(item, Repeat) else Levels(item, body, restarts)


def _sub_graph(node: Node) -> Invoke:
    """A sub-graph is a call: it gets inputs, gives outputs, and keeps nothing between calls.

    Inside it is the level and the turn of the call, and the camera and the images are those that it is given.
    """
    graph = node.callee.graph
    assert graph is not None
    schedule = compile_graph(graph)

    def invoke(values: Values, context: Context, outer: State) -> Mapping[str, Any]:
        given = accept(graph, values)
        inner = State([None] * schedule.slots, context._seed, camera_of(given), cancel=outer.cancel)
        inner.root = Frame(context.level, None, context._turns)
        inner.within = f"{outer.within}{node.name}."
        inner.emit, inner.record = outer.emit, outer.record
        execute(schedule, inner, given)
        return {name: inner.slots[slot] for name, slot in schedule.outputs.items()}

    return invoke


def up_to(schedule: Schedule, node: str) -> Block:
    """The root block up to and with the item that holds ``node``; GraphError VI219 if there is no such node."""
    root = schedule.root
    for i, item in enumerate(root.items):
        inner = [item] if isinstance(item, Step) else list(item.body.steps())
        if any(step.node.name == node for step in inner):
            return Block(root.items[: i + 1], root.frees[: i + 1], root.after[: i + 1])
    known = [step.node.name for step in root.steps()]
    near = did_you_mean(node, known)
    raise GraphError(
        Problem(
            "VI219",
            f"there is no node {node!r} to stop after",
            choices="nodes: " + listed(known),
            write=near or "",
        )
    )

"""Running a graph: inputs accepted, the schedule made ready, gone through once, the result gathered."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from os import PathLike
from time import perf_counter
from typing import Any

from visint.engine.call import Call, read_as
from visint.engine.executors import Run, in_order, side_by_side
from visint.engine.frame import Frame
from visint.engine.inputs import accept, camera_of, size_of
from visint.engine.levels import Levels
from visint.engine.loops import Turns
from visint.engine.options import Options
from visint.engine.state import State, emitter
from visint.errors import GraphError, Problem
from visint.events import RunFinished, RunStarted
from visint.fields.camera import Camera
from visint.fields.evidence import Evidence
from visint.graph import Graph, load
from visint.graph.graph import Node
from visint.names import did_you_mean, listed
from visint.results import Result, gather
from visint.schedule import Block, Repeat, Schedule, Step, compile_graph

__all__ = ["run"]


def run(
    graph: Graph | str | PathLike[str],
    inputs: Mapping[str, Any] | None = None,
    *,
    options: Options | None = None,
    **named: Any,
) -> Result:
    """Runs a graph.

    Parameters
    ----------
    graph
        A graph, or what :func:`visint.load` takes.
    inputs, named
        The graph's inputs by name. Images are float32 (H, W) or (H, W, 3), linear, in [0, 1]; a colour
        image feeds an ``Image`` by its luminance.
    options
        Seed, threads, observers and so on.

    Returns
    -------
    The outputs, their confidence, the evidence and the record of the run.

    Raises
    ------
    GraphError, PluginError
        If the graph is wrong, or a plugin of it.
    InputError
        If an input is missing or wrong.
    ModuleError
        If a module fails; names node, module, version, level and turn.
    Cancelled
        If ``options.cancel`` was set.
    """
    graph = load(graph)
    options = options or Options()
    values = accept(graph, {**(inputs or {}), **named})
    schedule = compile_graph(graph)
    state = State([None] * schedule.slots, seed=options.seed, warm=options.start, cancel=options.cancel)
    observers = [*options.observers, *(seen for plugin in graph.catalog.loaded for seen in plugin.observers())]
    state.emit = emitter(observers)
    started = perf_counter()
    names = tuple(step.node.name for step in schedule.root.steps())
    state.tell(RunStarted(graph.name, names, _calls(schedule, size_of(graph, values))))
    finished = False
    try:
        with _one_thread_each():
            _execute(schedule, state, values, options)
        finished = True
    finally:
        state.tell(RunFinished(graph.name, perf_counter() - started, failed=not finished))
    state.record.in_order(graph.loops, names)
    return _result(schedule, state, values, perf_counter() - started)


def _one_thread_each() -> Any:
    """One BLAS thread: other numbers of threads give other last bits."""
    from threadpoolctl import threadpool_limits

    return threadpool_limits(limits=1, user_api="blas")


def _execute(schedule: Schedule, state: State, values: Mapping[str, Any], options: Options) -> None:
    for name, reader, slot in schedule.inputs:
        state.slots[slot] = read_as(values[name], reader)
    root = _up_to(schedule, options.stop_after) if options.stop_after else schedule.root
    frame = Frame(0, size_of(schedule.graph, values))
    with ExitStack() as stack:
        ready = _Ready(schedule, state, options, camera_of(values), stack)
        ready.block(root, 0)(state, frame)


class _Ready:
    """Makes the parts of a schedule ready to run."""

    def __init__(
        self, schedule: Schedule, state: State, options: Options, camera: Camera | None, stack: ExitStack
    ) -> None:
        self._schedule = schedule
        self._state = state
        self._options = options
        self._camera = camera
        self._stack = stack
        self._pools: list[ThreadPoolExecutor] = []

    def block(self, block: Block, depth: int) -> Run:
        items = [self._item(item, depth) for item in block.items]
        if self._options.threads == 1:
            return in_order(block, items)
        return side_by_side(block, items, self._pool(depth))

    def _item(self, item: Any, depth: int) -> Run:
        if isinstance(item, Step):
            return Call(item, self._options.seed, self._sub_graph, self._state)
        body = self.block(item.body, depth + 1)
        restarts = self._schedule.restarts.get(item.loop.name, ())
        if isinstance(item, Repeat):
            return Turns(item, body, restarts, self._camera)
        return Levels(item, body, restarts, self._camera)

    def _pool(self, depth: int) -> ThreadPoolExecutor:
        """One pool a depth of loops: a loop waits for its body, which must not wait for the loop's thread."""
        while len(self._pools) <= depth:
            pool = ThreadPoolExecutor(self._options.threads, thread_name_prefix=f"visint-{len(self._pools)}")
            self._pools.append(self._stack.enter_context(pool))
        return self._pools[depth]

    def _sub_graph(self, node: Node, values: dict[str, Any], state: State) -> Mapping[str, Any]:
        """A sub-graph is a call: it gets inputs, gives outputs, and keeps nothing between calls."""
        graph = node.callee.graph
        assert graph is not None
        schedule = compile_graph(graph)
        slots = [None] * schedule.slots
        inner = State(slots, state.seed, cancel=state.cancel, emit=state.emit, record=state.record)
        given = accept(graph, values)
        options = Options(seed=self._options.seed, threads=1)
        _execute(schedule, inner, given, options)
        return {name: inner.slots[slot] for name, slot in schedule.outputs.items()}


def _up_to(schedule: Schedule, node: str) -> Block:
    """The root block up to and with the item that holds ``node``."""
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


def _calls(schedule: Schedule, size: tuple[int, int] | None) -> int:
    """The most calls of ``run`` that the schedule can make: what progress is measured against."""
    from visint.fields.resampling import levels_down_to

    def count(block: Block) -> int:
        total = 0
        for item in block.items:
            if isinstance(item, Step):
                total += 1
            elif isinstance(item, Repeat):
                total += (item.loop.spec.times or 1) * count(item.body)
            else:
                spec = item.loop.spec
                levels = spec.levels or (levels_down_to(size, spec.coarsest or 1) if size else 1)
                total += levels * count(item.body)
        return total

    return count(schedule.root)


def _result(schedule: Schedule, state: State, values: Mapping[str, Any], seconds: float) -> Result:
    outputs = {
        name: state.slots[slot] for name, slot in schedule.outputs.items() if state.slots[slot] is not None
    }
    evidence: dict[str, Evidence] = {}
    ports = [spoke for spoke, _ in schedule.kept]
    for (spoke, port), slot in schedule.kept.items():
        if state.slots[slot] is not None:
            evidence[spoke if ports.count(spoke) == 1 else f"{spoke}.{port}"] = state.slots[slot]
    for name, edge in schedule.graph.outputs.items():  # what an output's evidence said beside its value
        if isinstance(outputs.get(name), Evidence):
            evidence.setdefault(edge.source.node, outputs[name])
    maps = {name: state.slots[slot] for name, slot in schedule.maps.items()}
    return gather(
        schedule.graph,
        values,
        outputs,
        maps=maps,
        evidence=evidence,
        record=state.record,
        seed=state.seed,
        seconds=seconds,
    )

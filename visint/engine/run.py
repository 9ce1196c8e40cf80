"""Running a graph: inputs accepted, the schedule made ready, gone through once, the result gathered."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from functools import lru_cache
from os import PathLike
from time import perf_counter
from typing import Any

from visint.engine.attribution import Attribution, Weights
from visint.engine.inputs import accept, camera_of, size_of
from visint.engine.one_thread import ONE_THREAD
from visint.engine.options import Options
from visint.engine.ready import execute, pools_for, up_to
from visint.engine.state import Halt, State, emitter
from visint.engine.warm import accept_start
from visint.events import Observer, RunFinished, RunStarted
from visint.fields.evidence import Evidence
from visint.graph import Graph, load
from visint.graph.ending import ending_at
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
    options = options or Options()
    graph = ending_at(load(graph), options.stop_after) if options.stop_after else load(graph)
    values = accept(graph, {**(inputs or {}), **named})
    schedule = compile_graph(graph)
    threaded = options.threads > 1
    cancel = Halt(options.cancel) if threaded else options.cancel
    state = State([None] * schedule.slots, (options.seed,), camera_of(values), cancel=cancel)
    size = size_of(graph, values)
    state.warm = accept_start(graph, options.start, size)
    attribution = Attribution(graph) if options.attribution else None
    state.emit = emitter(_observers(graph, options, attribution), threaded=threaded)
    started = perf_counter()
    names = _names(schedule)
    state.tell(RunStarted(graph.name, names, _calls(schedule, size, options.stop_after)))
    finished = False
    try:
        with ONE_THREAD, ExitStack() as stack:
            state.pools = [
                stack.enter_context(ThreadPoolExecutor(options.threads, f"visint-{depth}"))
                for depth in range(pools_for(schedule.root) if threaded else 0)
            ]
            execute(schedule, state, values, options.stop_after)
        finished = True
    finally:
        state.tell(RunFinished(graph.name, perf_counter() - started, failed=not finished))
    if options.threads > 1 or graph.loops:  # else the order of time is the order of the nodes
        state.record.in_order(graph.loops, names)
    state.record.stop_after, state.record.start = options.stop_after, options.start
    weights = attribution.weights if attribution else {}
    return _result(schedule, state, values, perf_counter() - started, weights)


def _observers(graph: Graph, options: Options, attribution: Attribution | None) -> list[Observer]:
    """Who listens: the run's own, those that were asked for, and those of plugins."""
    plugins = (seen for plugin in graph.catalog.loaded for seen in plugin.observers())
    return [*([attribution] if attribution else []), *options.observers, *plugins]


@lru_cache(maxsize=32)
def _names(schedule: Schedule) -> tuple[str, ...]:
    return tuple(step.node.name for step in schedule.root.steps())


@lru_cache(maxsize=32)
def _calls(schedule: Schedule, size: tuple[int, int] | None, stop_after: str | None) -> int:
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

    return count(up_to(schedule, stop_after) if stop_after else schedule.root)


def _result(
    schedule: Schedule, state: State, values: Mapping[str, Any], seconds: float, attribution: Weights
) -> Result:
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
        attribution=attribution,
        record=state.record,
        seed=state.seed[0],
        seconds=seconds,
    )

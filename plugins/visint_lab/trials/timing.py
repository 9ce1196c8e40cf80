"""Seconds by part of a system, beside the published ones."""

from __future__ import annotations

from collections.abc import Mapping

import visint
from visint_lab.datasets.pair import Pair
from visint_lab.render.rendering import render
from visint_lab.scenes import scene
from visint_lab.trials.grid import number
from visint_lab.trials.published import TimeTable
from visint_lab.trials.systems import baseline_of, installed, reconstruct

__all__ = ["seconds_by_plugin", "time_rows"]


def seconds_by_plugin(graph: str, seconds: Mapping[str, float]) -> dict[str, float]:
    """Node seconds added up by the plugin that each node's module comes from; ``""`` is all."""
    nodes = visint.load(graph).nodes
    total: dict[str, float] = {"": sum(seconds.values())}
    for name, spent in seconds.items():
        plugin = nodes[name].callee.id.split(".")[0] if name in nodes else "engine"
        total[plugin] = total.get(plugin, 0.0) + spent
    return total


def time_rows(table: TimeTable, size: int) -> tuple[list[str], list[list[str]], list[str]]:
    """(head, rows, notes). Where the table's system is not there, the same stereo alone is timed."""
    system = table.system if installed(table.system) else baseline_of(table.system)
    rendering = render(scene(table.scene, size))
    pair = Pair.of(rendering)
    reconstruct(system, pair, rendering.light)  # compilation is not timed
    found = reconstruct(system, pair, rendering.light)
    spent = seconds_by_plugin(system, found.seconds)
    rows = [[label, number(then), number(spent.get(plugin), 3)] for label, plugin, then in table.rows]
    notes = [*table.notes, f"Ours: {size}×{size}, one thread, wall time of the nodes of each plugin."]
    if system != table.system:
        notes.insert(0, f"{table.system} is not there yet: only {system} was timed.")
    return ["", "published s", f"{system} s"], rows, notes

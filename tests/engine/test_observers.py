"""Observers: events in order, none made for nobody; the profile and its timeline."""

from __future__ import annotations

import json

import pytest

from visint import events
from visint.engine import call, levels, loops, state
from visint.engine.profile import Profile

TEXT = """
inputs: {left: Image}
loops: {levels: {over: pyramid, levels: 2}, turns: {inside: levels, times: 2}}
nodes:
  one: {uses: toy.constant}
  count: {uses: toy.counter, loop: turns, feedback: {value: {from: count.value, start: one.value}}}
  note: {uses: toy.measure, loop: levels, in: {value: count.value}}
  said: {uses: toy.warn, in: {value: note.value}}
outputs: {said: said.value}
"""


def told(event):
    """An event in a few words."""
    name = type(event).__name__
    if isinstance(event, events.RunStarted):
        return name, event.calls
    if isinstance(event, events.RunFinished):
        return name, event.failed
    return name, *event[:3]


def test_come_in_order(stage, image):
    """Start, levels, nodes, turns, measures, ends, warnings, finish: as they happen."""
    stage.run(TEXT, {"left": image})
    wanted = [("RunStarted", 8), ("NodeStarted", "one", 0, 0), ("NodeFinished", "one", 0, 0)]
    for level, size in ((1, (11, 7)), (0, (21, 13))):
        wanted.append(("LevelStarted", "levels", level, size))
        for turn in range(2):
            wanted += [("NodeStarted", "count", level, turn), ("NodeFinished", "count", level, turn)]
            wanted.append(("TurnFinished", "turns", level, turn))
        wanted.append(("LoopEnded", "turns", level, 2))
        wanted += [
            ("NodeStarted", "note", level, 0),
            ("Measured", "note", level, 0),
            ("NodeFinished", "note", level, 0),
        ]
    wanted.append(("LoopEnded", "levels", 0, 2))
    wanted += [("NodeStarted", "said", 0, 0), ("Warned", "said", 0, 0), ("NodeFinished", "said", 0, 0)]
    wanted.append(("RunFinished", False))
    assert [told(event) for event in stage.events] == wanted


def test_calls_announced_are_the_most_there_can_be(stage, image):
    stage.run(TEXT, {"left": image})
    (started,) = stage.of(events.RunStarted)
    assert started.calls == len(stage.calls)
    assert started.nodes == ("one", "count", "note", "said")
    assert started.graph == "staged"


def test_nobody_listening_costs_no_event(stage, image, monkeypatch):
    """Without an observer no event is ever made while nodes, turns and levels go by."""

    def forbidden(*args):
        raise AssertionError("an event for nobody")

    made = {call: ("NodeStarted", "NodeFinished"), loops: ("TurnFinished", "LoopEnded")}
    made |= {levels: ("LevelStarted", "LoopEnded"), state: ("Measured", "Warned")}
    for module, names in made.items():
        for name in names:
            monkeypatch.setattr(module, name, forbidden)
    stage.run(TEXT, {"left": image}, watch=False)


def test_several_observers_hear_the_same(stage, image):
    first, second = [], []
    stage.run(TEXT, {"left": image}, observers=(first.append, second.append))
    assert first == second == stage.events


def test_a_plugins_observer_is_asked_once_a_run(stage, image):
    """An observer that a plugin brings hears the run, too."""
    from visint.hookspecs import hookimpl

    heard = []

    class Listening:
        visint_contract = 1

        @hookimpl
        def visint_modules(self):
            from visint.testing.toys import Constant

            return [Constant]

        @hookimpl
        def visint_observers(self):
            return [heard.append]

    stage._plugins["ears"] = Listening()
    stage.run("nodes: {one: {uses: ears.constant}}\noutputs: {one: one.value}", watch=False)
    assert [type(event).__name__ for event in heard] == [
        "RunStarted",
        "NodeStarted",
        "NodeFinished",
        "RunFinished",
    ]


def test_outputs_are_told_in_a_few_words(stage, image):
    stage.run(
        "inputs: {left: Image}\nnodes: {see: {uses: toy.edges, in: {image: inputs.left}}}\n"
        "outputs: {e: see.boundaries}",
        {"left": image},
    )
    (finished,) = stage.of(events.NodeFinished)
    summary = finished.summary()
    assert summary["boundaries"].startswith("bool (21, 13)")
    assert summary["regions"].startswith("int32 (21, 13) 0..2")


def test_the_maps_fields_are_told_without_deriving_any(stage, image, monkeypatch):
    """A commit's outputs are the stored fields: looking at them computes nothing."""
    from visint.fields import geometry

    monkeypatch.setattr(geometry, "normals_from_depth", lambda *a: pytest.fail("derived for nobody"))
    stage.run(
        "inputs: {left: Image}\nhub: {order: [cue], spokes: {cue: {uses: toy.cue, in: {image: inputs.left}}}}\n"
        "outputs: {depth: map.depth}",
        {"left": image},
    )
    summaries = [event.summary() for event in stage.of(events.NodeFinished) if event.node == "map"]
    assert set(summaries[0]) == {"depth", "boundaries"}


class TestProfile:
    def test_keeps_every_call(self, stage, image):
        profile = Profile()
        stage.run(TEXT, {"left": image}, observers=(profile,))
        assert [(row.node, row.level, row.turn) for row in profile.rows] == stage.calls
        assert all(row.seconds >= 0 for row in profile.rows)
        clocks = [row.clock for row in profile.rows]
        assert clocks == sorted(clocks)

    def test_table(self, stage, image):
        """Calls, total and longest by node and level, the dearest first."""
        profile = Profile()
        text = TEXT.replace("one: {uses: toy.constant}", "one: {uses: toy.sleep, with: {seconds: 0.03}}")
        stage.run(text, {"left": image}, observers=(profile,))
        table = profile.table()
        assert (table[0].node, table[0].level, table[0].calls) == ("one", 0, 1)
        assert table[0].seconds >= 0.03
        assert table[0].longest == table[0].seconds
        by_place = {(line.node, line.level): line.calls for line in table}
        assert by_place == {
            ("one", 0): 1,
            ("count", 1): 2,
            ("count", 0): 2,
            ("note", 1): 1,
            ("note", 0): 1,
            ("said", 0): 1,
        }
        assert [line.seconds for line in table] == sorted((line.seconds for line in table), reverse=True)

    def test_timeline_is_a_chrome_trace(self, stage, image):
        """Complete events ('X') in microseconds from the first call, one lane a thread; JSON as it stands."""
        profile = Profile()
        stage.run(TEXT, {"left": image}, observers=(profile,))
        trace = json.loads(json.dumps(profile.chrome()))
        assert len(trace["traceEvents"]) == len(stage.calls)
        first = trace["traceEvents"][0]
        assert (first["name"], first["ph"], first["ts"], first["pid"], first["tid"]) == ("one", "X", 0, 0, 0)
        assert first["args"] == {"level": 0, "turn": 0}
        assert all(event["dur"] >= 0 for event in trace["traceEvents"])

    def test_threads_have_lanes(self, stage):
        profile = Profile()
        stage.run(
            "nodes:\n  a: {uses: toy.sleep, with: {seconds: 0.03}}\n"
            "  b: {uses: toy.sleep, with: {seconds: 0.03}}\n"
            "outputs: {a: a.value}",
            threads=2,
            observers=(profile,),
        )
        assert {event["tid"] for event in profile.chrome()["traceEvents"]} == {0, 1}

    def test_of_nothing_is_empty(self):
        assert Profile().chrome()["traceEvents"] == []
        assert Profile().table() == []


def test_timings_are_in_the_result(stage, image):
    """Calls and seconds by node and level, without any observer."""
    result = stage.run(TEXT, {"left": image}, watch=False)
    assert [timing[:3] for timing in result.record.timings()] == [
        ("one", 0, 1),
        ("count", 1, 2),
        ("count", 0, 2),
        ("note", 1, 1),
        ("note", 0, 1),
        ("said", 0, 1),
    ]
    assert result.seconds > 0

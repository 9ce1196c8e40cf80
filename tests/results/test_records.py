"""What a run leaves on record."""

from __future__ import annotations

from visint.results import Measure, Record, Stop, Timing, Turn, Warned


def test_timings_add_up_calls_by_node_and_level():
    record = Record()
    for node, level, seconds in (("a", 1, 0.5), ("b", 0, 1.0), ("a", 1, 0.25)):
        total = record.seconds[node, level]
        total[0] += 1
        total[1] += seconds
    assert list(record.timings()) == [Timing("a", 1, 2, 0.75), Timing("b", 0, 1, 1.0)]


def test_order_is_by_loop_and_node_and_time_within():
    """Threads may mix records of nodes that run side by side; sorting keeps the time order of each."""
    record = Record(
        turns=[Turn("inner", 0, 1, 0.1), Turn("outer", 0, 1, 0.5), Turn("inner", 0, 2, 0.01)],
        stops=[Stop("inner", 0, 3, "converged"), Stop("outer", 0, 2, "times")],
        warnings=[Warned("b", 0, 0, "x", "1"), Warned("a", 0, 0, "x", "2"), Warned("b", 0, 1, "x", "3")],
        measures=[Measure("b", 0, 0, "m", 1.0), Measure("a", 0, 0, "m", 2.0)],
    )
    record.in_order(["outer", "inner"], ["a", "b"])
    assert [(turn.loop, turn.turn) for turn in record.turns] == [("outer", 1), ("inner", 1), ("inner", 2)]
    assert [stop.loop for stop in record.stops] == ["outer", "inner"]
    assert [warned.text for warned in record.warnings] == ["2", "1", "3"]
    assert [measure.node for measure in record.measures] == ["a", "b"]


def test_loops_of_sub_graphs_come_behind():
    """A sub-graph's loops are not among the graph's own, yet what they did is kept."""
    record = Record(
        turns=[Turn("theirs", 0, 1, 0.1), Turn("own", 0, 1, 0.5)],
        stops=[Stop("theirs", 0, 3, "times"), Stop("own", 0, 3, "times")],
    )
    record.in_order(["own"], [])
    assert [turn.loop for turn in record.turns] == ["own", "theirs"]
    assert [stop.loop for stop in record.stops] == ["own", "theirs"]


def test_a_result_offers_its_record(met):
    """The toy hub converges at every level, warns once and measures once."""
    assert {stop.reason for stop in met.stops if stop.loop == "sweeps"} == {"converged"}
    assert [warned.node for warned in met.warnings] == ["said"]
    assert met.measures == [Measure("measured", 0, 0, "seen", 1.0)]
    assert all(turn.change > 0 for turn in met.trace)

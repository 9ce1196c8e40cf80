"""Threads: the same bits, the same records, the same failure; no deadlock, and no thread left behind."""

from __future__ import annotations

import os
import signal
import threading
import time
from itertools import pairwise

import numpy as np
import pytest

from visint.errors import Cancelled, ModuleError, UsageError
from visint.events import LoopEnded, NodeFinished
from visint.module import Module, Params, Ports
from visint.schedule import compile_graph
from visint.testing.toys.scalars import MaybeValue, Value

HUB = """
inputs: {left: Image, camera: Camera}
loops: {levels: {over: pyramid, levels: 3}, sweeps: {inside: levels, times: 3}}
nodes:
  noise: {uses: toy.noise, loop: sweeps}
  other: {uses: toy.noise, loop: sweeps, with: {sigma: 2.0}}
  sum: {uses: toy.add, loop: sweeps, in: {a: noise.value, b: other.value}}
  note: {uses: toy.measure, loop: sweeps, in: {value: sum.sum}}
  alarm: {uses: toy.warn, loop: levels, in: {value: note.value}}
hub:
  uses: toy.even
  loop: sweeps
  order: [edges, cue, disparity]
  spokes:
    edges: {uses: toy.boundary_cue, in: {image: inputs.left}}
    cue: {uses: toy.cue, in: {image: inputs.left}}
    disparity: {uses: toy.disparity_cue, in: {image: inputs.left}}
outputs: {depth: map.depth, normals: map.normals, boundaries: map.boundaries, alarm: alarm.value}
"""
WIDE = """
loops: {{turns: {{times: {times}}}}}
nodes:
{nodes}
outputs: {{out: n0.value}}
"""


def wide(count, times=1, seconds=0.05, loop=""):
    """Independent nodes that sleep."""
    line = "  n{}: {{uses: toy.sleep, with: {{seconds: {}}}{}}}"
    return WIDE.format(times=times, nodes="\n".join(line.format(i, seconds, loop) for i in range(count)))


def test_the_same_bits_and_the_same_records(stage, image, camera_for):
    """1, 2 and 4 threads: outputs, confidence, writers, trace, stops, warnings and measures are all equal."""
    given = {"left": 0.5 + image / 2, "camera": camera_for(image)}
    one = stage.run(HUB, given, seed=5)
    calls = sorted(stage.calls)
    for threads in (2, 4):
        for _ in range(2):
            many = stage.run(HUB, given, seed=5, threads=threads)
            assert sorted(stage.calls) == calls
            assert list(many) == list(one)
            for name in one:
                np.testing.assert_array_equal(many[name], one[name])
            assert many.writers == one.writers
            assert (many.trace, many.stops) == (one.trace, one.stops)
            assert (many.warnings, many.measures) == (one.warnings, one.measures)
            timings, wanted = many.record.timings(), one.record.timings()
            assert [timing[:3] for timing in timings] == [timing[:3] for timing in wanted]


class TestOverlap:
    def test_nodes_that_do_not_wait_for_each_other_overlap(self, stage):
        """Four nodes that sleep on four threads: the last has begun before the first has ended."""
        stage.run(wide(4, seconds=0.2), threads=4)
        spans = [(event.clock, event.clock + event.seconds) for event in stage.of(NodeFinished)]
        assert max(begin for begin, _ in spans) < min(end for _, end in spans)

    def test_nodes_that_do_wait_do_not(self, stage):
        stage.run(
            """
nodes:
  a: {uses: toy.sleep, with: {seconds: 0.02}}
  b: {uses: toy.sleep, with: {seconds: 0.02}, in: {value: a.value}}
  c: {uses: toy.sleep, with: {seconds: 0.02}, in: {value: b.value}}
outputs: {c: c.value}
""",
            threads=4,
        )
        spans = [(event.clock, event.clock + event.seconds) for event in stage.of(NodeFinished)]
        assert all(after[0] >= before[1] for before, after in pairwise(spans))
        assert [name for name, _, _ in stage.calls] == ["a", "b", "c"]

    def test_loops_overlap_and_do_not_lock_each_other(self, stage):
        """Three nested loops side by side, wider than the threads there are: they end, and overlap."""
        loops = ", ".join(
            f"a{i}: {{times: 2}}, b{i}: {{inside: a{i}, times: 2}}, c{i}: {{inside: b{i}, times: 2}}"
            for i in range(3)
        )
        nodes = "\n".join(
            f"  n{i}{j}: {{uses: toy.noise, loop: c{i}}}\n"
            f"  s{i}{j}: {{uses: toy.sleep, loop: c{i}, with: {{seconds: 0.002}}, "
            f"in: {{value: n{i}{j}.value}}}}"
            for i in range(3)
            for j in range(3)
        )
        text = f"loops: {{{loops}}}\nnodes:\n{nodes}\noutputs: {{out: s00.value}}\n"
        done = threading.Event()
        thread = threading.Thread(target=lambda: (stage.run(text, threads=2), done.set()), daemon=True)
        thread.start()
        assert done.wait(20), "the loops wait for each other"
        thread.join()
        assert len(stage.calls) == 2 * 3 * 3 * 8
        ends = [i for i, event in enumerate(stage.events) if isinstance(event, LoopEnded)]
        assert len(ends) == 3 * (4 + 2 + 1)

    def test_values_are_let_go_as_soon_as_in_order(self, stage):
        """A chain beside another node: what is read for the last time is let go though the block goes on."""
        from weakref import WeakSet

        alive, most = WeakSet(), []

        class Token(Ports):
            pass

        class Box:
            __slots__ = ("__weakref__",)

        class BoxPorts(Ports):
            box: Box | None = None

        class Link(Module[Params, BoxPorts, BoxPorts]):
            """A new box."""

            name = "link"

            def run(self, inputs, ctx):
                box = Box()
                alive.add(box)
                most.append(len(alive))
                return BoxPorts(box=box)

        stage.modules(own=[Link])
        chain = "\n".join(
            f"  n{i}: {{uses: own.link{f', in: {{box: n{i - 1}.box}}' if i else ''}}}" for i in range(20)
        )
        stage.run(
            f"nodes:\n  aside: {{uses: toy.constant}}\n{chain}\noutputs: {{one: aside.value}}\n",
            threads=2,
            watch=False,
        )
        assert len(most) == 20
        assert max(most) <= 3


class Fails(Module[Params, MaybeValue, Value]):
    """Fails after a while."""

    name = "fails"

    def run(self, inputs, ctx):
        time.sleep(0.05 if inputs.value is None else inputs.value)
        raise RuntimeError("on purpose")


def failing_first(stage, nodes, seconds):
    """A graph of sleeping nodes and of one that fails, with parameters that put it first in order."""
    for shift in range(20):
        sleep = f"{{uses: toy.sleep, with: {{seconds: {seconds * (1 + shift / 1000)}}}}}"
        nodes_now = nodes.replace("{sleep}", sleep)
        graph = stage.graph(f"nodes:\n  bad: {{uses: own.fails}}\n{nodes_now}\noutputs: {{o: bad.value}}\n")
        if next(compile_graph(graph).root.steps()).node.name == "bad":
            return graph
    raise AssertionError("no such graph")


class TestFailure:
    @pytest.mark.parametrize("threads", [1, 2, 4])
    def test_the_first_in_order_is_told_each_time(self, stage, threads):
        """Two nodes fail, the later one sooner: the one told is the one that fails in order."""
        stage.modules(own=[Fails])
        text = """
nodes:
  slow: {uses: toy.constant, with: {value: 0.03}}
  quick: {uses: toy.constant, with: {value: 0.001}}
  a: {uses: own.fails, in: {value: slow.value}}
  b: {uses: own.fails, in: {value: quick.value}}
outputs: {a: a.value, b: b.value}
"""
        said = set()
        for inputs in (
            text,
            text.replace("0.03", "0.001").replace("value: 0.001}}\n  a", "value: 0.03}}\n  a"),
        ):
            with pytest.raises(ModuleError) as caught:
                stage.run(inputs, threads=threads)
            said.add(caught.value.problems[0].where.path.split(",")[0])
            serial = stage.graph(inputs)
            with pytest.raises(ModuleError) as wanted:
                stage.run(serial)
            assert str(caught.value) == str(wanted.value)
        assert len(said) >= 1

    def test_what_has_not_begun_does_not_begin(self, stage):
        """After a failure nothing more is started: fifty sleeps do not have to be slept."""
        stage.modules(own=[Fails])
        graph = failing_first(stage, "\n".join(f"  n{i}: {{sleep}}" for i in range(50)), 0.05)
        with pytest.raises(ModuleError, match="on purpose"):
            stage.run(graph, threads=2)
        assert len(stage.calls) < 25
        assert [thread.name for thread in threading.enumerate() if "visint" in thread.name] == []

    def test_what_runs_beside_it_is_told_to_stop(self, stage):
        """A failure before everything that is still at work ends that, too, at its next check."""
        stage.modules(own=[Fails])
        graph = failing_first(stage, "  beside: {sleep}", 10.0)
        started = time.monotonic()
        with pytest.raises(ModuleError, match="on purpose"):
            stage.run(graph, threads=2)
        assert "bad" in {name for name, _, _ in stage.calls}
        assert time.monotonic() - started < 5

    def test_keyboard_interrupt_ends_everything(self, stage):
        """Ctrl-C in one node: the others stop at their next check, and it comes out as it is."""

        class Presses(Module[Params, MaybeValue, Value]):
            """Ctrl-C."""

            name = "presses"

            def run(self, inputs, ctx):
                time.sleep(0.02)
                raise KeyboardInterrupt

        stage.modules(own=[Presses])
        text = wide(4, seconds=10).replace("nodes:\n", "nodes:\n  key: {uses: own.presses}\n")
        before = threading.active_count()
        started = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            stage.run(text, threads=5)
        assert time.monotonic() - started < 5
        assert threading.active_count() == before

    def test_keyboard_interrupt_while_waiting_ends_everything(self, stage):
        """Ctrl-C reaches the thread that waits for the others: they stop at their next check."""
        before = threading.active_count()
        threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
        started = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            stage.run(wide(4, seconds=10), threads=2)
        assert time.monotonic() - started < 5
        assert threading.active_count() == before
        assert stage.events[-1].failed

    def test_the_callers_flag_is_left_alone(self, stage):
        """A failure stops the rest of the run, and not the next run with the same options."""
        stage.modules(own=[Fails])
        cancel = threading.Event()
        with pytest.raises(ModuleError):
            stage.run(failing_first(stage, "  beside: {sleep}", 1.0), threads=2, cancel=cancel)
        assert not cancel.is_set()


class TestCancelling:
    @pytest.mark.parametrize("threads", [1, 3])
    def test_from_another_thread_stops_within_a_node(self, stage, threads):
        """Set while nodes sleep for 10 s each: they look every few milliseconds, the run ends at once."""
        cancel = threading.Event()
        threading.Timer(0.1, cancel.set).start()
        started = time.monotonic()
        with pytest.raises(Cancelled, match="VI130") as caught:
            stage.run(wide(4, seconds=10), threads=threads, cancel=cancel)
        assert time.monotonic() - started < 3
        assert caught.value.exit_code == 130
        assert stage.events[-1].failed

    def test_before_the_run_nothing_runs(self, stage):
        cancel = threading.Event()
        cancel.set()
        with pytest.raises(Cancelled):
            stage.run(wide(2), cancel=cancel)
        assert stage.calls == []

    def test_between_nodes_of_a_loop(self, stage):
        """Modules that never look are stopped between nodes."""
        cancel = threading.Event()

        def observer(event):
            if isinstance(event, NodeFinished) and event.turn == 4:
                cancel.set()

        text = """
loops: {turns: {times: 1000000}}
nodes: {count: {uses: toy.counter, loop: turns, feedback: {value: {from: count.value}}}}
outputs: {count: count.value}
"""
        with pytest.raises(Cancelled):
            stage.run(text, cancel=cancel, observers=(observer,))
        assert len(stage.calls) == 5

    def test_inside_a_sub_graph(self, stage):
        stage.sub_graph(
            "visint: 1\nname: long\nnodes: {s: {uses: toy.sleep, with: {seconds: 10}}}\noutputs: {y: s.value}\n"
        )
        cancel = threading.Event()
        threading.Timer(0.05, cancel.set).start()
        started = time.monotonic()
        with pytest.raises(Cancelled):
            stage.run('nodes: {call: {uses: "graph:long"}}\noutputs: {y: call.y}', cancel=cancel)
        assert time.monotonic() - started < 3


@pytest.mark.parametrize("threads", [0, -1, 1.5, "2"])
def test_a_wrong_number_of_threads_is_refused(stage, threads):
    with pytest.raises(UsageError, match="VI701"):
        stage.run(wide(1), threads=threads)


def test_events_come_one_at_a_time(stage):
    """An observer is never called from two threads at once, whatever runs side by side."""
    inside, clashes = [], []

    def observer(event):
        if inside:
            clashes.append(event)
        inside.append(1)
        time.sleep(0.0005)
        inside.pop()

    stage.run(wide(8, seconds=0.002), threads=4, observers=(observer,), watch=False)
    assert clashes == []


def test_runs_of_one_graph_side_by_side(stage):
    """One bound graph, four runs in four threads: each has a state of its own."""
    graph = stage.graph("""
inputs: {x: Scalar}
loops: {turns: {times: 50}}
nodes: {sum: {uses: toy.add, loop: turns, in: {a: inputs.x}, feedback: {b: {from: sum.sum, start: 0}}}}
outputs: {sum: sum.sum}
""")
    from visint.engine import run

    sums = {}
    threads = [
        threading.Thread(target=lambda x=x: sums.update({x: run(graph, {"x": float(x)})["sum"]}))
        for x in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sums == {x: 50.0 * x for x in range(4)}


def test_opencv_takes_one_thread_while_a_run_goes_on():
    """Other numbers of threads may give other last bits; afterwards it is as it was."""
    cv2 = pytest.importorskip("cv2")
    from visint.engine.one_thread import ONE_THREAD

    before = cv2.getNumThreads()
    try:
        cv2.setNumThreads(2)
        with ONE_THREAD:
            assert cv2.getNumThreads() == 1
        assert cv2.getNumThreads() == 2
    finally:
        cv2.setNumThreads(before)

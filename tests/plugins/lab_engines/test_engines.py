"""The contest of engines on tiny chains; peers run only where ``make peers`` has been run."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

import visint
from visint.testing import ModuleContract
from visint_lab import bench
from visint_lab.engines import contest, on_python, on_visint, starts, stopwatch, telling
from visint_lab.engines.contest import Heat, Spread
from visint_lab.engines.relay import Relay
from visint_lab.engines.stopwatch import Asked
from visint_lab.peers import available

TINY = Asked(chains=(2, 4, 6), turns=3, size=8, budget=0.01)


def installed():
    try:
        return bool(available())
    except visint.UsageError:
        return False


class TestRelay(ModuleContract):
    """The node of the contest is a module like any other."""

    module = Relay
    instant = True


class TestStopwatch:
    def test_counts_whole_runs_by_nodes_and_turns(self):
        """An engine that sleeps a millisecond a node and two a turn is found to do so."""

        def asleep(milliseconds, image):
            def run():
                time.sleep(milliseconds / 1e3)
                return image

            return run

        asked = Asked(chains=(5,), turns=4, size=4, budget=0.1)
        found = stopwatch.measured(asleep, lambda turns, image: asleep(2 * turns, image), asked)
        assert 1000 <= found["node"]["5"]["least"] <= found["node"]["5"]["median"] < 4000
        assert 2000 <= found["turn"]["least"] < 8000

    def test_three_runs_or_as_many_as_fit_into_the_budget(self):
        """Slow and quick engines are given the same time."""
        assert len(stopwatch.seconds(lambda: time.sleep(0.001), 0.02)) in range(3, 21)
        assert len(stopwatch.seconds(lambda: None, 0.0)) == 3

    def test_an_engine_that_does_nothing_is_no_engine(self):
        """What goes in must come out."""
        with pytest.raises(ValueError, match="did not come out"):
            stopwatch.measured(lambda nodes, image: lambda: image[:1], lambda turns, image: lambda: image, TINY)

    @pytest.mark.parametrize("engine", [on_python, on_visint])
    def test_chain_and_loop_give_the_image(self, engine):
        """Both ends of the contest do what is timed."""
        image = np.random.default_rng(0).random((5, 7), dtype=np.float32)
        np.testing.assert_array_equal(engine.chain(3, image)(), image)
        np.testing.assert_array_equal(engine.loop(3, image)(), image)

    def test_the_loop_goes_round_as_often_as_asked(self):
        """Four calls a turn, and one stop."""
        result = visint.run(on_visint._looped(7), image=np.zeros((4, 4), np.float32))
        assert [timing.calls for timing in result.record.timings()] == [7] * 4
        assert [(stop.turns, stop.reason) for stop in result.stops] == [(7, "times")]

    def test_preparation_is_told_by_part(self):
        """Read, bind and prepare, in milliseconds."""
        spent = on_visint.preparation(np.zeros((4, 4), np.float32), nodes=3, budget=0.01)
        assert set(spent) == {"read", "bind", "prepare"}
        assert 0 < spent["bind"] < spent["read"]


class TestContest:
    def test_ours_and_none_run_in_processes_of_their_own(self):
        """Every length, the loop, and what only this engine tells."""
        ours, bare = contest.heats(TINY, peers=())
        assert (ours.engine, bare.engine) == ("visint", "python")
        assert set(ours.node) == {2, 4, 6}
        assert ours.node[6].least > bare.node[6].least > 0
        assert ours.preparation["bind"] > 0
        assert not bare.preparation

    def test_an_unknown_peer_is_refused_with_the_choices(self):
        """Before anything is started."""
        with pytest.raises(visint.UsageError, match=r"no engine is named 'airflow'(.|\n)*langgraph"):
            contest.run_engine("airflow", TINY)

    def test_a_peer_that_fails_stops_no_other(self, monkeypatch):
        """It stands in the table with its reason; ours must not fail."""

        def broken(engine, asked):
            raise visint.ModuleError.of("VI401", f"{engine} failed: no such package")

        ours = {"visint": lambda *_: Heat("visint")}
        monkeypatch.setattr(contest, "run_engine", lambda name, asked: ours.get(name, broken)(name, asked))
        failures = [heat.failure for heat in contest.heats(TINY, ["dask"])]
        assert failures == ["", "python failed: no such package", "dask failed: no such package"]
        monkeypatch.setattr(contest, "run_engine", broken)
        with pytest.raises(visint.ModuleError, match="visint failed"):
            list(contest.heats(TINY, ["dask"]))

    @pytest.mark.skipif(not installed(), reason="make peers has not been run")
    @pytest.mark.parametrize(
        "peer",
        [pytest.param(peer, marks=[] if peer == "dask" else pytest.mark.slow) for peer in contest.PEERS],
    )
    def test_a_peer_says_what_it_took(self, peer):
        """Each on its own, with its version."""
        heat = contest.run_engine(peer, TINY)
        assert heat.version
        assert heat.turn.least > 0
        assert heat.imported > 0

    def test_a_peers_script_runs_alone(self):
        """``python on_python.py`` with the folder as it is, and no visint in sight."""
        script = contest.FOLDER / "on_python.py"
        words = ["--chains", "2", "--turns", "2", "--size", "4", "--budget", "0.01"]
        surroundings = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
        command = [sys.executable, "-S", str(script), *words]
        surroundings["PYTHONPATH"] = str(Path(np.__file__).parents[1])
        done = subprocess.run(command, capture_output=True, text=True, check=True, env=surroundings)
        assert set(json.loads(done.stdout)) == {"version", "import", "node", "turn"}


class TestTelling:
    HEATS = (
        Heat("visint", "1", {2: Spread(4, 2, 9), 4: Spread(4, 3, 9)}, Spread(20, 16, 9), 300, {"bind": 4.0}),
        Heat("slow", "2", {2: Spread(40, 9, 9), 4: Spread(500, 450, 9)}, Spread(90, 80, 9), 600),
        Heat("gone", failure="gone failed: no such package"),
    )

    def test_ratios_are_of_the_least_to_ours(self):
        """At the middle length; growth from the first length to the last."""
        ours, slow, gone = telling.rows(self.HEATS, (2, 4))
        assert ours == ["visint 1", "4.0 (2.0)", "4.0 (3.0)", "20.0 (16.0)", "1.00", "1.00", "1.50", "300"]
        assert slow[2:] == ["500 (450)", "90.0 (80.0)", "150.00", "5.00", "50.00", "600"]
        assert gone == ["gone", *["–"] * 7]
        assert len(telling.head((2, 4))) == len(ours)

    def test_the_missing_are_named(self):
        """With their reason."""
        assert "gone: gone failed: no such package" in telling.notes(self.HEATS, (2, 4), 8)


class TestVerb:
    def called(self, *words):
        app = typer.Typer()
        app.command()(bench.command)
        return CliRunner().invoke(app, list(words))

    def test_engine_prints_a_row_an_engine(self, monkeypatch, tmp_path):
        """And writes the table where told."""
        monkeypatch.setattr("visint_lab.engines.bench.Asked", lambda: TINY)
        done = self.called("engine", "--peer", "none", "--out", str(tmp_path / "out"))
        assert done.exit_code == 0, done.output
        lines = done.stdout.splitlines()
        assert lines[2].startswith("visint ")
        assert lines[3].startswith("python ")
        assert (tmp_path / "out" / "engines.csv").read_text().count("\n") == 3

    def test_start_prints_visint_beside_what_it_puts_off(self, monkeypatch):
        """``import visint`` is quicker than ``import numpy, pydantic``: it imports neither."""
        few = {name: starts.STARTS[name] for name in ("import numpy, pydantic", "import visint")}
        monkeypatch.setattr(starts, "STARTS", few)
        found = starts.starts(repeats=2)
        assert found["import visint"].least < found["import numpy, pydantic"].least
        monkeypatch.setattr("visint_lab.engines.bench.starts", lambda: found)
        assert "import visint" in self.called("start").stdout

    def test_a_start_that_fails_is_told(self, monkeypatch):
        """With its last line."""
        monkeypatch.setattr(starts, "STARTS", {"broken": ("-c", "raise SystemExit('no luck')")})
        with pytest.raises(visint.ModuleError, match="broken failed: no luck"):
            starts.starts(repeats=1)

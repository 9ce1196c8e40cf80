"""While a run goes on: Ctrl-C once and twice, and the bar that a terminal gets after a second."""

from __future__ import annotations

import os
import pty
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from visint.cli.progress import progress
from visint.testing import installed

SLOW = """visint: 1
name: slow
inputs: {a: Scalar}
nodes: {nap: {uses: toy.sleep, in: {value: inputs.a}}}
outputs: {n: nap.value}
"""
NAPS = '''"""A module that sleeps, and hears or does not hear that it shall end."""
import time
from visint.hookspecs import hookimpl
from visint.module import Module, Params, Ports

class Ins(Ports):
    value: float

class Outs(Ports):
    value: float

class Nap(Module[Params, Ins, Outs]):
    """Sleeps."""
    name = "sleep"
    def run(self, inputs, ctx):
        print("asleep", flush=True)
        end = time.monotonic() + 30
        while time.monotonic() < end:
            time.sleep(0.01)
            {check}
        return Outs(value=1)

@hookimpl
def visint_modules():
    return [Nap]
'''
PATIENCE = 20


def environment(folder):
    return {**os.environ, "PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1", "TERM": "xterm"}


def call(seconds=None):
    settings = [] if seconds is None else ["--set", f"nap.seconds={seconds}"]
    return [sys.executable, "-m", "visint", "run", "slow.yaml", "--in", "a=1", "--out", "out", *settings]


@pytest.fixture
def slow(tmp_path):
    (tmp_path / "slow.yaml").write_text(SLOW)
    return tmp_path


class TestInterrupted:
    """130, and nothing half-written."""

    @pytest.fixture
    def asleep(self, slow, request):
        """A process whose only node has begun to sleep."""
        files = {"naps.py": NAPS.replace("{check}", request.param)}
        with (
            installed("naps", plugins={"toy": "naps"}, files=files) as folder,
            subprocess.Popen(
                [*call(), "--trace", "t.json"],
                cwd=slow,
                env=environment(folder),
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
            ) as running,
        ):
            assert running.stdout.readline() == "asleep\n"
            yield running
            running.kill()

    @pytest.mark.parametrize("asleep", ["ctx.check()"], indirect=True)
    @pytest.mark.parametrize("which", [signal.SIGINT, signal.SIGTERM])
    def test_once(self, slow, asleep, which):
        """The node at work is asked to end; it does, and no folder is made."""
        asleep.send_signal(which)
        out, err = asleep.communicate(timeout=PATIENCE)
        assert asleep.returncode == 130
        assert out == ""
        assert "interrupted" in err
        assert "Traceback" not in err
        assert [entry.name for entry in slow.iterdir()] == ["slow.yaml"]

    @pytest.mark.parametrize("asleep", [""], indirect=True)
    def test_twice_ends_at_once(self, slow, asleep):
        """A module that hears nothing: the second Ctrl-C ends the process under it."""
        asleep.send_signal(signal.SIGINT)
        assert "once more ends at once" in asleep.stderr.readline()
        began = time.monotonic()
        asleep.send_signal(signal.SIGINT)
        asleep.communicate(timeout=PATIENCE)
        assert asleep.returncode == 130
        assert time.monotonic() - began < 5
        assert [entry.name for entry in slow.iterdir()] == ["slow.yaml"]

    def test_while_files_are_written(self, visint, pair, tmp_path, files, monkeypatch):
        """Ctrl-C amid the files: none of them is left."""
        write = os.fsync

        def interrupted(handle):
            if os.fstat(handle).st_size > 20_000:
                signal.raise_signal(signal.SIGTERM)
            write(handle)

        monkeypatch.setattr("os.fsync", interrupted)
        done = visint("run", "stereo_sgm", *pair.all, "--out", "out")
        assert (done.code, done.out) == (130, "")
        assert "interrupted" in done.err
        assert not list(tmp_path.iterdir())


def test_the_program_may_be_called_from_a_thread(visint, pair, tmp_path):
    """Where signals cannot be listened to: it runs all the same."""
    with ThreadPoolExecutor(1) as pool:
        done = pool.submit(visint, "run", "stereo_sgm", *pair.all, "--out", "out").result(PATIENCE)
    assert (done.code, done.err) == (0, "")


def on_terminal(arguments, folder, **options):
    """What a terminal shows of a call."""
    main, side = pty.openpty()
    running = subprocess.Popen(arguments, stderr=side, stdout=subprocess.DEVNULL, cwd=folder, **options)
    os.close(side)
    shown = b""
    while True:
        try:
            part = os.read(main, 4096)
        except OSError:
            break
        if not part:
            break
        shown += part
    os.close(main)
    assert running.wait(PATIENCE) == 0
    return shown.decode()


class TestBar:
    """Only where somebody waits and looks."""

    def test_one_slow_node_gets_a_bar(self, slow, toys):
        """It shows while the node is at work, names it, and is wiped away after."""
        shown = on_terminal(call(1.6), slow, env=environment(toys))
        assert "nap (level 0)" in shown
        assert shown.rstrip().endswith("\x1b[2K") or shown.rstrip().endswith("\x1b[?25h")

    def test_a_quick_run_gets_none(self, slow, toys):
        assert "nap" not in on_terminal(call(0), slow, env=environment(toys))

    @pytest.mark.parametrize(("quiet", "terminal"), [(True, True), (False, False), (True, False)])
    def test_quiet_and_pipes_get_none(self, monkeypatch, quiet, terminal):
        monkeypatch.setattr("sys.stderr.isatty", lambda: terminal)
        with progress(quiet=quiet) as shown:
            assert shown is None

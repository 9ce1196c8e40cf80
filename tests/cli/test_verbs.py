"""The program itself: help, versions, verbs of plugins, and what the other end of a pipe does."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib.metadata import entry_points

import pytest

import visint as package
from visint.testing import installed

HELLO = '''"""A verb of a stranger."""
from typing import Annotated
import typer

EXAMPLES = "Example: visint hello --loud"


def command(loud: Annotated[bool, typer.Option("--loud")] = False) -> None:
    """Say hello. And no more."""
    print("HELLO" if loud else "hello")
'''
OWN = ["run", "check", "show", "modules", "schema"]


def hello(**options):
    given = {"groups": {"visint.commands": {"hello": "hello_verb:command"}}, "files": {"hello_verb.py": HELLO}}
    return installed("hello-visint", **{**given, **options})


def test_version(visint):
    assert visint("--version") == (0, f"{package.__version__}\n", "")


@pytest.mark.parametrize("flag", ["--help", "-h"])
def test_help_lists_every_verb(visint, flag):
    """In whole sentences: no line is cut with dots."""
    done = visint(flag)
    assert (done.code, done.err) == (0, "")
    assert all(f"\n  {verb} " in done.out for verb in [*OWN, "demo"])
    assert "..." not in done.out.partition("Commands:")[2]


@pytest.mark.parametrize("verb", OWN)
def test_help_of_a_verb_has_an_example(visint, verb):
    done = visint(verb, "--help")
    assert done.code == 0
    assert f"visint {verb}" in " ".join(done.out.partition("Example")[2].split())


def test_every_installed_verb_has_help(visint):
    for entry in entry_points(group="visint.commands"):
        assert visint(entry.name, "--help").code == 0


def test_no_verb_is_a_mistake_that_shows_the_help(visint):
    done = visint()
    assert done.code == 2
    assert "Commands:" in done.out + done.err


@pytest.mark.parametrize(("typed", "meant"), [("rnu", "run"), ("chekc", "check"), ("dmo", "demo")])
def test_near_misses(refused, typed, meant):
    """A plugin's verb is meant as often as one of our own."""
    assert f"Write: visint {meant} " in refused(2, typed)


def test_unknown_option_of_the_program(refused):
    assert "--verson" in refused(2, "--verson")


class TestPlugins:
    """Verbs of strangers."""

    def test_one_is_listed_and_called(self, visint):
        with hello():
            assert "Say hello. And no more" in visint("--help").out
            assert visint("hello", "--loud") == (0, "HELLO\n", "")
            assert "visint hello --loud" in visint("hello", "-h").out
            assert visint("hello", "--quiet").code == 2

    @pytest.mark.parametrize(
        "text", ["def command(:", "import nothing_at_all", "raise SystemExit(0)", "x = 1", "\0"]
    )
    def test_a_broken_one_is_listed_and_fails_by_name(self, visint, text):
        """``--help`` and other verbs do not care; the call names the distribution."""
        with hello(files={"hello_verb.py": text}):
            assert "\n  hello " in visint("--help").out
            assert visint("schema").code == 0
            done = visint("hello")
        assert (done.code, done.out) == (4, "")
        assert "hello-visint 1.0" in done.err
        assert "Traceback" not in done.err

    def test_two_of_a_name(self, visint):
        with hello(), installed("other", groups={"visint.commands": {"hello": "hello_verb:command"}}):
            assert "\n  hello " in visint("--help").out
            done = visint("hello")
        assert done.code == 4
        assert all(name in done.err for name in ("hello-visint", "other"))

    def test_our_own_cannot_be_taken(self, visint):
        with hello(groups={"visint.commands": {"schema": "hello_verb:command"}}):
            assert visint("schema").json["$schema"]


def test_demo(visint, tmp_path):
    """One line on stdout: where the report is."""
    done = visint("demo", "--size", 64, "--out", "scene")
    assert done.code == 0
    assert done.out == f"{(tmp_path / 'scene' / 'report.html').resolve()}\n"
    assert "against the truth" in done.err
    assert (tmp_path / "scene/depth.pfm").exists()
    assert visint("run", "scene/run.json", "--out", "again").code == 0
    same = ("depth.pfm", "normals.npz", "points.ply", "run.json")
    assert all((tmp_path / "again" / f).read_bytes() == (tmp_path / "scene" / f).read_bytes() for f in same)


def test_demo_refuses_its_folder_before_the_work(refused, tmp_path, monkeypatch):
    """Nothing is rendered for a folder that holds something else."""
    (tmp_path / "scene").mkdir()
    (tmp_path / "scene" / "mine.txt").write_text("mine")
    monkeypatch.setattr("visint_lab.render.rendering.render", None)
    assert "VI602" in refused(5, "demo", "--size", 64, "--out", "scene")


class TestSchema:
    """The JSON schema of graph files."""

    def test_accepts_keys_of_a_graph(self, visint):
        schema = visint("schema").json
        assert {"visint", "name", "inputs", "nodes", "loops", "hub", "outputs"} <= set(schema["properties"])
        assert "stereo.sgm" not in json.dumps(schema)

    def test_installed_spells_out_modules(self, visint):
        text = visint("schema", "--installed").out
        assert "stereo.sgm" in text
        assert "max_disparity" in text
        json.loads(text)


class TestProcess:
    """What only a process of its own can show."""

    def test_python_m_visint(self, process):
        done = process("-m", "visint", "--version")
        assert (done.returncode, done.stdout, done.stderr) == (0, f"{package.__version__}\n", "")

    def test_head_does_not_break_it(self):
        """The reader goes away while much is still to be written: no traceback, no complaint."""
        call = [sys.executable, "-m", "visint", "schema", "--installed"]
        with subprocess.Popen(call, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
            running.stdout.close()
            assert running.wait(30) == 0
            assert running.stderr.read() == ""

    def test_ascii_terminal_and_no_color(self, process):
        """Signs that the terminal lacks are replaced; NO_COLOR or not, a pipe gets no escape codes."""
        done = process("-m", "visint", "modules", "stereo", env={"PYTHONIOENCODING": "ascii", "NO_COLOR": "1"})
        assert done.returncode == 0, done
        assert "stereo.residual" in done.stdout
        assert "\x1b" not in done.stdout + done.stderr

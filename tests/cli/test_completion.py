"""What the shell offers after TAB, and that every verb shows examples that can be pasted."""

from __future__ import annotations

from importlib.metadata import entry_points

import pytest

from visint.cli import complete
from visint.cli.main import main

OWN = ["run", "check", "show", "modules", "schema"]


@pytest.fixture
def offered(process):
    """What the program tells bash, for the words typed so far."""

    def call(*words: str) -> list[str]:
        typed = {"COMP_WORDS": " ".join(words), "COMP_CWORD": str(len(words) - 1)}
        return process("-m", "visint", env={"_VISINT_COMPLETE": "complete_bash", **typed}).stdout.split()

    return call


def test_the_shell_is_offered_verbs_options_and_graphs(offered):
    """Through the door that the installed completion uses."""
    assert offered("visint", "ru") == ["run"]
    assert offered("visint", "run", "--ga") == ["--gamma"]
    assert "stereo_sgm" in offered("visint", "check", "stereo_")


def test_graphs_are_names_files_and_folders(tmp_path, monkeypatch):
    """Of files, graph files and run records; folders end in a slash."""
    monkeypatch.chdir(tmp_path)
    for name in ("mine.yaml", "notes.txt", "out/run.json", "out/depth.pfm", "moved/x.yaml"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("")
    assert complete.graphs("m") == ["mine.yaml", "moved/"]
    assert complete.graphs("out/") == ["out/run.json"]
    assert complete.graphs("./m") == ["./mine.yaml", "./moved/"]
    assert complete.graphs(f"{tmp_path}/mi") == [f"{tmp_path}/mine.yaml"]
    assert complete.graphs("no/such/") == []
    assert "stereo_sgm" in complete.graphs("stereo")


def test_modules_are_plugins_then_ids():
    """A plugin is loaded once it is spelled out."""
    assert "stereo" in complete.modules("st")
    assert "stereo.sgm" in complete.modules("stereo.s")
    assert complete.modules("nope.x") == []


TABLES = {entry.name for entry in entry_points(group="visint.commands")} - {"tune"}
"""Verbs that print a table; what tune learns is ``learned.json`` in its folder."""


@pytest.mark.parametrize("verb", sorted(TABLES))
def test_verbs_of_the_lab_speak_json(capsys, verb):
    """As our own do; the schema is JSON as it is."""
    assert main([verb, "--help"]) == 0
    assert "--json" in capsys.readouterr().out


def test_demo_as_json(visint):
    """One object on stdout, nothing beside it."""
    told = visint("demo", "--size", 64, "--out", "scene", "--json").json
    assert told["out"] == "scene"
    assert "median depth error" in told["against_the_truth"]


def test_a_table_as_json():
    """Figures are numbers, a dash is nothing, what names a row has a name."""
    from json import loads

    from visint_lab.trials.grid import as_json

    told = loads(as_json({"scores": (["", "bad2 %"], [["sgm", "4.5"], ["x", "–"]])}, ["a note"]))
    assert told == {
        "scores": [{"name": "sgm", "bad2 %": 4.5}, {"name": "x", "bad2 %": None}],
        "notes": ["a note"],
    }


@pytest.mark.parametrize("verb", [*OWN, *sorted(entry.name for entry in entry_points(group="visint.commands"))])
def test_every_verb_shows_examples_on_lines_of_their_own(capsys, verb):
    """Each begins with the program's name and is not broken across lines."""
    assert main([verb, "--help"]) == 0
    said = capsys.readouterr().out
    examples = said.partition("\n  Example")[2].splitlines()[1:]
    assert examples, said
    assert all(line.startswith("    visint ") for line in examples if line.strip())

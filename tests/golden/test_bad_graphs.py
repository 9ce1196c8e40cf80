"""Faulty graph files and what is said about them, word for word.

A case is ``bad_graphs/NNN_what.yaml`` with ``NNN_what.txt`` beside it. A first line ``# load: NAME`` loads an
installed graph instead; ``# alter: without NAME`` (or ``set KEY=VALUE``, ``control NAME``) makes a variant of
the graph. After a change that is meant, ``VISINT_REGENERATE=1 pytest tests/golden`` writes the texts anew;
read the difference as the person who made the mistake.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

import numpy as np
import pytest

import visint.testing.plugin
from visint import hookimpl
from visint.errors import CODES, Problem, VisintError
from visint.fields import ReliefEvidence
from visint.graph import alter, load
from visint.module import Context, Module, Params, Ports
from visint.registry import Catalog
from visint.testing.toys.images import ImagePorts

HERE = Path(__file__).parent
BAD = HERE / "bad_graphs"
CASES = sorted(path.stem for path in BAD.glob("*.yaml"))


class TiltOutputs(Ports):
    """Depth up to scale and tilt."""

    evidence: ReliefEvidence


class Tilt(Module[Params, ImagePorts, TiltOutputs]):
    """Evidence on depth that is no depth: it cannot enter the map as it is."""

    name = "tilt"

    def run(self, inputs: ImagePorts, ctx: Context) -> TiltOutputs:
        return TiltOutputs(evidence=ReliefEvidence.of(np.zeros_like(inputs.image), 1.0, 1.0))


class Shape:
    """A plugin with one cue."""

    @hookimpl
    def visint_modules(self) -> list[type[Module]]:
        return [Tilt]


@pytest.fixture(scope="module")
def catalog() -> Catalog:
    graphs = {path.stem: Path("..") / "graphs" / path.name for path in sorted((HERE / "graphs").glob("*.yaml"))}
    return Catalog({"toy": visint.testing.plugin, "shape": Shape()}, graphs)


def problems(case: str, catalog: Catalog) -> tuple[Problem, ...]:
    """What is wrong with a case, met in its own folder so that messages name the file alone."""
    first = (BAD / f"{case}.yaml").read_bytes().partition(b"\n")[0].decode("utf-8", "replace")
    loads, alters = re.match(r"# load: (.*)", first), re.match(r"# alter: (\w+) (.*)", first)
    with pytest.raises(VisintError) as caught:
        _meet(Path(f"{case}.yaml"), loads and loads[1], alters and alters.groups(), catalog)
    return caught.value.problems


def _meet(path: Path, name: str | None, change: tuple[str, str] | None, catalog: Catalog) -> None:
    graph = load(name or path, catalog)
    what, value = change or ("", "")
    if what == "set":
        key, _, new = value.partition("=")
        alter(graph, settings={key: new})
    elif what == "without":
        alter(graph, without=[value])
    elif what:
        alter(graph, control=value)


@pytest.fixture(scope="module")
def told(catalog: Catalog) -> dict[str, tuple[Problem, ...]]:
    before = Path.cwd()
    os.chdir(BAD)
    try:
        return {case: problems(case, catalog) for case in CASES}
    finally:
        os.chdir(before)


@pytest.mark.parametrize("case", CASES)
def test_what_is_said(case, told):
    """Each faulty graph is told of exactly as its golden text has it."""
    text = "\n".join(map(str, told[case])) + "\n"
    golden = BAD / f"{case}.txt"
    if os.environ.get("VISINT_REGENERATE"):
        golden.write_text(text, encoding="utf-8")
    assert text == golden.read_text(encoding="utf-8")


def test_every_code_of_graphs_has_a_case(told):
    """The cases meet every code of reading and of binding."""
    met = {problem.code for each in told.values() for problem in each}
    assert {code for code in CODES if code.startswith(("VI1", "VI2")) and code != "VI130"} <= met


def test_there_is_no_text_without_a_case():
    """A renamed case takes its text along."""
    assert sorted(path.stem for path in BAD.glob("*.txt")) == CASES


def test_there_are_enough_cases():
    """A hundred and more, no two alike."""
    assert len({(BAD / f"{case}.yaml").read_bytes() for case in CASES}) == len(CASES) >= 100


def test_every_problem_of_a_file_has_a_place(told):
    """File, line and column lead every problem of a file; variants made by hand have only names."""
    files = [
        case for case in CASES if not (BAD / f"{case}.yaml").read_bytes().startswith((b"# load", b"# alter"))
    ]
    lost = [str(problem) for case in files for problem in told[case] if not problem.where.line]
    assert not lost


def test_nearly_every_problem_says_what_to_write(told):
    """At least 95 of 100 problems end with a line to paste."""
    everything = [problem for each in told.values() for problem in each]
    assert sum(bool(problem.write) for problem in everything) >= 0.95 * len(everything)


def test_messages_stay_short_and_printable(told):
    """No message is longer than a few lines of a terminal, and none can play tricks on it."""
    for each in told.values():
        for problem in each:
            assert len(str(problem)) < 1500
            assert str(problem).replace("\n", "").isprintable()

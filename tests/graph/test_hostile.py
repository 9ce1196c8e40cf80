"""Hostile graph files: each is refused in milliseconds, with its place, and touches nothing outside."""

from __future__ import annotations

# ruff: noqa: E501 - lists of payloads
import string
import sys
import time
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import pytest

import visint.testing.plugin
from visint.errors import GraphError, PluginError
from visint.graph import parse_graph
from visint.graph.load import load
from visint.registry import Catalog

CATALOG = Catalog({"toy": visint.testing.plugin}, {})
GOOD = "visint: 1\nname: good\nnodes: {one: {uses: toy.constant}}\noutputs: {value: one.value}\n"
LETTERS = string.ascii_lowercase

YAML = {
    "billion laughs": "a: &a [lol]\n" + "".join(f"{b}: &{b} [{f'*{a}, ' * 9}]\n" for a, b in pairwise(LETTERS)),
    "aliases in a ring": "a: &a {b: *a}",
    "deep lists": "[" * 100_000,
    "deep mappings": "{a: " * 50_000,
    "deep lists with values": "[1, " * 30_000,
    "deep lines": "".join(" " * i + "a:\n" for i in range(700)),
    "deep dashes": "- " * 100_000,
    "deep questions": "? " * 100_000,
    "closed depth": "a: " + "[" * 5_000 + "]" * 5_000,
    "depth in quotes": "a: '" + "[" * 5_000,
    "a huge word": "a: " + "x" * 200_000,
    "a huge quoted word": 'a: "' + "x" * 200_000 + '"',
    "a huge quoted text": 'a: "' + "x " * 100_000 + '"',
    "a huge block": "a: |\n" + "  x\n" * 60_000,
    "a huge folded text": "a: >\n" + "  x\n\n" * 40_000,
    "a huge plain text": "a: x\n" + " x\n" * 60_000,
    "a huge key": "x" * 200_000 + ": 1",
    "a long key": "x y" * 300 + ": 1",
    "a huge number": "a: " + "9" * 100_000,
    "a huge exponent": "a: 1e" + "9" * 900,
    "a huge tag": "!" * 200_000 + " a",
    "a huge anchor": "&" + "a" * 200_000 + " b",
    "a huge alias": "*" + "a" * 200_000,
    "a huge directive": "%" + "a" * 200_000,
    "a huge version": "%YAML 1." + "1" * 900 + "\n---\na: 1\n",
    "a huge gap": "a:" + " " * 200_000 + "1",
    "a huge comment": "#" * 200_000,
    "many comments": "# x\n" * 60_000,
    "many blank lines": "\n" * 250_000,
    "many keys": "".join(f"k{i}: 1\n" for i in range(20_001)),
    "many values": "a: [" + "1," * 100_000 + "]",
    "many empty values": "a: [" + "," * 100_000 + "]",
    "many documents": "---\n" * 60_000,
    "many ends": "...\n" * 60_000,
    "many colons": ":" * 200_000,
    "many quotes": "'" * 200_000,
    "many escapes": 'a: "' + "\\U0001F600" * 20_000 + '"',
    "many anchors": "".join(f"k{i}: &a{i} 1\n" for i in range(9_000)),
    "one megabyte": "a: 1\n" * 250_000,
    "a python object": GOOD + "about: !!python/object/apply:os.system ['touch /tmp/owned']\n",
    "a python name": "!!python/name:os.system a",
    "a python module": "a: !!python/module:os b",
    "a tag of our own": "%TAG ! tag:visint.example,2000:\n---\n!graph {visint: 1}\n",
    "a tag directive": "%TAG !! tag:yaml.org,2002:python/\n---\na: !!object:os 1\n",
    "a binary": "a: !!binary aGVsbG8=",
    "a set": "!!set {a, b}",
    "a merge": "<<: {visint: 1}",
    "merged lists": "<<: [{visint: 1}, {name: a}]",
    "an escape beyond all": 'a: "\\UFFFFFFFF"',
    "half an escape": 'a: "\\ud800"',
    "a lone surrogate": "a: \ud800",
    "a nul": "a: \0",
    "an escaped nul as key": '"\\0": 1',
    "a bell": "a: \x07",
    "a terminal trick": 'visint: 1\n"\\e[31mname": 1\n',
    "a mark in the middle": "a: 1\n\ufeffb: 2\n",
    "a no-break space": "a:\xa01",
    "a next line": "a: 1\x85b: 2",
    "a line separator": "a: 1\u2028b: 2",
    "right to left": "visint: 1\nname: \u202eabc\nnodes: {}\noutputs: {a: b.c}\n",
    "tabs": "\t" * 2_000,
    "block of no sense": "a: |9999999\n x",
    "a percent": "%",
    "dashes": "---",
    "an only colon": ":",
    "an only brace": "{",
    "an only question": "?",
    "a key of a list": "? [a]\n: 1",
    "a key of nothing": ": 1",
    "true and one": "{1: a, true: b}",
    "a dunder": "visint: 1\n__class__: a\nname: a\nnodes: {}\noutputs: {a: b.c}\n",
}  # fmt: skip


def refusal(text: str) -> GraphError | PluginError:
    started = time.process_time()
    with pytest.raises((GraphError, PluginError)) as caught:
        parse_graph(text, CATALOG, file="g.yaml")
    assert time.process_time() - started < 0.25
    return caught.value


@pytest.mark.parametrize("name", YAML)
def test_hostile_yaml_is_refused_with_its_place(name, watch):
    """No traceback, no waiting, nothing imported or opened: file, line and column, and it fits a terminal."""
    with watch:
        text = str(refusal(YAML[name]))
    assert not watch.seen
    assert text[5:].startswith(" g.yaml:")
    assert len(text) < 2_000
    assert text.replace("\n", "").isprintable()


def test_the_payloads_take_milliseconds(tmp_path, monkeypatch):
    """None takes 50 ms where the machine is quiet: the best of three, for texts, names and paths."""
    monkeypatch.chdir(tmp_path)
    slow = {}
    for name, text in YAML.items():
        best = min(_seconds(text) for _ in range(3))
        if best > 0.05:
            slow[name] = round(best, 3)
    for name in NAMES:
        slow |= _if_slow(
            name, lambda name=name: parse_graph(GOOD.replace("toy.constant", _quoted(name)), CATALOG)
        )
    for path in PATHS:
        slow |= _if_slow(path, lambda path=path: load(path, CATALOG))
    assert not slow


def _seconds(text: str) -> float:
    return _spent(lambda: parse_graph(text, CATALOG))


def _if_slow(name: str, act: Callable[[], object]) -> dict[str, float]:
    best = min(_spent(act) for _ in range(3))
    return {name[:40]: round(best, 3)} if best > 0.05 else {}


def _spent(act: Callable[[], object]) -> float:
    started = time.process_time()
    with pytest.raises((GraphError, PluginError)):
        act()
    return time.process_time() - started


def test_there_are_enough_payloads():
    """40 texts, 60 names, 50 paths."""
    assert len(YAML) >= 40
    assert len(NAMES) >= 60
    assert len(PATHS) >= 50


NAMES = [
    "os.system", "os.path.join", "builtins.eval", "sys.exit", "subprocess.run", "visint.testing.toys",
    "..toy.constant", "toy..constant", "toy.", ".constant", ".", "..", "", " ", "toy constant", "toy.constant ",
    " toy.constant", "toy.constant\n", "toy.constant\0", "Toy.Constant", "toy.Constant", "toy.__class__",
    "toy.__init__", "__import__.os", "toy.constant.run", "toy/constant", "toy\\constant", "../toy.constant",
    "/etc/passwd", "file:///etc/passwd", "http://example.org/a", "toy:constant", "toy.constant:run",
    "graph:", "graph:..", "graph:../good", "graph:/etc/passwd", "graph:good.yaml", "graph:\0", "graph:graph:good",
    "graph:~/x", "graph:$HOME", "graph:*", "GRAPH:good", "map.begin.x", "map.other", "map.", "map",
    "tоy.constant", "toy.ｃonstant", "toy.cons\u200btant", "toy.\u202econstant", "${toy.constant}", "{{toy}}",
    "%(toy)s", "$(id).x", "`id`.x", "a" * 90 + ".b", "toy." + "b" * 90, "t o y " * 15, "toy.con\x1b[31mstant", "pip.main",
    "visint_stereo.sgm", "stereo.sgm", "importlib.import_module", "toy.constant,toy.constant", "null.null",
]  # fmt: skip


class Watch:
    """Imports, opened files and started processes, as the interpreter tells them."""

    def __init__(self) -> None:
        self.on = False
        self.seen: list[str] = []
        sys.addaudithook(self._hook)

    def _hook(self, event: str, args: tuple[object, ...]) -> None:
        if self.on and event in ("open", "import", "exec", "os.system", "subprocess.Popen", "socket.connect"):
            self.seen.append(f"{event} {args[0]!r}"[:200])

    def __enter__(self) -> Watch:
        self.on, self.seen = True, []
        return self

    def __exit__(self, *_: object) -> None:
        self.on = False


@pytest.fixture(scope="module", autouse=True)
def watch() -> Watch:
    parse_graph(GOOD, CATALOG)
    with pytest.raises(GraphError):
        parse_graph(YAML["an escape beyond all"], CATALOG)
    for text in (GOOD.replace("toy.constant", "no.such"), GOOD.replace("toy.constant", "graph:no")):
        with pytest.raises(GraphError):  # what is imported lazily is imported by now
            parse_graph(text, CATALOG)
    with pytest.raises(GraphError):
        load(__file__, CATALOG)
    return Watch()


@pytest.mark.parametrize("name", NAMES)
def test_a_name_is_looked_up_and_never_imported_or_opened(name, watch):
    """Whatever stands where a module's name should, nothing is imported, opened or started for it."""
    text = GOOD.replace("toy.constant", _quoted(name))
    started = time.process_time()
    with watch, pytest.raises(GraphError) as caught:
        parse_graph(text, CATALOG, file="g.yaml")
    assert time.process_time() - started < 0.25
    assert not watch.seen
    assert "VI201 g.yaml:3:21 nodes.one.uses" in str(caught.value)
    assert str(caught.value).replace("\n", "").isprintable()
    assert len(str(caught.value)) < 2_000


def _quoted(text: str) -> str:
    return '"' + "".join(f"\\U{ord(letter):08x}" for letter in text) + '"'


PATHS = [
    "../../etc/passwd", "/etc/passwd", "/etc/shadow", "/dev/zero", "/dev/stdin", "/proc/self/mem", "/proc/self/environ",
    "..", ".", "/", "~", "~/.ssh/id_rsa", "~root/x", "a/../../b", "a\0b", "\0", "", " ", "\n", "a\nb", "CON", "nul.yaml",
    "file:///etc/passwd", "http://localhost:1/x.yaml", "ftp://x/y", "//host/share", "\\\\host\\share", "C:\\x.yaml",
    "a" * 300, "a/" * 3000, "%2e%2e/x", "${HOME}/x", "$(id)", "`id`", "|id", ";id", "-rf", "--help", "*", "?.yaml", "[a].yaml",
    "\ud800.yaml", "\udcff.yaml", "\u202eyaml", "good", "Good", "gооd", "graph:good", "good.yaml.exe", "x" * 64,
]  # fmt: skip


@pytest.mark.parametrize("path", PATHS, ids=range(len(PATHS)))
def test_a_path_opens_that_file_or_nothing(path, watch, tmp_path, monkeypatch):
    """What is asked for as a graph opens at most the very file that was named, and says what is wrong."""
    monkeypatch.chdir(tmp_path)
    started = time.process_time()
    with watch, pytest.raises(GraphError) as caught:
        load(path, CATALOG)
    assert time.process_time() - started < 0.25
    assert [seen for seen in watch.seen if repr(str(Path(path)))[1:-1] not in seen] == []
    assert caught.value.problems[0].code in ("VI101", "VI102", "VI103", "VI105", "VI106", "VI107", "VI108")

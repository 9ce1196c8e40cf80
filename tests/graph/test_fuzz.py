"""Random and randomly broken graph files: a graph, or an error that says where. Never a traceback."""

from __future__ import annotations

# ruff: noqa: E501, SIM905 - a bag of words
import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import visint.testing.plugin
from visint.errors import GraphError, PluginError
from visint.graph import Graph, parse_graph
from visint.registry import Catalog
from visint.schedule import compile_graph

CATALOG = Catalog({"toy": visint.testing.plugin}, {})
HERE = Path(__file__).parent
SEEDS = [path.read_text() for path in sorted((HERE / "graphs_toys").glob("*.yaml"))]
BAD = HERE.parent / "golden" / "bad_graphs"
FAULTY = [path.read_bytes().decode("utf-8", "replace") for path in sorted(BAD.glob("*.yaml"))]

WORDS = st.sampled_from(
    "visint name inputs loops nodes hub outputs uses with in from start none plane restart feedback of at levels loop over "
    "pyramid coarsest times until change_of below holds inside order spokes cohere reconcile replace map map.depth map.map "
    "toy.add toy.cue toy.smooth toy.joint toy.constant map.begin map.commit graph:x Image [Image] Light? Camera inputs.left "
    "a a.value a.sum b b.image 0 1 -1 2.5 1e-3 .nan .inf true null ~ '' {} [] : - ? , { } [ ] # & * ! | > ' \" % @ ` << \n"
    "".split(" ")
)  # fmt: skip
QUICK = settings(max_examples=250, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
THOROUGH = settings(QUICK, max_examples=20_000, derandomize=bool(os.environ.get("CI")))


def graph_or_error(text: str) -> Graph | None:
    """What every file must give; a graph also has a schedule and reads back from its own text."""
    try:
        graph = parse_graph(text, CATALOG, file="g.yaml")
    except (GraphError, PluginError) as error:
        for problem in error.problems:
            assert str(problem)[5:].startswith(" g.yaml:"), problem
            assert str(problem).replace("\n", "").isprintable()
        return None
    compile_graph(graph)
    assert parse_graph(graph.expanded(), CATALOG).plain_spec.nodes == graph.plain_spec.nodes
    return graph


@st.composite
def mutated(draw: st.DrawFn) -> str:
    """A sound or faulty graph with one to six words or lines cut, doubled, swapped or replaced."""
    text = draw(st.sampled_from(SEEDS + FAULTY))
    for _ in range(draw(st.integers(1, 6))):
        text = draw(st.sampled_from([_cut, _insert, _swap_words, _copy_line, _drop_line]))(draw, text)
    return text


def _spot(draw: st.DrawFn, text: str) -> int:
    return draw(st.integers(0, max(len(text) - 1, 0)))


def _cut(draw: st.DrawFn, text: str) -> str:
    at = _spot(draw, text)
    return text[:at] + text[at + draw(st.integers(1, 12)) :]


def _insert(draw: st.DrawFn, text: str) -> str:
    at = _spot(draw, text)
    return text[:at] + draw(WORDS | st.text(max_size=3)) + text[at:]


def _swap_words(draw: st.DrawFn, text: str) -> str:
    words = text.split(" ")
    words[draw(st.integers(0, len(words) - 1))] = draw(WORDS | st.sampled_from(words))
    return " ".join(words)


def _copy_line(draw: st.DrawFn, text: str) -> str:
    lines = text.split("\n")
    lines.insert(draw(st.integers(0, len(lines))), draw(st.sampled_from(lines)))
    return "\n".join(lines)


def _drop_line(draw: st.DrawFn, text: str) -> str:
    lines = text.split("\n")
    del lines[draw(st.integers(0, len(lines) - 1))]
    return "\n".join(lines)


ANYTHING = (
    st.text(max_size=300)
    | st.lists(WORDS, max_size=60).map(" ".join)
    | st.lists(WORDS, max_size=60).map("".join)
)


@given(ANYTHING)
@QUICK
def test_any_text_gives_a_graph_or_an_error(text):
    """Letters and words of graph files thrown together."""
    graph_or_error(text)


@given(mutated())
@QUICK
def test_a_broken_graph_gives_a_graph_or_an_error(text):
    """Graphs as a careless hand would leave them."""
    graph_or_error(text)


@pytest.mark.slow
@given(ANYTHING | mutated())
@THOROUGH
def test_twenty_thousand_files(text):
    """The same, at length."""
    graph_or_error(text)


PLAIN = st.recursive(
    st.none() | st.booleans() | st.integers(-5, 5) | st.floats() | WORDS | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(WORDS | st.integers(-2, 3), inner, max_size=3),
    max_leaves=8,
)


@st.composite
def shuffled_data(draw: st.DrawFn) -> dict:
    """The data of a sound graph with parts replaced by anything."""
    from visint.graph.read import parse

    data = dict(parse(draw(st.sampled_from(SEEDS))).spec.plain())
    for _ in range(draw(st.integers(1, 3))):
        part = data
        while True:
            key = draw(st.sampled_from(sorted(part, key=str)))
            if isinstance(part[key], dict) and part[key] and draw(st.booleans()):
                part[key] = dict(part[key])
                part = part[key]
            else:
                part[key] = draw(PLAIN)
                break
    return data


@given(shuffled_data())
@QUICK
def test_data_of_any_form_gives_a_graph_or_an_error(data):
    """A run record may have been edited by hand."""
    from visint.graph.bind import bind
    from visint.graph.read import parse_data

    try:
        source = parse_data(data, "run.json")
        bind(source.spec, CATALOG, source.places)
    except (GraphError, PluginError) as error:
        files = {problem.where.file for problem in error.problems}
    else:
        files = {"run.json"}
    assert files == {"run.json"}

"""Reading: YAML 1.2 values, JSON, exact places, and what the reader makes of odd but honest files."""

from __future__ import annotations

import json
import math

import pytest

from visint.errors import GraphError
from visint.graph.read import parse, parse_data, parse_value, read_graph

GOOD = """visint: 1
name: good
inputs: {left: Image}
nodes:
  smooth: {uses: toy.smooth, in: {image: inputs.left}}
outputs: {image: smooth.image}
"""


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-4", 1e-4),
        ("1.0e-3", 1e-3),
        ("1.", 1.0),
        (".5", 0.5),
        ("-7", -7),
        ("+7", 7),
        ("007", 7),
        ("0o17", 15),
        ("0x1F", 31),
        ("1_000", "1_000"),
        ("1:30", "1:30"),
        ("no", "no"),
        ("on", "on"),
        ("yes", "yes"),
        ("True", True),
        ("false", False),
        ("null", None),
        ("~", None),
        ("", None),
        (".inf", math.inf),
        ("-.inf", -math.inf),
        ("1e999", "1e999"),
        ("2020-01-01", "2020-01-01"),
        ("'1'", "1"),
        ('"true"', "true"),
        ("'null'", "null"),
        ("=", "="),
        ('"\\u00fc\\n"', "ü\n"),
        ('"\\ud83d\\ude00"', "😀"),
        ("[1, a, {b: 2}]", [1, "a", {"b": 2}]),
        ("Light?", "Light?"),
    ],
)
def test_values_are_those_of_the_core_schema(text, value):
    """Numbers, words and texts are told apart as YAML 1.2 says, so that ``1e-4`` is a number, ``no`` a word."""
    read = parse_value(text)
    assert read == value
    assert type(read) is type(value)


def test_nan_is_a_number():
    """``.nan`` stands for unknown."""
    assert math.isnan(parse_value(".nan"))


def test_json_reads_as_yaml_does():
    """The same graph as JSON, minified, indented by tabs or not at all, gives the same spec."""
    spec = parse(GOOD).spec
    data = spec.plain()
    for text in (json.dumps(data), json.dumps(data, indent="\t"), json.dumps(data, separators=(",", ":"))):
        assert parse(text).spec == spec
    assert parse_data(json.loads(json.dumps(data))).spec == spec


@pytest.mark.parametrize("ends", ["\r\n", "\r", "\n"])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_line_ends_and_byte_order_marks_change_nothing(ends, mark):
    """Files from any editor read alike, places included."""
    source = parse(mark + GOOD.replace("\n", ends))
    assert source.spec == parse(GOOD).spec
    assert source.places == parse(GOOD).places


PLACED = """visint: 1
name: good
inputs:
  left: Image

  stack: [Image]   # a list
nodes:
  "smooth": {uses: toy.smooth,
     in: {image: inputs.left}}
  mean:
    uses: toy.stack
    in:
      images:
      - inputs.left
      - smooth.image
outputs: {image: mean.image}
"""


@pytest.mark.parametrize(
    ("path", "key", "place"),
    [
        ((), False, (1, 1)),
        (("visint",), False, (1, 9)),
        (("inputs", "left"), False, (4, 9)),
        (("inputs", "left"), True, (4, 3)),
        (("inputs", "stack"), False, (6, 10)),
        (("nodes", "smooth"), True, (8, 3)),
        (("nodes", "smooth", "uses"), False, (8, 20)),
        (("nodes", "smooth", "in", "image"), False, (9, 18)),
        (("nodes", "mean", "in", "images", 1), False, (15, 9)),
        (("nodes", "mean", "with"), False, (10, 3)),
        (("outputs", "image"), False, (16, 18)),
        (("hub", "order"), False, (1, 1)),
    ],
)
def test_places_are_exact(path, key, place):
    """Line and column of each value, and of each key; what is not there is looked for above it."""
    where = parse(PLACED, "g.yaml").places.where(*path, key=key)
    assert (where.line, where.column) == place
    assert where.path == ".".join(map(str, path))


def test_columns_count_letters():
    """A letter that takes four bytes is one column, as an editor counts."""
    with pytest.raises(GraphError) as caught:
        parse(GOOD.replace("name: good", 'name: good\nabout: {"😀ü": 1}'), "g.yaml")
    assert str(caught.value).startswith("VI105 g.yaml:3:8 about")


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"", "VI101 {}:1:1: the file is empty"),
        (b"visint: 1\nname: \xff\n", "VI101 {}:2:1: the file is not UTF-8 text"),
        ("visint: 1\nname: a".encode("utf-16"), "VI101 {}:1:1: the file is not UTF-8 text"),
        (b"visint: 1\nname: \x00\n", "VI101 {}:2:1: the file is not text: it has NUL bytes"),
        (b"# " + b"x" * (1 << 18), "VI107 {}:1:1: the file"),
    ],
)
def test_a_file_that_is_no_text_is_told_with_its_line(tmp_path, data, said):
    """Bytes that no text has, and files beyond the limit, are refused with file, line and column."""
    path = tmp_path / "g.yaml"
    path.write_bytes(data)
    with pytest.raises(GraphError) as caught:
        read_graph(path)
    assert str(caught.value).startswith(said.format(path))


def test_a_missing_file_and_a_folder(tmp_path):
    """Both are VI101, with the name that was asked for."""
    for path in (tmp_path / "none.yaml", tmp_path):
        with pytest.raises(GraphError, match="VI101") as caught:
            read_graph(path)
        assert str(path) in str(caught.value)


def test_all_problems_of_a_phase_come_in_the_order_of_the_file():
    """Line by line, each place once."""
    text = GOOD.replace("name: good", "name: 1").replace("uses: toy.smooth", "use: toy.smooth") + "more: 1\n"
    with pytest.raises(GraphError) as caught:
        parse(text, "g.yaml")
    lines = [problem.where.line for problem in caught.value.problems]
    assert lines == sorted(lines)
    assert [problem.where.path for problem in caught.value.problems] == ["name", "nodes.smooth.use", "more"]

"""Spec to YAML and back: equal, whatever names, numbers and texts it holds; the builder; the schema."""

from __future__ import annotations

# ruff: noqa: E501, RUF005 - lists of odd texts
import json
import math
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import visint
import visint.testing.plugin
from visint.errors import GraphError, UsageError
from visint.graph import Graph, json_schema, load, parse_graph
from visint.graph.read import parse
from visint.graph.spec import GraphSpec
from visint.graph.write import to_yaml
from visint.registry import Catalog

CATALOG = Catalog({"toy": visint.testing.plugin}, {})
GRAPHS = sorted((Path(__file__).parent / "graphs_toys").glob("*.yaml"))
SHIPPED = sorted((Path(__file__).parents[2] / "graphs").glob("*.yaml"))
BAD = Path(__file__).parents[1] / "golden" / "bad_graphs"

NAMES = st.from_regex(r"[a-z][a-z0-9_]{0,12}", fullmatch=True)
REFS = st.builds("{}.{}".format, NAMES, NAMES)
NUMBERS = (
    st.integers(-(10**17), 10**17)
    | st.floats(allow_nan=False)
    | st.sampled_from([math.inf, -math.inf, 1e-4, -0.0])
)
TEXTS = st.text(max_size=12) | st.sampled_from(
    ["no", "On", "null", "~", "true", "1e-4", "0x1F", "0o7", ".inf", ".nan", "1.", "+1", " a ", "a: b", "- a", "# no", "'", '"', "\\"]
    + ["a\nb", "\t", "\r\n", "\x85", "\u2028", "\ufeff", "\x07", "é", "😀", "{a}", "[a]", "a,b", "&a", "*a", "!a", "<<", "=", "?", "%", "@", "`", ""]
)  # fmt: skip
TEXT = TEXTS.filter(lambda text: not any(0xD800 <= ord(letter) < 0xE000 for letter in text))
VALUES = st.recursive(
    st.none() | st.booleans() | NUMBERS | TEXT,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(NAMES | st.integers(-3, 9), inner, max_size=3),
    max_leaves=6,
)
PARAMS = st.dictionaries(NAMES | TEXT.filter(lambda key: key.isprintable() and key != "<<"), VALUES, max_size=3)
WIRES = st.dictionaries(NAMES, REFS | st.lists(REFS, max_size=2).map(tuple), max_size=2)
STARTS = st.none() | st.floats(-5, 5) | st.just("plane") | REFS
FEEDBACK = st.dictionaries(NAMES, st.fixed_dictionaries({"from": REFS, "start": STARTS}), max_size=2)
LEVELS = st.none() | st.lists(st.integers(0, 6), max_size=3).map(tuple)
STEPS = st.fixed_dictionaries({"uses": st.none() | st.just("none") | REFS, "with": PARAMS, "in": WIRES})
SPOKES = {"uses": REFS, "with": PARAMS, "in": WIRES, "feedback": FEEDBACK, "levels": LEVELS, "cohere": STEPS}
NODES = {
    "uses": REFS,
    "with": PARAMS,
    "in": WIRES,
    "feedback": FEEDBACK,
    "loop": st.none() | NAMES,
    "levels": LEVELS,
    "at": st.dictionaries(st.integers(0, 6), PARAMS, max_size=2),
    "of": st.none() | NAMES,
}
LOOPS = {
    "times": st.none() | st.integers(1, 99),
    "inside": st.none() | NAMES,
    "over": st.none() | st.just("pyramid"),
    "between": st.dictionaries(NAMES, st.sampled_from(["linear", "replicate"]), max_size=2),
    "until": st.none() | st.fixed_dictionaries({"change_of": REFS, "below": st.floats(1e-9, 10)}),
    "on_exhausted": st.sampled_from(["accept", "warn", "fail"]),
}
HUBS = {
    "order": st.lists(NAMES, max_size=3).map(tuple),
    "start": st.dictionaries(NAMES, STARTS, max_size=2),
    "reconcile": st.dictionaries(NAMES, STEPS, max_size=2),
    "spokes": st.dictionaries(NAMES, st.fixed_dictionaries(SPOKES), max_size=2),
}
SPECS = st.fixed_dictionaries(
    {
        "visint": st.just(1),
        "name": NAMES,
        "about": TEXT,
        "inputs": st.dictionaries(
            NAMES, st.sampled_from(["Image", "Light?", "flow.Flow", ("Image",)]), max_size=3
        ),
        "loops": st.dictionaries(NAMES, st.fixed_dictionaries(LOOPS), max_size=2),
        "nodes": st.dictionaries(NAMES, st.fixed_dictionaries(NODES), max_size=3),
        "hub": st.none() | st.fixed_dictionaries(HUBS),
        "controls": st.dictionaries(NAMES, st.dictionaries(REFS, VALUES, max_size=2), max_size=2),
        "outputs": st.dictionaries(NAMES, REFS, min_size=1, max_size=2),
    }
).map(GraphSpec.model_validate)
QUICK = settings(max_examples=100, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))


@given(SPECS)
@QUICK
def test_a_spec_reads_back_equal(spec):
    """Odd texts, infinities, integers as keys, empty lists and nested parameters included."""
    text = to_yaml(spec)
    again = parse(text).spec
    assert again == spec
    assert to_yaml(again) == text


@given(SPECS)
@QUICK
def test_a_spec_reads_back_equal_from_json(spec):
    """Run records hold graphs as JSON; keys that are numbers come back as what they were."""
    data = json.loads(json.dumps(_with_text_keys(spec.plain()), allow_nan=True))
    text = json.dumps(data)
    if "Infinity" not in text and "\\ud" not in text:
        assert parse(text).spec == GraphSpec.model_validate(data)


def _with_text_keys(value: object) -> object:
    if isinstance(value, dict):
        return {str(key): _with_text_keys(one) for key, one in value.items()}
    return [_with_text_keys(one) for one in value] if isinstance(value, list | tuple) else value


def test_lines_stay_readable():
    """Short mappings stand on one line, long ones a line a key; no line of a toy graph is too long."""
    for path in GRAPHS:
        assert max(map(len, load(path, CATALOG).to_yaml().splitlines())) <= 140


FULL = """visint: 1
name: full
about: All that the builder can say.
inputs: {image: Image, guess: Image?, stack: [Image], camera: Camera?}
loops:
  levels: {over: pyramid, levels: 2, between: {Depth: linear}}
  sweeps: {inside: levels, times: 3, until: {change_of: relax.image, below: 0.01}}
nodes:
  mean: {uses: toy.stack, in: {images: [inputs.image, inputs.image]}}
  relax:
    uses: toy.smooth
    loop: sweeps
    in: {source: inputs.guess}
    feedback: {image: {from: relax.image, start: mean.image, restart: levels}}
  edges: {uses: toy.edges, with: {at: 0.2}, loop: levels, at: {0: {at: 0.3}}, levels: [0, 1], in: {image: relax.image}}
hub:
  loop: levels
  start: {depth: plane}
  order: [cue]
  spokes:
    cue: {uses: toy.cue, in: {image: inputs.image}, reconcile: {uses: toy.blend}}
controls: {flat: {edges.at: 9.0}}
outputs: {edges: edges.boundaries, depth: map.depth}
"""


def built() -> Graph:
    g = visint.Builder("full", CATALOG, image="Image", guess="Image?", stack=["Image"], camera="Camera?")
    g.about("All that the builder can say.")
    levels = g.loop("levels", over="pyramid", levels=2, between={"Depth": "linear"})
    sweeps = g.loop("sweeps", inside=levels, times=3, until={"change_of": "relax.image", "below": 0.01})
    mean = g.add("mean", "toy.stack", images=[g.image, g.image])
    relax = g.add(
        "relax",
        "toy.smooth",
        options={"loop": sweeps},
        source=g.guess,
        feedback={"image": {"from": "relax.image", "start": mean.image, "restart": levels}},
    )
    options = {"loop": levels, "levels": [0, 1], "at": {0: {"at": 0.3}}}
    edges = g.add("edges", "toy.edges", params={"at": 0.2}, options=options, image=relax.image)
    cue = {"uses": "toy.cue", "in": {"image": "inputs.image"}, "reconcile": {"uses": "toy.blend"}}
    hub = g.hub({"loop": levels, "start": {"depth": "plane"}, "order": ["cue"], "spokes": {"cue": cue}})
    g.control("flat", **{"edges.at": 9.0})
    return g.outputs(edges=edges.boundaries, depth=hub.depth)


def test_a_graph_built_in_code_equals_its_file_both_ways():
    """The builder gives what the file gives, and the built graph's text reads back equal."""
    from_file = parse_graph(FULL, CATALOG)
    assert built() == from_file
    assert built().nodes == from_file.nodes
    assert parse_graph(built().to_yaml(), CATALOG) == built()
    assert hash(built()) == hash(from_file)


@pytest.mark.parametrize("path", GRAPHS, ids=lambda path: path.stem)
def test_any_plain_graph_can_be_built(path):
    """Node by node from the expanded text: the same graph."""
    wanted = parse_graph(load(path, CATALOG).expanded(), CATALOG)
    data = wanted.spec.plain()
    inputs = {
        name: list(kind) if isinstance(kind, list | tuple) else kind
        for name, kind in data.get("inputs", {}).items()
    }
    g = visint.Builder(data["name"], CATALOG, **inputs)
    for name, loop in data.get("loops", {}).items():
        g.loop(name, **loop)
    for name, node in data["nodes"].items():
        rest = {key: node[key] for key in ("loop", "levels", "at", "of") if key in node}
        fed, ports = node.get("feedback", {}), node.get("in", {})
        g.add(name, node["uses"], params=node.get("with"), feedback=fed, options=rest, **ports)
    for name, control in data.get("controls", {}).items():
        g.control(name, **control)
    about = wanted.spec.about
    assert g.about(about).outputs(**data["outputs"]) == wanted


def test_the_builder_tells_its_own_mistakes():
    """A name taken twice, an input that is not there, and whatever binding finds."""
    g = visint.Builder("mine", CATALOG, image="Image")
    g.add("edges", "toy.edges", image=g.image)
    with pytest.raises(UsageError, match="VI223"):
        g.add("edges", "toy.edges", image=g.image)
    with pytest.raises(AttributeError, match="no input 'picture'"):
        _ = g.picture
    with pytest.raises(GraphError, match=r"VI202 mine outputs\.a"):
        g.outputs(a="edge.boundaries")
    with pytest.raises(GraphError, match="VI105 mine outputs"):
        g.outputs()
    with pytest.raises(GraphError, match=r"VI105 mine loops\.turns\.time"):
        g.loop("turns", time=3)
    with pytest.raises(GraphError, match=r"VI105 mine nodes\.again\.feedback\.image\.form"):
        g.add("again", "toy.smooth", feedback={"image": {"form": "edges.image"}})


def accepts(schema: dict, value: object, root: dict) -> bool:
    """Whether a JSON schema takes a value: the part of the standard that pydantic writes."""
    if "$ref" in schema:
        return accepts(root["$defs"][schema["$ref"].rpartition("/")[2]], value, root)
    if "anyOf" in schema and not any(accepts(one, value, root) for one in schema["anyOf"]):
        return False
    if value != schema.get("const", value) or value not in schema.get("enum", [value]):
        return False
    for branch in schema.get("allOf", ()):
        if accepts(branch["if"], value, root) and not accepts(branch["then"], value, root):
            return False
    kinds = {
        "object": dict,
        "array": list,
        "string": str,
        "integer": int,
        "number": (int, float),
        "boolean": bool,
        "null": type(None),
    }
    kind = schema.get("type")
    if kind and (
        not isinstance(value, kinds[kind]) or (isinstance(value, bool) and kind in ("integer", "number"))
    ):
        return False
    return _members(schema, value, root)


def _members(schema: dict, value: object, root: dict) -> bool:
    if isinstance(value, dict):
        known, others = schema.get("properties", {}), schema.get("additionalProperties", True)
        if not {*schema.get("required", ())} <= {*value} or len(value) < schema.get("minProperties", 0):
            return False
        return all(
            accepts(known[key], one, root)
            if key in known
            else others is True or (others and accepts(others, one, root))
            for key, one in value.items()
        )
    if isinstance(value, list):
        prefix, rest = schema.get("prefixItems", []), schema.get("items", True)
        if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", 10**6):
            return False
        items = [*zip(value, [*prefix, *[rest] * len(value)], strict=False)]
        return all(each is True or accepts(each, one, root) for one, each in items)
    if isinstance(value, int | float) and not isinstance(value, bool):
        return schema.get("minimum", -math.inf) <= value <= schema.get("maximum", math.inf) and (
            value > schema.get("exclusiveMinimum", -math.inf)
        )
    return True


def plain(path: Path) -> object:
    from visint.graph.compose import compose

    return json.loads(json.dumps(compose(path.read_text(), path.name)[0]))


@pytest.mark.parametrize("path", [*GRAPHS, *SHIPPED], ids=lambda path: path.stem)
def test_the_schema_accepts_every_graph(path):
    """Toy graphs with the installed modules spelled out, shipped ones by form."""
    schema = json_schema()
    assert accepts(schema, plain(path), schema)
    if path in GRAPHS:
        schema = json_schema(CATALOG)
        assert accepts(schema, plain(path), schema)


FORM = [
    "no_outputs",
    "empty_outputs",
    "unknown_key_at_top",
    "unknown_key_of_loop",
    "unknown_key_of_hub",
    "node_is_text",
]
FORM += ["in_is_text", "port_is_number", "times_is_text", "times_is_true", "times_is_zero", "below_is_negative"]
FORM += [
    "on_exhausted_typo",
    "between_typo",
    "levels_is_number",
    "two_kinds_in_a_list",
    "hub_without_order",
    "no_version",
]
MODULES = ["module_typo", "plugin_typo", "spoke_module_typo", "parameter_typo", "parameter_of_wrong_type"]
MODULES += ["spoke_parameter_typo", "sub_graph_typo"]


@pytest.mark.parametrize("name", FORM + MODULES)
def test_the_schema_refuses_what_the_reader_refuses(name):
    """Faults of form by the schema alone; wrong modules and parameters with the installed ones spelled out."""
    (path,) = BAD.glob(f"???_{name}.yaml")
    schema = json_schema(CATALOG if name in MODULES else None)
    assert not accepts(schema, plain(path), schema)

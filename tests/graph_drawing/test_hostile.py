"""Names and texts of a graph file are data: whatever they hold, the drawing stays a drawing."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

import pytest
import shapes

from visint.graph import drawing
from visint.graph.drawing.lettering import clean, fitted, width
from visint.graph.spec import FeedbackSpec, GraphSpec, HubSpec, LoopSpec, NodeSpec, SpokeSpec, UntilSpec

HOSTILE = [
    "</title><script>alert(1)</script>",
    "\"><img src=x onerror='alert(1)'>",
    "</svg></style><b>&amp;&lt;",
    "]]><!-- -->",
    'a" -> b [label="x"]; }\ndigraph {',
    "back\\slash\\",
    'ends in \\"',
    "line\nbreak\ttab\r",
    "nul\x00bell\x07\x1b[31m\ufffe",
    "right\u202eto left",
    "lone \ud800 half",
    "x" * 5000,
    "寬字 ﷽ é",
    "",
    "%n \\N \\G {a|b}",
]


def everywhere(text: str) -> GraphSpec:
    """A graph with ``text`` wherever a graph file may hold one."""
    node = NodeSpec(
        uses=text,
        with_={text: text},
        loop=text,
        at={0: {text: text}},
        in_={text: f"inputs.{text}", "other": text},
        feedback={text + "f": FeedbackSpec(from_=f"{text}.{text}", start=text, restart=text)},
    )
    spoke = SpokeSpec(uses=text, with_={text: [text]}, in_={text: f"{text}.{text}"})
    loop = LoopSpec(times=1, until=UntilSpec(change_of=text, below=0.1), between={text: "linear"})
    hub = HubSpec(uses=text, loop=text, start={text: text}, order=(text,), spokes={text: spoke})
    return GraphSpec(
        visint=1, name=text, about=text, inputs={text: text}, loops={text: loop}, nodes={text: node, "n": node},
        hub=hub, outputs={text: f"map.{text}"},
    )  # fmt: skip


@pytest.mark.parametrize("text", HOSTILE, ids=range(len(HOSTILE)))
def test_no_text_breaks_out_of_the_page(text: str) -> None:
    """The svg stays well-formed and holds the elements it always holds; the page can be written as UTF-8."""
    spec = everywhere(text)
    svg = drawing.to_svg(spec, text)
    root = ET.fromstring(svg)
    tags = {element.tag.removeprefix(shapes.SVG) for element in root.iter()}
    assert tags == {"svg", "style", "g", "title", "rect", "path", "text", "circle"}
    attributes = {name for element in root.iter() for name in element.attrib}
    assert not [name for name in attributes if name.startswith("on") or "href" in name]
    page = drawing.to_html(spec)
    page.encode("utf-8")
    assert not re.search(r"<(script|img|b|iframe)\b", page)
    assert page.count("</svg>") == page.count("</html>") == 1
    assert page.count("</style>") == 2


@pytest.mark.parametrize("text", HOSTILE, ids=range(len(HOSTILE)))
def test_no_text_breaks_out_of_the_dot_file(text: str) -> None:
    """Outside quoted strings stands only what this package wrote."""
    dot = drawing.to_dot(everywhere(text), text)
    dot.encode("utf-8")
    bare = re.sub(r'"(?:[^"\\\n]|\\.)*"', "S", dot)
    assert '"' not in bare
    words = {*re.findall(r"[A-Za-z_]+", re.sub(r"\bn\d+\b", "", bare))}
    assert words <= {
        *("digraph", "subgraph", "graph", "node", "edge", "label", "taillabel", "tooltip", "labeljust", "l"),
        *("rankdir", "TB", "fontname", "fontsize", "fontcolor", "compound", "shape", "box", "ellipse", "style"),
        *("rounded", "filled", "fillcolor", "color", "dashed", "peripheries", "penwidth", "dir", "both", "S"),
        *("constraint", "false", "true", "red"),
    }
    assert bare.count("{") == bare.count("}")


def test_what_cannot_be_printed_is_shown_as_such() -> None:
    """Controls and marks that turn the writing round become the replacement sign; white space one blank."""
    assert clean("a\x00b\u202ec \n\t d\ud800") == "a\ufffdb\ufffdc d\ufffd"


def test_long_texts_are_cut_where_they_are_shown_and_whole_in_the_tooltip() -> None:
    """A box does not grow without end; the tooltip tells the name in full, up to 200 characters."""
    assert fitted("x" * 50) == "x" * 43 + "…"
    name = "long_" * 20
    root = shapes.tree(
        shapes.spec(f"visint: 1\nname: g\nnodes: {{{name}: {{uses: a.b}}}}\noutputs: {{o: {name}.c}}\n")
    )
    box = next(g for g in shapes.groups(root, "node"))
    assert shapes.title(box).startswith(name)
    assert shapes.area(box).w < 500


def test_words_are_measured_by_their_letters() -> None:
    """Wide letters are wider than narrow ones, bold than plain, and sizes scale."""
    assert width("illi", 10) < width("abcd", 10) < width("MWMW", 10)
    assert width("abc", 10) < width("abc", 10, bold=True)
    assert width("abc", 20) == pytest.approx(2 * width("abc", 10))

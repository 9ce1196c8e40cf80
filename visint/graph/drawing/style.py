"""The colours of a drawing, for light and for dark; every rule is bound to the drawing's own class."""

from __future__ import annotations

__all__ = ["STYLE"]

_LIGHT = {
    "paper": "#ffffff",
    "ink": "#1c2733",
    "soft": "#5b6875",
    "line": "#7f8c99",
    "edge": "#8592a0",
    "box": "#ffffff",
    "end": "#eef1f4",
    "frame0": "#f5f8fb",
    "frame1": "#eaf1f6",
    "rim": "#b9c7d3",
    "hub": "#0f766e",
    "hubbox": "#e3f4f1",
    "back": "#b45309",
    "red": "#c81e1e",
    "redbox": "#fdecec",
}
_DARK = {
    "paper": "#12171c",
    "ink": "#e6ebf0",
    "soft": "#a3b0bc",
    "line": "#75838f",
    "edge": "#64717d",
    "box": "#1c242b",
    "end": "#29323a",
    "frame0": "#161d23",
    "frame1": "#1b252d",
    "rim": "#3a4853",
    "hub": "#4fc9b9",
    "hubbox": "#14312f",
    "back": "#f0a04b",
    "red": "#ff7b72",
    "redbox": "#3b1a1b",
}
_RULES = """
.visint-graph{background:var(--paper);font-family:"Helvetica Neue",Helvetica,Arial,"Liberation Sans",sans-serif}
.visint-graph text{fill:var(--ink)}
.visint-graph .name,.visint-graph .loop,.visint-graph .count{font-weight:600}
.visint-graph .text,.visint-graph .bound,.visint-graph .port,.visint-graph .loop{fill:var(--soft)}
.visint-graph .frame{fill:var(--frame0);stroke:var(--rim)}
.visint-graph .loop1 .frame{fill:var(--frame1)}
.visint-graph .body{fill:var(--box);stroke:var(--line);stroke-width:1.2}
.visint-graph .input .body,.visint-graph .output .body{fill:var(--end);stroke:none}
.visint-graph .missing .body{stroke:var(--red);stroke-dasharray:3 3}
.visint-graph .spoke .body,.visint-graph .map .body{stroke:var(--hub);stroke-width:1.5}
.visint-graph .map .body{fill:var(--hubbox);stroke-width:2}
.visint-graph .rim{fill:none;stroke:var(--hub);stroke-width:.8}
.visint-graph .turn{fill:var(--hub)}
.visint-graph text.count{fill:var(--paper)}
.visint-graph .line{fill:none;stroke:var(--edge);stroke-width:1.3}
.visint-graph .head{fill:var(--edge)}
.visint-graph .feedback .line{stroke:var(--back);stroke-width:1.5;stroke-dasharray:6 4}
.visint-graph .feedback .head{fill:var(--back)}
.visint-graph .spoke .line{stroke:var(--hub);stroke-width:2}
.visint-graph .spoke .head{fill:var(--hub)}
.visint-graph .edge:hover .line{stroke:var(--ink);stroke-width:2.4}
.visint-graph .failed .body{fill:var(--redbox);stroke:var(--red);stroke-width:2.6}
.visint-graph .failed .name{fill:var(--red)}
.visint-graph [tabindex]{outline:none}
.visint-graph [tabindex]:focus-visible>rect:first-of-type{stroke:var(--ink);stroke-width:3}
"""


def _colours(of: dict[str, str]) -> str:
    return ".visint-graph{" + ";".join(f"--{name}:{colour}" for name, colour in of.items()) + "}"


STYLE = f"{_colours(_LIGHT)}\n@media (prefers-color-scheme:dark){{{_colours(_DARK)}}}{_RULES}"
"""The style sheet inside every drawing; it follows the reader's choice of light or dark."""

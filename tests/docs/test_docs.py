"""The docs are run: every snippet, every graph, every sentence that can be held."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from visint.graph import parse_graph

ROOT = Path(__file__).parents[2]
PAGES = sorted([*(ROOT / "docs").rglob("*.md"), ROOT / "README.md"])
WRITTEN = [page for page in PAGES if "generated" not in page.parts and "_build" not in page.parts]


def blocks(page: Path, language: str) -> list[str]:
    """The fenced blocks of a language, in order."""
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE)


@pytest.mark.parametrize("page", WRITTEN, ids=lambda page: page.name)
def test_every_graph_in_the_docs_binds(page):
    """A YAML block that is a whole graph file is a sound one."""
    for text in blocks(page, "yaml"):
        if text.startswith("visint:"):
            graph = parse_graph(text, file=page.name)
            assert parse_graph(graph.to_yaml()) == graph


def test_links_between_pages_lead_somewhere():
    """Every relative link of a written page names a file."""
    for page in [*WRITTEN, *ROOT.glob("*.md")]:
        for target in re.findall(r"\]\((?!https?:|#)([^)#]+)", page.read_text()):
            assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_decisions_are_numbered_and_listed():
    """0001, 0002, …: none missing, each with a status."""
    pages = sorted((ROOT / "docs/decisions").glob("0*.md"))
    assert [int(page.name[:4]) for page in pages] == list(range(1, len(pages) + 1))
    for page in pages:
        assert "**Status:**" in page.read_text(), page.name

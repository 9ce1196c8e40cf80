"""Whatever can be installed, named or met as an error stands in the reference, and links are checked."""

from __future__ import annotations

import importlib.util
import inspect
import json
import re
from pathlib import Path
from types import ModuleType

import pytest

from visint import hookspecs
from visint.errors import CODES
from visint.fields.assumptions import ASSUMPTIONS
from visint.fields.kinds import KINDS
from visint.graph import json_schema
from visint.registry import installed
from visint.registry.discover import discover

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="module", autouse=True)
def beside():
    """The docs' own modules find each other as they do when the site is built."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(DOCS))
        yield


def from_docs(name: str) -> ModuleType:
    """A module of the docs, which are no package."""
    spec = importlib.util.spec_from_file_location(name, DOCS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """The generated pages by name."""
    folder = tmp_path_factory.mktemp("reference")
    from_docs("reference_pages").write_all(folder)
    return {path.stem: path.read_text(encoding="utf-8") for path in folder.iterdir()}


def test_every_module_with_its_ports_parameters_and_assumptions(pages):
    """Each under its id; every public port and parameter by name, every assumption in words."""
    catalog = installed()
    found = [(name, one) for name in catalog.plugin_names for one in catalog.plugin(name).modules.values()]
    assert len(found) > 20
    for plugin, module in found:
        title = f"### {plugin}.{module.name}\n"
        assert title in pages["modules"]
        text = pages["modules"].partition(title)[2].partition("\n### ")[0]
        names = [*module.Inputs.specs, *module.Outputs.specs, *module.Params.model_fields, *module.assumptions]
        assert not [name for name in names if f"`{name}`" not in text], title


def test_every_module_says_what_it_does_and_its_parameters_what_turning_them_does(pages):
    """A docstring each; every parameter stands in that of its model."""
    catalog = installed()
    for plugin in catalog.plugin_names:
        for module in catalog.plugin(plugin).modules.values():
            assert inspect.getdoc(module), f"{plugin}.{module.name}"
            text = inspect.getdoc(module.Params) or ""
            told = from_docs("docstrings").parameters_in(text) or dict.fromkeys(
                re.findall(r"``(\w+)``", text), text
            )
            silent = [name for name in module.Params.model_fields if not told.get(name)]
            assert not silent, f"{plugin}.{module.name}: {silent}"


def test_a_doi_is_a_link(pages):
    assert "https://doi.org/10." in pages["modules"]


def test_every_policy(pages):
    catalog = installed()
    policies = [f"{name}.{one}" for name in catalog.plugin_names for one in catalog.plugin(name).policies]
    assert policies
    assert all(f"### {policy}\n" in pages["modules"] for policy in policies)


def test_every_hook_with_its_exact_signature(pages):
    for name in (name for name in vars(hookspecs) if name.startswith("visint_")):
        assert f"def {name}{inspect.signature(getattr(hookspecs, name))}" in pages["hooks"]
        assert f"## {name}\n" in pages["hooks"]


def test_every_error_code(pages):
    assert all(f"| `{code}` | {meaning} |" in pages["errors"] for code, meaning in CODES.items())


def test_every_code_that_is_raised_is_in_the_table():
    """And every one of the table is raised somewhere: a code nobody can meet misleads."""
    root = DOCS.parent
    code = [path for top in ("visint", "plugins") for path in (root / top).rglob("*.py")]
    raised = {
        found
        for path in code
        if path.name != "errors.py" and "testing" not in path.parts
        for found in re.findall(r'"(VI\d{3})"', path.read_text())
    }
    assert raised <= set(CODES)
    assert set(CODES) - raised <= {"VI130"}  # Cancelled carries it


def test_every_field_kind(pages):
    rows = [line.split()[0] for line in pages["kinds"].splitlines() if line.strip() and line[0].isupper()]
    assert set(KINDS) <= set(rows)


def test_every_assumption(pages):
    assert all(f"| `{name}` | {says} |" in pages["assumptions"] for name, says in ASSUMPTIONS.items())


def test_every_verb(pages):
    """Those of plugins too, each with its options."""
    for verb in ("run", "check", "show", "modules", "schema", *discover("visint.commands")):
        text = pages["cli"].partition(f"## visint {verb}\n")[2].partition("\n## ")[0]
        assert f"Usage: visint {verb}" in text


def test_the_schema_is_the_one_that_is_printed(pages):
    assert json.dumps(json_schema(), indent=1) in pages["schema"]


def test_every_page_is_in_the_table_of_contents():
    """Whoever starts at the front page can reach each."""
    listed = (DOCS / "index.md").read_text().splitlines()
    apart = {"generated", "_build", "decisions"}  # decisions are listed by their numbers
    written = [page for page in DOCS.rglob("*.md") if not apart & set(page.parts)]
    names = {page.relative_to(DOCS).with_suffix("").as_posix() for page in written}
    assert names - {"index"} <= set(listed)


class TestDocstrings:
    """As Markdown: signs are text, code is code."""

    def test_prose(self):
        prose = from_docs("docstrings").prose
        assert prose("One\ntwo ``a_b`` n_z * 2 [1].") == "One two `a_b` n\\_z \\* 2 \\[1\\]."
        assert prose("See :func:`visint.run`.\n\n    x = 1\n\nEnd.") == (
            "See `visint.run`.\n\n```text\n    x = 1\n```\n\nEnd."
        )
        assert prose("* one\n  more\n* two") == "* one more\n* two"

    def test_parameters(self):
        """Each with all of its lines, two of one name line apart."""
        text = "About.\n\nParameters\n----------\na, b\n    First | line\n    and second.\nc\n    Third.\n"
        assert from_docs("docstrings").parameters_in(text) == {
            "a": "First \\| line and second.",
            "b": "First \\| line and second.",
            "c": "Third.",
        }
        assert from_docs("docstrings").parameters_in("About.") == {}


class TestLinkCheck:
    """The check that runs at the end of each build."""

    def site(self, folder, **pages):
        for name, text in pages.items():
            (folder / f"{name}.html").write_text(text)
        return from_docs("link_check").broken_links(folder)

    def test_links_that_lead_somewhere(self, tmp_path):
        (tmp_path / "a picture.png").write_bytes(b"")
        a = '<p id="here"><a href="b.html#there">b</a><a href="#here">a</a><img src="a%20picture.png">'
        b = '<h1 id="there"><a href="https://example.org/none">out</a><a href="a.html">a</a>'
        assert self.site(tmp_path, a=a, b=b) == []

    def test_links_that_do_not(self, tmp_path):
        """A page that is missing, a place that is missing in a page that is there, a picture."""
        a = '<a href="c.html">c</a><a href="b.html#none">b</a><a href="#no">a</a><img src="x.png">'
        found = self.site(tmp_path, a=a, b="<p>")
        assert found == ["a.html: c.html", "a.html: b.html#none", "a.html: #no", "a.html: x.png"]

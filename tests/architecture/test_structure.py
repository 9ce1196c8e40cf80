"""The house rules that a program can hold: layers, names, budgets, the façade, what is shipped."""

from __future__ import annotations

import ast
import io
import re
import statistics
import subprocess
import sys
import tokenize
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CODE = [path for top in ("visint", "plugins") for path in sorted((ROOT / top).rglob("*.py"))]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
PLUGINS = sorted(path.name for path in (ROOT / "plugins").iterdir() if (path / "__init__.py").exists())
FORBIDDEN_NAMES = {"utils", "util", "common", "helpers", "base", "core", "misc"}
TOP_LEVEL = {"visint", "plugins", "graphs", "tests", "docs", ".ci"}


def functions(path: Path) -> Iterator[ast.FunctionDef]:
    """Every function of a file, methods included."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.FunctionDef):
            yield node


def imports(path: Path) -> Iterator[str]:
    """Every module a file imports, type-checking imports included."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module


def statements(function: ast.FunctionDef) -> int:
    """Statements in a function's body, docstring not counted."""
    inner = sum(isinstance(node, ast.stmt) for node in ast.walk(function)) - 1
    return inner - (ast.get_docstring(function) is not None)


def code_lines(path: Path) -> int:
    """Lines of a file that hold code: no blanks, no comments, no docstrings."""
    text = path.read_text()
    silent = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT}
    lines: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in silent:
            lines.update(range(token.start[0], token.end[0] + 1))
    for node in ast.walk(ast.parse(text)):
        body = getattr(node, "body", None)
        if (
            isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)
            and ast.get_docstring(node) is not None
        ):
            lines.difference_update(range(body[0].lineno, body[0].end_lineno + 1))
    return len(lines)


class TestLayout:
    """What stands where."""

    def test_the_top_level_stays_as_it_is(self):
        """Folders of the repository are those of the design; tools' own folders apart."""
        tracked = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False)
        if tracked.returncode:
            pytest.skip("not a git checkout")
        folders = {line.partition("/")[0] for line in tracked.stdout.splitlines() if "/" in line}
        assert folders <= TOP_LEVEL

    def test_nothing_is_named_after_nothing(self):
        """No module is called utils or the like."""
        assert not [path for path in CODE if {path.stem, path.parent.name} & FORBIDDEN_NAMES]

    def test_every_plugin_folder_is_shipped_and_registered(self):
        """The wheel's packages, the entry points and the folders are one list."""
        packages = PROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"]
        points = PROJECT["project"]["entry-points"]["visint.plugins"].values()
        assert sorted(packages) == sorted(["visint", *(f"plugins/{name}" for name in PLUGINS)])
        assert sorted(points) == PLUGINS

    def test_linters_know_every_plugin(self):
        """The import contracts name each plugin."""
        contracts = {contract["name"]: contract for contract in PROJECT["tool"]["importlinter"]["contracts"]}
        assert sorted(contracts["Plugins know no other plugin"]["modules"]) == PLUGINS
        assert sorted(contracts["The core knows no plugin"]["forbidden_modules"]) == PLUGINS
        assert sorted(contracts["Plugins meet the core at its contract"]["source_modules"]) == PLUGINS

    def test_no_file_names_a_package_index(self):
        """Where packages come from is the user's affair."""
        files = [ROOT / "pyproject.toml", ROOT / "Makefile", ROOT / ".ci/run", *ROOT.glob("*.md")]
        words = ("py" + "pi.org", "python" + "hosted", "index" + "-url")
        assert not [(path.name, word) for path in files for word in words if word in path.read_text()]


class TestWhoMayImportWhom:
    """The layers themselves are the import linter's; these are the rules it cannot say."""

    def test_the_core_names_no_plugin(self):
        """Not even in a string."""
        core = [path for path in CODE if path.is_relative_to(ROOT / "visint")]
        found = [(path.name, name) for path in core for name in PLUGINS if name in path.read_text()]
        assert not found

    def test_plugins_meet_the_core_at_its_contract(self):
        """A plugin imports the façade and the modules of the contract, nothing else of visint."""
        allowed = re.compile(
            r"visint(\.(module|ports|arrays|fields|events|hookspecs|errors|io|testing)(\..*)?)?$"
        )
        for path in (path for path in CODE if path.is_relative_to(ROOT / "plugins")):
            own = path.relative_to(ROOT / "plugins").parts[0]
            for name in imports(path):
                if name.split(".")[0] in PLUGINS:
                    assert name.split(".")[0] == own, f"{path}: {name}"
                if name.split(".")[0] == "visint":
                    assert allowed.match(name), f"{path}: {name}"

    def test_only_io_opens_files(self):
        """`open`, `read_text` and their kin stand in visint/io alone; the kit's fake installations apart."""
        opening = re.compile(r"(?<![\w.])open\(|\.(read_text|read_bytes|write_text|write_bytes|unlink|mkdir)\(")
        exempt = {
            ROOT / "visint/testing/installed.py",  # writes a fake distribution into a temporary folder
            ROOT / "visint/cli/verbs.py",  # reads a verb's docstring from its source, which is no data
        }
        for path in CODE:
            if path.is_relative_to(ROOT / "visint/io") or path in exempt or "peers" in path.parts:
                continue
            found = [line for line in path.read_text().splitlines() if opening.search(line)]
            assert not [line for line in found if "io." not in line and "folder.write" not in line], path

    def test_heavy_libraries_are_imported_where_they_are_used(self):
        """cv2, scipy and numba stand in functions and kernels, so that checking a graph loads none of them."""
        for path in CODE:
            if path.name == "_kernels.py" or "peers" in path.parts:
                continue
            body = ast.parse(path.read_text()).body
            tops = [node for node in body if isinstance(node, ast.Import | ast.ImportFrom)]
            names = {node.names[0].name if isinstance(node, ast.Import) else node.module for node in tops}
            assert not {str(name).split(".")[0] for name in names} & {"cv2", "scipy", "numba"}, path


class TestBudgets:
    """Budgets serve the reader; an exemption stands here with its reason."""

    def test_files_are_short(self):
        """No file is over 400 lines, the median at most 150; tests at most 600."""
        lengths = {path: path.read_text().count("\n") for path in CODE}
        assert not {str(path): n for path, n in lengths.items() if n > 400}
        assert statistics.median(lengths.values()) <= 150
        tests = {path: path.read_text().count("\n") for path in (ROOT / "tests").rglob("*.py")}
        assert not {str(path): n for path, n in tests.items() if n > 600}

    def test_functions_are_short(self):
        """No function is over 30 statements; half are at most 8. Kernels are exempt: they may call nothing."""
        sizes = {
            f"{path.relative_to(ROOT)}:{function.lineno} {function.name}": statements(function)
            for path in CODE
            if path.name != "_kernels.py"
            for function in functions(path)
        }
        assert not {name: n for name, n in sizes.items() if n > 30}
        assert statistics.median(sizes.values()) <= 8

    def test_the_core_is_tested_at_length(self):
        """There are 1.5 lines of tests for a line of visint.

        Lines of code: blanks, comments and docstrings count on neither side. The contract kit stands on the
        side of the tests, and so do the golden texts, each line of which is an assertion.
        """
        kit = ROOT / "visint/testing"
        core = [path for path in CODE if path.is_relative_to(ROOT / "visint") and kit not in path.parents]
        tests = [*(ROOT / "tests").rglob("*.py"), *kit.rglob("*.py")]
        golden = [path for path in (ROOT / "tests").rglob("*") if path.suffix in (".txt", ".yaml")]
        asserted = sum(path.read_text(errors="replace").count("\n") for path in golden)
        lines = sum(map(code_lines, tests)) + asserted
        wanted = sum(map(code_lines, core))
        assert lines >= 1.5 * wanted, f"{lines} lines of tests for {wanted}"

    def test_exemptions_carry_their_reason(self):
        """Every noqa says what it allows; those in code also say why."""
        for path in CODE:
            for number, line in enumerate(path.read_text().splitlines(), 1):
                if "# noqa" in line or "# ruff: noqa" in line:
                    assert re.search(r"noqa: [A-Z0-9, ]+ - \w", line), f"{path}:{number}: {line.strip()}"


class TestFacade:
    """What `import visint` offers."""

    def test_at_most_thirty_names(self):
        """The façade is small, every name of it resolves, and each is documented where it lives."""
        import visint

        assert len(visint.__all__) <= 30
        for name in visint.__all__:
            assert getattr(visint, name) is not None
        assert set(visint.__dir__()) == set(visint.__all__)

    def test_an_unknown_name_is_an_attribute_error(self):
        """As for any module."""
        import visint

        with pytest.raises(AttributeError, match="nonsense"):
            _ = visint.nonsense

    def test_type_checkers_see_the_same_names(self):
        """The names imported for type checkers are those imported on use."""
        import visint

        tree = ast.parse((ROOT / "visint/__init__.py").read_text())
        block = next(node for node in tree.body if isinstance(node, ast.If))
        seen = {alias.asname for node in block.body if isinstance(node, ast.ImportFrom) for alias in node.names}
        assert seen | {"__version__"} == set(visint.__all__)

    def test_the_wheel_is_what_is_tested(self):
        """Under `make test` the package comes from the environment, not from the checkout."""
        import visint

        where = Path(visint.__file__)
        if Path(sys.prefix).is_relative_to(ROOT) and (Path(sys.prefix) / "wheel").exists():
            assert where.is_relative_to(sys.prefix)

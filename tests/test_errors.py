"""Errors: one tree, one table of codes, texts that teach and survive another process."""

from __future__ import annotations

import copy
import pickle
import re
from pathlib import Path

import pytest

import visint
from visint import errors
from visint.errors import (
    CODES,
    Cancelled,
    GraphError,
    InputError,
    ModuleError,
    OutputError,
    PluginError,
    Problem,
    UsageError,
    VisintError,
    Where,
)

SOURCES = [Path(visint.__file__).parent, Path(visint.__file__).parents[1] / "plugins"]
PROBLEM = Problem(
    "VI203",
    "wants Depth float32 (H, W); 'match.left' is Disparity float32 (H, W)",
    Where("g.yaml", 16, 20, "nodes.couple.in.depth"),
    choices="outputs of 'depth' (stereo.depth): depth: Depth",
    write="depth: depth.depth",
)


def subclasses(root):
    for each in root.__subclasses__():
        if each.__module__.startswith("visint."):
            yield each
            yield from subclasses(each)


def drawn():
    """(name, exit code, what it is for) of every class in the tree of the docstring."""
    tree = re.findall(r"^    [├└]── (\w+) +\(exit (\d+)\)  (.+)$", errors.__doc__, re.MULTILINE)
    return {name: (int(code), text) for name, code, text in tree}


class TestTree:
    def test_the_drawn_tree_is_the_tree(self):
        """Every class of visint's own is in the drawing, with its exit code, and nothing else is."""
        assert {each.__name__: each.exit_code for each in subclasses(VisintError)} == {
            name: code for name, (code, _) in drawn().items()
        }
        assert all(each.__bases__ == (VisintError,) for each in subclasses(VisintError))

    def test_all_are_exported(self):
        names = {"VisintError", "Problem", "Where", "CODES", *drawn()}
        assert set(errors.__all__) == names
        assert names - {"Problem", "Where", "CODES"} <= set(visint.__all__)

    def test_the_exit_codes_are_those_of_the_command_line(self):
        codes = {each: each.exit_code for each in (GraphError, UsageError, InputError, PluginError)}
        assert codes == {GraphError: 2, UsageError: 2, InputError: 3, PluginError: 4}
        assert (ModuleError.exit_code, OutputError.exit_code, Cancelled.exit_code) == (4, 5, 130)

    def test_each_says_what_to_mend(self):
        assert all(each.__doc__.strip() for each in subclasses(VisintError))


class TestCodes:
    def test_every_code_has_a_meaning_of_its_own(self):
        assert all(re.fullmatch(r"VI\d{3}", code) for code in CODES)
        assert len(set(CODES.values())) == len(CODES)
        assert all(text == text.strip() and not text.endswith(".") for text in CODES.values())

    def test_every_code_in_the_sources_is_documented(self):
        """No message carries a code that the table does not explain."""
        used = {
            (code, path.name)
            for root in SOURCES
            for path in root.rglob("*.py")
            for code in re.findall(r"\"(VI\d+)\"", path.read_text(encoding="utf-8"))
        }
        assert not [(code, name) for code, name in sorted(used) if code not in CODES]
        assert used


class TestTexts:
    def test_found_wanted_choices_write_fault(self):
        """Code, place, what was found and wanted; the choices; the line to write; whose fault."""
        assert str(PROBLEM) == (
            "VI203 g.yaml:16:20 nodes.couple.in.depth: wants Depth float32 (H, W); 'match.left' is Disparity "
            "float32 (H, W)\n  outputs of 'depth' (stereo.depth): depth: Depth.   Write: depth: depth.depth   "
            "[graph]"
        )

    def test_less_is_left_out(self):
        assert str(Problem("VI130", "interrupted", fault="usage")) == "VI130: interrupted\n  [usage]"
        assert str(Problem("VI301", "no such file", Where("a.png"), fault="input")).startswith(
            "VI301 a.png: no"
        )

    @pytest.mark.parametrize(
        ("where", "text"),
        [
            (Where(), ""),
            (Where("g.yaml"), "g.yaml"),
            (Where("g.yaml", 3, 1), "g.yaml:3:1"),
            (Where(path="nodes.a"), "nodes.a"),
            (Where("g.yaml", 3, 1, "nodes.a"), "g.yaml:3:1 nodes.a"),
        ],
    )
    def test_places(self, where, text):
        assert str(where) == text

    def test_all_problems_are_told_together(self):
        error = GraphError([PROBLEM, Problem("VI202", "points nowhere")])
        assert [problem.code for problem in error.problems] == ["VI203", "VI202"]
        assert str(error).count("VI20") == 2
        assert GraphError(PROBLEM).problems == (PROBLEM,)

    def test_problems_may_come_from_a_generator(self):
        error = InputError(Problem(code, CODES[code]) for code in ("VI301", "VI302"))
        assert len(error.problems) == 2
        assert len(str(error).splitlines()) == 4

    @pytest.mark.parametrize("kind", list(subclasses(VisintError)), ids=lambda kind: kind.__name__)
    def test_of_knows_whose_fault_it_is(self, kind):
        error = kind.of("VI401", "broke", where="match", choices="a, b", write="c")
        assert type(error) is kind
        (problem,) = error.problems
        assert problem.fault == kind.fault
        assert str(error) == f"VI401 match: broke\n  a, b.   Write: c   [{kind.fault}]"


class TestAcrossProcesses:
    @pytest.mark.parametrize("kind", [VisintError, *subclasses(VisintError)], ids=lambda kind: kind.__name__)
    @pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, lambda e: pickle.loads(pickle.dumps(e))])
    def test_errors_arrive_whole(self, kind, again):
        """A worker's error is the same error in the driver."""
        error = kind([PROBLEM, Problem("VI401", "broke")])
        arrived = again(error)
        assert type(arrived) is kind
        assert arrived.problems == error.problems
        assert str(arrived) == str(error)

    def test_problems_are_values(self):
        assert hash(PROBLEM) == hash(copy.copy(PROBLEM))
        with pytest.raises(AttributeError):
            PROBLEM.code = "VI000"

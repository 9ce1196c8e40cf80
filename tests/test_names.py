"""Names of modules and ports: what is one, how it is read, and which was meant."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from visint.names import ModuleId, PortRef, did_you_mean, is_name, listed

WORDS = st.from_regex(r"[a-z][a-z0-9_]{0,30}", fullmatch=True)


@pytest.mark.parametrize("text", ["a", "sgm", "mean_2", "x" * 64, "z__9_"])
def test_names(text):
    assert is_name(text)


@pytest.mark.parametrize(
    "text",
    ["", "A", "9a", "_a", "a-b", "a b", "a.b", "x" * 65, "é", "a\n", "ａ", "a٣", "../a", "a\x00"],
)
def test_no_names(text):
    """Capitals, other scripts' letters and digits, trailing newlines, separators, more than 64."""
    assert not is_name(text)


@pytest.mark.parametrize("made", [ModuleId, PortRef])
class TestDotted:
    @given(first=WORDS, second=WORDS)
    def test_there_and_back(self, made, first, second):
        found = made.parse(f"{first}.{second}")
        assert found == (first, second)
        assert str(found) == f"{first}.{second}"

    @pytest.mark.parametrize(
        "text", ["", "a", "a.", ".b", "a.b.c", "A.b", "a. b", "a..b", "os.path:join", "a.b\n"]
    )
    def test_what_is_none(self, made, text):
        assert made.parse(text) is None

    @given(text=st.text(max_size=80))
    def test_no_text_is_too_strange(self, made, text):
        """Whatever a graph file holds: a reference or None, and never an exception."""
        found = made.parse(text)
        assert found is None or str(found) == text


class TestNearMisses:
    @pytest.mark.parametrize(
        ("word", "meant"),
        [
            ("dephts", "depth"),
            ("disparty", "disparity"),
            ("left_", "left"),
            ("normal", "normals"),
            ("qqq", None),
        ],
    )
    def test_did_you_mean(self, word, meant):
        assert did_you_mean(word, ["depth", "disparity", "left", "normals", "right"]) == meant

    def test_the_order_of_the_known_does_not_matter(self):
        """Two equally near: the same one whatever the order, since messages must not differ by chance."""
        assert did_you_mean("cat", ["bat", "rat"]) == did_you_mean("cat", ["rat", "bat"])
        assert did_you_mean("cat", iter({"bat", "rat"})) in ("bat", "rat")

    def test_nothing_known(self):
        assert did_you_mean("depth", []) is None

    def test_listed(self):
        assert listed(["b", "a"]) == "b, a"
        assert listed([]) == "none"
        assert listed([], none="no input") == "no input"

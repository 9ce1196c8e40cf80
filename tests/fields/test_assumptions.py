"""The table of assumptions: its names, its sentences, and what is said of a wrong one."""

from __future__ import annotations

import pytest

from visint.fields.assumptions import ASSUMPTIONS, check_names, meaning
from visint.names import is_name


def test_the_glossary_is_whole():
    """Appendix B has 32 entries; some more are needed, and every one is a name and a sentence."""
    assert len(ASSUMPTIONS) >= 32
    assert all(is_name(name) for name in ASSUMPTIONS)
    assert all(says[0].isupper() and says.endswith(".") and len(says) <= 100 for says in ASSUMPTIONS.values())
    assert {"opacity", "general_viewpoint", "lambertian_reflectance", "homogeneity"} <= ASSUMPTIONS.keys()


def test_a_plugin_may_bring_its_own():
    check_names(("opacity", "flow.slow_water"))
    assert meaning("flow.slow_water") == ""
    assert meaning("opacity").startswith("One surface")


@pytest.mark.parametrize(
    ("names", "said"),
    [
        (("lambertian_reflectence",), "did you mean 'lambertian_reflectance'?"),
        (("quite_another",), "'plugin.name'"),
        (("Flow.Slow",), "'Flow.Slow' is unknown"),
        (("opacity", "opacity"), "twice"),
    ],
)
def test_wrong_names_are_refused(names, said):
    with pytest.raises(ValueError, match=said.replace("?", r"\?")):
        check_names(names)


@pytest.mark.parametrize("names", ["opacity", (1,)])
def test_what_is_no_tuple_of_names(names):
    with pytest.raises(TypeError, match="tuple of names"):
        check_names(names)

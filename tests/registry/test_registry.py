"""Plugins: found without importing, loaded one by one, their failures their own; clashes refused by name."""

from __future__ import annotations

# ruff: noqa: E501 - a table of broken plugins
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path

import pytest

import visint.testing.plugin
from visint.errors import GraphError, PluginError
from visint.graph import load, parse_graph
from visint.names import ModuleId
from visint.registry import Catalog, discover
from visint.registry import installed as installed_catalog
from visint.testing import installed

HEAD = """
from visint.hookspecs import hookimpl
from visint.module import Context, Module, Params, Ports

class Out(Ports):
    value: float

class One(Module[Params, Ports, Out]):
    name = "one"
    def run(self, inputs: Ports, ctx: Context) -> Out:
        return Out(value=1.0)
"""
MODULES = "\n@hookimpl\ndef visint_modules():\n    return [One]\n"
SOUND = HEAD + MODULES

BROKEN = {
    "raises at import": ("raise RuntimeError('no licence')", "RuntimeError: no licence"),
    "exits at import": ("import sys\nsys.exit('bye')", "SystemExit: bye"),
    "misses a library": ("import no_such_library", "ModuleNotFoundError: No module named 'no_such_library'"),
    "does not parse": ("def (:", "SyntaxError"),
    "misspells a hook": (HEAD + MODULES.replace("visint_modules", "visint_module"), "unknown hook 'visint_module'"),
    "misspells an unmarked hook": (SOUND + "\ndef visint_policy():\n    return {}\n", "'visint_policy' is no hook"),
    "marks what is no hook": (HEAD + MODULES.replace("visint_modules", "modules"), "unknown hook 'modules'"),
    "forgets to mark": (HEAD + MODULES.replace("@hookimpl\n", ""), "'visint_modules' is not marked with @hookimpl"),
    "takes arguments": (HEAD + MODULES.replace("modules()", "modules(catalog)"), "PluginValidationError"),
    "raises in a hook": (HEAD + MODULES.replace("return [One]", "raise KeyError('x')"), "KeyError: 'x'"),
    "exits in a hook": (HEAD + MODULES.replace("return [One]", "raise SystemExit(3)"), "SystemExit: 3"),
    "forgets to return": (HEAD + MODULES.replace("return", "given ="), "visint_modules gave nothing"),
    "returns a name": (HEAD + MODULES.replace("[One]", "['one']"), "'one', which is no subclass of Module"),
    "returns an object": (HEAD + MODULES.replace("[One]", "[One()]"), "no subclass of Module"),
    "returns another class": (HEAD + MODULES.replace("[One]", "[Out]"), "no subclass of Module"),
    "names a module badly": (SOUND.replace('"one"', '"One!"'), "'One!' of One is taken or no name"),
    "names two alike": (HEAD + MODULES.replace("[One]", "[One, One]"), "'one' of One is taken"),
    "misspells an assumption": (
        SOUND.replace('name = "one"', 'name = "one"\n    assumptions = ("lambertian_reflectence",)'),
        "assumption 'lambertian_reflectence' is unknown; did you mean 'lambertian_reflectance'?",
    ),
    "says no models": (SOUND.replace("Module[Params, Ports, Out]", "Module"), "does not say Module[Params, Inputs, Outputs]"),
    "has no run": (SOUND.replace("def run", "def ran"), "One has no run"),
    "takes any array": (SOUND.replace("value: float", "value: object"), "TypeError: port 'value'"),
    "brings a kind that is none": (SOUND + "\n@hookimpl\ndef visint_fields():\n    return ['Flow']\n", "no FieldKind"),
    "takes a built-in kind": (
        SOUND + "\nfrom visint.fields import FieldKind\n@hookimpl\ndef visint_fields():\n    return [FieldKind('Depth')]\n",
        "must be named 'bad.Depth'",
    ),
    "has an odd policy": (
        SOUND + "\n@hookimpl\ndef visint_policies():\n    return {'p': {'Depth': {'blend': {'uses': 'a.b'}}}}\n",
        "policy 'p': a step is 'cohere' or 'reconcile'",
    ),
    "has a policy of lists": (SOUND + "\n@hookimpl\ndef visint_policies():\n    return {'p': ['Depth']}\n", "AttributeError"),
}  # fmt: skip


@pytest.fixture
def catalog():
    """A catalog that looks anew at what is installed."""
    return Catalog()


@pytest.mark.parametrize("what", BROKEN)
def test_a_broken_plugin_is_named_and_harms_no_other(what, catalog):
    """VI501 with plugin, distribution, version and reason, each time it is asked; its neighbour works."""
    code, said = BROKEN[what]
    with (
        installed("bad-vision", plugins={"bad": "bad_vision"}, files={"bad_vision.py": code}, version="2.1"),
        installed("fine-vision", plugins={"fine": "fine_vision"}, files={"fine_vision.py": SOUND}),
    ):
        for _ in range(2):
            with pytest.raises(PluginError) as caught:
                catalog.plugin("bad")
            assert caught.value.problems[0].code == "VI501"
            assert "plugin 'bad' (bad-vision 2.1)" in str(caught.value)
            assert said in str(caught.value)
        assert catalog.module(ModuleId("fine", "one")).name == "one"
        assert [plugin.name for plugin in catalog.loaded] == ["fine"]


def test_a_graph_of_a_broken_plugin_names_the_node_and_is_the_plugins_fault(catalog):
    """Exit code 4, with the place of the node; a graph that does not use it is none the worse."""
    text = "visint: 1\nname: a\nnodes: {one: {uses: bad.one}}\noutputs: {value: one.value}\n"
    with (
        installed("bad-vision", plugins={"bad": "bad_vision"}, files={"bad_vision.py": "1 / 0"}),
        installed("fine-vision", plugins={"fine": "fine_vision"}, files={"fine_vision.py": SOUND}),
    ):
        with pytest.raises(PluginError) as caught:
            parse_graph(text, catalog, file="g.yaml")
        assert caught.value.exit_code == 4
        assert str(caught.value).startswith("VI501 g.yaml:3:21 nodes.one.uses: plugin 'bad'")
        assert (
            parse_graph(text.replace("bad.", "fine."), catalog).nodes["one"].callee.origin == "fine-vision 1.0"
        )


def test_another_version_of_the_contract_is_refused_by_name(catalog):
    """VI503: both versions, and what to do."""
    files = {"old_vision.py": SOUND + "\nvisint_contract = 0\n"}
    with installed("old-vision", plugins={"old": "old_vision"}, files=files):
        with pytest.raises(PluginError, match="VI503") as caught:
            catalog.plugin("old")
        assert "written for contract 0; this visint has 1" in str(caught.value)
        assert "pip install --upgrade old-vision" in str(caught.value)


def test_two_distributions_of_one_name_are_refused_with_both_named(catalog):
    """VI502; neither is imported, neither chosen; other names stay usable."""
    with ExitStack() as stack:
        for name, package in (("first-flow", "first_flow"), ("second-flow", "second_flow")):
            files = {f"{package}.py": "raise AssertionError('imported')"}
            stack.enter_context(installed(name, plugins={"flow": package}, files=files))
        stack.enter_context(installed("fine", plugins={"fine": "fine_vision"}, files={"fine_vision.py": SOUND}))
        with pytest.raises(PluginError, match="VI502") as caught:
            catalog.plugin("flow")
        assert "first-flow 1.0 and second-flow 1.0" in str(caught.value)
        assert catalog.plugin("fine").modules


def test_one_distribution_seen_twice_is_one(catalog):
    """A checkout and its installed copy are the same distribution: the first on the path counts."""
    with (
        installed("flow", plugins={"flow": "flow_old"}, files={"flow_old.py": "1 / 0"}, version="1"),
        installed("flow", plugins={"flow": "flow_new"}, files={"flow_new.py": SOUND}, version="2"),
    ):
        assert catalog.plugin("flow").origin == "flow 2"


def test_a_name_that_is_not_there(catalog):
    """VI504 lists what there is."""
    with pytest.raises(PluginError, match="VI504") as caught:
        catalog.plugin("flaw")
    assert "installed plugins: " in str(caught.value)


@pytest.mark.parametrize(
    "damage", [{"METADATA": None}, {"METADATA": ""}, {"entry_points.txt": "[visint.plugins]\nnonsense\n"}]
)
def test_a_distribution_with_broken_metadata_hides_no_other(damage):
    """Missing or empty metadata, or entry points that do not parse."""
    with installed("torn", plugins={"torn": "torn_vision"}, files={"torn_vision.py": SOUND}) as folder:
        (about,) = folder.glob("*.dist-info")
        for name, text in damage.items():
            (about / name).unlink()
            if text is not None:
                (about / name).write_text(text)
        with installed("fine-vision", plugins={"fine": "fine_vision"}, files={"fine_vision.py": SOUND}):
            found = discover("visint.plugins")
            assert found["fine"][0].origin == "fine-vision 1.0"
            assert Catalog().plugin("fine").modules


IMPORTS_NOTHING = """
import sys
from visint.registry import Catalog, discover
catalog = Catalog()
assert {"flow", "other"} <= {*catalog.plugin_names}, catalog.plugin_names
discover("visint.commands"), catalog.graphs()
assert not {"flow_vision", "other_vision", "visint_stereo", "visint_lab"} & {*sys.modules}
assert catalog.plugin("flow").modules
assert "flow_vision" in sys.modules and "other_vision" not in sys.modules
assert not {"cv2", "scipy", "numba"} & {*sys.modules}
"""


def test_discovery_imports_nothing_and_loading_imports_one():
    """In a fresh process: names are known without an import; one plugin loaded leaves the others alone."""
    with (
        installed("flow", plugins={"flow": "flow_vision"}, files={"flow_vision.py": SOUND}) as one,
        installed("other", plugins={"other": "other_vision"}, files={"other_vision.py": "1 / 0"}) as two,
    ):
        path = ":".join([str(one), str(two), *filter(None, sys.path)])
        done = subprocess.run(
            [sys.executable, "-c", IMPORTS_NOTHING],
            env={"PYTHONPATH": path},
            capture_output=True,
            text=True,
            check=False,
        )
    assert done.returncode == 0, done.stderr


GRAPH = "visint: 1\nname: flow\nnodes: {one: {uses: flow.one}}\noutputs: {value: one.value}\n"


def test_graphs_of_a_distribution_are_found_by_name(catalog):
    """A folder of graph files is no more imported than a plugin is."""
    files = {"flow_vision.py": SOUND, "flow_graphs/flow.yaml": GRAPH, "flow_graphs/__init__.py": "1 / 0"}
    with installed(
        "flow", plugins={"flow": "flow_vision"}, files=files, groups={"visint.graphs": {"flow": "flow_graphs"}}
    ):
        assert load("flow", catalog).nodes["one"].callee.id == "flow.one"


def test_two_folders_with_a_graph_of_one_name_are_refused_with_both_named(catalog):
    """As for plugins: never a silent choice, and other graphs stay usable."""
    with ExitStack() as stack:
        for name in ("first", "second"):
            files = {f"{name}_graphs/flow.yaml": GRAPH, f"{name}_graphs/{name}.yaml": GRAPH}
            groups = {"visint.graphs": {name: f"{name}_graphs"}}
            stack.enter_context(installed(name, files=files, groups=groups))
        stack.enter_context(installed("flow", plugins={"flow": "flow_vision"}, files={"flow_vision.py": SOUND}))
        assert load("first", catalog)
        with pytest.raises((PluginError, GraphError)) as caught:
            load("flow", catalog)
        assert "first" in str(caught.value)
        assert "second" in str(caught.value)


def test_given_plugins_go_through_the_same_door():
    """Objects given in code are loaded, refused and named as installed ones are."""

    class Bad:
        def visint_modules(self):
            return []

    catalog = Catalog({"toy": visint.testing.plugin, "bad": Bad()}, {})
    assert catalog.plugin("toy").origin == "given in code"
    assert catalog.plugin_names == ("bad", "toy")
    with pytest.raises(PluginError, match="not marked with @hookimpl"):
        catalog.plugin("bad")


def test_the_installed_catalog_follows_the_path():
    """One catalog as long as the path is the same, another when something is installed."""
    before = installed_catalog()
    assert installed_catalog() is before
    with installed("flow", plugins={"flow": "flow_vision"}, files={"flow_vision.py": SOUND}):
        assert "flow" in installed_catalog().plugin_names
    assert "flow" not in installed_catalog().plugin_names


def test_what_is_shipped_is_found(catalog):
    """The shipped plugins and graphs, from the same entry points as a stranger's."""
    if "stereo" not in catalog.plugin_names:
        pytest.skip("visint itself is not installed here")
    assert {"lab", "stereo"} <= {*catalog.plugin_names}
    shipped = {path.stem for path in (Path(__file__).parents[2] / "graphs").glob("*.yaml")}
    assert shipped <= {*catalog.graphs()}

"""Every graph file that is shipped: named like its file, sound, one object with its YAML, and able to run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import visint
from visint.graph import parse_graph
from visint.registry import installed
from visint_lab.render.rendering import render
from visint_lab.scenes import scene
from visint_lab.scenes.demonstration import sphere_before_plane

GRAPHS = sorted((Path(__file__).parents[2] / "graphs").glob("*.yaml"))
every_graph = pytest.mark.parametrize("path", GRAPHS, ids=lambda path: path.stem)


@pytest.fixture(scope="module")
def before_a_plane():
    """A textured sphere before a plane, whose truth is known; all that a graph can ask for is in it."""
    return render(sphere_before_plane(size=64, seed=0))


@pytest.fixture(scope="module")
def before_a_void():
    """A shaded sphere before nothing: what the joint estimate has candidates and uncertain normals of."""
    return render(scene("a/sphere/lambertian", 64))


@pytest.fixture
def pair(path, before_a_plane, before_a_void):
    """The scene that a graph is for."""
    return before_a_void if path.stem.startswith("joint") else before_a_plane


def test_there_are_graphs_and_they_are_found_by_name():
    assert {path.stem for path in GRAPHS} <= set(installed().graphs())
    assert len(GRAPHS) >= 2


@every_graph
def test_its_name_is_that_of_its_file(path):
    assert visint.load(path).name == path.stem


@every_graph
def test_it_says_what_it_is_for(path):
    """One sentence, which ``visint show`` prints first."""
    about = visint.load(path).spec.about
    assert about
    assert about.endswith(".")
    assert len(about.split()) >= 4


@every_graph
def test_its_yaml_reads_back_equal(path):
    """As written, as its expansion, and once more."""
    graph = visint.load(path)
    again = parse_graph(graph.to_yaml())
    assert again == graph
    assert again.to_yaml() == graph.to_yaml()
    plain = parse_graph(graph.expanded())
    assert plain.expanded() == graph.expanded()


@every_graph
def test_it_runs(path, pair):
    """At a small size on a scene of the lab: every output has values, maps are of the images' size."""
    graph = visint.load(path)
    offered = {"left": pair.left, "right": pair.right, "camera": pair.camera, "light": pair.light}
    offered |= {"image": pair.left}
    inputs = {name: offered[name] for name in graph.inputs if name in offered}
    result = visint.run(graph, inputs)
    assert set(graph.outputs) <= set(result)
    for name, value in result.items():
        if isinstance(value, np.ndarray) and value.ndim >= 2:
            assert value.shape[:2] == pair.left.shape, name
        if isinstance(value, np.ndarray) and value.dtype.kind == "f":
            assert np.isfinite(value).any(), name
    for name, sure in result.confidence.items():
        assert ((sure >= 0) & (sure <= 1)).all(), name


@every_graph
def test_its_variants_are_sound(path):
    """Each of its controls, and the graph without each of its spokes."""
    from visint.graph import alter

    graph = visint.load(path)
    for control in graph.spec.controls:
        assert alter(graph, control=control) != graph
    for spoke in graph.spec.hub.spokes if graph.spec.hub else ():
        assert spoke not in alter(graph, without=[spoke]).nodes
